//! The smoother on motions that are not linear.

use std::sync::Arc;

use mujoco_safe::Data;
use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise};

use crate::{Random, diagonal, pendulum, tumbler};

/// Returns the sums of the squared errors of a swinging pendulum, by the filter and by the smoother
/// 30 steps later, and the sum of the normalised squares of the latter.
fn swing(seed: u64) -> [f64; 3] {
    const LAG: usize = 30;
    let (start, force) = ([0.3, 1.0], 0.8);
    let mut random = Random::new(seed);
    let model = Arc::new(pendulum());
    let noise = ProcessNoise::new(&model).with_forces(&[force]).unwrap();
    let encoder = Measurement::new(&model).with_noisy_sensors().unwrap();
    let mut truth = Data::new(&model).unwrap();
    truth.qpos_mut()[0] = 2.0;
    let filter = ExtendedKalmanFilter::new(truth.clone(), &diagonal(&start), noise, encoder).unwrap();
    let mut smoother = FixedLagSmoother::new(filter, LAG + 1).unwrap();
    random.disturb(&mut truth, &start);
    let (mut states, mut filtered) = (Vec::new(), Vec::new());
    let mut sums = [0.0; 3];
    for step in 0..150 {
        truth.forward().unwrap();
        let reading = truth.sensordata()[0] + 0.03 * random.number();
        smoother.update(&[0.0], &[reading]).unwrap();
        states.push(truth.physics_state());
        filtered.push(smoother.filter().data().physics_state());
        if step >= LAG && step % 10 == 0 {
            let report = smoother.smooth().unwrap();
            assert!(report.converged, "seed {seed}, step {step}: {report:?}");
            let (state, truth, earlier) = (smoother.state(0), &states[step - LAG], &filtered[step - LAG]);
            let covariance = smoother.covariance(0);
            let [angle, rate] = [0, 1].map(|index| truth[index] - state[index]);
            sums[0] += (truth[0] - earlier[0]).powi(2) + 0.01 * (truth[1] - earlier[1]).powi(2);
            sums[1] += angle * angle + 0.01 * rate * rate;
            // The readings of 30 steps determine the state of the first one almost independently.
            if step % LAG == 0 {
                let (a, b, c) = (covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]);
                sums[2] += (c * angle * angle - 2.0 * b * angle * rate + a * rate * rate) / (a * c - b * b);
            }
        }
        truth.qfrc_applied_mut()[0] = force * random.number();
        truth.step().unwrap();
        smoother.predict(&[0.0]).unwrap();
    }
    sums
}

#[test]
fn smoothed_states_are_nearer_to_the_truth() {
    const RUNS: u64 = 12;
    let mut sums = [0.0; 3];
    for seed in 0..RUNS {
        sums.iter_mut().zip(swing(seed)).for_each(|(sum, value)| *sum += value);
    }
    let [filtered, smoothed, normalised] = sums;
    assert!(smoothed < 0.5 * filtered, "{smoothed} against {filtered}");
    // Four states of two components in each run.
    let degrees = 8 * RUNS as usize;
    let bounds = [0.0005, 0.9995].map(|p| mujoco_safe::estimation::chi_square_quantile(p, degrees).unwrap());
    assert!((bounds[0]..bounds[1]).contains(&normalised), "{normalised} for {degrees} degrees of freedom");
}

/// A wrong orientation of one radian: the filter linearises far from the truth, the smoother about
/// the trajectory that it finds.
#[test]
fn iterations_find_the_trajectory_from_a_wrong_start() {
    let model = Arc::new(tumbler());
    let mut truth = Data::new(&model).unwrap();
    truth.qvel_mut().copy_from_slice(&[0.1, 0.2, 0.8, 2.0, -1.0, 0.5]);
    let mut wrong = truth.clone();
    wrong.integrate_pos(&[0.0, 0.0, 0.0, 0.6, -0.6, 0.5], 1.0).unwrap();
    let deviations = [0.1, 0.1, 0.1, 1.0, 1.0, 1.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1];
    let noise = ProcessNoise::new(&model).with_forces(&[1e-3; 6]).unwrap();
    let place = Measurement::new(&model).with_sensor("place", 1e-3).unwrap();
    let filter = ExtendedKalmanFilter::new(wrong, &diagonal(&deviations), noise, place).unwrap();
    let mut smoother = FixedLagSmoother::new(filter, 60).unwrap().with_iterations(50, 1e-6).unwrap();
    let start = truth.qpos().to_vec();
    for _ in 0..60 {
        truth.forward().unwrap();
        let readings = truth.sensordata()[..3].to_vec();
        smoother.update(&[], &readings).unwrap();
        if smoother.len() < 60 {
            smoother.predict(&[]).unwrap();
        }
        truth.step().unwrap();
    }
    let report = smoother.smooth().unwrap();
    assert!(report.converged, "{report:?}");
    let mut error = [0.0; 6];
    model.differentiate_pos_into(1.0, &start, &smoother.state(0)[..7], &mut error).unwrap();
    let angle = error[3..].iter().map(|value| value * value).sum::<f64>().sqrt();
    assert!(angle < 0.02, "the first orientation is wrong by {angle} rad");
    // At the optimum, another run moves nothing.
    let before = smoother.state(0).to_vec();
    assert!(smoother.smooth().unwrap().converged);
    let change = before.iter().zip(smoother.state(0)).map(|(before, after)| (before - after).abs()).fold(0.0, f64::max);
    assert!(change < 1e-8, "{change}");
}
