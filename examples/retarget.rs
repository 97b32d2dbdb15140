//! The motion of a person, who lifts a box and turns with it, is transferred to the humanoid, whose
//! proportions differ, with inverse kinematics.
//!
//! ```text
//! cargo run --release --example retarget -- --out out
//! cargo run --release --features html --example retarget -- --out out
//! ```
//!
//! With the feature `html` it also writes a page that plays the motion.
//!
//! The motion has the positions of the pelvis and of the hands of a person of 1.85 m, at 60 frames
//! per second. They are scaled by the length of the legs. The feet stand and the centre of mass
//! stays above them, with a higher priority than the scaled positions; the head looks at the box.
//! The program prints the errors, and the smallest distance of a joint from the ends of its range.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::control::residual::{Frame, FramePose, FramePosition, Gaze, JointPosition, Subtree};
use mujoco_safe::ik::{Ik, Task};
use mujoco_safe::{Data, Model, Trajectory, sample};

const DT: f64 = 1.0 / 60.0;
/// Frames before the motion.
const APPROACH: i32 = 120;
/// Height of the person's pelvis above the soles, m.
const PELVIS: f64 = 0.98;
/// Height of the humanoid's pelvis with almost straight legs, m.
const LEGS: f64 = 0.88;

/// A person's motion is transferred to the humanoid.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Folder for the plot; without it, no file is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Positions of the person's pelvis and hands, m: forwards, to the left and up from a point between
/// the soles.
type Markers = [[f64; 3]; 3];

/// Moment of the motion, s, with the position of the pelvis, the middle of the hands, half their
/// distance, and the angle by which they are turned to the left.
type Moment = (f64, [f64; 3], [f64; 3], f64, f64);

const MOTION: [Moment; 6] = [
    (0.0, [0.0, 0.0, 0.95], [0.20, 0.0, 1.00], 0.25, 0.0),
    (1.5, [-0.12, 0.0, 0.62], [0.42, 0.0, 0.40], 0.20, 0.0),
    (2.0, [-0.12, 0.0, 0.62], [0.42, 0.0, 0.40], 0.17, 0.0),
    (3.5, [0.0, 0.0, 0.96], [0.40, 0.0, 1.20], 0.17, 0.0),
    (5.0, [0.0, 0.02, 0.96], [0.40, 0.0, 1.10], 0.17, 0.6),
    (6.0, [0.0, 0.02, 0.96], [0.40, 0.0, 1.10], 0.17, 0.6),
];

/// Returns the markers at a time.
fn markers(time: f64) -> Markers {
    let next = MOTION.iter().position(|moment| moment.0 > time).unwrap_or(MOTION.len() - 1).max(1);
    let (from, to) = (MOTION[next - 1], MOTION[next]);
    let part = ((time - from.0) / (to.0 - from.0)).clamp(0.0, 1.0);
    let part = part * part * (3.0 - 2.0 * part);
    let mix = |from: f64, to: f64| from + part * (to - from);
    let point = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|axis| mix(from[axis], to[axis]));
    let (middle, half) = (point(from.2, to.2), mix(from.3, to.3));
    let (sin, cos) = mix(from.4, to.4).sin_cos();
    let hand = |side: f64| [cos * middle[0] - sin * side, sin * middle[0] + cos * side, middle[2]];
    [point(from.1, to.1), hand(half), hand(-half)]
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

struct Run {
    times: Vec<f64>,
    /// Scaled markers, and the positions of the humanoid.
    targets: Vec<Markers>,
    reached: Vec<Markers>,
    /// Largest distances of the soles and of the centre of mass from their targets, m.
    feet: f64,
    balance: f64,
    /// Smallest distance of a hinge from the ends of its range, rad.
    margin: f64,
    /// Mean time of a frame, s.
    frame: f64,
    #[cfg_attr(not(feature = "html"), allow(dead_code, reason = "only the page shows it"))]
    model: Arc<Model>,
    trajectory: Trajectory,
}

