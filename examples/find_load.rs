//! The load of an arm is found from a log of its motion, and compensated.
//!
//! ```text
//! cargo run --release --example find_load -- --out out
//! ```
//!
//! An arm with six joints holds a load that its controller does not know: 0.6 kg, beside the axis
//! of the hand. The motors follow a slow motion under PD control with the torques of the model
//! without a load, so the hand sags. The log has the torques, and positions from encoders with a
//! noise of 0.1 mrad. From them the program identifies the mass and the centre of mass of the load,
//! checks them with a second motion, and repeats the motion with the torques of the identified
//! model. It prints the values with their confidence intervals and the errors of the hand. `--help`
//! lists the options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::command_line;
use mujoco_safe::identification::{Experiment, Fit, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, Matrix, Model, Result};
use rand::RngExt;
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

/// Mass of the load in kg, and its centre of mass in the frame of the hand, m.
const LOAD: [f64; 4] = [0.6, 0.04, 0.02, -0.03];
/// Radius that the load is taken to have for its moments of inertia, m.
const RADIUS: f64 = 0.04;
/// Standard deviation of the encoders' noise, rad.
const NOISE: f64 = 1e-4;
/// Duration of the log, s.
const SECONDS: f64 = 3.0;
/// Gains of the controller relative to the torque of each motor.
const GAINS: [f64; 2] = [3.0, 0.3];

/// Finds the load of an arm from a log of its motion.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Folder for the plot; without it, nothing is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

/// Returns the arm with a load at its hand: without mass unless [`set_load`] gives it one.
fn arm() -> Result<Model> {
    let mut spec = Spec::from_xml_str(include_str!("../models/arm.xml"))?;
    let wrist = spec.body("wrist")?.id();
    let mut load = spec.add_body(wrist);
    load.set_name("load").set_pos([0.15, 0.0, 0.0]);
    load.set_inertial(1e-6, [0.0; 3], [1e-9; 3]);
    spec.compile()
}

/// Writes a load to a model.
fn set_load(model: &mut mujoco_safe::ModelMut<'_>, [mass, centre @ ..]: [f64; 4]) -> Result<()> {
    let load = model.body("load")?.index();
    model.body_mass_mut()[load] = mass;
    model.body_inertia_mut()[load] = [0.4 * mass * RADIUS * RADIUS; 3];
    model.body_ipos_mut()[load] = centre;
    model.update_constants()
}

/// Motion that the arm should follow: positions, velocities and accelerations.
fn reference(model: &Model, time: f64, phase: f64) -> Result<[Vec<f64>; 3]> {
    let ready = model.keyframe("ready")?.qpos().to_vec();
    let amplitude = |joint: f64| 0.35 * (joint + phase).cos();
    let rate = |joint: f64| 2.5 + 0.4 * joint;
    let joints = || (0..model.nv()).map(|joint| joint as f64);
    // Starts at rest.
    let position = joints().map(|joint| amplitude(joint) * (1.0 - (rate(joint) * time).cos()));
    let velocity = joints().map(|joint| amplitude(joint) * rate(joint) * (rate(joint) * time).sin());
    let acceleration = joints().map(|joint| amplitude(joint) * rate(joint).powi(2) * (rate(joint) * time).cos());
    Ok([ready.iter().zip(position).map(|(ready, by)| ready + by).collect(), velocity.collect(), acceleration.collect()])
}

/// Log of a motion.
struct Log {
    times: Vec<f64>,
    controls: Matrix,
    positions: Matrix,
    /// Distance of the hand from where it should be, m.
    errors: Vec<f64>,
}

/// Moves the real arm under PD control with the torques that `known` needs for the motion.
fn follow(real: &Arc<Model>, known: &Model, phase: f64) -> Result<Log> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut arm, mut ideal) = (Data::new(real)?, Data::new(known.clone())?);
    arm.reset_to_key("ready")?;
    let gears: Vec<f64> = known.actuator_gear().iter().map(|gear| gear[0]).collect();
    let (nu, nv) = (real.nu(), real.nv());
    let (mut times, mut errors) = (Vec::new(), Vec::new());
    let (mut controls, mut positions) = (Vec::new(), Vec::new());
    let hand = real.site("hand")?.index();
    while arm.time() < SECONDS {
        let [position, velocity, acceleration] = reference(known, arm.time(), phase)?;
        ideal.qpos_mut().copy_from_slice(&position);
        ideal.qvel_mut().copy_from_slice(&velocity);
        ideal.qacc_mut().copy_from_slice(&acceleration);
        ideal.inverse()?;
        for joint in 0..nu {
            let feedback =
                GAINS[0] * (position[joint] - arm.qpos()[joint]) + GAINS[1] * (velocity[joint] - arm.qvel()[joint]);
            let torque = ideal.qfrc_inverse()[joint] / gears[joint];
            arm.ctrl_mut()[joint] = (torque + feedback).clamp(-1.0, 1.0);
        }
        times.push(arm.time());
        controls.extend_from_slice(arm.ctrl());
        let noise = (0..nv).map(|_| NOISE * random.sample::<f64, _>(StandardNormal));
        positions.extend(arm.qpos().iter().zip(noise).map(|(position, noise)| position + noise));
        arm.step()?;
        let [is, should] = [&arm, &ideal].map(|data| data.site_xpos()[hand]);
        errors.push((0..3).map(|axis| (is[axis] - should[axis]).powi(2)).sum::<f64>().sqrt());
    }
    let rows = times.len();
    Ok(Log {
        controls: Matrix::from_row_major(rows, nu, controls),
        positions: Matrix::from_row_major(rows, nv, positions),
        times,
        errors,
    })
}

