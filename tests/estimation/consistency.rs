//! The errors on simulated data are as large as the covariance says: the sum of their normalised
//! squares over independent runs has the chi-square distribution.
//!
//! Each run draws its initial error and all noise from the distributions that the filter assumes. A
//! sum is outside of the bounds with a probability of 0.001 if the filter is consistent; the seeds
//! are fixed.

use std::sync::Arc;

use mujoco_safe::Data;
use mujoco_safe::control::residual::{JointPosition, Residual};
use mujoco_safe::estimation::{
    ExtendedKalmanFilter, Measurement, ProcessNoise, ReadingOutcome, UpdateStatus, chi_square_quantile,
};

use crate::{Random, diagonal, pendulum, tumbler};

/// Sums of normalised squares over runs.
#[derive(Default)]
pub(crate) struct Squares {
    sum: f64,
    degrees: usize,
}

impl Squares {
    pub(crate) fn add(&mut self, filter: &ExtendedKalmanFilter, truth: &Data, components: std::ops::Range<usize>) {
        self.degrees += components.len();
        self.sum += filter.nees(truth, components).unwrap().expect("the covariance is not singular");
    }

    #[track_caller]
    pub(crate) fn check(&self, what: &str) {
        let [low, high] = [0.0005, 0.9995].map(|p| chi_square_quantile(p, self.degrees).unwrap());
        let &Self { sum, degrees } = self;
        assert!(
            (low..high).contains(&sum),
            "{what}: {sum:.1} for {degrees} degrees of freedom, in {low:.1} to {high:.1}"
        );
    }
}

#[test]
fn a_pendulum_with_an_encoder_and_a_noisy_motor() {
    let model = Arc::new(pendulum());
    let (start, force, motor) = ([0.2, 0.5], 0.3, 0.2);
    let mut squares: [Squares; 3] = Default::default();
    let mut innovations = Squares::default();
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let noise = ProcessNoise::new(&model).with_forces(&[force]).unwrap().with_controls(&[motor]).unwrap();
        let encoder = Measurement::new(&model).with_noisy_sensors().unwrap();
        let mut truth = Data::new(&model).unwrap();
        truth.qpos_mut()[0] = 1.5;
        let mut filter = ExtendedKalmanFilter::new(truth.clone(), &diagonal(&start), noise, encoder).unwrap();
        random.disturb(&mut truth, &start);
        for step in 0..=100_usize {
            let control = (0.1 * step as f64).sin();
            truth.ctrl_mut()[0] = control + motor * random.number();
            truth.qfrc_applied_mut()[0] = force * random.number();
            truth.forward().unwrap();
            let update = filter.update(&[control], &[truth.sensordata()[0] + 0.03 * random.number()]).unwrap();
            (innovations.sum, innovations.degrees) = (innovations.sum + update.nis, innovations.degrees + update.used);
            if step % 50 == 0 {
                squares[step / 50].add(&filter, &truth, 0..2);
            }
            truth.step().unwrap();
            filter.predict(&[control]).unwrap();
        }
    }
    squares.iter().enumerate().for_each(|(index, squares)| squares.check(&format!("step {}", 50 * index)));
    innovations.check("innovations");
}

#[test]
fn a_tumbling_body_with_an_inertial_measurement_unit() {
    let model = Arc::new(tumbler());
    let start = [0.05, 0.05, 0.05, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0.2];
    let (forces, sensors) = ([1.0, 1.0, 1.0, 0.1, 0.1, 0.1], [0.02, 0.05, 0.1]);
    let mut squares: [Squares; 3] = Default::default();
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let noise = ProcessNoise::new(&model).with_forces(&forces).unwrap();
        let measurement = Measurement::new(&model).with_sensor("place", sensors[0]).unwrap();
        let measurement = measurement.with_sensor("gyro", sensors[1]).unwrap();
        let measurement = measurement.with_sensor("accelerometer", sensors[2]).unwrap();
        let mut truth = Data::new(&model).unwrap();
        truth.qvel_mut().copy_from_slice(&[0.1, -0.2, 1.0, 2.0, 0.5, -1.0]);
        let mut filter = ExtendedKalmanFilter::new(truth.clone(), &diagonal(&start), noise, measurement).unwrap();
        random.disturb(&mut truth, &start);
        for step in 0..=80_usize {
            truth.qfrc_applied_mut().copy_from_slice(&random.numbers(forces));
            truth.forward().unwrap();
            let mut readings = vec![0.0; 9];
            filter.measurement().select_into(truth.sensordata(), &mut readings).unwrap();
            let noise = random.numbers(filter.measurement().deviations());
            readings.iter_mut().zip(noise).for_each(|(reading, noise)| *reading += noise);
            filter.update(&[], &readings).unwrap();
            if step % 40 == 0 {
                squares[step / 40].add(&filter, &truth, 0..12);
            }
            truth.step().unwrap();
            filter.predict(&[]).unwrap();
        }
    }
    squares.iter().enumerate().for_each(|(index, squares)| squares.check(&format!("step {}", 40 * index)));
}

