//! Filters and smoothers do not allocate after they are created.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use mujoco_safe::Matrix;
use mujoco_safe::control::residual::JointPosition;
use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise};

use crate::allocations::{allocates_nothing, squatting};
use crate::lock_process;

/// Returns a filter of a squatting humanoid with all kinds of noise and readings.
fn filter() -> ExtendedKalmanFilter {
    let data = squatting();
    let model = data.model();
    let noise = ProcessNoise::new(model).with_forces(&vec![0.1; model.nv()]).unwrap();
    let noise = noise.with_body_forces("torso", 1.0, 0.1).unwrap().with_contact_forces(1.0, 1.0).unwrap();
    let noise = noise.with_controls(&vec![0.01; model.nu()]).unwrap();
    let measurement = Measurement::new(model).with_sensor("torso_gyro", 0.01).unwrap();
    let measurement = measurement.with_sensor("torso_accelerometer", 0.1).unwrap();
    let measurement = measurement.with_residual(JointPosition::all(model), 0.01).unwrap();
    let covariance = Matrix::from_diagonal(&vec![1e-4; 2 * model.nv()]);
    ExtendedKalmanFilter::new(data.clone(), &covariance, noise, measurement).unwrap().with_gate(0.999).unwrap()
}

#[test]
fn filters_do_not_allocate() {
    let _lock = lock_process();
    let mut filter = filter();
    let controls = filter.data().ctrl().to_vec();
    // The readings of the joints are missing in the first call, which must not size a buffer.
    let mut readings = vec![f64::NAN; filter.measurement().len()];
    readings[..6].fill(0.1);
    allocates_nothing("update", || {
        filter.update(&controls, &readings).unwrap();
        readings.fill(0.1);
    });
    allocates_nothing("predict", || _ = filter.predict(&controls).unwrap());
}

#[test]
fn smoothers_do_not_allocate() {
    let _lock = lock_process();
    let mut smoother = FixedLagSmoother::new(filter(), 3).unwrap();
    let controls = smoother.filter().data().ctrl().to_vec();
    let readings = vec![0.0; smoother.filter().measurement().len()];
    allocates_nothing("a tick of a smoother", || {
        smoother.update(&controls, &readings).unwrap();
        smoother.smooth().unwrap();
        smoother.predict(&controls).unwrap();
    });
}
