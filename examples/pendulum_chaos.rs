//! Chaos and energy of a triple pendulum: state copies, sensitivity to the initial state, and the
//! error of the integrators.
//!
//! ```text
//! cargo run --release --example pendulum_chaos -- --out out
//! ```
//!
//! The program simulates the pendulum several times from states that differ by 1e-9 m/s, and prints
//! when their angles differ by more than 0.1 rad. Then it compares the drift of the total energy
//! for several time steps and two integrators.
//!
//! `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use common::chart::{self, Event, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::enums::Integrator;
use mujoco_safe::{Data, Model, Result};

const PENDULUM: &str = r#"
<mujoco model="triple pendulum">
  <option timestep="0.001"><flag energy="enable" contact="disable"/></option>
  <worldbody>
    <light pos="0 -1 1"/>
    <camera name="front" pos="0 -2.2 0" xyaxes="1 0 0 0 0 1"/>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass=".5"/>
      <body name="middle" pos="0 0 -.3">
        <joint name="elbow" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.25" size=".02" mass=".4"/>
        <body name="lower" pos="0 0 -.25">
          <joint name="wrist" axis="0 1 0"/>
          <geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".3"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"#;

/// Measures the sensitivity of a triple pendulum, and the error of the integrators.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Folder for the plot; without it, no plot is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let model = Arc::new(Model::from_xml_str(PENDULUM)?);

    let runs = (0..4).map(|run| swing(&model, 1e-9 * f64::from(run))).collect::<Result<Vec<_>>>()?;
    let mut first_apart = None;
    for (run, angles) in runs.iter().enumerate().skip(1) {
        let apart = runs[0].iter().zip(angles).find(|(first, other)| (first.1 - other.1).abs() > 0.1);
        match apart {
            Some(((time, _), _)) => {
                first_apart = first_apart.or((run == 1).then_some(*time));
                println!("run {run}, faster by {run}e-9 rad/s: differs by 0.1 rad after {time:.2} s");
            }
            None => println!("run {run} stays within 0.1 rad"),
        }
    }

    println!("largest drift of the energy in 10 s, J:");
    let mut drifts = Vec::new();
    for (name, integrator) in [("Euler", Integrator::Euler), ("Runge-Kutta", Integrator::Rk4)] {
        let mut line = Vec::new();
        for timestep in [0.004, 0.002, 0.001, 0.0005] {
            let drift = energy_drift(integrator, timestep)?;
            println!("  {name:11} timestep {timestep:.4} s: {drift:.2e}");
            line.push((timestep, drift));
        }
        drifts.push((name, line));
    }

    if let Some(out) = &arguments.out {
        let lines = |curves: Vec<(String, Vec<(f64, f64)>)>| {
            curves.into_iter().zip(PALETTE).map(|((label, points), color)| Line::new(&label, color, points)).collect()
        };
        let label = |run| if run == 0 { "reference".to_owned() } else { format!("+{run}e-9 rad/s") };
        let runs = runs.into_iter().enumerate().map(|(run, angles)| (label(run), angles)).collect();
        let drifts = drifts.into_iter().map(|(name, line)| (name.to_owned(), line)).collect();
        let panels = [
            Panel::new("Shoulder angle, by initial velocity", ["time (s)", "angle (rad)"], lines(runs))
                .events(first_apart.map(|time| Event::moment("0.1 rad apart", time))),
            Panel::new("Largest drift of the energy in 10 s", ["timestep (s)", "drift (J)"], lines(drifts))
                .logarithmic([true, true]),
        ];
        chart::save(out, "pendulum_chaos.svg", 260, &panels)?;
    }
    Ok(())
}

/// Returns the pendulum, lifted to the side, with a small initial velocity.
fn lifted(model: &Arc<Model>, velocity: f64) -> Result<Data> {
    let mut data = Data::new(model.clone())?;
    data.joint_mut("shoulder")?.qpos_mut()[0] = 2.0;
    data.joint_mut("shoulder")?.qvel_mut()[0] = velocity;
    Ok(data)
}

/// Returns the shoulder angle over 10 s.
fn swing(model: &Arc<Model>, velocity: f64) -> Result<Vec<(f64, f64)>> {
    let mut data = lifted(model, velocity)?;
    let mut angles = Vec::new();
    while data.time() < 10.0 {
        data.step()?;
        angles.push((data.time(), data.joint("shoulder")?.qpos()[0]));
    }
    Ok(angles)
}

/// Returns the largest deviation from the initial energy in 10 s, J.
fn energy_drift(integrator: Integrator, timestep: f64) -> Result<f64> {
    let mut model = Model::from_xml_str(PENDULUM)?;
    model.edit().edit_options(|options| (options.integrator, options.timestep) = (integrator, timestep))?;
    let mut data = lifted(&Arc::new(model), 0.0)?;
    data.forward()?;
    let total = |data: &Data| data.energy().iter().sum::<f64>();
    let (initial, mut drift) = (total(&data), 0.0_f64);
    while data.time() < 10.0 {
        data.step()?;
        drift = drift.max((total(&data) - initial).abs());
    }
    Ok(drift)
}
