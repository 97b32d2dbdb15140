//! Pushes of random direction against the humanoid on its left leg: the regulator alone, and iLQR
//! over a receding horizon.
//!
//! Both controllers start from the same pose. A humanoid counts as fallen when its centre of mass
//! is below 80 % of the initial height; it may put down its right foot. The direction of a push is
//! a function of its seed. Each run is simulated in lock-step with its planner in one thread, so
//! the results depend neither on the clock nor on the number of threads.

#[cfg(feature = "renderer")]
mod film;
mod plot;
mod scenario;
mod table;

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use mujoco_safe::Result;
use mujoco_safe::rayon::ThreadPoolBuilder;
use mujoco_safe::rayon::prelude::*;
pub use scenario::Scenario;
use scenario::{HORIZON, INTERVAL, PUSH_AT, PUSH_DURATION};

use crate::simulate::Run;

/// Default force of a push, N. The regulator falls in more than half of the directions.
pub const NEWTONS: f64 = 85.0;
/// Default simulated time, s.
pub const SECONDS: f64 = 4.0;
/// Fraction of falls with the planner above which the program fails.
const MOST_FALLS: f64 = 0.05;

/// One push, under both controllers.
pub struct Outcome {
    pub seed: u64,
    /// Direction of the force, rad, from the front of the humanoid to its left.
    pub angle: f64,
    pub regulated: Run,
    pub planned: Run,
}

/// Arguments of the series.
pub struct Series<'a> {
    pub first_seed: u64,
    pub count: usize,
    pub newtons: f64,
    pub seconds: f64,
    pub threads: usize,
    pub out: Option<&'a Path>,
}

/// Simulates all pushes, prints a table of the falls, and writes the files.
pub fn run(series: &Series<'_>) -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::new()?;
    let pool = ThreadPoolBuilder::new().num_threads(series.threads).build()?;
    println!(
        "plans of {HORIZON} steps, every {INTERVAL} steps, on {} threads; pushes of {} N for {PUSH_DURATION} s, starting at {PUSH_AT} s",
        pool.current_num_threads(),
        series.newtons
    );
    let bar = ProgressBar::new(series.count as u64);
    bar.set_style(ProgressStyle::with_template("{bar:40} {pos} of {len} pushes, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_secs(1));
    let start = Instant::now();
    let outcomes = pool.install(|| {
        let seeds = (0..series.count).into_par_iter().map(|index| series.first_seed + index as u64);
        // One push at a time: their durations differ.
        let outcomes = seeds.with_max_len(1).map(|seed| {
            let outcome = scenario.push(series.newtons, seed, series.seconds);
            bar.inc(1);
            outcome
        });
        outcomes.collect::<Result<Vec<_>>>()
    })?;
    bar.finish_and_clear();
    println!("{} pushes in {:.0} s", outcomes.len(), start.elapsed().as_secs_f64());
    table::print(&outcomes);
    if let Some(out) = series.out {
        std::fs::create_dir_all(out)?;
        let [csv, svg] = ["humanoid_pushes.csv", "humanoid_pushes.svg"].map(|name| out.join(name));
        table::save(&csv, series.newtons, &outcomes)?;
        plot::draw(&svg, &outcomes)?;
        println!("wrote {}\nwrote {}", csv.display(), svg.display());
        #[cfg(feature = "renderer")]
        film::record(&out.join("humanoid_pushes.gif"), &scenario, &outcomes)?;
        #[cfg(not(feature = "renderer"))]
        println!("no film: it requires `--features renderer`");
    }
    let falls = outcomes.iter().filter(|outcome| !outcome.planned.upright()).count();
    if falls as f64 <= MOST_FALLS * outcomes.len() as f64 {
        Ok(())
    } else {
        Err(format!("the humanoid fell in {falls} of {} pushes with the planner", outcomes.len()).into())
    }
}
