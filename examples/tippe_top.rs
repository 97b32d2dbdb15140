//! A tippe top turns over while it spins: free bodies, rolling contact, and a choice of integrator.
//!
//! ```text
//! cargo run --release --example tippe_top -- --out out
//! ```
//!
//! The top is a ball with a low centre of mass and a stem. A fast spin about the stem raises the
//! centre of mass until the top spins on its stem. The program prints the time at which it turns
//! over, and plots the height of the stem and the spin.
//!
//! `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;

use clap::Parser;
use common::chart::{self, Event, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::{Data, Model};

const TOP: &str = r#"
<mujoco model="tippe top">
  <option integrator="RK4" timestep="0.0005"/>
  <worldbody>
    <light pos="0 0 .6"/>
    <camera name="side" pos="0 -.12 .05" xyaxes="1 0 0 0 .3 1"/>
    <geom name="table" type="plane" size=".3 .3 .01" />
    <body name="top" pos="0 0 .02">
      <freejoint/>
      <geom name="shell" type="sphere" size=".02" mass=".03" rgba=".8 .3 .2 1"/>
      <geom name="stem" type="cylinder" size=".004 .008" pos="0 0 .02" mass=".0008" rgba=".2 .2 .2 1"/>
      <geom name="ballast" type="box" size=".02 .02 .004" pos="0 0 -.014" mass=".018" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
</mujoco>"#;

/// Initial angular velocity, rad/s.
const SPIN: f64 = 200.0;

/// Prints the time at which a spinning tippe top turns over.
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

fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let mut data = Data::new(Model::from_xml_str(TOP)?)?;
    // The velocity of a free joint is linear, then angular in the body's frame. A small tilt breaks
    // the symmetry.
    data.qvel_mut().copy_from_slice(&[0.0, 0.0, 0.0, 0.3, 0.0, SPIN]);

    let (mut stem, mut rate, mut turned) = (Vec::new(), Vec::new(), None);
    while data.time() < 8.0 {
        data.step()?;
        // The third column of the rotation matrix is the direction of the stem.
        let upward = data.body("top")?.xmat()[8];
        if upward < -0.8 && turned.is_none() {
            turned = Some(data.time());
        }
        stem.push((data.time(), upward));
        rate.push((data.time(), data.qvel()[5]));
    }
    match turned {
        Some(time) => println!("the top stands on its stem after {time:.2} s"),
        None => println!("the top has not turned over in {:.0} s", data.time()),
    }

    if let Some(out) = &arguments.out {
        let panel = |title, y, color, points: Vec<_>| {
            let every_tenth = points.into_iter().step_by(10);
            let line = Line::new("", color, every_tenth);
            Panel::new(title, ["time (s)", y], vec![line]).events(turned.map(|time| Event::moment("on its stem", time)))
        };
        let panels = [
            panel("Tilt of the stem: 1 is up, −1 is down", "cosine of the tilt", PALETTE[0], stem),
            panel("Spin about the stem", "angular velocity (rad/s)", PALETTE[1], rate),
        ];
        chart::save(out, "tippe_top.svg", 260, &panels)?;
    }
    Ok(())
}
