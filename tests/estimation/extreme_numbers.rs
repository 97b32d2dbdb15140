//! Random extreme covariances, deviations, states, controls and readings: each call returns, and
//! the estimates stay finite.

use std::sync::Arc;

use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise};
use mujoco_safe::{Data, Matrix, Model, Result};
use rand::RngExt;

use crate::{Random, quadruped, springs, tumbler};

const NUMBERS: [f64; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.3,
    1e-3,
    1e-9,
    -1e4,
    1e10,
    1e30,
    1e-154,
    1e150,
    1e154,
    -1e300,
    f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

impl Random {
    /// Returns an extreme number in one of `rarity` cases, else a normal one.
    fn extreme(&mut self, rarity: usize) -> f64 {
        let choice = self.0.random_range(0..rarity * NUMBERS.len());
        NUMBERS.get(choice).copied().unwrap_or_else(|| self.number())
    }

    fn extremes(&mut self, count: usize, rarity: usize) -> Vec<f64> {
        (0..count).map(|_| self.extreme(rarity)).collect()
    }
}

/// Returns a random covariance: often a valid one with variances over all magnitudes.
fn covariance(random: &mut Random, n: usize) -> Matrix {
    let deviations: Vec<f64> = (0..n).map(|_| 10_f64.powf(40.0 * random.number())).collect();
    let mut matrix = match random.0.random_range(0..4) {
        0 => Matrix::from_row_major(n, n, random.extremes(n * n, 3)),
        1 => {
            let root = random.extremes(n, 50);
            let entry = |index: usize| root[index / n] * root[index % n];
            Matrix::from_row_major(n, n, (0..n * n).map(entry).collect())
        }
        2 => crate::diagonal(&deviations),
        _ => crate::diagonal(&vec![random.extreme(2); n]),
    };
    if n > 0 && random.0.random_bool(0.1) {
        let (row, column) = (random.0.random_range(0..n), random.0.random_range(0..n));
        matrix[(row, column)] = random.extreme(1);
    }
    matrix
}

fn build(model: &Arc<Model>, random: &mut Random, is_extreme: bool) -> Result<ExtendedKalmanFilter> {
    let nx = 2 * model.nv() + model.na();
    let rarity = if is_extreme { 3 } else { 1000 };
    let mut noise = ProcessNoise::new(model);
    if random.0.random_bool(0.5) {
        noise = noise.with_covariance(&covariance(random, nx))?;
    }
    let deviations =
        |random: &mut Random, count| -> Vec<f64> { random.extremes(count, rarity).into_iter().map(f64::abs).collect() };
    noise = noise.with_forces(&deviations(random, model.nv()))?;
    if random.0.random_bool(0.5) {
        noise = noise.with_controls(&deviations(random, model.nu()))?;
    }
    noise = noise.with_contact_forces(random.extreme(rarity).abs(), random.extreme(rarity).abs())?;
    noise = noise.with_body_forces(1, random.extreme(rarity).abs(), random.extreme(rarity).abs())?;
    let mut measurement = Measurement::new(model);
    for sensor in 0..model.nsensor() {
        let deviation = random.extreme(2 * rarity).abs();
        measurement = measurement.with_sensor(sensor, deviation)?;
    }
    let mut data = Data::new(model)?;
    if is_extreme {
        let state = random.extremes(model.nq() + model.nv() + model.na(), 40);
        data.set_physics_state(&state)?;
    }
    let filter = ExtendedKalmanFilter::new(data, &covariance(random, nx), noise, measurement)?;
    if random.0.random_bool(0.3) { filter.with_gate(random.0.random_range(0.01..0.999)) } else { Ok(filter) }
}

fn run(model: &Arc<Model>, seed: u64, valid: &mut usize) {
    let mut random = Random::new(seed);
    let is_extreme = seed.is_multiple_of(2);
    let Ok(filter) = build(model, &mut random, is_extreme) else { return };
    *valid += 1;
    let Ok(mut smoother) = FixedLagSmoother::new(filter, 4) else { return };
    let fresh = Data::new(model).unwrap();
    for _ in 0..8 {
        let controls = random.extremes(model.nu(), 40);
        let readings = random.extremes(smoother.filter().measurement().len(), 20);
        let _ = smoother.update(&controls, &readings);
        let _ = smoother.filter().nees(&fresh, 0..model.nv());
        let _ = smoother.predict(&controls);
        let _ = smoother.smooth();
        assert!(smoother.filter().covariance().as_slice().iter().all(|value| value.is_finite()), "seed {seed}");
        if random.0.random_bool(0.1) {
            let nx = 2 * model.nv() + model.na();
            let _ = smoother.reset(&fresh, &covariance(&mut random, nx));
        }
    }
}

#[test]
fn extreme_numbers_are_errors_or_statuses() {
    let models = [springs(), tumbler(), quadruped::model(1.0).unwrap()].map(Arc::new);
    let counts = [200, 200, 20];
    let mut valid = [0; 3];
    for ((model, count), valid) in models.iter().zip(counts).zip(&mut valid) {
        (0..count).for_each(|seed| run(model, seed, valid));
    }
    assert!(valid[0] > 20 && valid[1] > 10, "{valid:?}");
}
