//! Rejected options, files and images.

use std::fs;

use mujoco_safe::Error;
use mujoco_safe::record::{Recorder, RecorderOptions};

use super::{HEIGHT, WIDTH, names, options, picture};

#[test]
fn an_option_out_of_range_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let rejected = |name: &str, options| {
        let error = Recorder::create(folder.path().join(name), options).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        error.to_string()
    };
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1001.0] {
        assert!(rejected("a.png", options(rate)).contains("frames_per_second"));
    }
    assert!(rejected("a.gif", options(51.0)).contains("from 0.001 to 50"));
    for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(rejected("a.png", RecorderOptions::default().with_speed(speed)).contains("speed"));
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn creating_a_recorder_with_an_unwritable_file_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["missing/walk.png", "missing/walk.gif"] {
        let error = Recorder::create(folder.path().join(name), RecorderOptions::default()).unwrap_err();
        assert!(matches!(&error, Error::File { path, .. } if path.ends_with(name)), "{error}");
    }
    // A folder that is a file.
    fs::write(folder.path().join("file"), "").unwrap();
    let error = Recorder::create(folder.path().join("file/frames"), RecorderOptions::default()).unwrap_err();
    assert!(error.to_string().contains("file/frames"), "{error}");
    let error = Recorder::create(folder.path().join("walk.jpg"), RecorderOptions::default()).unwrap_err();
    assert!(matches!(&error, Error::Save { path, .. } if path.ends_with("walk.jpg")), "{error}");
}

#[test]
fn an_image_of_another_size_is_rejected_and_the_recording_continues() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["walk.png", "walk.gif", "walk_%d.png"] {
        let mut recorder = Recorder::create(folder.path().join(name), options(10.0)).unwrap();
        recorder.push_rgb(WIDTH, HEIGHT, &picture(0), 0.0).unwrap();
        for (width, height) in [(WIDTH + 1, HEIGHT), (WIDTH, HEIGHT - 1), (HEIGHT, WIDTH)] {
            let error = recorder.push_rgb(width, height, &vec![0; 3 * width * height], 0.1).unwrap_err();
            assert!(error.to_string().contains("24 × 10"), "{error}");
        }
        assert!(recorder.is_due(0.1));
        recorder.push_rgb(WIDTH, HEIGHT, &picture(1), 0.1).unwrap();
        assert_eq!(recorder.finish().unwrap().frames, 2);
    }
}

#[test]
fn each_property_of_an_image_is_checked() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path().join("walk.gif"), options(10.0)).unwrap();
    let rgb = picture(0);
    for (width, height) in [(0, HEIGHT), (WIDTH, 0), (usize::MAX, HEIGHT), (WIDTH, usize::MAX), (1 << 31, 1 << 31)] {
        let error = recorder.push_rgb(width, height, &rgb, 0.0).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
    for length in [0, rgb.len() - 1, rgb.len() - 3] {
        let error = recorder.push_rgb(WIDTH, HEIGHT, &rgb[..length], 0.0).unwrap_err();
        assert!(matches!(error, Error::Shape { .. }), "{error}");
    }
    for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!recorder.is_due(time));
        let error = recorder.push_rgb(WIDTH, HEIGHT, &rgb, time).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
    recorder.push_rgb(WIDTH, HEIGHT, &rgb, -f64::MAX).unwrap();
    let error = recorder.push_rgb(WIDTH, HEIGHT, &rgb, f64::MAX).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    assert_eq!(recorder.finish().unwrap().frames, 1);
}

#[test]
fn an_image_larger_than_the_gif_limit_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path().join("walk.gif"), options(10.0)).unwrap();
    let error = recorder.push_rgb(65_536, 1, &vec![0; 3 * 65_536], 0.0).unwrap_err();
    assert!(error.to_string().contains("65535"), "{error}");
    drop(recorder);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_recording_without_images_is_an_error_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["walk.png", "walk.gif"] {
        let create = || Recorder::create(folder.path().join(name), options(10.0)).unwrap();
        let error = create().finish().unwrap_err();
        assert!(error.to_string().contains("no image was recorded"), "{error}");
        drop(create());
    }
    assert!(names(folder.path()).is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_once_and_ends_the_recording() {
    for name in ["walk.gif", "walk.png"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        // /dev/full can be opened, but not written to.
        std::os::unix::fs::symlink("/dev/full", &path).unwrap();
        let mut recorder = Recorder::create(&path, options(10.0)).unwrap();
        let error = (0..1000)
            .find_map(|number| recorder.push_rgb(WIDTH, HEIGHT, &picture(number), number as f64 / 10.0).err())
            .unwrap();
        assert!(matches!(&error, Error::File { path, .. } if path.ends_with(name)), "{error}");
        let error = recorder.push_rgb(WIDTH, HEIGHT, &picture(0), 2000.0).unwrap_err();
        assert!(error.to_string().contains("an earlier write failed"), "{error}");
        recorder.finish().unwrap_err();
    }
}
