//! What the benches share: criterion's settings, and the comparison of several ways to do the same.
//!
//! Criterion times one way after another, and on a machine that does other things besides, the second may find it faster or
//! slower by more than what is to be measured. So the ratio of two ways is measured for itself: they take turns, one short run
//! each, and every two neighbouring runs give one ratio. Criterion reports it with its confidence interval, on a line of its
//! own (which says `time:`, as all its lines do):
//!
//! ```text
//! step/humanoid/Data::step ÷ mj_step
//!                         time:   [0.9996 times 1.0003 times 1.0010 times]
//! ```

#![allow(dead_code, reason = "each bench uses its part")]

pub(crate) mod balance;
pub(crate) mod samples;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::measurement::{Measurement, ValueFormatter};
use criterion::{Criterion, SamplingMode, Throughput};

/// Criterion with settings under which all benches together take a few minutes, and with the arguments of the command line.
pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
        .sample_size(40)
        .nresamples(10_000)
        .without_plots()
        .configure_from_args()
}

/// One way to do it: its name, and a run of it on the common state. A run is long enough to be timed by itself.
pub(crate) type Way<'a, T> = (&'a str, &'a dyn Fn(&mut T));

/// Times each way, and its ratio to the last, which is the reference. All work on the same state, so they have the same
/// inputs in the same memory. The times are those of a run divided by `per_run`, the number of calls that it makes.
pub(crate) fn compare<T>(criterion: &mut Criterion, name: &str, state: &mut T, per_run: u32, ways: &[Way<'_, T>]) {
    let mut group = criterion.benchmark_group(name);
    for (way, run) in ways {
        group.bench_function(*way, |bencher| {
            bencher.iter_custom(|runs| (0..runs).map(|_| time(&mut || run(state))).sum::<Duration>() / per_run);
        });
    }
    group.finish();

    let Some(((reference, run_reference), others)) = ways.split_last() else { return };
    let mut ratios = self::criterion().with_measurement(Ratio);
    let mut group = ratios.benchmark_group(name);
    // Fewer samples of more pairs each, so that their medians are good ones.
    group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(2));
    for (way, run) in others {
        group.bench_function(format!("{way} ÷ {reference}"), |bencher| {
            bencher.iter_custom(|pairs| {
                let ratios = (0..pairs).map(|pair| {
                    let mut time = |run: &dyn Fn(&mut T)| deeper(pair % 67, &mut || time(&mut || run(state)));
                    // Each goes first every other time.
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

fn time(run: &mut dyn FnMut()) -> Duration {
    let start = Instant::now();
    run();
    start.elapsed()
}

/// Calls from some frames further down the stack. Where on the stack the engine works makes a difference of up to 2 % to a short
/// call; one way has more frames than the other, and from many depths neither is the lucky one.
#[inline(never)]
fn deeper(frames: u64, call: &mut dyn FnMut() -> Duration) -> Duration {
    if frames == 0 { call() } else { black_box(deeper(black_box(frames - 1), call)) }
}

/// Of many ratios the median: a run that was interrupted says nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = (values.len() - 1) / 2..=values.len() / 2;
    values[middle.clone()].iter().sum::<f64>() / middle.count() as f64
}

/// Criterion measures this where it would otherwise measure time. The values come from `iter_custom`.
struct Ratio;

impl Measurement for Ratio {
    type Intermediate = ();
    type Value = f64;

    fn start(&self) {}

    fn end(&self, (): ()) -> f64 {
        unreachable!("a ratio has no beginning and no end: use `iter_custom`")
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
