//! Numbered PNG files.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use mujoco_safe::record::{Format, Recorder};

use super::{HEIGHT, WIDTH, names, options, picture, record};

fn decode(path: &Path) -> Vec<u8> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((info.width, info.height, info.color_type), (WIDTH as u32, HEIGHT as u32, png::ColorType::Rgb));
    rgb
}

#[test]
fn each_frame_is_a_file_and_long_steps_repeat_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let pattern = folder.path().join("new/folder/walk_%03d.png");
    let summary = record(&pattern, options(10.0), [0.0, 0.1, 0.4]);
    assert_eq!((summary.format, summary.frames, summary.seconds), (Format::Sequence, 5, 0.5));
    assert_eq!(summary.path, folder.path().join("new/folder/walk_000.png"));
    let files = ["walk_000.png", "walk_001.png", "walk_002.png", "walk_003.png", "walk_004.png"];
    assert_eq!(names(&folder.path().join("new/folder")), files);
    for (file, number) in files.into_iter().zip([0, 1, 1, 1, 2]) {
        assert!(decode(&folder.path().join("new/folder").join(file)) == picture(number), "{file}");
    }
}

#[test]
fn a_folder_gets_numbered_files() {
    let folder = tempfile::tempdir().unwrap();
    let summary = record(folder.path(), options(10.0), [0.0, 0.1]);
    assert_eq!(summary.path, folder.path().join("frame_00000.png"));
    assert_eq!(names(folder.path()), ["frame_00000.png", "frame_00001.png"]);
    // Even if the name has an extension.
    let named = folder.path().join("a_%d.png");
    fs::create_dir(&named).unwrap();
    record(&named, options(10.0), [0.0]);
    assert_eq!(names(&named), ["frame_00000.png"]);
}

#[test]
fn files_appear_during_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::create(folder.path(), options(10.0)).unwrap();
    for number in 0..3 {
        recorder.push_rgb(WIDTH, HEIGHT, &picture(number), number as f64).unwrap();
    }
    assert_eq!((names(folder.path()).len(), recorder.frames()), (20, 21));
    drop(recorder);
    assert_eq!(names(folder.path()).len(), 21);
}
