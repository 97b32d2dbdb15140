//! Tests that need a separate process: they depend on process-wide state, or inspect the output of
//! the process.
//!
//! The program starts itself again with a single test selected. That test does nothing unless
//! [`is_child`] returns `true`.

#![allow(dead_code, reason = "included by several programs, each of which uses some of it")]

use std::process::Command;

const VARIABLE: &str = "MUJOCO_SAFE_TEST_CHILD";

/// Returns `true` if this process was started by [`command`].
pub(crate) fn is_child() -> bool {
    std::env::var_os(VARIABLE).is_some()
}

/// Returns a command that runs one test of this program, given by its path, in a separate process.
pub(crate) fn command(test: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args([test, "--exact", "--nocapture", "--test-threads=1"]).env(VARIABLE, test).env("RUST_BACKTRACE", "0");
    command
}

/// Runs one test of this program, given by its path, in a separate process, and panics if it fails.
#[track_caller]
pub(crate) fn passes(test: &str) {
    let output = command(test).output().unwrap();
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success() && stdout.contains("1 passed"), "{stdout}{stderr}");
}

/// Returns the lines of a child's standard output that the test harness did not print.
pub(crate) fn printed(stdout: &str) -> Vec<&str> {
    let is_of_harness =
        |line: &str| line.is_empty() || line == "ok" || line.starts_with("running 1 test") || line.starts_with("test ");
    stdout.lines().filter(|line| !is_of_harness(line)).collect()
}
