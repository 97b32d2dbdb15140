//! Ratios of run times, as a table and a chart.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use mujoco_safe::rayon::ThreadPool;

use crate::speed_chart::{self, Bar};
use crate::{Outcome, processor};

/// Relative tolerance of checksums, which covers the order of summation.
const TOLERANCE: f64 = 1e-9;

/// Run times of both sides, and their ratios: speed of this crate relative to the reference.
pub(crate) struct Comparison {
    ours: Vec<f64>,
    theirs: Vec<f64>,
    ratios: Vec<f64>,
    pub(crate) our_checksum: f64,
    pub(crate) their_checksum: f64,
    /// Number of pairs discarded for lack of cores.
    discarded: usize,
}

/// Maximum number of tries per counted pair.
const MAX_TRIES: usize = 4;

impl Comparison {
    /// Measures both sides alternately, ours on the threads of a pool. Discards the first pair, and
    /// every pair for which a core per thread was not available before and after.
    pub(crate) fn measure(
        pool: &ThreadPool,
        pairs: usize,
        mut ours: impl FnMut() -> Outcome<(f64, f64)> + Send,
        mut theirs: impl FnMut() -> Outcome<(f64, f64)>,
    ) -> Outcome<Self> {
        let mut ours = || pool.install(&mut ours);
        let (_, our_checksum) = ours()?;
        let (_, their_checksum) = theirs()?;
        let mut comparison =
            Self { ours: vec![], theirs: vec![], ratios: vec![], our_checksum, their_checksum, discarded: 0 };
        let mut had_cores = processor::has_core_per_thread(pool);
        for pair in 0..MAX_TRIES * pairs {
            if comparison.ratios.len() == pairs {
                break;
            }
            let (our_time, their_time) = if pair % 2 == 0 {
                let first = ours()?.0;
                (first, theirs()?.0)
            } else {
                let first = theirs()?.0;
                (ours()?.0, first)
            };
            let has_cores = processor::has_core_per_thread(pool);
            if !(std::mem::replace(&mut had_cores, has_cores) && has_cores) {
                comparison.discarded += 1;
                continue;
            }
            comparison.ours.push(our_time);
            comparison.theirs.push(their_time);
            comparison.ratios.push(their_time / our_time);
        }
        for values in [&mut comparison.ours, &mut comparison.theirs, &mut comparison.ratios] {
            values.sort_unstable_by(f64::total_cmp);
        }
        Ok(comparison)
    }

    pub(crate) fn is_bitwise_equal(&self) -> bool {
        self.our_checksum.to_bits() == self.their_checksum.to_bits()
    }

    /// Prints a warning if the results differ. Two builds of the engine differ in the last bits,
    /// which simulations with contacts amplify.
    pub(crate) fn warn_if_different(self) -> Self {
        let (ours, theirs) = (self.our_checksum, self.their_checksum);
        if (ours - theirs).abs() > TOLERANCE * (1.0 + theirs.abs()) {
            println!(
                "The results of the next task differ: {ours:e} here, {theirs:e} there. Do both use the same engine?"
            );
        }
        self
    }
}

struct Row {
    task: String,
    reference: &'static str,
    microseconds: [f64; 2],
    quartiles: [f64; 3],
    pairs: usize,
}

impl Row {
    fn bar(&self) -> Bar<'_> {
        Bar { task: &self.task, reference: self.reference, quartiles: self.quartiles }
    }
}

#[derive(Default)]
pub(crate) struct Report {
    rows: Vec<Row>,
}

impl Report {
    /// Adds a comparison of runs with `calls` calls each.
    pub(crate) fn add(&mut self, task: String, reference: &'static str, calls: usize, comparison: &Comparison) {
        let pairs = comparison.ratios.len();
        if comparison.discarded > 0 {
            println!("Discarded {} pairs of the next task for lack of a core per thread.", comparison.discarded);
        }
        if pairs == 0 {
            println!("{task}: no comparison with {reference}.");
            return;
        }
        let at = |values: &[f64], quarter: usize| values[(values.len() - 1) * quarter / 4];
        let microseconds = [&comparison.ours, &comparison.theirs].map(|times| 1e6 * at(times, 2) / calls as f64);
        let quartiles = [1, 2, 3].map(|quarter| at(&comparison.ratios, quarter));
        let [low, median, high] = quartiles;
        let [ours, theirs] = microseconds.map(|time| 1e6 / time);
        println!(
            "{task}: {median:.3} times as fast as {reference} ({low:.3} to {high:.3}), {ours:.0} and {theirs:.0} per second"
        );
        self.rows.push(Row { task, reference, microseconds, quartiles, pairs });
    }

    /// Writes `compare.md` and `compare.svg`.
    pub(crate) fn write(&self, out: &Path) -> Outcome<()> {
        fs::create_dir_all(out)?;
        let mut table = String::from(
            "| task | reference | ours, µs | theirs, µs | speed-up | quartiles | pairs |\n|---|---|---:|---:|---:|---|---:|\n",
        );
        for Row { task, reference, microseconds: [ours, theirs], quartiles: [low, median, high], pairs } in &self.rows {
            writeln!(
                table,
                "| {task} | {reference} | {ours:.2} | {theirs:.2} | {median:.3} | {low:.3} to {high:.3} | {pairs} |"
            )?;
        }
        writeln!(table, "\nMedians over alternating pairs. {}", machine())?;
        fs::write(out.join("compare.md"), table)?;
        let bars: Vec<Bar<'_>> = self.rows.iter().map(Row::bar).collect();
        speed_chart::draw(&out.join("compare.svg"), &bars).map_err(|error| error.to_string())?;
        println!("wrote {0}/compare.md and {0}/compare.svg", out.display());
        Ok(())
    }
}

/// Describes the machine and the engine.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("an unknown processor", |(_, model)| model);
    format!("{model}, {cores} cores, engine {}.", mujoco_safe::engine_version())
}
