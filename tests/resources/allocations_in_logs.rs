//! A log allocates for chunks of the file, not for steps.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use mujoco_safe::Data;
use mujoco_safe::mcap::Log;

use crate::allocations::squatting;
use crate::allocator::allocations;
use crate::lock_process;

#[test]
fn a_log_allocates_for_chunks_only() {
    let _lock = lock_process();
    let folder = tempfile::tempdir().unwrap();
    let mut data = squatting();
    let mut log = Log::create(folder.path().join("t.mcap"), data.model()).unwrap().with_display_rate(0.0);
    let mut steps = |data: &mut Data| (0..1000).for_each(|_| log.step(data).unwrap());
    steps(&mut data);
    // The thread that writes allocates for each of three or four chunks, whose indices grow.
    let (number, ()) = allocations(|| steps(&mut data));
    assert!(number < 200, "{number} allocations in 1000 steps");
}
