//! State estimation of a walking robot: an extended Kalman filter estimates the pose of the trunk
//! of a quadruped from its inertial measurement unit and its joint encoders.
//!
//! ```text
//! cargo run --release --example state_estimation -- --out out
//! ```
//!
//! The robot trots for some seconds on a floor with half the friction that the filter assumes, and
//! its servos are not exact. The program prints the errors of the height, the tilt and the velocity
//! of the trunk, their normalised squares (NEES), and how far the position and the heading have
//! drifted, which no sensor sees. A second filter, without noise of the contact forces, shows why
//! that is needed.
//!
//! The estimate knows the height and the velocity of the trunk only by the feet that touch the
//! floor. With the default seed all feet of the estimate have left it after 3.4 s, and the error of
//! the velocity leaves its band. For longer walks, measure which feet stand
//! ([`FramePosition`](mujoco_safe::control::residual::FramePosition) of a standing foot is a
//! reading).
//!
//! `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;

use clap::Parser;
use common::chart::{self, Line, PALETTE, Panel};
use common::{command_line, quadruped};
use mujoco_safe::estimation::{ExtendedKalmanFilter, Measurement, ProcessNoise};
use mujoco_safe::{Data, Matrix, Result};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Deviations of the readings: rad/s, m/s² and rad; and of the targets of the servos, rad.
const GYRO: f64 = 0.02;
const ACCELEROMETER: f64 = 0.2;
const ENCODER: f64 = 0.002;
const SERVO: f64 = 0.01;
/// Components of the error that are plotted, with their names and units.
const SHOWN: [(usize, &str, &str); 4] = [
    (2, "Height of the trunk", "error (m)"),
    (3, "Roll", "error (rad)"),
    (4, "Pitch", "error (rad)"),
    (14, "Forward velocity", "error (m/s)"),
];

/// Estimates the pose of a trotting quadruped from an IMU and joint encoders.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Duration of the trot, s
    #[arg(long, default_value = "4", value_parser = command_line::not_negative)]
    seconds: f64,
    /// Seed of the noise
    #[arg(long, default_value = "1")]
    seed: u64,
    /// Folder for the plot; without it, no plot is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let believed = quadruped::standing(quadruped::model(1.0)?)?;
    println!("                        NEES   height   roll and pitch   velocity       drift");
    let mut allowing = None;
    for (label, contact) in [("without contact noise", None), ("with contact noise", Some([100.0, 50.0]))] {
        let run = trot(&believed, contact, arguments)?;
        let [height, roll, pitch, velocity] = run.root_mean_squares();
        println!(
            "{label:22} {:5.1}   {:.1} mm   {:.2}° and {:.2}°   {velocity:.3} m/s   {:.0} cm, {:.1}°",
            run.nees,
            1e3 * height,
            roll.to_degrees(),
            pitch.to_degrees(),
            100.0 * run.drift[0],
            run.drift[1].to_degrees(),
        );
        allowing = Some(run);
    }
    println!("The NEES of height, roll and pitch of a consistent filter is 3 on average.");
    if let (Some(out), Some(run)) = (&arguments.out, allowing) {
        let panels: Vec<Panel<'_>> = SHOWN
            .iter()
            .enumerate()
            .map(|(index, &(_, title, unit))| Panel::new(title, ["time (s)", unit], run.lines(index)))
            .collect();
        chart::save(out, "state_estimation.svg", 190, &panels)?;
    }
    Ok(())
}

/// Errors along a trot.
struct Run {
    /// Time, and error and standard deviation of each component that is shown.
    records: Vec<(f64, [[f64; 2]; 4])>,
    /// Mean normalised square of the error of height, roll and pitch.
    nees: f64,
    /// Final errors of the horizontal position, m, and of the heading, rad.
    drift: [f64; 2],
}

impl Run {
    fn root_mean_squares(&self) -> [f64; 4] {
        std::array::from_fn(|index| {
            let squares = self.records.iter().map(|(_, values)| values[index][0] * values[index][0]);
            (squares.sum::<f64>() / self.records.len().max(1) as f64).sqrt()
        })
    }

