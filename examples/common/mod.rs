//! What the examples share: plots, command-line options, and how they end.

pub mod chart;
pub mod option;

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
