//! The steps of a log do not allocate.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use mujoco_safe::Data;
use mujoco_safe::mcap::Log;

use crate::allocations::squatting;
use crate::allocator::allocations;
use crate::lock_process;

#[test]
fn a_step_of_a_log_does_not_allocate() {
    let _lock = lock_process();
    let folder = tempfile::tempdir().unwrap();
    let mut data = squatting();
    let mut log = Log::create(folder.path().join("t.mcap"), data.model()).unwrap();
    let mut steps = |data: &mut Data| (0..1000).for_each(|_| log.step(data).unwrap());
    steps(&mut data);
    // The standard library can allocate when a step waits for the thread that writes.
    let (number, ()) = allocations(|| steps(&mut data));
    assert!(number < 10, "{number} allocations in 1000 steps");
}
