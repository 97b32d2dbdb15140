//! A pole that hangs from a cart is swung up and held: trajectory optimisation, a gain table along the trajectory, and LQR.
//!
//! ```text
//! cargo run --release --example cartpole_swing_up -- --out out
//! ```
//!
//! The plan is made by the iterative linear-quadratic regulator with controls within their range ([`mujoco_safe::control::ilqr`]).
//! The simulation begins up to 0.1 rad off where the plan does, so that it does not get far without feedback.
//!
//! `--seeds N` from how many random beginnings (5), `--threads N` with how many threads (all cores), `--out DIR` where the plots
//! go (none is written without).

#[path = "../common/mod.rs"]
mod common;
mod plots;
mod swing_up;

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use common::option;
use mujoco_safe::sample;
use swing_up::{SIMULATED, attempt};

struct Arguments {
    seeds: u64,
    threads: usize,
    out: Option<PathBuf>,
}

const HELP: &str = "cartpole_swing_up [--seeds N] [--threads N] [--out DIR]";

fn arguments() -> Result<Arguments, String> {
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    let arguments = Arguments { seeds: 5, threads: cores, out: None };
    option::read(HELP, arguments, |arguments, option| {
        match option.name() {
            "--seeds" => arguments.seeds = option.number()?,
            "--threads" => arguments.threads = option.number()?,
            "--out" => arguments.out = Some(option.path()?),
            _ => return option.unknown(),
        }
        Ok(())
    })
}

fn main() -> std::process::ExitCode {
    common::finish(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    let model = Arc::new(sample::cartpole());
    let mut attempts = Vec::new();
    for seed in 1..=arguments.seeds {
        let attempt = attempt(&model, seed, arguments.threads)?;
        let (plan, planned) = (&attempt.plan, attempt.planned(&model));
        println!(
            "seed {seed}: {} iterations, {}, cost {:.1} → {:.2}; planned {planned} s in {:.3} s, {:.1} times real time; \
             simulated at {:.0} times; {}",
            plan.costs.len() - 1,
            plan.status,
            plan.costs[0],
            plan.cost(),
            attempt.planning.as_secs_f64(),
            planned / attempt.planning.as_secs_f64(),
            SIMULATED / attempt.simulating.as_secs_f64(),
            match attempt.up_at {
                Some(time) => format!("up from {time:.2} s on"),
                None => "not up".to_owned(),
            }
        );
        attempts.push(attempt);
    }
    if let Some(out) = &arguments.out {
        std::fs::create_dir_all(out)?;
        let path = out.join("cartpole_swing_up.svg");
        plots::draw(&path, &model, &attempts)?;
        println!("wrote {}", path.display());
    }
    let up = attempts.iter().filter(|attempt| attempt.up_at.is_some()).count();
    println!("{up} of {} poles are up", attempts.len());
    if up == attempts.len() { Ok(()) } else { Err("a pole is not up".into()) }
}
