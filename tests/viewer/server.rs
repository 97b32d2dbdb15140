//! The end of the X server while a window is open.

use std::path::Path;
use std::process::Command;
use std::thread;

use mujoco_safe::record::RecorderOptions;
use mujoco_safe::viewer::{self, Viewer, ViewerError, ViewerOptions, test_hooks};
use mujoco_safe::{Data, sample};

use crate::display::Display;
use crate::harness::{SIZE, exit_on_panic, press, unique_title};
use crate::input::{Input, wait_until};

pub fn end() {
    for function in ["run", "launch"] {
        let display = Display::start();
        let folder = tempfile::tempdir().unwrap();
        let mut command = crate::child(&["lose", function, &display.process().to_string()]);
        let output = command.arg(folder.path()).env("DISPLAY", display.name()).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{function}: {}\n{text}", output.status);
        // The file is complete.
        let file = std::fs::File::open(folder.path().join("recording.gif")).unwrap();
        let mut decoder = gif::Decoder::new(file).unwrap();
        let mut frames = 0;
        while decoder.read_next_frame().unwrap().is_some() {
            frames += 1;
        }
        assert!(frames >= 2, "{frames} frames");
    }
}

/// Shows a window, records it and kills the X server.
pub fn lose(function: &str, server: &str, folder: &Path) {
    test_hooks::start();
    let title = unique_title();
    let options = ViewerOptions::default()
        .with_title(&*title)
        .with_size(SIZE.map(|pixels| pixels as usize))
        .with_recordings(folder.join("recording.gif"))
        .with_recording(RecorderOptions::default().with_frames_per_second(10.0));
    let record_and_kill = || {
        wait_until("the window is drawn", || test_hooks::latest().is_some());
        let input = Input::at(&title);
        press(&input, "ctrl+v", "the recording has two frames", |state| {
            state.recording.is_some_and(|frames| frames >= 2)
        });
        assert!(Command::new("sh").arg("-c").arg(format!("kill -KILL {server}")).status().unwrap().success());
    };
    let mut data = Data::new(sample::cartpole()).unwrap();
    if function == "launch" {
        let mut handle = viewer::launch(options).unwrap();
        thread::scope(|scope| {
            scope.spawn(|| exit_on_panic(record_and_kill));
            while handle.is_running() {
                data.step().unwrap();
                handle.sync(&mut data).unwrap();
                thread::sleep(std::time::Duration::from_millis(1));
            }
        });
        handle.sync(&mut data).unwrap();
    } else {
        let error = thread::scope(|scope| {
            scope.spawn(|| {
                exit_on_panic(|| {
                    wait_until("the window is drawn", || test_hooks::latest().is_some());
                    press(&Input::at(&title), "space", "the simulation runs", |state| state.time > 0.0);
                    record_and_kill();
                });
            });
            Viewer::new().with_options(options).run(data).map(drop).unwrap_err()
        });
        assert!(matches!(error, ViewerError::Window(_)) && error.to_string().contains("X server"), "{error}");
    }
    // A process connects to an X server only once.
    for _ in 0..2 {
        let error = Viewer::new().run(Data::new(sample::cartpole()).unwrap()).map(drop).unwrap_err();
        assert!(error.to_string().contains("the connection to the X server was lost"), "{error}");
    }
}
