//! Contacts of a tumbling block: number, forces, penetration, and their sum against the weight.
//!
//! ```text
//! cargo run --release --example contacts -- --out out
//! ```
//!
//! A spinning block falls onto the floor and comes to rest. The program prints the contacts at rest
//! and compares the sum of their normal forces with the weight. It plots contacts, forces, velocity
//! and penetration.
//!
//! `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::{Data, Model};

const BLOCK: &str = r#"
<mujoco model="tumbling block">
  <worldbody>
    <light pos="0 -.3 .8"/>
    <camera name="side" pos="0 -.6 .2" xyaxes="1 0 0 0 .25 1"/>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="block" pos="0 0 .25" euler="30 20 10">
      <freejoint/>
      <geom name="block" type="box" size=".05 .04 .03" mass=".5" solref=".004 1"/>
    </body>
  </worldbody>
</mujoco>"#;

/// Prints the contacts of a tumbling block at rest, and plots their forces.
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
    let mut data = Data::new(Model::from_xml_str(BLOCK)?)?;
    data.qvel_mut().copy_from_slice(&[0.0, 0.0, 0.0, 8.0, 4.0, -6.0]);
    let (mut counts, mut forces, mut speeds, mut depths) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    while data.time() < 1.0 {
        data.step()?;
        // After a step, contacts and their forces are those of the state before.
        let (mut normal, mut depth) = (0.0, 0.0_f64);
        for contact in data.contacts() {
            normal += contact.force()?.force[0];
            depth = depth.max(-contact.dist());
        }
        counts.push((data.time(), data.contacts().count() as f64));
        forces.push((data.time(), normal));
        speeds.push((data.time(), data.qvel()[..3].iter().map(|v| v * v).sum::<f64>().sqrt()));
        depths.push((data.time(), 1e3 * depth));
    }

    data.forward()?;
    let mut sum = 0.0;
    for contact in data.contacts() {
        let force = contact.force()?.force[0];
        sum += force;
        println!(
            "contact at {:.3?} m, penetration {:.1e} m, normal force {force:.3} N",
            contact.pos(),
            -contact.dist()
        );
    }
    let weight = data.model().body("block")?.mass() * -data.model().options().gravity[2];
    println!("sum of the normal forces {sum:.3} N, weight {weight:.3} N");

    if let Some(out) = &arguments.out {
        let held = Line::dashed("weight", PALETTE[1], [(0.0, weight), (data.time(), weight)]);
        let panel = |title, y, lines| Panel::new(title, ["time (s)", y], lines).at_least(0.0, 1.0);
        let line = |points: Vec<_>| Line::new("", PALETTE[0], points);
        let panels = [
            panel("Contacts of the block with the floor", "contacts (number)", vec![line(counts)]),
            panel("Sum of the normal forces", "force (N)", vec![line(forces), held]),
            panel("Speed of the centre of mass", "speed (m/s)", vec![line(speeds)]),
            panel("Largest penetration", "penetration (mm)", vec![line(depths)]),
        ];
        chart::save(out, "contacts.svg", 200, &panels)?;
    }
    Ok(())
}
