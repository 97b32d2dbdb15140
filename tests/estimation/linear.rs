//! A linear system: the estimates are those of an independent computation and of identities.
//!
//! `tests/oracle/estimation.py` conditions the joint normal distribution of all states and
//! readings, without a recursion.

use std::sync::Arc;

use mujoco_safe::control::residual::{JointPosition, JointVelocity};
use mujoco_safe::control::riccati::Riccati;
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise, UpdateStatus};
use mujoco_safe::{Data, Lineariser, Matrix, Model};
use serde_json::Value;

use crate::{assert_close, diagonal, springs};

fn numbers(value: &Value) -> Vec<f64> {
    serde_json::from_value(value.clone()).unwrap()
}

struct Recorded(Value);

impl Recorded {
    fn read() -> Self {
        Self(serde_json::from_str(include_str!("../oracle/estimation.json")).unwrap())
    }

    fn noise(&self, model: &Arc<Model>, has_motor_noise: bool) -> ProcessNoise {
        let deviations = &self.0["deviations"];
        let covariance = Matrix::from_row_major(4, 4, numbers(&self.0["noise"]));
        let noise = ProcessNoise::new(model).with_covariance(&covariance).unwrap();
        let noise = noise.with_forces(&numbers(&deviations["forces"])).unwrap();
        if has_motor_noise { noise.with_controls(&numbers(&deviations["motors"])).unwrap() } else { noise }
    }

    fn deviations(&self) -> Vec<f64> {
        numbers(&self.0["deviations"]["sensors"])
    }

    fn filter(&self, model: &Arc<Model>, has_motor_noise: bool, sensors: Measurement) -> ExtendedKalmanFilter {
        let mut data = Data::new(model).unwrap();
        data.set_physics_state(&numbers(&self.0["prior"])).unwrap();
        let covariance = Matrix::from_row_major(4, 4, numbers(&self.0["covariance"]));
        ExtendedKalmanFilter::new(data, &covariance, self.noise(model, has_motor_noise), sensors).unwrap()
    }

    fn run(&self, has_motor_noise: bool) -> &Value {
        &self.0[if has_motor_noise { "with_motor_noise" } else { "without_motor_noise" }]
    }
}

fn sensors(model: &Arc<Model>, deviations: &[f64]) -> Measurement {
    let sensors = Measurement::new(model).with_sensor("left", deviations[0]).unwrap();
    let sensors = sensors.with_sensor("right", deviations[1]).unwrap();
    sensors.with_sensor("acceleration", deviations[2]).unwrap()
}

/// Returns the three readings as those of the sensors: the accelerometer has three axes, of which
/// two are missing here.
fn readings(recorded: &Value) -> Vec<f64> {
    let [left, right, acceleration] = numbers(recorded)[..] else { panic!("three readings") };
    vec![left, right, acceleration, f64::NAN, f64::NAN]
}

#[test]
fn estimates_are_those_of_the_joint_distribution() {
    let recorded = Recorded::read();
    let model = Arc::new(springs());
    for has_motor_noise in [false, true] {
        let run = recorded.run(has_motor_noise);
        let filter = recorded.filter(&model, has_motor_noise, sensors(&model, &recorded.deviations()));
        let mut smoother = FixedLagSmoother::new(filter, 8).unwrap();
        let count = run["readings"].as_array().unwrap().len();
        for step in 0..count {
            let controls = numbers(&run["controls"][step]);
            let update = smoother.update(&controls, &readings(&run["readings"][step])).unwrap();
            assert_eq!((update.status, update.used), (UpdateStatus::Corrected, 3));
            let expected = &run["filtered"][step];
            assert_close(&smoother.filter().data().physics_state(), &numbers(&expected["mean"]), 1e-9);
            assert_close(smoother.filter().covariance().as_slice(), &numbers(&expected["covariance"]), 1e-9);
            if step + 1 < count {
                smoother.predict(&controls).unwrap();
            }
        }
        let report = smoother.smooth().unwrap();
        assert!(report.converged && report.iterations <= 2, "{report:?}");
        assert_eq!(smoother.len(), count);
        for step in 0..count {
            let expected = &run["smoothed"][step];
            assert_close(smoother.state(step), &numbers(&expected["mean"]), 1e-8);
            assert_close(smoother.covariance(step).as_slice(), &numbers(&expected["covariance"]), 1e-8);
        }
    }
}

