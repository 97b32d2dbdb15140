//! The ways to show a window.

use std::thread;

use mujoco_safe::viewer::{self, Handle, Key, Viewer, ViewerError, ViewerOptions};
use mujoco_safe::{Data, sample};

use crate::case::{SIZE, fresh_title, or_exit, press, show, state};
use crate::hand::{Hand, wait_until};

/// Simulated time, s.
const A_WHILE: f64 = 1.0;

fn options() -> ViewerOptions {
    ViewerOptions { title: fresh_title(), size: Some(SIZE), ..ViewerOptions::default() }
}

/// A program's own loop, until the window is closed. Returned are the keys that it got.
fn steps(handle: &mut Handle, data: &mut Data) -> Result<Vec<Key>, ViewerError> {
    let mut keys = Vec::new();
    while handle.is_running() {
        if !handle.is_paused() {
            data.step()?;
        }
        handle.sync(data)?;
        keys.extend(handle.keys().into_iter().map(|press| press.key));
        handle.wait(std::time::Duration::from_millis(2));
    }
    Ok(keys)
}

pub fn one_after_another() {
    // The simulation's own, then a program's, then one that the program closes.
    let data = show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |hand| {
        press(hand, "Right", "a step", |state| state.time > 0.0);
    });
    assert!(data.time() > 0.0, "how it stands at the end is returned");

    let mut data = Data::new(sample::humanoid()).unwrap();
    viewer::probe::start();
    let programs = options();
    let title = programs.title.clone();
    let keys = thread::scope(|scope| {
        scope.spawn(|| {
            or_exit(|| {
                wait_until("the program's simulation is seen", || {
                    viewer::probe::latest().is_some_and(|state| state.status == "Program" && state.nbody > 10)
                });
                let hand = Hand::at(&title);
                hand.key("Home");
                wait_until("a while of the simulation", || state().time > A_WHILE);
                press(&hand, "space", "the program pauses", |state| state.status == "Paused");
                press(&hand, "BackSpace", "the start", |state| state.time < A_WHILE);
                hand.key("Escape");
            });
        });
        viewer::run(programs, |handle| steps(handle, &mut data)).unwrap()
    });
    assert_eq!(keys, [Key::Home], "keys that the viewer has no use for are the program's");

    let answer = viewer::run(options(), |handle| -> Result<u32, ViewerError> {
        handle.sync(&mut data)?;
        Ok(42)
    });
    assert_eq!(answer.unwrap(), 42, "the window closes with the program");
    let error = viewer::run(options(), |_| -> Result<(), Failure> { Err(Failure::Own) }).unwrap_err();
    assert!(matches!(error, Failure::Own));
}

enum Failure {
    Own,
    Viewer(ViewerError),
}

impl From<ViewerError> for Failure {
    fn from(error: ViewerError) -> Self {
        Self::Viewer(error)
    }
}

impl std::fmt::Debug for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Own => f.write_str("the program's own"),
            Self::Viewer(error) => write!(f, "{error}"),
        }
    }
}

pub fn launched() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    // One after another, and two at once.
    for _ in 0..2 {
        viewer::probe::start();
        let options = options();
        let title = options.title.clone();
        let mut handle = viewer::launch(options).unwrap();
        let hand = thread::spawn(move || {
            or_exit(|| {
                wait_until("it is drawn", || viewer::probe::latest().is_some());
                Hand::at(&title).key("ctrl+q");
            });
        });
        steps(&mut handle, &mut data).unwrap();
        hand.join().unwrap();
    }
    let mut one = viewer::launch(options()).unwrap();
    let others = options();
    let title = others.title.clone();
    let mut other = viewer::launch(others).unwrap();
    one.sync(&mut data).unwrap();
    other.sync(&mut data).unwrap();
    let hand = Hand::at(&title);
    hand.key("Escape");
    wait_until("one of two is closed", || !other.is_running());
    assert!(one.is_running());
    drop(one);
    // A window that waits for its program is shown by the same thread.
    let data = show(Viewer::new(), data, |hand| {
        press(hand, "Right", "a step", |state| state.status == "Paused" && state.time > 0.0);
    });
    drop(data);
}

pub fn two_threads() {
    let data = show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |_| {});
    let error = thread::spawn(move || Viewer::new().run(data).map(drop).unwrap_err()).join().unwrap();
    assert!(matches!(error, ViewerError::OtherThread), "{error}");
    let error = viewer::launch(options()).map(drop).unwrap_err();
    assert!(matches!(error, ViewerError::OtherThread), "{error}");
    // And the thread that shows them goes on.
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |_| {});
}