fn retarget() -> mujoco_safe::Result<Run> {
    let model = Arc::new(sample::humanoid());
    let mut data = Data::new(&model)?;
    // Bent knees: straight ones do not bend, since that does not lower the pelvis at first.
    data.reset_to_key("squat")?;
    data.forward()?;
    let soles = ["sole_left", "sole_right"];
    let places = [*data.site(soles[0])?.xpos(), *data.site(soles[1])?.xpos()];
    let ground: [f64; 3] = std::array::from_fn(|axis| 0.5 * (places[0][axis] + places[1][axis]));
    let scale = LEGS / PELVIS;
    let scaled = |marker: [f64; 3]| std::array::from_fn(|axis| ground[axis] + scale * marker[axis]);

    let mut ik = Ik::new(&model);
    ik.set_velocity_limits(6.0)?;
    for (sole, place) in soles.into_iter().zip(places) {
        let pose = FramePose::new(Frame::site(&model, sole)?).with_target(place, [1.0, 0.0, 0.0, 0.0]);
        ik.add_task(Task::new(pose));
    }
    let above = Task::new(Subtree::com(&model, "torso")?.with_target(ground));
    ik.add_task(above.with_weights([1.0, 1.0, 0.0]));
    let mut track = |body: &str, weights: [f64; 3]| {
        let task = Task::new(FramePosition::body(&model, body)?);
        Ok::<_, mujoco_safe::Error>(ik.add_task(task.with_weights(weights).with_damping(0.02).with_priority(1)))
    };
    // The balance decides where the pelvis is, apart from its height.
    let tracked = [track("pelvis", [0.1, 0.1, 1.0])?, track("hand_left", [1.0; 3])?, track("hand_right", [1.0; 3])?];
    let gaze = ik.add_task(
        Task::new(Gaze::new(Frame::body(&model, "head")?, [1.0, 0.0, 0.0])?).with_weight(0.05).with_priority(1),
    );
    let posture = JointPosition::all(&model).with_target(data.qpos())?;
    ik.add_task(Task::new(posture).with_weight(1e-3).with_priority(1));

    let frames = (MOTION[MOTION.len() - 1].0 / DT).round() as i32;
    let mut run = Run {
        times: Vec::new(),
        targets: Vec::new(),
        reached: Vec::new(),
        feet: 0.0,
        balance: 0.0,
        margin: f64::INFINITY,
        frame: 0.0,
        trajectory: Trajectory::new(&model),
        model: model.clone(),
    };
    // The first frames lead to the start of the motion.
    for frame in -APPROACH..=frames {
        let time = DT * f64::from(frame.max(0));
        let targets = markers(time).map(scaled);
        for (task, target) in tracked.into_iter().zip(&targets) {
            ik.set_target(task, target)?;
        }
        let [_, left, right] = targets;
        ik.set_target(gaze, &[0, 1, 2].map(|axis| 0.5 * (left[axis] + right[axis])))?;
        let start = Instant::now();
        ik.step(&mut data, DT)?;
        if frame < 0 {
            continue;
        }
        run.frame += start.elapsed().as_secs_f64() / f64::from(frames + 1);
        data.set_time(time);
        data.forward()?;
        run.trajectory.push(&data)?;
        let bodies = ["pelvis", "hand_left", "hand_right"].map(|name| data.body(name).map(|body| *body.xpos()));
        let [pelvis, left, right] = bodies;
        run.times.push(time);
        run.targets.push(targets);
        run.reached.push([pelvis?, left?, right?]);
        for (sole, place) in soles.into_iter().zip(&places) {
            run.feet = run.feet.max(distance(data.site(sole)?.xpos(), place));
        }
        let [x, y, _] = data.subtree_com()[model.body("torso")?.id().index()];
        run.balance = run.balance.max((x - ground[0]).hypot(y - ground[1]));
        for joint in model.joints().skip(1) {
            let ([low, high], angle) = (model.jnt_range()[joint.id().index()], data.qpos()[joint.qpos_range().start]);
            run.margin = run.margin.min(angle - low).min(high - angle);
        }
    }
    Ok(run)
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let run = retarget()?;
    let errors: Vec<[f64; 3]> = run.targets.iter().zip(&run.reached).map(|(a, b)| errors(a, b)).collect();
    let largest = |marker: usize| errors.iter().map(|error| error[marker]).fold(0.0, f64::max);
    println!(
        "largest errors: height of the pelvis {:.1} mm, left hand {:.1} mm, right hand {:.1} mm",
        1e3 * largest(0),
        1e3 * largest(1),
        1e3 * largest(2)
    );
    println!("feet: {:.2} mm; centre of mass: {:.1} mm from between the feet", 1e3 * run.feet, 1e3 * run.balance);
    println!(
        "smallest distance from the end of a range: {:.3} rad; time of a frame: {:.1} µs",
        run.margin,
        1e6 * run.frame
    );
    if let Some(out) = &arguments.out {
        chart::save(out, "retarget.svg", 260, &panels(&run, &errors))?;
        #[cfg(feature = "html")]
        run.trajectory.save_html(&run.model, out.join("retarget.html"), &mujoco_safe::html::HtmlOptions::default())?;
    }
    Ok(())
}

/// Returns the difference of the heights of the pelvis, and the distances of the hands.
fn errors(a: &Markers, b: &Markers) -> [f64; 3] {
    [(a[0][2] - b[0][2]).abs(), distance(&a[1], &b[1]), distance(&a[2], &b[2])]
}

fn panels(run: &Run, errors: &[[f64; 3]]) -> Vec<Panel<'static>> {
    const NAMES: [&str; 3] = ["pelvis", "left hand", "right hand"];
    let lines = |axis: usize| {
        let reached = NAMES.iter().zip(PALETTE).enumerate().map(move |(marker, (name, color))| {
            let points = run.times.iter().zip(&run.reached).map(|(&time, at)| (time, at[marker][axis]));
            Line::new(name, color, points)
        });
        let targets = NAMES.iter().zip(PALETTE).enumerate().map(move |(marker, (name, color))| {
            let points = run.times.iter().zip(&run.targets).map(|(&time, at)| (time, at[marker][axis]));
            Line::dashed(&format!("{name}, person"), color, points)
        });
        reached.chain(targets).collect::<Vec<_>>()
    };
    let gaps = NAMES.iter().zip(PALETTE).enumerate().map(|(marker, (name, color))| {
        Line::new(name, color, run.times.iter().zip(errors).map(|(&time, error)| (time, 1e3 * error[marker])))
    });
    vec![
        Panel::new("Heights", ["time (s)", "height (m)"], lines(2)),
        Panel::new("Positions to the left", ["time (s)", "position (m)"], lines(1)),
        Panel::new("Errors of the height of the pelvis and of the hands", ["time (s)", "error (mm)"], gaps.collect()),
    ]
}
