//! Functions that show a window: `Viewer::run`, `run` and `launch`.

use std::io::Write;
use std::thread;
use std::time::Duration;

use mujoco_safe::viewer::{self, Key, Viewer, ViewerError, ViewerHandle, ViewerOptions};
use mujoco_safe::{Data, sample};

use crate::harness::{SIZE, exit_on_panic, press, show, state, unique_title};
use crate::input::{Input, wait_until};

/// Simulated time until the pause, s.
const RUN_TIME: f64 = 1.0;

fn options() -> ViewerOptions {
    ViewerOptions::default().with_title(unique_title()).with_size(SIZE.map(|pixels| pixels as usize))
}

/// Steps a simulation until the window is closed. Returns the keys without a binding.
fn run_steps(handle: &mut ViewerHandle, data: &mut Data) -> Result<Vec<Key>, ViewerError> {
    let mut keys = Vec::new();
    while handle.is_running() {
        if !handle.is_paused() {
            data.step()?;
        }
        handle.sync(data)?;
        keys.extend(handle.keys().into_iter().map(|press| press.key));
        handle.wait(Duration::from_millis(2));
    }
    Ok(keys)
}

pub fn consecutive() {
    // Shows a window with the viewer's simulation, a window with the program's simulation, and a
    // window that the program closes.
    let data = show(Data::new(sample::cartpole()).unwrap(), |input| {
        press(input, "Right", "one step is taken", |state| state.time > 0.0);
    });
    assert!(data.time() > 0.0, "`run` returns the final state");

    let mut data = Data::new(sample::humanoid()).unwrap();
    viewer::test_hooks::start();
    let window_options = options();
    let title = window_options.title.clone();
    let keys = thread::scope(|scope| {
        scope.spawn(|| {
            exit_on_panic(|| {
                wait_until("the program's simulation is shown", || {
                    viewer::test_hooks::latest().is_some_and(|state| state.status == "Program" && state.nbody > 10)
                });
                let input = Input::at(&title);
                input.key("Home");
                wait_until("the simulation runs", || state().time > RUN_TIME);
                press(&input, "space", "the program is paused", |state| state.status == "Paused");
                press(&input, "BackSpace", "the start state is restored", |state| state.time < RUN_TIME);
                input.key("ctrl+q");
            });
        });
        viewer::run(window_options, |handle| run_steps(handle, &mut data)).unwrap()
    });
    assert_eq!(keys, [Key::Home], "keys without a binding reach the program");

    let result = viewer::run(options(), |handle| -> Result<u32, ViewerError> {
        handle.sync(&mut data)?;
        Ok(42)
    });
    assert_eq!(result.unwrap(), 42, "the window closes when the program ends");
    let error = viewer::run(options(), |_| -> Result<(), Failure> { Err(Failure::Program) }).unwrap_err();
    assert!(matches!(error, Failure::Program));
}

enum Failure {
    Program,
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
            Self::Program => f.write_str("an error of the program"),
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
                wait_until("the window is drawn", || viewer::test_hooks::latest().is_some());
                Input::at(&title).key("ctrl+q");
            });
        });
        run_steps(&mut handle, &mut data).unwrap();
        input.join().unwrap();
    }
    let mut first = viewer::launch(options()).unwrap();
    let second_options = options();
    let title = second_options.title.clone();
    let mut second = viewer::launch(second_options).unwrap();
    first.sync(&mut data).unwrap();
    second.sync(&mut data).unwrap();
    let input = Input::at(&title);
    input.key("ctrl+q");
    wait_until("the second window is closed", || !second.is_running());
    assert!(first.is_running());
    drop(first);
    // `Viewer::run` uses the same background thread.
    let data = show(data, |input| {
        press(input, "Right", "one step is taken", |state| state.status == "Paused" && state.time > 0.0);
    });
    drop(data);
}

pub fn exit() {
    let output = crate::child(&["exit"]).envs(std::env::vars()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text == FRAME_ENDED, "{}: {text}", output.status);
}

/// Output of [`exit_while_drawing`] if the process waits for the frame.
const FRAME_ENDED: &str = "the frame ends";

/// Exits while the background thread draws. The driver would free its data during the frame, which
/// crashes the process at times.
pub fn exit_while_drawing() {
    viewer::test_hooks::start();
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut handle = viewer::launch(options()).unwrap();
    handle.sync(&mut data).unwrap();
    wait_until("the window is drawn", || viewer::test_hooks::latest().is_some());
    viewer::test_hooks::hold();
    data.step().unwrap();
    handle.sync(&mut data).unwrap();
    wait_until("a frame starts", viewer::test_hooks::is_held);
    thread::spawn(|| {
        thread::sleep(Duration::from_millis(100));
        print!("{FRAME_ENDED}");
        std::io::stdout().flush().unwrap();
        viewer::test_hooks::release();
    });
    std::process::exit(0);
}

pub fn two_threads() {
    let data = show(Data::new(sample::cartpole()).unwrap(), |_| {});
    let error = thread::spawn(move || Viewer::new().run(data).map(drop).unwrap_err()).join().unwrap();
    assert!(matches!(error, ViewerError::OtherThread), "{error}");
    let error = viewer::launch(options()).map(drop).unwrap_err();
    assert!(matches!(error, ViewerError::OtherThread), "{error}");
    // The first thread can still show windows.
    show(Data::new(sample::cartpole()).unwrap(), |_| {});
}
