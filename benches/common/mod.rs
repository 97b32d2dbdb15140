//! Shared code of the benchmarks: times, and the comparison of several variants of a computation.
//!
//! On a machine with other load, the difference between the times of two variants, taken one after
//! another, can be smaller than the drift of the machine. The ratio of two variants is therefore
//! measured separately: they run alternately, one short run each, and every adjacent pair of runs
//! gives one ratio. A line has the median and its confidence interval of 95 %:
//!
//! ```text
//! step/humanoid/Data::step             43.1 µs   [43.0, 43.3]
//! step/humanoid/Data::step ÷ mj_step   1.0003    [0.9996, 1.0010]
//! ```
//!
//! Arguments select the benchmarks whose names contain one of them.

#![allow(dead_code, reason = "each benchmark uses a part of it")]

pub(crate) mod episode;
pub(crate) mod models;
pub(crate) mod peer;
mod process;

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Variant of a computation: its name, and a run on the shared state. A run must be long enough to
/// be timed individually.
pub(crate) type Variant<'a, T> = (&'a str, &'a dyn Fn(&mut T));

/// Times each variant, and its ratio to the last variant, the reference. All variants work on the
/// same state, and therefore have the same inputs in the same memory. A reported time is that of a
/// run divided by `per_run`, its number of calls.
pub(crate) fn compare<T>(name: &str, state: &mut T, per_run: u32, variants: &[Variant<'_, T>]) {
    for (variant, run) in variants {
        bench(&format!("{name}/{variant}"), per_run, &mut || run(state));
    }
    let Some(((reference, run_reference), others)) = variants.split_last() else { return };
    for (variant, run) in others {
        let name = format!("{name}/{variant} ÷ {reference}");
        if !is_selected(&name) {
            continue;
        }
        let mut pairs = 0;
        let mut ratio = || {
            pairs += 1;
            let mut time = |run: &dyn Fn(&mut T)| call_at_depth(pairs % 67, &mut || time(&mut || run(state)));
            // Alternate the order within a pair.
            let first = (pairs % 2 == 0).then(|| time(run));
            let reference = time(run_reference);
            first.unwrap_or_else(|| time(run)).as_secs_f64() / reference.as_secs_f64()
        };
        // Fewer samples of more pairs each give more reliable medians.
        let number = runs_within(Duration::from_millis(100), &mut || _ = ratio());
        let samples = (0..20).map(|_| median((0..number).map(|_| ratio()).collect())).collect();
        let [low, middle, high] = interval(samples);
        println!("{name:70} {middle:<12.4} [{low:.4}, {high:.4}]");
    }
}

/// Times a run, which makes `calls` calls, and prints the time of a call.
pub(crate) fn bench(name: &str, calls: u32, run: &mut dyn FnMut()) {
    if !is_selected(name) {
        return;
    }
    let runs = runs_within(Duration::from_millis(20), run);
    let samples = (0..40).map(|_| {
        let total = time(&mut || (0..runs).for_each(|_| run()));
        total.as_secs_f64() / (f64::from(runs) * f64::from(calls))
    });
    let times = interval(samples.collect());
    let (unit, scale) = match times[1] {
        ..1e-6 => ("ns", 1e9),
        ..1e-3 => ("µs", 1e6),
        _ => ("ms", 1e3),
    };
    let [low, middle, high] = times.map(|seconds| format!("{:.*}", decimals(seconds * scale), seconds * scale));
    println!("{name:70} {:<12} [{low}, {high}]", format!("{middle} {unit}"));
}

/// Returns the decimals of a number with four significant digits.
fn decimals(number: f64) -> usize {
    (3 - number.log10().floor() as i32).clamp(0, 3) as usize
}

/// Returns `true` if the command line selects this benchmark.
pub(crate) fn is_selected(name: &str) -> bool {
    // Cargo adds the option `--bench`.
    let mut words = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).peekable();
    words.peek().is_none() || words.any(|word| name.contains(&word))
}

/// Runs for 0.2 s to warm up, and returns the number of runs in the given time: at least one.
fn runs_within(limit: Duration, run: &mut dyn FnMut()) -> u32 {
    let (start, mut runs) = (Instant::now(), 0);
    while start.elapsed() < Duration::from_millis(200) {
        run();
        runs += 1;
    }
    (f64::from(runs) * limit.as_secs_f64() / start.elapsed().as_secs_f64()).ceil() as u32
}

/// Returns the median between the limits of its confidence interval of at least 95 %, by the
/// binomial distribution of the number of samples below the median. It needs at least six samples.
fn interval(mut samples: Vec<f64>) -> [f64; 3] {
    samples.sort_unstable_by(f64::total_cmp);
    let number = samples.len() as f64;
    let rank = (number / 2.0 - 0.98 * number.sqrt()) as usize;
    [samples[rank], median(samples.clone()), samples[samples.len() - 1 - rank]]
}

pub(crate) fn time(run: &mut dyn FnMut()) -> Duration {
    let start = Instant::now();
    run();
    start.elapsed()
}

/// Calls a function from a deeper stack frame. The alignment of the engine's stack changes the time
/// of a short call by up to 2 %. The variants have different numbers of frames; averaging over many
/// depths removes the bias.
#[inline(never)]
fn call_at_depth(frames: u64, call: &mut dyn FnMut() -> Duration) -> Duration {
    if frames == 0 { call() } else { black_box(call_at_depth(black_box(frames - 1), call)) }
}

/// Returns the median, which is robust against interrupted runs.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = (values.len() - 1) / 2..=values.len() / 2;
    values[middle.clone()].iter().sum::<f64>() / middle.count() as f64
}
