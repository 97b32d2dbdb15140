//! The truth is found for an arm, a quadruped and a humanoid, from what such robots measure.

use std::sync::Arc;

use mujoco_safe::identification::{Experiment, Fit, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Matrix, Model, sample};

use crate::{Log, Noise, record};

/// Writes true values to a model: the parameters of unknowns.
fn truth(start: &Data, values: &[(Parameter, f64)]) -> Data {
    // A search without steps writes values as the search does.
    let mut data = start.clone();
    let unknowns = values.iter().map(|&(parameter, value)| {
        Unknown::parameter(start.model(), parameter).unwrap().starting_at(value).between(value, value)
    });
    let experiment = Experiment::new("none", start).with_measurement(Measurement::of(
        "none",
        Signal::scalar(vec![start.time()], vec![0.0]).unwrap(),
        |_, _| Ok(()),
    ));
    let identification = Identification::new(unknowns.collect()).unwrap().with_experiment(experiment).unwrap();
    let model = Arc::new(identification.solve(Options::default()).unwrap().model(start.model().clone()).unwrap());
    data.adopt(&model).unwrap();
    data
}

/// Searches from the nominal values.
fn search(start: &Data, values: &[(Parameter, f64)], experiment: Experiment) -> Fit {
    let unknowns = values.iter().map(|&(parameter, _)| {
        let unknown = Unknown::parameter(start.model(), parameter).unwrap();
        unknown.logarithmic()
    });
    let identification = Identification::new(unknowns.collect()).unwrap().with_experiment(experiment).unwrap();
    identification.solve(Options::default()).unwrap()
}

#[track_caller]
fn check(fit: &Fit, values: &[(Parameter, f64)], tolerance: f64) {
    assert!(fit.undetermined().is_empty(), "{fit}");
    for (estimate, (_, truth)) in fit.estimates().iter().zip(values) {
        assert!((estimate.value / truth - 1.0).abs() < tolerance, "{fit}");
        // Noise of a known size is in the readings.
        let half = 0.5 * (estimate.interval[1] - estimate.interval[0]);
        assert!((estimate.value - truth).abs() < 2.5 * half, "{fit}");
    }
}

/// Returns a measurement of positions from `first` on, by encoders with noise, every `stride`
/// steps.
fn encoders(log: &Log, nq: usize, first: usize, stride: usize) -> Measurement {
    const NOISE: f64 = 1e-4;
    let mut noise = Noise(7);
    let rows = (0..log.times.len()).step_by(stride);
    let values: Vec<f64> = rows
        .clone()
        .flat_map(|row| log.states.row(row)[first..nq].to_vec())
        .map(|it| it + NOISE * noise.normal())
        .collect();
    let signal = Signal::new(
        rows.clone().map(|row| log.times[row]).collect(),
        Matrix::from_row_major(rows.count(), nq - first, values),
    );
    Measurement::of("encoders", signal.unwrap(), move |data, output| {
        output.copy_from_slice(&data.qpos()[first..]);
        Ok(())
    })
    .with_deviation(NOISE)
}

/// The hand's mass, damping and a motor's gear of an arm, from its encoders, in segments.
#[test]
fn arm() {
    let model = Arc::new(Model::from_xml_path("models/arm.xml").unwrap());
    let mut start = Data::new(&model).unwrap();
    // It hangs down, away from the limits of its joints.
    start.joint_mut("pitch").unwrap().qpos_mut()[0] = 1.3;
    let body = |name: &str| model.body(name).unwrap().id();
    let values = [
        (Parameter::MassFactor(body("wrist")), 1.8),
        (Parameter::MassFactor(body("forearm")), 0.8),
        (Parameter::JointDamping(model.joint("pitch").unwrap().id()), 0.9),
        (Parameter::JointArmature(model.joint("yaw").unwrap().id()), 0.04),
        (Parameter::ActuatorGear(model.actuator(1).unwrap().id()), 1.2 * model.actuator_gear()[1][0]),
    ];
    let nu = model.nu();
    let log = record(truth(&start, &values), 400, |time| {
        (0..nu).map(|i| [0.15, 0.15, 0.1, 0.05, 0.05, 0.05][i] * ((2.0 + i as f64) * time + i as f64).sin()).collect()
    });
    walk(&start, &log, &values, 2e-2);
}

/// The mass of the trunk, gears and damping of a quadruped that sways,
/// from encoders and the pose of its trunk, in segments.
#[test]
fn quadruped() {
    let model = Arc::new(Model::from_xml_path("tests/models/gymnasium/quadruped.xml").unwrap());
    let mut start = Data::new(&model).unwrap();
    let nu = model.nu();
    let control = move |time: f64| (0..nu).map(|i| 0.15 * (6.0 * time + i as f64).sin()).collect::<Vec<_>>();
    // It stands before the log begins.
    for _ in 0..100 {
        start.step().unwrap();
    }
    let gear = |index: usize| Parameter::ActuatorGear(model.actuator(index).unwrap().id());
    let damping = model.joint("front_left_knee").unwrap().id();
    let values = [
        (Parameter::MassFactor(model.body("torso").unwrap().id()), 1.3),
        (gear(0), 30.0),
        (gear(3), 20.0),
        (Parameter::JointDamping(damping), 1.2),
    ];
    let log = record(truth(&start, &values), 60, control);
    walk(&start, &log, &values, 2e-2);
}

/// Masses, damping and gears of a humanoid that moves on one leg, from encoders and the pose of its
/// pelvis, in segments.
#[test]
fn humanoid() {
    let model = Arc::new(sample::humanoid());
    let mut start = Data::new(&model).unwrap();
    start.reset_to_key("stand_on_left_leg").unwrap();
    let body = |name: &str| model.body(name).unwrap().id();
    let names: Vec<&str> = model.bodies().filter_map(|body| body.name()).collect();
    let thigh = names.iter().find(|name| name.contains("thigh")).expect("a thigh");
    let values = [
        (Parameter::MassFactor(body("torso")), 1.2),
        (Parameter::MassFactor(body(thigh)), 0.8),
        (Parameter::ActuatorGear(model.actuator(3).unwrap().id()), 1.3 * model.actuator_gear()[3][0]),
    ];
    let nu = model.nu();
    let log = record(truth(&start, &values), 60, |time| {
        (0..nu).map(|i| 0.3 * ((8.0 + i as f64) * time + i as f64).sin()).collect()
    });
    walk(&start, &log, &values, 5e-2);
}

/// Searches in segments of a tenth of a second, whose first states come from the log's positions
/// and their differences.
fn walk(start: &Data, log: &Log, values: &[(Parameter, f64)], tolerance: f64) {
    let model = start.model();
    let (nq, nv) = (model.nq(), model.nv());
    let mut states = Matrix::zeros(log.times.len(), nq + nv);
    let mut velocity = vec![0.0; nv];
    for row in 0..log.times.len() {
        let (low, high) = (row.saturating_sub(1), (row + 1).min(log.times.len() - 1));
        let [from, to] = [low, high].map(|row| &log.states.row(row)[..nq]);
        model.differentiate_pos_into(log.times[high] - log.times[low], from, to, &mut velocity).unwrap();
        states.row_mut(row)[..nq].copy_from_slice(&log.states.row(row)[..nq]);
        states.row_mut(row)[nq..].copy_from_slice(&velocity);
    }
    let experiment = Experiment::new("walk", start)
        .with_controls(log.controls())
        .with_measurement(encoders(log, nq, 0, 1))
        .with_segments(0.1, Signal::new(log.times.clone(), states).unwrap());
    check(&search(start, values, experiment), values, tolerance);
}