    /// Returns the error of a component, and the band of twice its deviation.
    fn lines(&self, index: usize) -> Vec<Line> {
        let curve = |value: &dyn Fn([f64; 2]) -> f64| -> Vec<(f64, f64)> {
            self.records.iter().map(|(time, values)| (*time, value(values[index]))).collect()
        };
        vec![
            Line::new("error", PALETTE[0], curve(&|[error, _]| error)),
            Line::dashed("±2σ", PALETTE[1], curve(&|[_, deviation]| 2.0 * deviation)),
            Line::dashed("", PALETTE[1], curve(&|[_, deviation]| -2.0 * deviation)),
        ]
    }
}

/// Lets the robot trot, and estimates its state.
fn trot(believed: &Data, contact: Option<[f64; 2]>, arguments: &Arguments) -> Result<Run> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(arguments.seed);
    let mut normal = |deviation: f64| -> f64 {
        let number: f64 = StandardNormal.sample(&mut random);
        deviation * number
    };
    let mut robot = quadruped::standing(quadruped::model(0.5)?)?;
    let mut filter = filter(believed, contact)?;
    // The models were loaded separately, so the state is copied to compare.
    let mut truth = believed.clone();
    let nx = filter.covariance().nrows();
    let (mut error, mut readings) = (vec![0.0; nx], vec![0.0; filter.measurement().len()]);
    let deviations: Vec<f64> = filter.measurement().deviations().collect();
    let mut run = Run { records: Vec::new(), nees: 0.0, drift: [0.0; 2] };
    let start = robot.time();
    while robot.time() - start < arguments.seconds {
        let time = robot.time() - start;
        let controls = quadruped::trot(time);
        robot.ctrl_mut().iter_mut().zip(controls).for_each(|(ctrl, target)| *ctrl = target + normal(SERVO));
        truth.set_physics_state(&robot.physics_state())?;
        robot.step()?;

        // The readings after a step are those of the state before it.
        filter.measurement().select_into(robot.sensordata(), &mut readings)?;
        readings.iter_mut().zip(&deviations).for_each(|(reading, deviation)| *reading += normal(*deviation));
        filter.update(&controls, &readings)?;

        filter.error_into(&truth, &mut error)?;
        run.nees += filter.nees(&truth, 2..5)?.unwrap_or(f64::INFINITY);
        let shown = SHOWN.map(|(component, ..)| [error[component], filter.covariance()[(component, component)].sqrt()]);
        run.records.push((time, shown));
        filter.predict(&controls)?;
    }
    run.nees /= run.records.len().max(1) as f64;
    run.drift = [error[0].hypot(error[1]), error[5].abs()];
    Ok(run)
}

/// Returns a filter at the state of the standing robot.
fn filter(robot: &Data, contact: Option<[f64; 2]>) -> Result<ExtendedKalmanFilter> {
    let model = robot.model();
    let nv = model.nv();
    let mut noise = ProcessNoise::new(model).with_controls(&vec![SERVO; model.nu()])?;
    if let Some([normal, tangential]) = contact {
        // Impacts act on the trunk and the joints, too, and move the feet by fractions of a
        // millimetre in a step.
        let other = [vec![2.5e-7; 3], vec![4e-8; 3], vec![0.0; 2 * nv - 6]].concat();
        let joints = [vec![0.0; 6], vec![0.5; nv - 6]].concat();
        noise = noise
            .with_contact_forces(normal, tangential)?
            .with_body_forces("trunk", 100.0, 10.0)?
            .with_forces(&joints)?
            .with_covariance(&Matrix::from_diagonal(&other))?;
    } else {
        noise = noise.with_body_forces("trunk", 5.0, 0.5)?;
    }
    let mut sensors = Measurement::new(model).with_sensor("gyro", GYRO)?.with_sensor("accelerometer", ACCELEROMETER)?;
    for sensor in 2..model.nsensor() {
        sensors = sensors.with_sensor(sensor, ENCODER)?;
    }
    // The position is where the robot starts.
    let start = [vec![1e-8; nv], vec![1e-6; nv]].concat();
    ExtendedKalmanFilter::new(robot.clone(), &Matrix::from_diagonal(&start), noise, sensors)
}
