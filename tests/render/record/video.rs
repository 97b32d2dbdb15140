//! Video through a stand-in for `ffmpeg`, which stores its arguments and input, and through
//! `ffmpeg` itself (written for ffmpeg 5.1 with libx264 and ffprobe).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mujoco_safe::record::{Format, Recorder, RecorderOptions};

use super::{HEIGHT, WIDTH, names, options, picture, record};
use crate::child;
use crate::installed::has;

#[cfg(unix)]
mod stand_in {
    use super::*;

    /// Creates the stand-in program in a folder.
    fn program(folder: &Path, script: &str) -> PathBuf {
        let (path, text) = (folder.join("ffmpeg"), folder.join("script"));
        fs::write(&text, format!("#!/bin/sh\n[ \"$1\" = -version ] && exit 0\n{script}\n")).unwrap();
        // Another process writes it: a child that another test starts at this moment would inherit
        // the open file of this one, and a file that is open for writing cannot be executed.
        let status = Command::new("install").args(["-m", "755"]).arg(text).arg(&path).status().unwrap();
        assert!(status.success());
        path
    }

    /// A script that stores its arguments and its input beside itself, and writes the file.
    const KEEPER: &str = "here=$(dirname \"$0\")
        printf '%s\\n' \"$@\" >\"$here/arguments\"
        cat >\"$here/input\"
        for last; do :; done
        cp \"$here/input\" \"${last#file:}\"";

    fn with(program: PathBuf) -> RecorderOptions {
        options(25.0).with_ffmpeg(program)
    }

    #[test]
    fn ffmpeg_gets_every_frame_and_the_file_appears_at_the_end() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let path = out.path().join("walk.mp4");
        let mut recorder = Recorder::create(&path, with(program(folder.path(), KEEPER))).unwrap();
        // The third image lasts for three frames.
        for (number, frame) in [0, 1, 2, 5].into_iter().enumerate() {
            recorder.push_rgb(WIDTH, HEIGHT, &picture(number), f64::from(frame) / 25.0).unwrap();
        }
        assert!(!path.exists());
        let summary = recorder.finish().unwrap();
        assert_eq!((summary.format, summary.frames, summary.seconds), (Format::Video, 6, 0.24));
        assert_eq!(summary.path, path);
        let expected: Vec<u8> = [0, 1, 2, 2, 2, 3].into_iter().flat_map(picture).collect();
        assert!(fs::read(folder.path().join("input")).unwrap() == expected);
        assert!(fs::read(&path).unwrap() == expected);
        assert_eq!(names(out.path()), ["walk.mp4"]);
        let arguments = fs::read_to_string(folder.path().join("arguments")).unwrap().replace('\n', " ");
        for part in [
            "-f rawvideo -pixel_format rgb24 -video_size 24x10 -framerate 25 -i pipe:0 ",
            " -c:v libx264 -preset veryfast -crf 18 ",
            " -pix_fmt yuv420p ",
            " -nostdin ",
            " -f mp4 ",
        ] {
            assert!(arguments.contains(part), "{part}: {arguments}");
        }
    }

    #[test]
    fn an_odd_size_is_padded_to_an_even_size() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let options = with(program(folder.path(), KEEPER)).with_ffmpeg_arguments(vec!["-c:v".into(), "mpeg4".into()]);
        let mut recorder = Recorder::create(out.path().join("walk.mkv"), options).unwrap();
        recorder.push_rgb(1, 3, &[1, 2, 3, 4, 5, 6, 7, 8, 9], 0.0).unwrap();
        recorder.finish().unwrap();
        let input = fs::read(folder.path().join("input")).unwrap();
        assert_eq!(input, [1, 2, 3, 1, 2, 3, 4, 5, 6, 4, 5, 6, 7, 8, 9, 7, 8, 9, 7, 8, 9, 7, 8, 9]);
        let arguments = fs::read_to_string(folder.path().join("arguments")).unwrap().replace('\n', " ");
        assert!(arguments.contains("-video_size 2x4 ") && arguments.contains("-f matroska "), "{arguments}");
        assert!(arguments.contains(" -c:v mpeg4 ") && !arguments.contains("libx264"), "{arguments}");
    }

    #[test]
    fn the_error_has_the_output_of_ffmpeg_and_no_file_remains() {
        let scripts = [
            "echo 'Unknown encoder libx264' >&2; exit 1",
            // The program fails late, after it has read all frames.
            "cat >/dev/null; echo 'Unknown encoder libx264' >&2; exit 1",
            // More than the buffer of a pipe.
            "cat >/dev/null; head -c 300000 /dev/zero | tr '\\0' x >&2; echo 'Unknown encoder libx264' >&2; exit 1",
        ];
        for script in scripts {
            let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
            let path = out.path().join("walk.mp4");
            let mut recorder = Recorder::create(&path, with(program(folder.path(), script))).unwrap();
            let failed = (0..300)
                .find_map(|number| recorder.push_rgb(WIDTH, HEIGHT, &picture(number), number as f64 / 25.0).err());
            let error = match failed {
                Some(error) => {
                    drop(recorder);
                    error
                }
                None => recorder.finish().unwrap_err(),
            };
            let text = error.to_string();
            for part in ["walk.mp4", "Unknown encoder libx264", "ffmpeg_arguments"] {
                assert!(text.contains(part), "{text}");
            }
            assert!(names(out.path()).is_empty());
        }
    }

    #[test]
    fn dropping_a_recorder_waits_for_ffmpeg() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let path = out.path().join("walk.mov");
        let mut recorder = Recorder::create(&path, with(program(folder.path(), KEEPER))).unwrap();
        recorder.push_rgb(WIDTH, HEIGHT, &picture(0), 0.0).unwrap();
        drop(recorder);
        assert!(fs::read(&path).unwrap() == picture(0));
    }

    #[test]
    fn a_broken_ffmpeg_is_an_error_of_create() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let broken = program(folder.path(), "");
        fs::write(&broken, "#!/bin/sh\nexit 3\n").unwrap();
        let error = Recorder::create(out.path().join("walk.mp4"), with(broken)).unwrap_err();
        assert!(error.to_string().contains("exit status: 3"), "{error}");
        assert!(names(out.path()).is_empty());
    }
}

