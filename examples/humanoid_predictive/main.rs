//! Predictive sampling for a humanoid: it recovers from pushes that its linear-quadratic regulator
//! alone cannot withstand.
//!
//! ```text
//! cargo run --release --example humanoid_predictive -- --out out
//! ```
//!
//! Fifty times a second, the planner simulates 32 rollouts of half a second under the regulator
//! with random additions to the controls, and applies the best of them ([`planner`]). The cost
//! rewards an upright robot that is not about to fall ([`cost`]); it does not prescribe steps. The
//! simulation waits for the planner, and the program prints the real-time factor. `--help` lists
//! the options.
//!
//! ```text
//! cargo run --release --features renderer --example humanoid_predictive -- --pushes 100 --out out
//! ```
//!
//! compares LQR with iLQR over a receding horizon in pushes of random direction against the
//! humanoid on one leg ([`pushes`]): a table, a plot and a film.
//!
//! ```text
//! cargo run --release --features viewer --example humanoid_predictive -- --view
//! ```
//!
//! shows the humanoid on one leg under iLQR in the viewer ([`live`]): the planned paths of its
//! centre of mass and of its right sole, the cost of each term, and sliders for the weights. Space
//! starts the simulation. Double-click on the humanoid, then pull it with Ctrl and the right mouse
//! button.

mod attempt;
#[path = "../common/mod.rs"]
mod common;
mod cost;
mod live;
mod planner;
mod plots;
mod pushes;
mod robot;
#[allow(dead_code, reason = "`humanoid_lqr` prints more of the run")]
#[path = "../humanoid_lqr/simulate.rs"]
mod simulate;

use std::error::Error;
use std::path::PathBuf;

use attempt::{Attempt, attempt};
use clap::Parser;
use common::balance::{set_point, weights};
use common::command_line;
use mujoco_safe::rayon::ThreadPoolBuilder;
use planner::{HORIZON, SAMPLES, STEPS};
use pushes::Series;
use robot::{NEWTONS, PUSH_DURATION, Robot, push};

/// Default simulated time, s.
const SECONDS: f64 = 6.0;

/// A humanoid recovers from pushes that its linear-quadratic regulator alone cannot withstand, by
/// predictive sampling.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Number of pushes, each in another direction
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// Push the humanoid on one leg in N random directions instead, under LQR and under iLQR over a
    /// receding horizon
    #[arg(long, value_name = "N", conflicts_with = "seeds")]
    pushes: Option<usize>,
    /// Seed of the first of these directions; the weights and the horizon were chosen with seeds
    /// other than 101 to 200
    #[arg(long, value_name = "N", default_value_t = 101, requires = "pushes")]
    first_seed: u64,
    /// Force of a push of 0.1 s, N; 180 by default, and 85 with `--pushes`
    #[arg(long, value_name = "F")]
    newtons: Option<f64>,
    /// Simulated time, s; 6 by default with a push at 1 s, and 4 with `--pushes` with a push at 0.2
    /// s
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Number of threads for planning
    #[arg(long, value_name = "N", default_value_t = command_line::cores())]
    threads: usize,
    /// Show the humanoid on one leg under iLQR in a window instead (requires the feature viewer)
    #[arg(long, conflicts_with_all = ["seeds", "pushes"])]
    view: bool,
    /// Folder for the plot and the first trajectory; without it, no files are written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if arguments.view {
        return live::run(arguments.threads);
    }
    if let Some(count) = arguments.pushes {
        return pushes::run(&Series {
            first_seed: arguments.first_seed,
            count,
            newtons: arguments.newtons.unwrap_or(pushes::NEWTONS),
            seconds: arguments.seconds.unwrap_or(pushes::SECONDS),
            threads: arguments.threads,
            out: arguments.out.as_deref(),
        });
    }
    let (newtons, seconds) = (arguments.newtons.unwrap_or(NEWTONS), arguments.seconds.unwrap_or(SECONDS));
    let pool = ThreadPoolBuilder::new().num_threads(arguments.threads).build()?;
    let robot = Robot::new()?;
    println!(
        "{SAMPLES} rollouts of {HORIZON} s every {} ms on {} threads; pushes of {} N for {PUSH_DURATION} s, starting at 1 s",
        STEPS as f64 * robot.model.timestep() * 1e3,
        pool.current_num_threads(),
        newtons
    );
    let mut attempts = Vec::new();
    for seed in 1..=arguments.seeds {
        let push = push(newtons, seed);
        let attempt = pool.install(|| attempt(&robot, push, seed, seconds))?;
        let [x, y] = push.force;
        let outcome = |fell_at: Option<f64>| match fell_at {
            Some(time) => format!("falls after {time:.2} s"),
            None => "stands".to_owned(),
        };
        println!(
            "push {seed}, direction {:4.0}°: LQR {}, planner {}; real-time factor {:.2}",
            y.atan2(x).to_degrees(),
            outcome(attempt.regulated.fell_at),
            outcome(attempt.planned.fell_at),
            attempt.real_time_factor()
        );
        attempts.push(attempt);
    }
    if let (Some(out), Some(first)) = (&arguments.out, attempts.first()) {
        std::fs::create_dir_all(out)?;
        plots::draw(out, &attempts)?;
        let csv = out.join("humanoid_predictive.csv");
        first.planned.trajectory.save_csv(&csv)?;
        println!("wrote {}", csv.display());
    }
    let successes = attempts.iter().filter(|attempt| attempt.succeeded()).count();
    println!("{successes} of {} pushes toppled the regulator but not the planner", attempts.len());
    if attempts.iter().all(Attempt::succeeded) {
        Ok(())
    } else {
        Err("the planner did not succeed for every push".into())
    }
}
