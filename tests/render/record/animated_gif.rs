//! Animated GIF.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use mujoco_safe::record::{Format, Recorder};

use super::{HEIGHT, Shown, WIDTH, assert_shows, names, options, record};

/// Returns all frames as displayed, and the number of repetitions.
fn decode(path: &Path) -> (Vec<Shown>, gif::Repeat) {
    // Decodes indices and palettes, because a transparent pixel keeps the previous frame's colour.
    let mut decoder = gif::Decoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    let global = decoder.global_palette().unwrap().to_vec();
    let mut screen = vec![0; 3 * width * height];
    let mut shown = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert!(frame.dispose == gif::DisposalMethod::Keep && shown.is_empty() == frame.transparent.is_none());
        let palette = frame.palette.as_ref().unwrap_or(&global);
        for (place, &index) in frame.buffer.iter().enumerate() {
            let (row, column) = (place / usize::from(frame.width), place % usize::from(frame.width));
            let pixel = (row + usize::from(frame.top)) * width + column + usize::from(frame.left);
            if frame.transparent != Some(index) {
                screen[3 * pixel..][..3].copy_from_slice(&palette[3 * usize::from(index)..][..3]);
            }
        }
        shown.push(Shown { rgb: screen.clone(), seconds: f64::from(frame.delay) / 100.0 });
    }
    (shown, decoder.repeat())
}

#[test]
fn few_colours_are_exact_and_delays_add_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.gif");
    let mut times: Vec<f64> = (0..12).map(|frame| f64::from(frame) / 30.0).collect();
    times.push(20.0 / 30.0);
    let summary = record(&path, options(30.0), times);
    assert_eq!((summary.format, summary.frames), (Format::Gif, 21));
    let (shown, repeat) = decode(&path);
    assert_eq!(repeat, gif::Repeat::Infinite);
    // Frames of thirtieths of a second, each of which ends at the nearest hundredth.
    let ends: Vec<f64> =
        (1..=11).chain([20, 21]).map(|frame| (100.0 * f64::from(frame) / 30.0).round() / 100.0).collect();
    let expected: Vec<(usize, f64)> =
        (0..13).map(|number| (number, ends[number] - if number > 0 { ends[number - 1] } else { 0.0 })).collect();
    assert_shows(&shown, &expected);
    assert_eq!(names(folder.path()), ["walk.gif"]);
}

#[test]
fn a_file_lasts_until_the_end_of_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.gif");
    let begin = || {
        let mut recorder = Recorder::create(&path, options(10.0)).unwrap();
        recorder.push_rgb(WIDTH, HEIGHT, &super::picture(0), 5.0).unwrap();
        recorder
    };
    let summary = begin().finish_at(8.0).unwrap();
    assert_eq!((summary.frames, summary.seconds), (30, 3.0));
    assert_shows(&decode(&path).0, &[(0, 3.0)]);
    for earlier in [5.05, 5.0, 0.0, -1.0] {
        assert_eq!(begin().finish_at(earlier).unwrap().frames, 1);
    }
    // The file is complete although this end time is invalid.
    for time in [f64::NAN, f64::INFINITY, f64::MAX] {
        let error = begin().finish_at(time).unwrap_err();
        assert!(matches!(error, mujoco_safe::Error::Invalid { .. }), "{error}");
        assert_shows(&decode(&path).0, &[(0, 0.1)]);
    }
}

#[test]
fn a_frame_may_last_longer_than_the_largest_delay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.gif");
    record(&path, options(50.0), [0.0, 1000.0]);
    assert_shows(&decode(&path).0, &[(0, 655.35), (0, 344.65), (1, 0.02)]);
}

#[test]
fn the_number_of_repetitions_is_that_of_the_options() {
    let folder = tempfile::tempdir().unwrap();
    // The format counts repetitions after the first playback.
    for (plays, repeat) in [(0, gif::Repeat::Infinite), (1, gif::Repeat::Finite(0)), (4, gif::Repeat::Finite(3))] {
        let path = folder.path().join("walk.gif");
        record(&path, options(10.0).with_plays(plays), [0.0, 0.1]);
        assert_eq!(decode(&path).1, repeat);
    }
}

/// Returns an image of many colours, different in each frame.
fn colorful(width: usize, height: usize, number: usize) -> Vec<u8> {
    let pixel = |place: usize| {
        let (x, y) = (place % width, place / width);
        let (slope, other) = ((255 * x / width) as u8, (255 * y / height) as u8);
        match number % 3 {
            0 => [slope, other, 128],
            1 => [128, slope, other],
            _ => [other, 255 - slope, slope],
        }
    };
    (0..width * height).flat_map(pixel).collect()
}

#[test]
fn new_colours_get_a_new_palette() {
    let (width, height) = (64, 48);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.gif");
    let mut recorder = Recorder::create(&path, options(10.0)).unwrap();
    for number in 0..3 {
        recorder.push_rgb(width, height, &colorful(width, height, number), number as f64 * 0.1).unwrap();
    }
    recorder.finish().unwrap();
    let (shown, _) = decode(&path);
    for (number, shown) in shown.iter().enumerate() {
        let expected = colorful(width, height, number);
        let error: f64 =
            shown.rgb.iter().zip(&expected).map(|(&found, &expected)| f64::from(found.abs_diff(expected))).sum();
        let mean = error / expected.len() as f64;
        assert!(mean < 10.0, "image {number} is off by {mean}");
    }
}

#[test]
fn images_of_any_size_are_exact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.gif");
    for (width, height) in [(1, 1), (1, 17), (17, 1), (WIDTH, HEIGHT), (300, 2)] {
        let mut recorder = Recorder::create(&path, options(10.0)).unwrap();
        let rgb: Vec<u8> = (0..width * height).flat_map(|pixel| [(pixel % 100) as u8, 1, 2]).collect();
        recorder.push_rgb(width, height, &rgb, 0.0).unwrap();
        recorder.push_rgb(width, height, &rgb, 0.1).unwrap();
        recorder.finish().unwrap();
        let (shown, _) = decode(&path);
        assert!(shown.len() == 2 && shown.iter().all(|shown| shown.rgb == rgb), "{width} × {height}");
    }
}
