//! Cart-pole swing-up: trajectory optimisation with iLQR, time-varying LQR along the plan, and LQR
//! at the top.
//!
//! ```text
//! cargo run --release --example cartpole_swing_up -- --out out
//! ```
//!
//! The plan is computed by the iterative linear-quadratic regulator with control limits
//! ([`mujoco_safe::control::ilqr`]). Each simulation starts up to 0.1 rad away from the start of
//! the plan, so that it fails without feedback. The program prints the iterations and the cost of
//! each plan, and the time from which the pole is upright. `--help` lists the options.

#[path = "../common/mod.rs"]
mod common;
mod plots;
mod swing_up;

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use common::command_line;
use mujoco_safe::sample;
use swing_up::{SIMULATION_DURATION, attempt};

/// Swings a pole up by trajectory optimisation, and balances it.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Number of random initial states
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// Folder for the plot; without it, no plot is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let model = Arc::new(sample::cartpole());
    let mut attempts = Vec::new();
    for seed in 1..=arguments.seeds {
        let attempt = attempt(&model, seed, command_line::cores())?;
        let (plan, planned) = (&attempt.plan, attempt.planned(&model));
        println!(
            "seed {seed}: {} iterations, {}, cost {:.1} → {:.2}; planned {planned} s in {:.3} s ({:.1} times real time), \
             simulated at {:.0} times real time; {}",
            plan.costs.len() - 1,
            plan.status,
            plan.costs[0],
            plan.cost(),
            attempt.planning.as_secs_f64(),
            planned / attempt.planning.as_secs_f64(),
            SIMULATION_DURATION / attempt.simulating.as_secs_f64(),
            match attempt.up_at {
                Some(time) => format!("upright from {time:.2} s"),
                None => "not upright".to_owned(),
            }
        );
        attempts.push(attempt);
    }
    if let Some(out) = &arguments.out {
        plots::draw(out, &model, &attempts)?;
    }
    let up = attempts.iter().filter(|attempt| attempt.up_at.is_some()).count();
    println!("{up} of {} poles are upright", attempts.len());
    if up == attempts.len() { Ok(()) } else { Err("not every pole reached the upright position".into()) }
}
