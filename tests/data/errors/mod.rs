//! Errors have helpful messages, and the process continues.

#![deny(unsafe_code)]

mod arguments;
mod files;
mod poisoning;
mod shapes;
mod simulation;
mod texts;

use mujoco_safe::Result;

/// Returns the message of the error, which must contain all of these parts.
#[track_caller]
fn text_of<T>(result: Result<T>, parts: &[&str]) -> String {
    let text = result.err().expect("no error").to_string();
    for part in parts {
        assert!(text.contains(part), "'{part}' is missing in: {text}");
    }
    text
}
