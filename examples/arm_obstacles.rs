//! An arm with seven joints follows a moving target between two pillars with inverse kinematics.
//!
//! ```text
//! cargo run --release --features renderer --example arm_obstacles -- --out out
//! ```
//!
//! In each tick of 10 ms, the hand takes the step towards the target that the ranges of the joints,
//! their speeds and accelerations allow, and that keeps all links away from the pillars. The target
//! passes through the pillars, so the hand goes around them there. The program prints the largest
//! error where the target is free, the smallest distance and the time of a tick. `--out` writes a
//! plot and, with the feature `renderer`, a film.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::control::residual::{FramePosition, JointPosition};
use mujoco_safe::ik::{Avoidance, Ik, Task};
use mujoco_safe::{Data, Model};

const DT: f64 = 0.01;
const MINIMUM: f64 = 0.02;
/// Time in which the hand reaches the target, s.
const APPROACH: f64 = 2.0;
const PILLARS: [&str; 2] = ["pillar0", "pillar1"];

/// An arm follows a moving target between obstacles.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Duration, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = command_line::not_negative)]
    seconds: f64,
    /// Folder for the plot and the film; without it, no file is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Returns an arm of seven links on the floor, two pillars, and a marker of the target.
fn model() -> mujoco_safe::Result<Model> {
    let mut body = r#"<site name="hand" pos="0 0 .08"/>"#.to_owned();
    for link in (0..7).rev() {
        let (axis, length) = (["0 0 1", "0 1 0"][link % 2], [0.25, 0.2, 0.2, 0.15, 0.15, 0.1, 0.08][link]);
        let place = if link == 0 { 0.1 } else { [0.25, 0.2, 0.2, 0.15, 0.15, 0.1, 0.08][link - 1] };
        body = format!(
            r#"<body pos="0 0 {place}"><joint axis="{axis}" range="-140 140"/>
                 <geom name="link{link}" type="capsule" size=".04" fromto="0 0 0 0 0 {length}"/>{body}</body>"#
        );
    }
    Model::from_xml_str(&format!(
        r#"<mujoco><default><joint limited="true"/><geom rgba=".25 .5 .75 1"/></default>
             <visual><headlight ambient=".35 .35 .35"/></visual><worldbody>
             <light pos="1 -1 3" dir="-.3 .3 -1" diffuse=".5 .5 .5"/>
             <camera name="front" pos="2.2 .25 1" xyaxes="-.12 1 0 -.28 -.03 .96"/>
             <geom type="plane" size="2 2 .1" rgba=".85 .87 .9 1" contype="0" conaffinity="0"/>
             <geom name="pillar0" type="capsule" size=".06" fromto=".45 .2 0 .45 .2 .4" rgba=".8 .4 .2 1"/>
             <geom name="pillar1" type="capsule" size=".06" fromto=".45 -.25 0 .45 -.25 .4" rgba=".8 .4 .2 1"/>
             <body name="target" mocap="true">
               <geom size=".03" rgba=".1 .7 .3 .7" contype="0" conaffinity="0"/></body>
             {body}</worldbody></mujoco>"#
    ))
}

/// Returns the target at a time, m: an ellipse that passes through both pillars.
fn target(time: f64) -> [f64; 3] {
    let phase = TAU * time / 10.0;
    [0.45 + 0.05 * (2.0 * phase).cos(), 0.4 * phase.sin(), 0.45 + 0.1 * phase.cos()]
}

