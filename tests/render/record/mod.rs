//! Video and animation files: contents and durations of the recorded frames.

#![forbid(unsafe_code)]

mod animated_gif;
mod animated_png;
mod misuse;
mod sequence;
mod video;

use std::path::Path;

use mujoco_safe::record::{Recorder, RecorderOptions};

const WIDTH: usize = 24;
const HEIGHT: usize = 10;

/// Returns a grey image with a bright square at a position that depends on the number, with unequal
/// amounts of each channel.
fn picture(number: usize) -> Vec<u8> {
    let mut rgb = vec![90; 3 * WIDTH * HEIGHT];
    for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
        let pixel = (row + 2 + number % 5) * WIDTH + (column + 3 * number) % WIDTH;
        rgb[3 * pixel..][..3].copy_from_slice(&[250, (40 * (number % 6)) as u8, 10]);
    }
    rgb
}

fn options(frames_per_second: f64) -> RecorderOptions {
    RecorderOptions::default().with_frames_per_second(frames_per_second)
}

/// Records images at these times, starting with `picture(0)`.
fn record(path: &Path, options: RecorderOptions, times: impl IntoIterator<Item = f64>) -> mujoco_safe::record::Summary {
    let mut recorder = Recorder::create(path, options).unwrap();
    for (number, time) in times.into_iter().enumerate() {
        assert!(recorder.is_due(time));
        assert!(recorder.push_rgb(WIDTH, HEIGHT, &picture(number), time).unwrap());
    }
    recorder.finish().unwrap()
}

/// A displayed frame and its duration in seconds.
struct Shown {
    rgb: Vec<u8>,
    seconds: f64,
}

/// Asserts the images, their order and their durations.
fn assert_shows(shown: &[Shown], expected: &[(usize, f64)]) {
    assert_eq!(shown.len(), expected.len());
    for (index, (shown, &(number, seconds))) in shown.iter().zip(expected).enumerate() {
        assert!(shown.rgb == picture(number), "image {index} must have number {number}");
        assert!((shown.seconds - seconds).abs() < 1e-9, "image {index} is shown for {} s", shown.seconds);
    }
}

/// Returns the names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
