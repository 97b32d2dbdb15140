//! Cart-pole under LQR: linearise about the upright position, solve the Riccati equation, simulate.
//!
//! ```text
//! cargo run --release --example cartpole_lqr -- --angle 0.3 --out out
//! ```
//!
//! The program prints the linear system, the gain, the residual of the Riccati equation and the
//! final state. `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::{Data, Differences, Lqr, LqrWeights, Trajectory, sample};

/// Simulated time, s.
const SECONDS: f64 = 10.0;

/// Balances a cart-pole with a linear-quadratic regulator.
#[derive(Parser)]
#[command(allow_negative_numbers = true, args_override_self = true)]
struct Arguments {
    /// Initial angle of the pole, rad
    #[arg(long, value_name = "RAD", default_value_t = 0.1)]
    angle: f64,
    /// Folder for the plot; without it, no plot is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Show the result in a window (requires `--features viewer`)
    #[arg(long)]
    view: bool,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let model = Arc::new(sample::cartpole());
    let mut data = Data::new(model.clone())?;

    // State: [cart position, pole angle, cart velocity, pole velocity]. The origin is the upright
    // pole at rest. Linearise one simulation step there: x' = A x + B u.
    let system = data.transition_fd(1e-6, Differences::Central)?;

    // Minimise the sum of xᵀQx + uᵀRu over an infinite horizon.
    let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
    let solution = Lqr::solve(&system, &weights)?;
    let mut lqr = Lqr::with_gain(&data, solution.k)?;

    // Simulate from a tilted pole.
    data.joint_mut("hinge")?.qpos_mut()[0] = arguments.angle;
    let steps = (SECONDS / model.timestep()).round() as usize;
    let mut trajectory = Trajectory::with_capacity(&model, steps);
    trajectory.record(&mut data, &mut lqr, steps)?;
    let upright = data.qpos()[1].abs() < 0.01 && data.qvel()[1].abs() < 0.01;

    println!("A = {:.6?}\nB = {:.6?}\nK = {:.6?}", system.a, system.b, lqr.gain());
    println!(
        "Riccati equation: relative residual {:.1e}, spectral radius of A − BK {:.9}",
        solution.relative_residual, solution.spectral_radius
    );
    println!(
        "initial angle {} rad: the pole is {} after {SECONDS} s, [qpos; qvel] = {:.6?}",
        arguments.angle,
        if upright { "upright" } else { "not upright" },
        data.physics_state()
    );

    if let Some(out) = &arguments.out {
        plot(out, &trajectory)?;
    }
    if arguments.view {
        data.reset()?;
        data.joint_mut("hinge")?.qpos_mut()[0] = arguments.angle;
        common::window::show("Cart-pole under LQR", data, lqr, vec![trajectory])?;
    }
    if upright { Ok(()) } else { Err("the pole fell over".into()) }
}

fn plot(out: &std::path::Path, trajectory: &Trajectory) -> Result<(), Box<dyn std::error::Error>> {
    let line = |color: usize, value: &dyn Fn(usize) -> f64| {
        let points = (0..trajectory.len()).map(|record| (trajectory.times()[record], value(record)));
        vec![Line::new("", PALETTE[color], points)]
    };
    let position = line(0, &|record| trajectory.qpos(record)[0]);
    let angle = line(1, &|record| trajectory.qpos(record)[1]);
    // The engine clamps the control to its range.
    let control = line(2, &|record| trajectory.ctrl(record)[0].clamp(-1.0, 1.0));
    chart::save(
        out,
        "cartpole.svg",
        240,
        &[
            Panel::new("Position of a cart under LQR", ["time (s)", "position (m)"], position),
            Panel::new("Angle of its pole from upright", ["time (s)", "angle (rad)"], angle),
            Panel::new("Control of its motor", ["time (s)", "control (part of range)"], control),
        ],
    )
}
