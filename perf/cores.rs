//! How many cores the machine gives. Two processors of a virtual machine may be one core of its host, for seconds at a time: what two
//! threads bring then says nothing about them.

use std::hint::{self, black_box};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

/// Threads that have less of a core than this on average do not count.
const ENOUGH: f64 = 0.92;

/// Whether this many threads have a core each.
pub(crate) fn are_there(threads: usize) -> bool {
    given_to(threads) >= ENOUGH * threads as f64
}

/// How many times the work of one thread this many do in the same time, if they have nothing to wait for.
fn given_to(threads: usize) -> f64 {
    let ready = AtomicUsize::new(0);
    let together = |threads: usize| {
        // To wake a thread up takes a while, which is not to count.
        ready.fetch_add(1, Ordering::Relaxed);
        while ready.load(Ordering::Relaxed) < threads {
            hint::spin_loop();
        }
        let begin = Instant::now();
        work();
        begin.elapsed().as_secs_f64()
    };
    let one = together(1);
    ready.store(0, Ordering::Relaxed);
    let all = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(|| together(threads))).collect();
        others.into_iter().map(|other| other.join().expect("nothing panics there")).fold(together(threads), f64::max)
    });
    threads as f64 * one / all
}

/// Some ten milliseconds of multiplications that do not depend on each other: a core has none to spare for another thread.
fn work() {
    let mut lanes = [1_u64, 2, 3, 4, 5, 6, 7, 8];
    for step in 0..black_box(4_000_000) {
        for lane in &mut lanes {
            *lane = lane.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(step);
        }
    }
    black_box(lanes);
}
