//! Animated PNG.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use mujoco_safe::record::{Format, Recorder};

use super::{HEIGHT, Shown, WIDTH, assert_shows, names, options, picture, record};

/// Returns all frames as displayed, and the number of repetitions.
fn decode(path: &Path) -> (Vec<Shown>, u32) {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let control = *reader.info().animation_control().unwrap();
    let mut screen = vec![0; 3 * WIDTH * HEIGHT];
    let mut part = vec![0; reader.output_buffer_size().unwrap()];
    let shown = (0..control.num_frames).map(|_| {
        reader.next_frame(&mut part).unwrap();
        let frame = *reader.info().frame_control().unwrap();
        assert_eq!((frame.blend_op, frame.dispose_op), (png::BlendOp::Source, png::DisposeOp::None));
        let bytes = 3 * frame.width as usize;
        for row in 0..frame.height as usize {
            let start = 3 * ((frame.y_offset as usize + row) * WIDTH + frame.x_offset as usize);
            screen[start..start + bytes].copy_from_slice(&part[row * bytes..][..bytes]);
        }
        Shown { rgb: screen.clone(), seconds: f64::from(frame.delay_num) / f64::from(frame.delay_den) }
    });
    let shown = shown.collect();
    reader.finish().unwrap();
    (shown, control.num_plays)
}

#[test]
fn frames_and_delays_are_those_of_the_simulation() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["walk.png", "walk.apng"] {
        let path = folder.path().join(name);
        let summary = record(&path, options(10.0).with_plays(3), [7.0, 7.1, 7.2, 7.5]);
        assert_eq!((summary.format, summary.frames, summary.seconds), (Format::AnimatedPng, 6, 0.6));
        assert_eq!(summary.path, path);
        let (shown, plays) = decode(&path);
        assert_eq!(plays, 3);
        assert_shows(&shown, &[(0, 0.1), (1, 0.1), (2, 0.3), (3, 0.1)]);
    }
    assert_eq!(names(folder.path()), ["walk.apng", "walk.png"]);
}

#[test]
fn delays_of_a_fractional_frame_rate_add_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.png");
    let rate = 30_000.0 / 1001.0;
    record(&path, options(rate), (0..40).map(|frame| f64::from(frame) / rate));
    let (shown, plays) = decode(&path);
    assert_eq!((shown.len(), plays), (40, 0));
    let seconds: f64 = shown.iter().map(|shown| shown.seconds).sum();
    assert!((seconds - 40.0 / rate).abs() < 1e-4, "{seconds}");
}

#[test]
fn a_frame_may_last_longer_than_the_largest_delay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.png");
    record(&path, options(1000.0), [0.0, 70.0]);
    assert_shows(&decode(&path).0, &[(0, 65.535), (0, 4.465), (1, 0.001)]);
}

#[test]
fn the_file_appears_when_the_recording_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.png");
    std::fs::write(&path, "old").unwrap();
    let mut recorder = Recorder::create(&path, options(10.0)).unwrap();
    recorder.push_rgb(WIDTH, HEIGHT, &picture(0), 0.0).unwrap();
    recorder.push_rgb(WIDTH, HEIGHT, &picture(1), 0.1).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    drop(recorder);
    assert_shows(&decode(&path).0, &[(0, 0.1), (1, 0.1)]);
    assert_eq!(names(folder.path()), ["walk.png"]);
}

#[test]
fn a_panic_keeps_the_recorded_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.png");
    let recording = path.clone();
    let panicked = std::thread::spawn(move || {
        let mut recorder = Recorder::create(recording, options(10.0)).unwrap();
        recorder.push_rgb(WIDTH, HEIGHT, &picture(0), 0.0).unwrap();
        std::panic::resume_unwind(Box::new("a mistake"));
    });
    panicked.join().unwrap_err();
    assert_shows(&decode(&path).0, &[(0, 0.1)]);
}

#[test]
fn a_recording_continues_after_a_reset_of_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.png");
    record(&path, options(10.0), [3.0, 3.1, 0.0, 0.1]);
    assert_shows(&decode(&path).0, &[(0, 0.1), (1, 0.1), (2, 0.1), (3, 0.1)]);
}

#[test]
fn slow_motion_records_more_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.png");
    let mut recorder = Recorder::create(&path, options(20.0).with_speed(0.1)).unwrap();
    let taken: Vec<bool> =
        (0..=100).map(|step| recorder.push_rgb(WIDTH, HEIGHT, &picture(step), step as f64 * 0.001).unwrap()).collect();
    for (step, &taken) in taken.iter().enumerate() {
        assert_eq!(taken, step % 5 == 0, "step {step}");
    }
    let summary = recorder.finish().unwrap();
    assert_eq!((summary.frames, summary.seconds), (21, 1.05));
    assert_eq!(decode(&path).0.len(), 21);
}