/// Runs in a child process of the next test, whose `PATH` is empty.
#[test]
fn without_ffmpeg_child() {
    if child::is_child() {
        let error = Recorder::create("walk.mp4", RecorderOptions::default()).unwrap_err();
        println!("{error}");
    }
}

#[test]
fn without_ffmpeg_the_error_says_what_to_install() {
    let out = tempfile::tempdir().unwrap();
    let output = child::command("record::video::without_ffmpeg_child")
        .env("PATH", out.path())
        .current_dir(out.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    for part in ["walk.mp4", "ffmpeg was not found", "apt-get install ffmpeg", ".gif"] {
        assert!(output.status.success() && text.contains(part), "{text}");
    }
    assert!(names(out.path()).is_empty());
}

fn has_ffmpeg() -> bool {
    let runs =
        |program: &str| Command::new(program).arg("-version").output().is_ok_and(|output| output.status.success());
    has("ffmpeg", runs("ffmpeg") && runs("ffprobe"))
}

#[test]
fn ffmpeg_makes_a_video_of_the_right_length() {
    if !has_ffmpeg() {
        return;
    }
    let out = tempfile::tempdir().unwrap();
    for (name, container) in [("walk it.mp4", "mp4"), ("walk.mov", "mov"), ("-walk:1.mkv", "matroska")] {
        let path = out.path().join(name);
        let summary = record(&path, options(20.0), (0..30).map(|frame| f64::from(frame) / 20.0));
        assert_eq!((summary.frames, summary.seconds), (30, 1.5));
        let output = Command::new("ffprobe")
            .args(["-v", "error", "-count_frames", "-of", "default=noprint_wrappers=1", "-show_entries"])
            .arg("stream=codec_name,width,height,nb_read_frames,avg_frame_rate,color_space,pix_fmt:format=format_name")
            .arg(&path)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        for line in [
            "codec_name=h264",
            "width=24",
            "height=10",
            "nb_read_frames=30",
            "avg_frame_rate=20/1",
            "color_space=bt709",
            "pix_fmt=yuv420p",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}: {text}");
        }
        assert!(text.lines().any(|line| line.starts_with("format_name=") && line.contains(container)), "{text}");
    }
}

#[test]
fn the_colours_of_a_video_are_those_of_the_images() {
    if !has_ffmpeg() {
        return;
    }
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("colors.mp4");
    let (width, height) = (65, 33);
    for color in [[200, 30, 40], [20, 180, 60], [30, 60, 220], [128, 128, 128], [255, 255, 255], [0, 0, 0]] {
        let mut recorder = Recorder::create(&path, options(25.0)).unwrap();
        recorder.push_rgb(width, height, &color.repeat(width * height), 0.0).unwrap();
        recorder.finish().unwrap();
        let output = Command::new("ffmpeg")
            .args(["-v", "error", "-i"])
            .arg(&path)
            .args(["-f", "rawvideo", "-pix_fmt", "rgb24", "-"])
            .output()
            .unwrap();
        assert_eq!(output.stdout.len(), 3 * (width + 1) * (height + 1));
        for pixel in output.stdout.chunks_exact(3) {
            let off = pixel.iter().zip(color).map(|(&found, expected)| found.abs_diff(expected)).max();
            assert!(off <= Some(4), "{pixel:?}, not {color:?}");
        }
    }
}
