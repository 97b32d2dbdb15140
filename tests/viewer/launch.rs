//! Functions that show a window: `Viewer::run`, `run` and `launch`.

use std::thread;

use mujoco_safe::viewer::{self, Handle, Key, Viewer, ViewerError, ViewerOptions};
use mujoco_safe::{Data, sample};

use crate::harness::{SIZE, exit_on_panic, press, show, state, unique_title};
use crate::input::{Input, wait_until};

/// Simulated time until the pause, s.
const RUN_TIME: f64 = 1.0;

fn options() -> ViewerOptions {
    ViewerOptions { title: unique_title(), size: Some(SIZE), ..ViewerOptions::default() }
}

/// Steps a simulation until the window is closed. Returns the keys without a binding.
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
    // A window with the viewer's simulation, one with a program's simulation, and one that the program closes.
    let data = show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |input| {
        press(input, "Right", "a step", |state| state.time > 0.0);
    });
    assert!(data.time() > 0.0, "`run` returns the final state");

    let mut data = Data::new(sample::humanoid()).unwrap();
    viewer::test_hooks::start();
    let programs = options();
    let title = programs.title.clone();
    let keys = thread::scope(|scope| {
        scope.spawn(|| {
            exit_on_panic(|| {
                wait_until("the program's simulation is seen", || {
                    viewer::test_hooks::latest().is_some_and(|state| state.status == "Program" && state.nbody > 10)
                });
                let input = Input::at(&title);
                input.key("Home");
                wait_until("the simulation runs", || state().time > RUN_TIME);
                press(&input, "space", "the program pauses", |state| state.status == "Paused");
                press(&input, "BackSpace", "the start", |state| state.time < RUN_TIME);
                input.key("Escape");
            });
        });
        viewer::run(programs, |handle| steps(handle, &mut data)).unwrap()
    });
    assert_eq!(keys, [Key::Home], "keys without a binding reach the program");

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
    // One window after another, then two at the same time.
    for _ in 0..2 {
        viewer::test_hooks::start();
        let options = options();
        let title = options.title.clone();
        let mut handle = viewer::launch(options).unwrap();
        let input = thread::spawn(move || {
            exit_on_panic(|| {
                wait_until("it is drawn", || viewer::test_hooks::latest().is_some());
                Input::at(&title).key("ctrl+q");
            });
        });
        steps(&mut handle, &mut data).unwrap();
        input.join().unwrap();
    }
    let mut one = viewer::launch(options()).unwrap();
    let others = options();
    let title = others.title.clone();
    let mut other = viewer::launch(others).unwrap();
    one.sync(&mut data).unwrap();
    other.sync(&mut data).unwrap();
    let input = Input::at(&title);
    input.key("Escape");
    wait_until("one of two windows is closed", || !other.is_running());
    assert!(one.is_running());
    drop(one);
    // `Viewer::run` uses the same background thread.
    let data = show(Viewer::new(), data, |input| {
        press(input, "Right", "a step", |state| state.status == "Paused" && state.time > 0.0);
    });
    drop(data);
}

pub fn two_threads() {
    let data = show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |_| {});
    let error = thread::spawn(move || Viewer::new().run(data).map(drop).unwrap_err()).join().unwrap();
    assert!(matches!(error, ViewerError::OtherThread), "{error}");
    let error = viewer::launch(options()).map(drop).unwrap_err();
    assert!(matches!(error, ViewerError::OtherThread), "{error}");
    // The first thread can still show windows.
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |_| {});
}
