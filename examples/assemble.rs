//! A model in code: two arms on a table, joined with boxes that the program adds.
//!
//! ```text
//! cargo run --release --example assemble -- --out out
//! ```
//!
//! The arms are two copies of `models/arm.xml` on a table, whose motors become servos. Each holds
//! its hand above a box. The program prints the sizes of the joined model, and the distances of the
//! hands from the boxes. With `--out` it writes the model's MJCF text and, with the feature
//! `renderer`, a picture.
//!
//! `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use common::{command_line, parts};
use mujoco_safe::Data;
use mujoco_safe::enums::{GeomType, TextureType};
use mujoco_safe::spec::{Mount, Spec, TexturePattern};

/// Height of the table's top, m.
const TABLE: f64 = 0.4;
/// Positions of the boxes on the table, m.
const BOXES: [[f64; 2]; 2] = [[0.25, 0.3], [0.25, -0.3]];
/// Posture of an arm, rad, with the hand above a box.
const POSTURE: [f64; 6] = [0.0, -0.5, 1.6, 0.0, 0.0, 0.0];

/// Joins two arms with a table, and simulates them.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Simulated time, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    seconds: f64,
    /// Folder for the model's text and a picture; without it, nothing is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let spec = workcell()?;
    let mut data = Data::new(spec.compile()?)?;
    println!("{:?}", data.model());

    for side in ["left", "right"] {
        for (joint, angle) in ["yaw", "pitch", "elbow", "wrist_roll", "wrist_pitch", "wrist_yaw"].iter().zip(POSTURE) {
            data.joint_mut(&format!("{side}_{joint}"))?.qpos_mut()[0] = angle;
            data.actuator_mut(&format!("{side}_{joint}"))?.set_ctrl(angle);
        }
    }
    while data.time() < arguments.seconds {
        data.step()?;
    }
    data.forward()?;
    for side in ["left", "right"] {
        let [hand, item] = [data.site(&format!("{side}_hand"))?.xpos(), data.body(&format!("{side}_box"))?.xpos()];
        let distance = hand.iter().zip(item).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        println!("{side}: the hand is {distance:.3} m from the centre of its box");
    }
    if let Some(out) = &arguments.out {
        std::fs::create_dir_all(out)?;
        std::fs::write(out.join("assemble.xml"), spec.to_xml())?;
        draw(&mut data, out)?;
        println!("wrote the model to {}", out.display());
    }
    Ok(())
}

/// Builds the model.
fn workcell() -> Result<Spec, mujoco_safe::Error> {
    let arm = parts::servo_arm()?;
    let mut spec = Spec::new("workcell");
    spec.section_mut("option")?.set("timestep", 0.002)?.set("integrator", "implicit")?;
    spec.section_mut("visual")?.child_mut("headlight")?.set("ambient", [0.3; 3])?.set("diffuse", [0.25; 3])?;
    spec.section_mut("visual")?.child_mut("rgba")?.set("haze", [0.85, 0.9, 0.95, 1.0])?;
    parts::add_sky(&mut spec, [0.85, 0.9, 0.95], [0.5, 0.62, 0.75])?;
    spec.add_texture()
        .set_name("checks")
        .set_type(TextureType::Flat)
        .set_builtin(TexturePattern::Checker)
        .set_width(256)
        .set_height(256);
    spec.texture_mut("checks")?.set_rgb1([0.75, 0.77, 0.8]).set_rgb2([0.68, 0.7, 0.73]);
    spec.add_material().set_name("ground").set_texture("checks").set_texrepeat([6.0, 6.0]).set_reflectance(0.1);
    spec.add_material().set_name("wood").set_rgba([0.72, 0.55, 0.38, 1.0]);

    let world = spec.world();
    spec.add_light(world).set_pos([1.0, -1.0, 3.0]).set_dir([-0.3, 0.3, -1.0]).set_diffuse([0.5; 3]);
    spec.add_camera(world)
        .set_name("overview")
        .set_pos([1.7, -0.9, 1.5])
        .set_xyaxes([0.5, 0.86, 0.0, -0.45, 0.26, 0.85]);
    spec.add_geom(world).set_type(GeomType::Plane).set_size(&[3.0, 3.0, 0.1]).set_material("ground");
    let table = spec.add_body(world).set_name("table").set_pos([0.0, 0.0, TABLE]).id();
    spec.add_geom(table)
        .set_type(GeomType::Box)
        .set_size(&[0.55, 0.75, 0.02])
        .set_pos([0.1, 0.0, -0.02])
        .set_material("wood");
    for corner in [[-0.4, -0.7], [-0.4, 0.7], [0.6, -0.7], [0.6, 0.7]] {
        let [x, y] = corner;
        let leg = spec.add_geom(table).set_type(GeomType::Cylinder).set_size(&[0.03]).set_material("wood").id();
        spec.geom_mut(leg).set_fromto([x, y, -0.02, x, y, -TABLE]);
    }
    for (side, [x, y]) in ["left", "right"].into_iter().zip(BOXES) {
        spec.attach(&arm, Mount::body(table).with_pos([-0.25, y, 0.0]), &format!("{side}_"))?;
        let item = spec.add_body(world).set_name(&format!("{side}_box")).set_pos([x, y, TABLE + 0.05]).id();
        spec.add_freejoint(item);
        spec.add_geom(item)
            .set_type(GeomType::Box)
            .set_size(&[0.05, 0.04, 0.05])
            .set_mass(0.3)
            .set_rgba([0.85, 0.3, 0.2, 1.0]);
    }
    Ok(spec)
}

/// Draws the scene from its camera.
#[cfg(feature = "renderer")]
fn draw(data: &mut Data, out: &std::path::Path) -> Result<(), Box<dyn Error>> {
    let model = data.model().clone();
    let mut renderer = mujoco_safe::render::Renderer::new(&model, 960, 640)?;
    renderer.snapshot(data, model.camera("overview")?.id())?.rgb()?.save_png(out.join("assemble.png"))?;
    Ok(())
}

/// Without the feature `renderer` there is no picture.
#[cfg(not(feature = "renderer"))]
#[allow(clippy::unnecessary_wraps, reason = "the other variant fails")]
fn draw(_: &mut Data, _: &std::path::Path) -> Result<(), Box<dyn Error>> {
    Ok(())
}