/// Returns what the log of a motion says, for an arm of this model.
fn experiment(name: &str, model: &Arc<Model>, log: &Log) -> Result<Experiment> {
    let mut start = Data::new(model)?;
    start.reset_to_key("ready")?;
    let encoders = Signal::new(log.times.clone(), log.positions.clone())?;
    let measurement = Measurement::of("encoders", encoders, |data, output| {
        output.copy_from_slice(data.qpos());
        Ok(())
    });
    Ok(Experiment::new(name, &start)
        .with_controls(Signal::new(log.times.clone(), log.controls.clone())?)
        .with_measurement(measurement.with_deviation(NOISE)))
}

/// Identifies the load.
fn identify(model: &Arc<Model>, log: &Log) -> Result<Fit> {
    // Segments of half a second, whose first states come from the encoders.
    let mut states = Matrix::zeros(log.times.len(), 2 * model.nv());
    for row in 0..log.times.len() {
        let (low, high) = (row.saturating_sub(2), (row + 2).min(log.times.len() - 1));
        for joint in 0..model.nv() {
            let change = log.positions[(high, joint)] - log.positions[(low, joint)];
            states[(row, joint)] = log.positions[(row, joint)];
            states[(row, model.nv() + joint)] = change / (log.times[high] - log.times[low]);
        }
    }
    let experiment = experiment("log", model, log)?.with_segments(0.5, Signal::new(log.times.clone(), states)?);
    let load = model.body("load")?.index();
    let mass = Unknown::edit("mass (kg)", 0.1, move |mass, model| {
        let [_, y, z] = model.body_ipos()[load];
        set_load(model, [mass, 0.0, y, z])
    });
    let mut unknowns = vec![mass.between(1e-3, 5.0)];
    for (axis, name) in ["x (m)", "y (m)", "z (m)"].into_iter().enumerate() {
        let place = Unknown::edit(name, 0.0, move |value, model| {
            model.body_ipos_mut()[load][axis] = value;
            model.update_constants()
        });
        unknowns.push(place.between(-0.3, 0.3).with_scale(0.01));
    }
    Identification::new(unknowns)?.with_experiment(experiment)?.solve(Options::default())
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let without = Arc::new(arm()?);
    let mut real = Model::clone(&without);
    set_load(&mut real.edit(), LOAD)?;
    let real = Arc::new(real);

    let log = follow(&real, &without, 0.0)?;
    let fit = identify(&without, &log)?;
    print!("{fit}");
    let [mass, x, y, z] = LOAD;
    println!("the truth: {mass} kg at ({x}, {y}, {z}) m");

    let found = fit.model(&without)?;
    let other = follow(&real, &found, 1.0)?;
    let held_out = fit.validate([experiment("another motion", &without, &other)?])?;
    println!("another motion, simulated with these values: rms error of the encoders {:.2e} rad", held_out[0].rms);
    let compensated = follow(&real, &found, 0.0)?;
    let largest = |log: &Log| log.errors.iter().fold(0.0, |most: f64, &error| most.max(error));
    println!(
        "largest error of the hand: {:.1} mm without the load in the model, {:.2} mm with it",
        1e3 * largest(&log),
        1e3 * largest(&compensated)
    );
    if let Some(out) = &arguments.out {
        chart::save(out, "find_load.svg", 260, &panels(&without, &fit, &log, &compensated)?)?;
    }
    Ok(())
}

/// Returns the plot: a joint as measured and as simulated with and without the load, and the errors
/// of the hand.
fn panels(without: &Arc<Model>, fit: &Fit, log: &Log, compensated: &Log) -> Result<[Panel<'static>; 2]> {
    const JOINT: usize = 2;
    // No unknowns: only a simulation.
    let nominal = Identification::new(Vec::new())?.with_experiment(experiment("log", without, log)?)?;
    let nominal = nominal.solve(Options::default())?;
    let line = |values: &Matrix| log.times.iter().copied().zip(values.rows().map(|row| row[JOINT]).collect::<Vec<_>>());
    let errors = |log: &Log| {
        let points = log.times.iter().zip(&log.errors).map(|(&time, error)| (time, 1e3 * error));
        points.collect::<Vec<_>>()
    };
    let joint = vec![
        Line::new("measured", PALETTE[6], line(&log.positions)),
        Line::new("without load", PALETTE[1], line(nominal.errors()[0].simulated.values())),
        Line::dashed("identified", PALETTE[0], line(fit.errors()[0].simulated.values())),
    ];
    let hand = vec![
        Line::new("unknown load", PALETTE[1], errors(log)),
        Line::new("compensated", PALETTE[0], errors(compensated)),
    ];
    Ok([
        Panel::new("The elbow under the same torques", ["time (s)", "angle (rad)"], joint),
        Panel::new("Error of the hand", ["time (s)", "distance (mm)"], hand).at_least(0.0, 1.0),
    ])
}
