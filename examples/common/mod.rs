//! What the examples share: plots, command-line options, progress, and how they end.

#![allow(dead_code, reason = "each example uses its part")]

pub mod balance;
pub mod chart;
pub mod option;
pub mod progress;
pub mod window;

use std::error::Error;
use std::process::ExitCode;

/// How a program ends: an error is told in words, on standard error.
pub fn finish(result: Result<(), Box<dyn Error>>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
