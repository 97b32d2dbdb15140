//! How many cores the machine gives. Two processors of a virtual machine may be one core of its host, for seconds at a time: what two
//! threads bring then says nothing about them.

use std::hint::{self, black_box};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use mujoco_safe::rayon::ThreadPool;

/// Threads that have less of a core than this on average do not count.
const ENOUGH: f64 = 0.92;

/// Whether each thread of a pool has a core. One alone has.
pub(crate) fn are_there(pool: &ThreadPool) -> bool {
    let threads = pool.current_num_threads();
    threads == 1 || given_to(pool) >= ENOUGH * threads as f64
}

/// How many times the work of one thread all of them do in the same time, with nothing to wait for.
fn given_to(pool: &ThreadPool) -> f64 {
    let threads = pool.current_num_threads();
    let one = pool.broadcast(|context| if context.index() == 0 { work() } else { 0.0 });
    let ready = AtomicUsize::new(0);
    let all = pool.broadcast(|_| {
        // To wake a thread up takes a while, which is not to count.
        ready.fetch_add(1, Ordering::Relaxed);
        while ready.load(Ordering::Relaxed) < threads {
            hint::spin_loop();
        }
        work()
    });
    let longest = |times: Vec<f64>| times.into_iter().fold(0.0, f64::max);
    threads as f64 * longest(one) / longest(all)
}

/// How long some milliseconds of multiplications take that do not depend on each other: a core has none to spare for another thread.
fn work() -> f64 {
    let begin = Instant::now();
    let mut lanes = [1_u64, 2, 3, 4, 5, 6, 7, 8];
    for step in 0..black_box(1_000_000) {
        for lane in &mut lanes {
            *lane = lane.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(step);
        }
    }
    black_box(lanes);
    begin.elapsed().as_secs_f64()
}
