//! Allocations, leaks and output: properties of the whole process, so the tests take turns.

#[path = "../common/child.rs"]
mod child;
#[path = "../common/trouble.rs"]
mod trouble;

mod allocations;
mod leaks;
mod quiet;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks the process: the tests of leaks measure its memory and its open files.
fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}
