//! What the cases share.

use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use mujoco_safe::Data;
use mujoco_safe::viewer::Viewer;
use mujoco_safe::viewer::probe::{self, State};

use crate::hand::{Hand, wait_until};

/// A window's title that no window had before: one that was closed may still be there for a moment.
pub fn fresh_title() -> String {
    static NEXT: AtomicU32 = AtomicU32::new(1);
    format!("test {} of the viewer", NEXT.fetch_add(1, Ordering::Relaxed))
}

/// Small, for it is drawn by the processor.
pub const SIZE: [u32; 2] = [480, 360];

/// Runs a process for so long at most. What it says is returned if it fails.
pub fn limited(command: &mut Command, most: Duration) -> Result<(), String> {
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| error.to_string())?;
    let (mut out, mut err) = (child.stdout.take().expect("a pipe"), child.stderr.take().expect("a pipe"));
    let read = |pipe: &mut dyn Read| {
        let mut text = Vec::new();
        let _ = pipe.read_to_end(&mut text);
        String::from_utf8_lossy(&text).into_owned()
    };
    thread::scope(|scope| {
        let out = scope.spawn(move || read(&mut out));
        let err = scope.spawn(move || read(&mut err));
        let deadline = Instant::now() + most;
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
            None => Err(format!("{}\nit took more than {most:?}", text())),
        }
    })
}

/// Ends the whole process if a closure panics: its window would wait for ever.
pub fn or_exit<R>(act: impl FnOnce() -> R) -> R {
    catch_unwind(AssertUnwindSafe(act)).unwrap_or_else(|_| std::process::exit(101))
}

/// Shows a viewer in this thread while the hand acts in another. The hand is to leave the window open: it is closed with Esc.
pub fn show(viewer: Viewer, data: Data, act: impl FnOnce(&Hand) + Send) -> Data {
    probe::start();
    let title = fresh_title();
    thread::scope(|scope| {
        scope.spawn(|| {
            or_exit(|| {
                // Before that the window of the case before may still be there.
                wait_until("the window is drawn", || probe::latest().is_some());
                let hand = Hand::at(&title);
                act(&hand);
                hand.key("Escape");
            });
        });
        viewer.title(&*title).size(SIZE).run(data).expect("a window")
    })
}

/// How the window stands.
pub fn state() -> State {
    probe::latest().expect("a window that was drawn")
}

/// Waits until the window has processed all events so far, and the simulation the requests that they led to: events are processed
/// in order, and F12 does nothing.
pub fn settle(hand: &Hand) {
    let marks = mark(hand);
    wait_until("all events are processed", || state().marks >= marks && state().answered);
}

/// Presses F12. Returns how often this process has pressed it.
pub fn mark(hand: &Hand) -> u64 {
    static MARKS: AtomicU64 = AtomicU64::new(0);
    hand.key("F12");
    MARKS.fetch_add(1, Ordering::Relaxed) + 1
}

/// Presses a key, and waits until something is so.
pub fn press(hand: &Hand, key: &str, what: &str, mut is_so: impl FnMut(&State) -> bool) {
    hand.key(key);
    wait_until(&format!("{key}: {what}"), || is_so(&state()));
}
