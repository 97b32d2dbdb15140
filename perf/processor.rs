//! Processors: affinity of threads, and detection of cores that are shared with other load.
//!
//! Threads are pinned. Otherwise the scheduler's placement persists for milliseconds: two threads
//! can share a processor while another is idle, and one of two programs can get a processor whose
//! core has other load.
//!
//! Two processors of a virtual machine can share one core of the host for seconds at a
//! time; the speed-up of two threads is then meaningless.

use std::fs;
use std::hint::{self, black_box};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder};

use crate::Outcome;

/// Creates a pool with each thread pinned to a processor, starting with the first. Without
/// `taskset`, threads are not pinned.
pub(crate) fn pool(threads: usize) -> Outcome<ThreadPool> {
    let processors = processors();
    let pin = move |thread: usize| {
        if !processors.is_empty() {
            pin_to(&processors[thread % processors.len()]);
        }
    };
    Ok(ThreadPoolBuilder::new().num_threads(threads).start_handler(pin).build()?)
}

/// Returns the processors that this process may use. Linux lists them in the form `0-3,8`.
fn processors() -> Vec<String> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:")).unwrap_or_default();
    let range = |part: &str| {
        let (first, last) = part.trim().split_once('-').unwrap_or((part.trim(), part.trim()));
        Some(first.parse::<u32>().ok()?..=last.parse().ok()?)
    };
    list.split(',').filter_map(range).flatten().map(|processor| processor.to_string()).collect()
}

/// Pins the calling thread to a processor.
fn pin_to(processor: &str) {
    let Ok(thread) = fs::read_link("/proc/thread-self") else { return };
    let Some(thread) = thread.file_name() else { return };
    let taskset = Command::new("taskset").args(["-cp", processor]).arg(thread).stdout(Stdio::null()).status();
    if taskset.is_err() {
        eprintln!("taskset is not installed: threads are not pinned, and the results vary more.");
    }
}

/// Minimum average share of a core per thread for a measurement to count.
const MIN_SHARE: f64 = 0.92;

/// Returns `true` if each thread of a pool has a core. A single thread always does.
pub(crate) fn has_core_per_thread(pool: &ThreadPool) -> bool {
    let threads = pool.current_num_threads();
    threads == 1 || throughput(pool) >= MIN_SHARE * threads as f64
}

/// Measures the throughput of all threads relative to one thread, with independent work.
fn throughput(pool: &ThreadPool) -> f64 {
    let threads = pool.current_num_threads();
    let one = pool.broadcast(|context| if context.index() == 0 { work() } else { 0.0 });
    let ready = AtomicUsize::new(0);
    let all = pool.broadcast(|_| {
        // Exclude the time to wake the threads.
        ready.fetch_add(1, Ordering::Relaxed);
        while ready.load(Ordering::Relaxed) < threads {
            hint::spin_loop();
        }
        work()
    });
    let longest = |times: Vec<f64>| times.into_iter().fold(0.0, f64::max);
    threads as f64 * longest(one) / longest(all)
}

/// Times some milliseconds of independent multiplications, which leave no execution units of a core
/// to a second thread.
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
