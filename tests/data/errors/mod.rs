//! Whatever goes wrong is an error with a text that helps, and the process goes on.

#![deny(unsafe_code)]

mod arguments;
mod files;
mod poisoning;
mod shapes;
mod simulation;

use mujoco_safe::Result;

/// The text of the error, which must have all of these parts.
#[track_caller]
fn text_of<T>(result: Result<T>, parts: &[&str]) -> String {
    let text = result.err().expect("no error").to_string();
    for part in parts {
        assert!(text.contains(part), "'{part}' is not in: {text}");
    }
    text
}
