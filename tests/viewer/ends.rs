//! How a viewer ends, and what goes wrong.

use std::process::Command;

use mujoco_safe::record::RecorderOptions;
use mujoco_safe::viewer::{Viewer, ViewerError, ViewerOptions};
use mujoco_safe::{Controller, Data, Result, sample};

use crate::case::{press, show, state};
use crate::hand::wait_until;

pub fn interrupt() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("film.gif");
    let options = ViewerOptions {
        recordings: Some(film.clone()),
        recording: RecorderOptions { frames_per_second: 10.0, ..RecorderOptions::default() },
        ..ViewerOptions::default()
    };
    let data = show(Viewer::new().options(options), Data::new(sample::cartpole()).unwrap(), |hand| {
        press(hand, "space", "it runs", |state| state.time > 0.0);
        press(hand, "ctrl+v", "it records", |state| state.recording.is_some_and(|frames| frames >= 2));
        assert!(!film.exists(), "a file is whole or not there");
        // The shell's own: not every system has a program of that name.
        let status = Command::new("sh").arg("-c").arg(format!("kill -INT {}", std::process::id())).status().unwrap();
        assert!(status.success());
        wait_until("the recording is finished", || film.exists());
    });
    assert!(data.time() > 0.0);
    assert!(std::fs::read(film).unwrap().starts_with(b"GIF89a"));
}

/// Fails at some time, in one way or the other.
struct Failing {
    panics: bool,
}

impl Controller for Failing {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if data.time() < 0.02 {
            return Ok(());
        }
        assert!(!self.panics, "this controller has had enough");
        Err(mujoco_safe::Error::Unsupported("this controller gives up".to_owned()))
    }
}

pub fn panic() {
    for (panics, words) in [(true, "has had enough"), (false, "gives up")] {
        let data = Data::new(sample::cartpole()).unwrap();
        show(Viewer::new().controller(Failing { panics }), data, |hand| {
            hand.key("space");
            wait_until("it is shown, and paused", || state().problem.contains(words) && state().status == "Paused");
            press(hand, "ctrl+Right", "the rest goes on", |state| state.mode == "Passive Dynamics");
            let then = state().time;
            press(hand, "space", "and runs", |state| state.time > then);
        });
    }
}

pub fn lost_surface() {
    let data = Data::new(sample::cartpole()).unwrap();
    show(Viewer::new(), data, |hand| {
        press(hand, "space", "it runs", |state| state.time > 0.0);
        for _ in 0..3 {
            let frame = state().frame;
            mujoco_safe::viewer::probe::lose_surface();
            wait_until("it is drawn again", || state().frame > frame + 2);
        }
    });
}

/// Nothing is drawn, and nothing computed, where nothing moves.
pub fn rest() {
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |_| {
        // Until messages are gone and the rate of frames is "at rest".
        let mut frame = state().frame;
        wait_until("it is not drawn for a second", || {
            let before = std::mem::replace(&mut frame, state().frame);
            std::thread::sleep(std::time::Duration::from_secs(1));
            before == state().frame
        });
        let seconds = processor_time();
        std::thread::sleep(std::time::Duration::from_secs(1));
        let used = processor_time() - seconds;
        assert!(used < 0.2, "{used} s of the processor in a second of rest");
    });
}

/// The processor's time that this process has used, s.
fn processor_time() -> f64 {
    // In hundredths of a second, in the user's and in the system's code: fields 14 and 15, counted behind the name.
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let behind = stat.rsplit(')').next().unwrap().split_whitespace();
    behind.skip(11).take(2).map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

pub fn no_display() {
    for _ in 0..2 {
        let data = Data::new(sample::cartpole()).unwrap();
        let error = Viewer::new().run(data).map(drop).unwrap_err();
        assert!(matches!(error, ViewerError::NoDisplay(_)), "{error}");
        assert!(error.to_string().contains("DISPLAY"), "{error}");
    }
}
