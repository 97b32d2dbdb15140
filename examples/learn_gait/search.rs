//! Augmented random search, version V2-t (Mania, Guy, Recht: *Simple random search of static linear
//! policies is competitive for reinforcement learning*, 2018).
//!
//! An iteration adds random directions to the weights of the policy and subtracts them, runs an
//! episode with each of these policies, and moves the weights along the directions of the best
//! episodes, in proportion to the differences of their returns. All episodes of an iteration run at
//! the same time, in a vector environment.

use std::sync::Arc;

use mujoco_safe::environment::{HalfCheetah, Task, VectorEnvironment};
use mujoco_safe::{Matrix, MatrixView, Model, Result};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::policy::Policy;

/// Number of directions per iteration.
const DIRECTIONS: usize = 8;
/// Number of directions along which the weights move.
const BEST: usize = 4;
/// Step size.
const STEP_SIZE: f64 = 0.02;
/// Standard deviation of the changes of a weight.
const DEVIATION: f64 = 0.03;
/// Number of episodes per iteration that measure the policy without changes.
const MEASURED: usize = 2;
/// Number of episodes per iteration.
pub const EPISODES: usize = 2 * DIRECTIONS + MEASURED;

/// Mean and variance of each observation so far, by Welford's method (1962).
struct Statistics {
    count: f64,
    mean: Vec<f64>,
    /// Sums of the squares of the deviations from the mean.
    squares: Vec<f64>,
}

impl Statistics {
    fn add(&mut self, observation: &[f64]) {
        self.count += 1.0;
        for ((mean, squares), value) in self.mean.iter_mut().zip(&mut self.squares).zip(observation) {
            let difference = value - *mean;
            *mean += difference / self.count;
            *squares += difference * (value - *mean);
        }
    }
}

/// Search for a policy.
pub struct Search {
    environment: VectorEnvironment<HalfCheetah>,
    policy: Policy,
    statistics: Statistics,
    random: Xoshiro256PlusPlus,
}

impl Search {
    /// Starts a search at weights of zero.
    pub fn new(model: &Arc<Model>, seed: u64) -> Result<Self> {
        let nobs = HalfCheetah.observation_size(model);
        Ok(Self {
            environment: VectorEnvironment::new(model, HalfCheetah, EPISODES, seed)?,
            policy: Policy::zero(model.nu(), nobs),
            statistics: Statistics { count: 0.0, mean: vec![0.0; nobs], squares: vec![0.0; nobs] },
            random: Xoshiro256PlusPlus::seed_from_u64(seed),
        })
    }

    /// Returns the policy.
    pub fn policy(&self) -> &Policy {
        &self.policy
    }

    /// Improves the policy by one iteration. Returns the mean return of the policy before the
    /// iteration.
    pub fn iterate(&mut self) -> Result<f64> {
        let weights = &self.policy.weights;
        let mut directions = Matrix::zeros(DIRECTIONS, weights.as_slice().len());
        for value in directions.as_mut_slice() {
            *value = StandardNormal.sample(&mut self.random);
        }
        // Row 2 k has the weights plus direction k, row 2 k + 1 the weights minus this direction.
        let mut tried = Matrix::zeros(EPISODES, weights.as_slice().len());
        for row in 0..EPISODES {
            tried.row_mut(row).copy_from_slice(weights.as_slice());
            if let Some(direction) = directions.rows().nth(row / 2) {
                let amount = if row % 2 == 0 { DEVIATION } else { -DEVIATION };
                add(tried.row_mut(row), amount, direction);
            }
        }
        let (policy, statistics) = (&self.policy, &mut self.statistics);
        let returns = returns(&mut self.environment, |observations, controls| {
            observations.rows().for_each(|observation| statistics.add(observation));
            policy.act_with(|row| tried.row(row), observations, controls);
        })?;

        let (pairs, measured) = (returns[..2 * DIRECTIONS].as_chunks::<2>().0, &returns[2 * DIRECTIONS..]);
        let mut order: Vec<usize> = (0..DIRECTIONS).collect();
        order.sort_by(|&a, &b| pairs[b][0].max(pairs[b][1]).total_cmp(&pairs[a][0].max(pairs[a][1])));
        order.truncate(BEST);
        let used: Vec<f64> = order.iter().flat_map(|&direction| pairs[direction]).collect();
        let scale = STEP_SIZE / (BEST as f64 * standard_deviation(&used).max(1e-6));
        for direction in order {
            let [plus, minus] = pairs[direction];
            add(self.policy.weights.as_mut_slice(), scale * (plus - minus), directions.row(direction));
        }
        self.policy.mean.copy_from_slice(&self.statistics.mean);
        for (deviation, squares) in self.policy.deviation.iter_mut().zip(&self.statistics.squares) {
            *deviation = (squares / self.statistics.count).sqrt().max(1e-6);
        }
        Ok(measured.iter().sum::<f64>() / measured.len() as f64)
    }
}

/// Runs an episode in each simulation, and returns the sums of the rewards.
pub fn returns(
    environment: &mut VectorEnvironment<HalfCheetah>,
    mut policy: impl FnMut(MatrixView<'_>, &mut [f64]),
) -> Result<Vec<f64>> {
    environment.reset()?;
    let mut actions = vec![0.0; environment.len() * environment.batch().model().nu()];
    let (mut returns, mut ended) = (vec![0.0; environment.len()], vec![false; environment.len()]);
    while ended.contains(&false) {
        policy(environment.observations(), &mut actions);
        environment.step(&actions)?;
        for (index, sum) in returns.iter_mut().enumerate().filter(|&(index, _)| !ended[index]) {
            *sum += environment.rewards()[index];
        }
        for (index, ended) in ended.iter_mut().enumerate() {
            *ended |= environment.terminated()[index] || environment.truncated()[index];
        }
    }
    Ok(returns)
}

/// Adds a multiple of a vector.
fn add(to: &mut [f64], factor: f64, vector: &[f64]) {
    to.iter_mut().zip(vector).for_each(|(to, value)| *to += factor * value);
}

fn standard_deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}