/// Both quaternions of an orientation are the same reading.
#[test]
fn the_sign_of_a_quaternion_has_no_effect() {
    let model = Arc::new(tumbler());
    let filter = || {
        let noise = ProcessNoise::new(&model).with_forces(&[0.1; 6]).unwrap();
        let orientation = Measurement::new(&model).with_sensor("orientation", 0.02).unwrap();
        ExtendedKalmanFilter::new(Data::new(&model).unwrap(), &diagonal(&[0.3; 12]), noise, orientation).unwrap()
    };
    let (mut one, mut other) = (filter(), filter());
    one.update(&[], &[0.98, 0.1, -0.1, 0.139]).unwrap();
    other.update(&[], &[-0.98, -0.1, 0.1, -0.139]).unwrap();
    assert_eq!(one.data().qpos(), other.data().qpos());
    // The reading of small variance turns the body there, with that deviation about each axis.
    assert!((one.data().qpos()[3] - 0.98).abs() < 1e-3);
    let variance = one.covariance()[(4, 4)];
    assert!((variance.sqrt() / 0.02 - 1.0).abs() < 0.05, "{variance}");
}

/// A correction by the rotation vector δ transports the covariance by the right Jacobian of δ. For
/// a turn by the angle a, the variances across the axis change by `2 (1 − cos a) / a²`.
#[test]
fn a_correction_transports_the_covariance() {
    let model = mujoco_safe::Model::from_xml_str(
        r#"<mujoco><worldbody><body><joint name="ball" type="ball"/><geom size=".1"/></body></worldbody></mujoco>"#,
    );
    let model = Arc::new(model.unwrap());
    let noise = ProcessNoise::new(&model);
    let position = JointPosition::new(&model, "ball").unwrap();
    assert_eq!(position.size(), 3);
    let measurement = Measurement::new(&model).with_residual(position, 0.5).unwrap();
    let data = Data::new(&model).unwrap();
    let mut filter = ExtendedKalmanFilter::new(data, &diagonal(&[0.5; 6]), noise, measurement).unwrap();
    let update = filter.update(&[], &[2.4, 0.0, 0.0]).unwrap();
    assert_eq!(update.status, UpdateStatus::Corrected);
    // The gain is one half.
    let angle: f64 = 1.2;
    assert!((filter.data().qpos()[1] - (angle / 2.0).sin()).abs() < 1e-12);
    let covariance = filter.covariance();
    assert!((covariance[(0, 0)] - 0.125).abs() < 1e-12);
    let across = 0.125 * 2.0 * (1.0 - angle.cos()) / (angle * angle);
    for axis in [1, 2] {
        assert!((covariance[(axis, axis)] - across).abs() < 1e-12, "{}", covariance[(axis, axis)]);
    }
    assert!(covariance[(1, 2)].abs() < 1e-12);
}

#[test]
fn the_gate_rejects_outliers() {
    use ReadingOutcome::{Missing, Rejected, Used};
    let model = Arc::new(tumbler());
    let noise = ProcessNoise::new(&model).with_forces(&[0.1; 6]).unwrap();
    let measurement = Measurement::new(&model).with_sensor("place", 0.01).unwrap();
    let measurement = measurement.with_sensor("gyro", 0.01).unwrap();
    let data = Data::new(&model).unwrap();
    let filter = ExtendedKalmanFilter::new(data, &diagonal(&[0.1; 12]), noise, measurement).unwrap();
    let mut filter = filter.with_gate(0.999).unwrap();
    // The variance at the place is about 0.01, and the bound for 3 components is 16.3.
    let place = [0.2, 0.1, 0.05];
    let update = filter.update(&[], &[place[0] + 0.9, place[1], place[2], 0.1, f64::NAN, 0.05]).unwrap();
    assert_eq!((update.status, update.used, update.rejected), (UpdateStatus::Corrected, 2, 3));
    assert_eq!(filter.outcomes(), [Rejected, Rejected, Rejected, Used, Missing, Used]);
    assert!((filter.innovations()[0] - 0.9).abs() < 1e-12 && filter.innovations()[4].is_nan());
    let update = filter.update(&[], &[place[0] + 0.1, place[1], place[2], f64::NAN, f64::NAN, f64::NAN]).unwrap();
    assert_eq!((update.used, update.rejected), (3, 0));
    let update = filter.update(&[], &[1e9; 6]).unwrap();
    assert_eq!((update.status, update.used, update.rejected), (UpdateStatus::NoReadings, 0, 6));
}