/// Returns the distance of a point from the surfaces of the pillars, m.
fn clearance([x, y, z]: [f64; 3]) -> f64 {
    let above = (z - 0.4).max(0.0);
    let distances = [0.2, -0.25].map(|side: f64| (x - 0.45).hypot(y - side).hypot(above) - 0.06);
    distances[0].min(distances[1])
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[derive(Default)]
struct Run {
    times: Vec<f64>,
    hand: Vec<[f64; 3]>,
    /// Positions of the joints, rad.
    joints: Vec<Vec<f64>>,
    errors: Vec<f64>,
    /// Distance of the arm from the pillars, m.
    distances: Vec<f64>,
    /// Distance of the target from the surfaces of the pillars, m.
    clearances: Vec<f64>,
    /// Mean time of a tick, s.
    tick: f64,
}

fn follow(seconds: f64) -> mujoco_safe::Result<Run> {
    let mut data = Data::new(Arc::new(model()?))?;
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let hand = ik.add_task(Task::new(FramePosition::site(&model, "hand")?));
    ik.add_task(Task::new(JointPosition::all(&model)).with_weight(1e-5));
    ik.set_velocity_limits(2.0)?;
    for joint in 0..model.njnt() {
        ik.set_acceleration_limit(joint, 20.0)?;
    }
    let links: Vec<String> = (0..7).map(|link| format!("link{link}")).collect();
    for link in &links {
        for pillar in PILLARS {
            ik.avoid(link, pillar, Avoidance { minimum: MINIMUM, detection: 0.15, gain: 0.3 })?;
        }
    }
    data.qpos_mut().copy_from_slice(&[0.0, -0.4, 0.0, 1.6, 0.0, 0.6, 0.0]);
    let mut run = Run::default();
    let ticks = (seconds / DT) as u32;
    for tick in 0..ticks {
        let time = DT * f64::from(tick);
        ik.set_target(hand, &target(time))?;
        let start = Instant::now();
        ik.step(&mut data, DT)?;
        run.tick += start.elapsed().as_secs_f64() / f64::from(ticks);
        data.kinematics()?;
        let mut nearest: f64 = 1.0;
        for link in &links {
            for pillar in PILLARS {
                nearest = data.geom_distance(link, pillar, 1.0)?.map_or(nearest, |found| nearest.min(found.distance));
            }
        }
        run.times.push(time);
        run.hand.push(*data.site("hand")?.xpos());
        run.joints.push(data.qpos().to_vec());
        run.errors.push(distance(data.site("hand")?.xpos(), &target(time)));
        run.distances.push(nearest);
        run.clearances.push(clearance(target(time)));
    }
    Ok(run)
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let run = follow(arguments.seconds)?;
    // The surface of the hand and the minimum need this much space.
    let is_free = |clearance: f64| clearance > 0.04 + MINIMUM + 0.06;
    let rows = run.times.iter().zip(&run.errors).zip(&run.clearances);
    let free = rows.filter(|((time, _), clearance)| **time > APPROACH && is_free(**clearance));
    let largest = free.map(|((_, error), _)| *error).fold(0.0, f64::max);
    let nearest = run.distances.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "largest error where the target is free: {:.2} mm; smallest distance: {:.2} mm; time of a tick: {:.1} µs",
        1e3 * largest,
        1e3 * nearest,
        1e6 * run.tick
    );
    if let Some(out) = &arguments.out {
        chart::save(out, "arm_obstacles.svg", 260, &panels(&run))?;
        film(&run, out)?;
    }
    Ok(())
}

/// Records a film of the run.
#[cfg(feature = "renderer")]
fn film(run: &Run, out: &std::path::Path) -> Result<(), Box<dyn Error>> {
    use mujoco_safe::record::{Recorder, RecorderOptions};
    use mujoco_safe::render::{Renderer, RgbImage};

    let model = Arc::new(model()?);
    let options = RecorderOptions::default().with_frames_per_second(20.0);
    let mut recorder = Recorder::create(out.join("arm_obstacles.gif"), options)?;
    let (mut renderer, mut picture) = (Renderer::new(&model, 400, 300)?, RgbImage::default());
    let mut data = Data::new(&model)?;
    for (joints, &time) in run.joints.iter().zip(&run.times) {
        if recorder.is_due(time) {
            data.qpos_mut().copy_from_slice(joints);
            data.mocap_pos_mut()[0] = target(time);
            data.forward()?;
            renderer.snapshot(&mut data, "front")?.rgb_into(&mut picture)?;
            recorder.push(&picture, time)?;
        }
    }
    let recorded = recorder.finish()?;
    println!("wrote {}: {} frames, {:.2} s", recorded.path.display(), recorded.frames, recorded.seconds);
    Ok(())
}

/// Without the feature `renderer` there is no film.
#[cfg(not(feature = "renderer"))]
#[allow(clippy::unnecessary_wraps, reason = "the other variant fails")]
fn film(run: &Run, _: &std::path::Path) -> Result<(), Box<dyn Error>> {
    let _ = &run.joints;
    Ok(())
}

fn panels(run: &Run) -> [Panel<'static>; 3] {
    let axes = [(0, "x"), (1, "y"), (2, "z")];
    let hand = axes.iter().zip(PALETTE).map(|(&(axis, name), color)| {
        Line::new(&format!("hand {name}"), color, run.times.iter().zip(&run.hand).map(|(&time, at)| (time, at[axis])))
    });
    let targets = axes.iter().zip(PALETTE).map(|(&(axis, name), color)| {
        Line::dashed(&format!("target {name}"), color, run.times.iter().map(|&time| (time, target(time)[axis])))
    });
    let line =
        |label, values: &[f64], color| Line::new(label, color, run.times.iter().copied().zip(values.iter().copied()));
    let last = run.times.last().copied().unwrap_or(1.0);
    let distances = vec![
        line("of the arm", &run.distances, PALETTE[0]),
        line("of the target", &run.clearances, PALETTE[2]),
        Line::dashed("minimum", PALETTE[1], [(0.0, MINIMUM), (last, MINIMUM)]),
    ];
    let axes = ["time (s)", "distance (m)"];
    [
        Panel::new(
            "Position of the hand and of its target",
            ["time (s)", "position (m)"],
            hand.chain(targets).collect(),
        ),
        Panel::new("Distance of the hand from its target", axes, vec![line("", &run.errors, PALETTE[0])]),
        Panel::new("Distances from the pillars", axes, distances),
    ]
}
