//! Interrupts, failing controllers, lost surfaces, idle windows and missing displays.

use std::process::Command;

use mujoco_safe::record::RecorderOptions;
use mujoco_safe::viewer::{self, Viewer, ViewerError, ViewerOptions, test_hooks};
use mujoco_safe::{Controller, Data, Result, sample};

use crate::cases::cases;
use crate::harness::{SIZE, press, show, show_with, state};
use crate::input::wait_until;

pub fn signals() {
    for &signal in cases(&["TERM"][..], &["INT", "TERM", "HUP"]) {
        record_until(signal);
    }
}

/// Checks that a signal closes the window and finishes its recording.
fn record_until(signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("recording.gif");
    let options = ViewerOptions::default()
        .with_recordings(recording.clone())
        .with_recording(RecorderOptions::default().with_frames_per_second(10.0));
    let data = show_with(options, Viewer::new(), Data::new(sample::cartpole()).unwrap(), |input| {
        press(input, "space", "the simulation runs", |state| state.time > 0.0);
        press(input, "ctrl+v", "the recording has two frames", |state| {
            state.recording.is_some_and(|frames| frames >= 2)
        });
        assert!(!recording.exists(), "the file appears only when it is complete");
        // `kill` is a shell builtin; not every system has a `kill` program.
        let status =
            Command::new("sh").arg("-c").arg(format!("kill -{signal} {}", std::process::id())).status().unwrap();
        assert!(status.success());
        wait_until("the recording is finished", || recording.exists());
    });
    assert!(data.time() > 0.0);
    assert!(std::fs::read(recording).unwrap().starts_with(b"GIF89a"));
}

/// Controller that fails with an error or a panic.
struct Failing {
    panics: bool,
}

impl Controller for Failing {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if data.time() < 0.02 {
            return Ok(());
        }
        assert!(!self.panics, "controller panic");
        Err(mujoco_safe::Error::Unsupported("controller error".to_owned()))
    }
}

pub fn controller_failure() {
    for (panics, message) in [(true, "controller panic"), (false, "controller error")] {
        let data = Data::new(sample::cartpole()).unwrap();
        show_with(ViewerOptions::default(), Viewer::new().with_controller(Failing { panics }), data, |input| {
            input.key("space");
            wait_until("the failure is shown and pauses the simulation", || {
                state().problem.contains(message) && state().status == "Paused"
            });
            press(input, "ctrl+Right", "the passive mode is selected", |state| state.mode == "Passive Dynamics");
            let time = state().time;
            press(input, "space", "the simulation runs", |state| state.time > time);
        });
    }
}

pub fn lost_surface() {
    let data = Data::new(sample::cartpole()).unwrap();
    show(data, |input| {
        press(input, "space", "the simulation runs", |state| state.time > 0.0);
        for _ in 0..3 {
            let frame = state().frame;
            mujoco_safe::viewer::test_hooks::lose_surface();
            wait_until("more frames are drawn", || state().frame > frame + 2);
        }
    });
}

/// Checks that values that no window can have are errors, other unusual values are accepted, and
/// neither prevents later windows.
pub fn options() {
    let options = |size: [u32; 2]| ViewerOptions::default().with_size(size.map(|pixels| pixels as usize));
    for (options, cause) in [
        (options(SIZE).with_title("a\0b"), "the title of the window"),
        (options([0, 100]), "the size of the window"),
        (options([100, 0]), "the size of the window"),
        (options([65_536, 100]), "the size of the window"),
        (options([100, u32::MAX]), "the size of the window"),
    ] {
        let error = viewer::launch(options.clone()).map(drop).unwrap_err().to_string();
        assert!(error.contains(cause), "{error}");
        let error =
            Viewer::new().with_options(options).run(Data::new(sample::cartpole()).unwrap()).map(drop).unwrap_err();
        assert!(error.to_string().contains(cause), "{error}");
    }
    let mut data = Data::new(sample::cartpole()).unwrap();
    for options in [
        options(SIZE).with_title(""),
        options(SIZE).with_title("\u{1}\u{10ffff}\n".repeat(10_000)),
        options([1, 1]),
        options(SIZE).with_scale(f64::NAN),
        options(SIZE).with_scale(f64::MAX),
        options(SIZE).with_scale(-1.0),
    ] {
        test_hooks::start();
        let mut handle = viewer::launch(options).unwrap();
        handle.sync(&mut data).unwrap();
        wait_until("the window is drawn", || test_hooks::latest().is_some());
        assert!(handle.is_running());
    }
    // The X server rejects this size, or the graphics driver does.
    for size in [[65_535, 1], [65_535; 2]] {
        if let Ok(mut handle) = viewer::launch(options(size)) {
            handle.sync(&mut data).unwrap();
        }
    }
    test_hooks::start();
    let mut handle = viewer::launch(options(SIZE)).unwrap();
    handle.sync(&mut data).unwrap();
    wait_until("a usual window is drawn", || test_hooks::latest().is_some());
}

/// Checks that a panic in a frame ends its window with an error, but no other window.
pub fn panic() {
    let options = || ViewerOptions::default().with_size(SIZE.map(|pixels| pixels as usize));
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut first = viewer::launch(options()).unwrap();
    for _ in 0..2 {
        test_hooks::panic_in_frame("panic");
        let viewer = Viewer::new().with_options(options().with_title("panic"));
        let error = viewer.run(Data::new(sample::cartpole()).unwrap()).map(drop).unwrap_err().to_string();
        assert!(error.contains("a panic of the test"), "{error}");
        first.sync(&mut data).unwrap();
        assert!(first.is_running());
    }
}

/// Checks that an idle window neither draws nor computes.
pub fn idle() {
    show(Data::new(sample::cartpole()).unwrap(), |_| {
        // Waits until the messages have expired and the info panel shows an idle refresh rate.
        let mut frame = state().frame;
        wait_until("no frame is drawn for a second", || {
            let before = std::mem::replace(&mut frame, state().frame);
            std::thread::sleep(std::time::Duration::from_secs(1));
            before == state().frame
        });
        let seconds = processor_time();
        std::thread::sleep(std::time::Duration::from_secs(1));
        let used = processor_time() - seconds;
        assert!(used < 0.2, "{used} s of processor time in an idle second");
    });
}

/// Returns the processor time of this process, s.
pub fn processor_time() -> f64 {
    // Fields 14 and 15 are the user and system time, in hundredths of a second. Field 2, the name,
    // may contain spaces.
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields = stat.rsplit(')').next().unwrap().split_whitespace();
    fields.skip(11).take(2).map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

pub fn no_display() {
    for _ in 0..2 {
        let data = Data::new(sample::cartpole()).unwrap();
        let error = Viewer::new().run(data).map(drop).unwrap_err();
        assert!(matches!(error, ViewerError::NoDisplay(_)), "{error}");
        assert!(error.to_string().contains("DISPLAY"), "{error}");
        // The windowing library precedes its message by the path and line of its source code.
        assert!(!error.to_string().contains(".rs"), "{error}");
        assert_eq!(format!("{error:?}"), error.to_string());
    }
}
