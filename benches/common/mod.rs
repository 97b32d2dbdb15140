//! Shared code of the benchmarks: criterion's settings, and the comparison of several variants of a
//! computation.
//!
//! Criterion times the variants one after another. On a machine with other load, the difference
//! between two variants can then be smaller than the drift of the machine. The ratio of two
//! variants is therefore measured separately: they run alternately, one short run each, and every
//! adjacent pair of runs gives one ratio. Criterion reports the ratio with its confidence interval
//! on a separate line (which starts with `time:` like all its lines):
//!
//! ```text
//! step/humanoid/Data::step ÷ mj_step
//!                         time:   [0.9996 times 1.0003 times 1.0010 times]
//! ```

#![allow(dead_code, reason = "each benchmark uses a part of it")]

pub(crate) mod models;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::measurement::{Measurement, ValueFormatter};
use criterion::{Criterion, SamplingMode, Throughput};

/// Configures criterion so that all benchmarks together take a few minutes, and applies the
/// command-line arguments.
pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
        .sample_size(40)
        .nresamples(10_000)
        .without_plots()
        .configure_from_args()
}

/// Variant of a computation: its name, and a run on the shared state. A run must be long enough to
/// be timed individually.
pub(crate) type Variant<'a, T> = (&'a str, &'a dyn Fn(&mut T));

/// Times each variant, and its ratio to the last variant, the reference. All variants work on the
/// same state, and therefore have the same inputs in the same memory. A reported time is that of a
/// run divided by `per_run`, its number of calls.
pub(crate) fn compare<T>(
    criterion: &mut Criterion,
    name: &str,
    state: &mut T,
    per_run: u32,
    variants: &[Variant<'_, T>],
) {
    let mut group = criterion.benchmark_group(name);
    for (variant, run) in variants {
        group.bench_function(*variant, |bencher| {
            bencher.iter_custom(|runs| (0..runs).map(|_| time(&mut || run(state))).sum::<Duration>() / per_run);
        });
    }
    group.finish();

    let Some(((reference, run_reference), others)) = variants.split_last() else { return };
    let mut ratios = self::criterion().with_measurement(Ratio);
    let mut group = ratios.benchmark_group(name);
    // Fewer samples of more pairs each give more reliable medians.
    group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(2));
    for (variant, run) in others {
        group.bench_function(format!("{variant} ÷ {reference}"), |bencher| {
            bencher.iter_custom(|pairs| {
                let ratios = (0..pairs).map(|pair| {
                    let mut time = |run: &dyn Fn(&mut T)| call_at_depth(pair % 67, &mut || time(&mut || run(state)));
                    // Alternate the order within a pair.
                    let first = (pair % 2 == 0).then(|| time(run));
                    let reference = time(run_reference);
                    first.unwrap_or_else(|| time(run)).as_secs_f64() / reference.as_secs_f64()
                });
                median(ratios.collect()) * pairs as f64
            });
        });
    }
    group.finish();
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

/// Returns the median of the ratios, which is robust against interrupted runs.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = (values.len() - 1) / 2..=values.len() / 2;
    values[middle.clone()].iter().sum::<f64>() / middle.count() as f64
}

/// Criterion measurement of a ratio in place of a time. The values come from `iter_custom`.
struct Ratio;

impl Measurement for Ratio {
    type Intermediate = ();
    type Value = f64;

    fn start(&self) {}

    fn end(&self, (): ()) -> f64 {
        unreachable!("a ratio has no start and no end: use `iter_custom`")
    }

    fn add(&self, a: &f64, b: &f64) -> f64 {
        a + b
    }

    fn zero(&self) -> f64 {
        0.0
    }

    fn to_f64(&self, value: &f64) -> f64 {
        *value
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        self
    }
}

impl ValueFormatter for Ratio {
    fn scale_values(&self, _: f64, _: &mut [f64]) -> &'static str {
        "times"
    }

    fn scale_throughputs(&self, _: f64, _: &Throughput, _: &mut [f64]) -> &'static str {
        "times"
    }

    fn scale_for_machines(&self, _: &mut [f64]) -> &'static str {
        "times"
    }
}
