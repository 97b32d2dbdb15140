//! Allocations, leaks, output and the engine that is loaded: properties of the process, so the
//! tests run one at a time.

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/child.rs"]
mod child;
#[path = "../common/trouble.rs"]
mod trouble;

mod allocations;
mod allocations_in_control;
mod allocations_in_environments;
mod allocations_in_estimation;
#[cfg(feature = "live")]
mod allocations_in_live;
#[cfg(feature = "mcap")]
mod allocations_in_logs;
mod allocator;
#[cfg(target_os = "linux")]
mod engine_version;
mod leaks;
mod quiet;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks the process, because the tests of leaks measure its memory and its open files.
fn lock_process() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}
