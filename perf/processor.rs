//! Threads with a processor of their own. Where they go otherwise is chance, and stays so for milliseconds: two may share one processor
//! while the other sleeps, and of two programs one may have the processor whose core somebody else uses too.

use std::fs;
use std::process::{Command, Stdio};

use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder};

use crate::Outcome;

/// So many threads, the first on the first processor that there is. Without `taskset` they go where they like.
pub(crate) fn pool(threads: usize) -> Outcome<ThreadPool> {
    let processors = processors();
    let keep = move |thread: usize| {
        if !processors.is_empty() {
            keep_to(&processors[thread % processors.len()]);
        }
    };
    Ok(ThreadPoolBuilder::new().num_threads(threads).start_handler(keep).build()?)
}

/// The numbers of the processors that this program may use, which Linux tells like this: `0-3,8`.
fn processors() -> Vec<String> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:")).unwrap_or_default();
    let range = |part: &str| {
        let (first, last) = part.trim().split_once('-').unwrap_or((part.trim(), part.trim()));
        Some(first.parse::<u32>().ok()?..=last.parse().ok()?)
    };
    list.split(',').filter_map(range).flatten().map(|processor| processor.to_string()).collect()
}

/// Keeps the calling thread to a processor.
fn keep_to(processor: &str) {
    let Ok(thread) = fs::read_link("/proc/thread-self") else { return };
    let Some(thread) = thread.file_name() else { return };
    let taskset = Command::new("taskset").args(["-cp", processor]).arg(thread).stdout(Stdio::null()).status();
    if taskset.is_err() {
        eprintln!("There is no taskset, so threads do not keep to a processor, and the figures vary more.");
    }
}
