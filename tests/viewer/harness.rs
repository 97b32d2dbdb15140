//! Functions shared by the cases.

use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use mujoco_safe::Data;
use mujoco_safe::viewer::test_hooks::{self, WindowState};
use mujoco_safe::viewer::{Viewer, ViewerOptions};

use crate::input::{Input, wait_until};

/// Returns a unique title, because a closed window may still exist for a moment.
pub fn unique_title() -> String {
    static NEXT: AtomicU32 = AtomicU32::new(1);
    format!("viewer test {}", NEXT.fetch_add(1, Ordering::Relaxed))
}

/// Size of the windows, small because a software driver draws them.
pub const SIZE: [u32; 2] = [480, 360];

/// Runs a process with a time limit. Returns its output if it fails.
pub fn run_with_timeout(command: &mut Command, timeout: Duration) -> Result<(), String> {
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| error.to_string())?;
    let (mut out, mut err) =
        (child.stdout.take().expect("the output is piped"), child.stderr.take().expect("the output is piped"));
    let read = |pipe: &mut dyn Read| {
        let mut text = Vec::new();
        let _ = pipe.read_to_end(&mut text);
        String::from_utf8_lossy(&text).into_owned()
    };
    thread::scope(|scope| {
        let out = scope.spawn(move || read(&mut out));
        let err = scope.spawn(move || read(&mut err));
        let deadline = Instant::now() + timeout;
        let status = loop {
            match child.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(20)),
                _ => {
                    let _ = child.kill();
                    let _ = child.wait();
                    break None;
                }
            }
        };
        let text = || format!("{}{}", out.join().unwrap_or_default(), err.join().unwrap_or_default());
        match status {
            Some(status) if status.success() => Ok(()),
            Some(status) => Err(format!("{}\n{status}", text())),
            None => Err(format!("{}\ntimeout after {timeout:?}", text())),
        }
    })
}

/// Calls a closure, and exits the process if the closure panics, because nothing would close the
/// window.
pub fn exit_on_panic<R>(act: impl FnOnce() -> R) -> R {
    catch_unwind(AssertUnwindSafe(act)).unwrap_or_else(|_| std::process::exit(101))
}

/// Shows a viewer on this thread while a closure performs input on another thread. The closure must
/// leave the window open; Ctrl+Q closes it afterwards.
pub fn show(data: Data, act: impl FnOnce(&Input) + Send) -> Data {
    show_with(ViewerOptions::default(), Viewer::new(), data, act)
}

/// As [`show`], in a window of this size.
pub fn show_sized(size: [u32; 2], data: Data, act: impl FnOnce(&Input) + Send) -> Data {
    show_window(size, ViewerOptions::default(), Viewer::new(), data, act)
}

/// As [`show`], with options, and with a viewer whose options are replaced.
pub fn show_with(options: ViewerOptions, viewer: Viewer, data: Data, act: impl FnOnce(&Input) + Send) -> Data {
    show_window(SIZE, options, viewer, data, act)
}

/// As [`show_with`], in a window of this size.
pub fn show_window(
    size: [u32; 2],
    options: ViewerOptions,
    viewer: Viewer,
    data: Data,
    act: impl FnOnce(&Input) + Send,
) -> Data {
    show_options(options.with_size(size.map(|pixels| pixels as usize)), viewer, data, act)
}

/// As [`show_window`], in a window of the size of the options.
pub fn show_options(options: ViewerOptions, viewer: Viewer, data: Data, act: impl FnOnce(&Input) + Send) -> Data {
    test_hooks::start();
    let title = unique_title();
    thread::scope(|scope| {
        scope.spawn(|| {
            exit_on_panic(|| {
                // Until this window is drawn, the previous window may still exist.
                wait_until("the window is drawn", || test_hooks::latest().is_some());
                let input = Input::at(&title);
                act(&input);
                input.key("ctrl+q");
            });
        });
        viewer.with_options(options.with_title(&*title)).run(data).expect("the window opens")
    })
}

/// Returns the state of the window in its last frame.
pub fn state() -> WindowState {
    test_hooks::latest().expect("the window was drawn")
}

/// Returns the point of the timeline at a part of its track.
pub fn on_timeline(part: f32) -> [i32; 2] {
    let state = state();
    let track = state.panel_rects.iter().find(|(name, _)| *name == "track").expect("the timeline is shown").1;
    let at = |axis: usize, part: f32| (track[0][axis] + part * (track[1][axis] - track[0][axis])) as i32;
    [at(0, part), at(1, 0.5)]
}

/// Waits until the window has processed all previous events and the simulation has executed the
/// resulting requests. Relies on the order of events: F12, which has no binding, is processed last.
pub fn settle(input: &Input) {
    let markers = press_marker(input);
    wait_until("all events are processed", || state().markers >= markers && state().answered);
}

/// Presses F12. Returns the number of presses in this process.
pub fn press_marker(input: &Input) -> u64 {
    static MARKERS: AtomicU64 = AtomicU64::new(0);
    input.key("F12");
    MARKERS.fetch_add(1, Ordering::Relaxed) + 1
}

/// Presses a key, and waits for a condition with this description.
pub fn press(input: &Input, key: &str, description: &str, mut condition: impl FnMut(&WindowState) -> bool) {
    input.key(key);
    wait_until(&format!("{key}: {description}"), || condition(&state()));
}

/// Double-clicks until a condition with this description is true. The interval between two clicks
/// can be too long on a loaded machine.
pub fn double_click(
    input: &Input,
    at: [i32; 2],
    button: u8,
    description: &str,
    mut condition: impl FnMut(&WindowState) -> bool,
) {
    wait_until(description, || {
        input.double_click(at, button);
        settle(input);
        condition(&state())
    });
}
