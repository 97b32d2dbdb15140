//! Predictive control of a humanoid: it gets up from a squat and stands.
//!
//! ```text
//! cargo run --release --example humanoid_stand_up -- --out out
//! ```
//!
//! Fifty times a second, one iteration of iLQR plans the motion of the next 0.4 s ([`stand_up`]).
//! The cost contains the pose at the end, but no motion towards it. `--help` lists the options.

#[path = "../common/mod.rs"]
mod common;
mod stand_up;

use std::error::Error;
use std::time::Instant;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::{command_line, standing};
use stand_up::{Run, stand_up};

/// A humanoid gets up from a squat with predictive control.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Simulated time, s
    #[arg(long, value_name = "S", default_value_t = 4.0, value_parser = command_line::not_negative)]
    seconds: f64,
    #[command(flatten)]
    planning: command_line::Planning,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let run = stand_up(arguments.seconds, command_line::cores())?;
    let factor = arguments.seconds / start.elapsed().as_secs_f64();
    if let (Some(first), Some(last)) = (run.heights.first(), run.heights.last()) {
        println!(
            "centre of mass: {first:.2} m at first, {last:.2} m at the end, {:.2} m in the standing pose; real-time factor {factor:.2}",
            run.target
        );
    }
    if let Some(out) = &arguments.planning.out {
        chart::save(out, "humanoid_stand_up.svg", 280, &panels(&run))?;
        let csv = out.join("humanoid_stand_up.csv");
        run.trajectory.save_csv(&csv)?;
        println!("wrote {}", csv.display());
    }
    if arguments.planning.view {
        common::window::replay("Humanoid that gets up", mujoco_safe::Data::new(run.model)?, vec![run.trajectory])?;
    }
    Ok(())
}

fn panels(run: &Run) -> [Panel<'static>; 2] {
    let timestep = run.model.timestep();
    let over_time = |values: &[f64]| -> Vec<(f64, f64)> {
        let times = run.trajectory.times().iter().map(|time| time + timestep);
        times.zip(values.iter().copied()).collect()
    };
    let target = Line::dashed("standing pose", PALETTE[1], over_time(&vec![run.target; run.heights.len()]));
    [
        Panel::new(
            "Height of the centre of mass",
            ["time (s)", "height (m)"],
            vec![Line::new("humanoid", PALETTE[0], over_time(&run.heights)), target],
        ),
        Panel::new(
            "Speed of the centre of mass",
            ["time (s)", "speed (m/s)"],
            vec![Line::new("", PALETTE[0], over_time(&run.speeds))],
        ),
    ]
}