/// The window's prior is the filter's prediction, so the last states are those of all readings.
#[test]
fn a_short_window_agrees_with_a_long_one_at_its_end() {
    let recorded = Recorded::read();
    let model = Arc::new(springs());
    let run = recorded.run(true);
    let filter = recorded.filter(&model, true, sensors(&model, &recorded.deviations()));
    let mut smoother = FixedLagSmoother::new(filter, 3).unwrap();
    for step in 0..8 {
        let controls = numbers(&run["controls"][step]);
        smoother.update(&controls, &readings(&run["readings"][step])).unwrap();
        smoother.smooth().unwrap();
        if step < 7 {
            smoother.predict(&controls).unwrap();
        }
    }
    for (index, step) in [5, 6, 7].into_iter().enumerate() {
        assert_close(smoother.state(index), &numbers(&run["smoothed"][step]["mean"]), 1e-8);
    }
}

#[test]
fn residuals_are_readings_as_sensors_are() {
    let recorded = Recorded::read();
    let model = Arc::new(springs());
    let run = recorded.run(false);
    let [left, right, acceleration] = recorded.deviations()[..] else { panic!("three deviations") };
    let measurement = Measurement::new(&model)
        .with_sensor("acceleration", acceleration)
        .unwrap()
        .with_residual(JointPosition::new(&model, "left").unwrap(), left)
        .unwrap()
        .with_residual(JointVelocity::new(&model, "right").unwrap(), right)
        .unwrap();
    assert_eq!(measurement.parts(), [0..3, 3..4, 4..5]);
    let mut filter = recorded.filter(&model, false, measurement);
    for step in 0..8 {
        let controls = numbers(&run["controls"][step]);
        let [left, right, acceleration] = numbers(&run["readings"][step])[..] else { panic!("three readings") };
        filter.update(&controls, &[acceleration, f64::NAN, f64::NAN, left, right]).unwrap();
        assert_close(filter.covariance().as_slice(), &numbers(&run["filtered"][step]["covariance"]), 1e-9);
        assert_close(&filter.data().physics_state(), &numbers(&run["filtered"][step]["mean"]), 1e-9);
        filter.predict(&controls).unwrap();
    }
}

/// The predicted covariance converges to the solution of the Riccati equation of the dual system.
#[test]
fn the_covariance_converges_to_the_solution_of_the_riccati_equation() {
    let model = Arc::new(springs());
    let mut data = Data::new(&model).unwrap();
    let (system, _) = Lineariser::new(&model, TransitionOptions::default()).unwrap().linear_system(&mut data).unwrap();
    let deviations = [0.01, 0.02, 0.1, 0.2];
    let noise = ProcessNoise::new(&model).with_covariance(&diagonal(&deviations)).unwrap();
    let measurement = sensors(&model, &[0.05, 0.1, 0.5]);
    let mut filter = ExtendedKalmanFilter::new(data, &Matrix::identity(4), noise, measurement).unwrap();
    for _ in 0..3000 {
        filter.update(&[0.0; 2], &[0.0, 0.0, 0.0, f64::NAN, f64::NAN]).unwrap();
        filter.predict(&[0.0; 2]).unwrap();
    }
    // The sensors in the order of the model: three axes of the accelerometer, then the joints.
    let c = system.c.to_nalgebra();
    let rows = [c.row(3), c.row(4), c.row(0)];
    let output = nalgebra::DMatrix::from_rows(&rows.map(|row| row.clone_owned()));
    let dual = Riccati::new(
        &system.a.to_nalgebra().transpose(),
        &output.transpose(),
        &diagonal(&deviations),
        &diagonal(&[0.05, 0.1, 0.5]),
    )
    .solve()
    .unwrap();
    assert_close(filter.covariance().as_slice(), dual.p.as_slice(), 1e-9);
}

#[test]
fn without_readings_an_update_changes_nothing() {
    let model = Arc::new(springs());
    let noise = ProcessNoise::new(&model).with_forces(&[1.0, 1.0]).unwrap();
    let measurement = sensors(&model, &[0.05, 0.1, 0.5]);
    let data = Data::new(&model).unwrap();
    let mut filter = ExtendedKalmanFilter::new(data, &Matrix::identity(4), noise, measurement).unwrap();
    filter.predict(&[1.0, 0.0]).unwrap();
    let (state, covariance) = (filter.data().physics_state(), filter.covariance().clone());
    let update = filter.update(&[1.0, 0.0], &[f64::NAN; 5]).unwrap();
    assert_eq!((update.status, update.used, update.nis), (UpdateStatus::NoReadings, 0, 0.0));
    assert_eq!((filter.data().physics_state(), filter.covariance()), (state, &covariance));
}
