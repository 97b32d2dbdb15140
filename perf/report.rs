//! Ratios, a table and a picture of them.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use mujoco_safe::rayon::ThreadPool;
use plotters::prelude::*;

use crate::{Outcome, cores};

/// What a number made of two results may differ by: the order of a sum.
const SAME: f64 = 1e-9;

/// The times of both, run by run, and how often as fast as they we are.
pub(crate) struct Duel {
    ours: Vec<f64>,
    theirs: Vec<f64>,
    ratios: Vec<f64>,
    pub(crate) ours_made: f64,
    pub(crate) theirs_made: f64,
    /// Pairs that do not count, for want of cores.
    left_out: usize,
}

/// How many pairs are tried for each that is to count.
const PATIENCE: usize = 4;

impl Duel {
    /// In turn, each first every other time; ours on the threads of a pool. The first pair does not count, and others only if there
    /// is a core for each thread before and after.
    pub(crate) fn fight(
        pool: &ThreadPool,
        pairs: usize,
        mut ours: impl FnMut() -> Outcome<(f64, f64)> + Send,
        mut theirs: impl FnMut() -> Outcome<(f64, f64)>,
    ) -> Outcome<Self> {
        let mut ours = || pool.install(&mut ours);
        let (_, ours_made) = ours()?;
        let (_, theirs_made) = theirs()?;
        let mut duel = Self { ours: vec![], theirs: vec![], ratios: vec![], ours_made, theirs_made, left_out: 0 };
        let mut were_there = cores::are_there(pool);
        for pair in 0..PATIENCE * pairs {
            if duel.ratios.len() == pairs {
                break;
            }
            let (our_time, their_time) = if pair % 2 == 0 {
                let first = ours()?.0;
                (first, theirs()?.0)
            } else {
                let first = theirs()?.0;
                (ours()?.0, first)
            };
            let are_there_still = cores::are_there(pool);
            if !(std::mem::replace(&mut were_there, are_there_still) && are_there_still) {
                duel.left_out += 1;
                continue;
            }
            duel.ours.push(our_time);
            duel.theirs.push(their_time);
            duel.ratios.push(their_time / our_time);
        }
        for values in [&mut duel.ours, &mut duel.theirs, &mut duel.ratios] {
            values.sort_unstable_by(f64::total_cmp);
        }
        Ok(duel)
    }

    pub(crate) fn is_same_to_the_last_bit(&self) -> bool {
        self.ours_made.to_bits() == self.theirs_made.to_bits()
    }

    /// Says so where the results are not the same. Two builds of one engine differ in the last bits, and simulations with contacts
    /// make more of it.
    pub(crate) fn same(self) -> Self {
        let (ours, theirs) = (self.ours_made, self.theirs_made);
        if (ours - theirs).abs() > SAME * (1.0 + theirs.abs()) {
            println!("The results of the next are not the same: {ours:e} here and {theirs:e} there. Is it one engine?");
        }
        self
    }
}

struct Row {
    what: String,
    whom: &'static str,
    microseconds: [f64; 2],
    quartiles: [f64; 3],
    pairs: usize,
}

#[derive(Default)]
pub(crate) struct Report {
    rows: Vec<Row>,
}

impl Report {
    /// Adds a comparison of runs that make this many calls.
    pub(crate) fn add(&mut self, what: String, whom: &'static str, calls: usize, duel: &Duel) {
        let pairs = duel.ratios.len();
        if duel.left_out > 0 {
            println!("{} pairs of the next are left out: there was not a core for each thread.", duel.left_out);
        }
        if pairs == 0 {
            println!("{what}: not compared with {whom}.");
            return;
        }
        let at = |values: &[f64], quarter: usize| values[(values.len() - 1) * quarter / 4];
        let microseconds = [&duel.ours, &duel.theirs].map(|times| 1e6 * at(times, 2) / calls as f64);
        let quartiles = [1, 2, 3].map(|quarter| at(&duel.ratios, quarter));
        let [low, median, high] = quartiles;
        println!("{what}: {median:.3} times as fast as {whom} ({low:.3} to {high:.3})");
        self.rows.push(Row { what, whom, microseconds, quartiles, pairs });
    }

    /// Writes `compare.md` and `compare.svg`.
    pub(crate) fn write(&self, out: &Path) -> Outcome<()> {
        fs::create_dir_all(out)?;
        let mut table = String::from(
            "| what | beside | ours, µs | theirs, µs | times as fast | quartiles | pairs |\n|---|---|---:|---:|---:|---|---:|\n",
        );
        for Row { what, whom, microseconds: [ours, theirs], quartiles: [low, median, high], pairs } in &self.rows {
            writeln!(
                table,
                "| {what} | {whom} | {ours:.2} | {theirs:.2} | {median:.3} | {low:.3} to {high:.3} | {pairs} |"
            )?;
        }
        writeln!(table, "\nMedians of pairs, in turn. {}", machine())?;
        fs::write(out.join("compare.md"), table)?;
        self.draw(&out.join("compare.svg"))?;
        println!("written: {0}/compare.md, {0}/compare.svg", out.display());
        Ok(())
    }

    /// A bar for each comparison, from 1 to the ratio, on a logarithmic scale.
    fn draw(&self, path: &Path) -> Outcome<()> {
        const LEFT: i32 = 400;
        const RIGHT: i32 = 880;
        let height = 60 + 26 * self.rows.len() as i32;
        let root = SVGBackend::new(path, (960, height as u32)).into_drawing_area();
        root.fill(&WHITE)?;
        let largest = self.rows.iter().map(|row| row.quartiles[2]).fold(10.0, f64::max);
        let least = self.rows.iter().map(|row| row.quartiles[0]).fold(0.9, f64::min);
        let place = |ratio: f64| {
            let part = (ratio / least).ln() / (largest / least).ln();
            LEFT + (part * f64::from(RIGHT - LEFT)).round() as i32
        };
        let font = |size: i32| ("sans-serif", size).into_font();
        root.draw_text("times as fast as the other (logarithmic)", &font(13).color(&BLACK), (LEFT, 12))?;
        for (index, Row { what, whom, quartiles: [low, median, high], .. }) in self.rows.iter().enumerate() {
            let top = 44 + 26 * index as i32;
            let color = if *median >= 0.99 { RGBColor(46, 110, 166) } else { RGBColor(190, 90, 50) };
            root.draw_text(&format!("{what} / {whom}"), &font(13).color(&BLACK), (10, top + 3))?;
            let bar = [(place(1.0), top), (place(*median).max(place(1.0) + 1), top + 16)];
            root.draw(&Rectangle::new(bar, color.filled()))?;
            root.draw(&PathElement::new([(place(*low), top + 8), (place(*high), top + 8)], BLACK))?;
            root.draw_text(&format!("{median:.2}"), &font(13).color(&BLACK), (place(*high) + 6, top + 3))?;
        }
        root.draw(&PathElement::new([(place(1.0), 34), (place(1.0), height - 10)], BLACK))?;
        root.present()?;
        Ok(())
    }
}

/// What it was measured on.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("an unknown processor", |(_, model)| model);
    format!("{model}, {cores} cores, engine {}.", mujoco_safe::engine_version())
}
