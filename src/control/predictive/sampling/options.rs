//! Options of the planner by sampling.

use super::Interpolation;
use crate::error::{Error, Result};
use crate::macros::with_methods;

/// Options of a [`SamplingPlanner`](super::SamplingPlanner).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SamplingOptions {
    /// Number of candidates of an iteration, at least 1; 32 by default. The first one is the
    /// previous plan.
    pub samples: usize,
    /// Number of iterations of a plan, at least 1; 1 by default.
    pub iterations: usize,
    /// Number of knots of the controls over the horizon, at least 1; 5 by default.
    pub knots: usize,
    /// Interpolation between the knots; linear by default.
    pub interpolation: Interpolation,
    /// Standard deviations of the noise on a knot, relative to half the range of the control, or in
    /// the unit of a control without a range. The candidates use them in turn. By default 0.3, 0.1
    /// and 0.03: the large ones explore, and the small ones refine the plan.
    pub deviations: Vec<f64>,
    /// Temperature λ of the weights of the candidates, in the unit of the cost; 0 by default, which
    /// selects the candidate of minimal cost.
    pub temperature: f64,
    /// Seed of the noise; 0 by default.
    pub seed: u64,
    /// Maximum number of candidates that are simulated at the same time; 1 by default. The plan
    /// does not depend on it.
    pub threads: usize,
}

impl Default for SamplingOptions {
    fn default() -> Self {
        Self {
            samples: 32,
            iterations: 1,
            knots: 5,
            interpolation: Interpolation::default(),
            deviations: vec![0.3, 0.1, 0.03],
            temperature: 0.0,
            seed: 0,
            threads: 1,
        }
    }
}

impl SamplingOptions {
    /// Checks all numbers.
    pub(super) fn check(&self) -> Result<()> {
        for (name, number) in [
            ("samples", self.samples),
            ("iterations", self.iterations),
            ("knots", self.knots),
            ("threads", self.threads),
            ("the number of deviations", self.deviations.len()),
        ] {
            if number == 0 {
                return Err(Error::out_of_range(format!("{name} of SamplingOptions"), number, "at least 1"));
            }
        }
        let is_valid = |number: f64| number.is_finite() && number >= 0.0;
        if let Some(deviation) = self.deviations.iter().find(|&&deviation| !is_valid(deviation)) {
            return Err(Error::out_of_range("a deviation of SamplingOptions", deviation, "finite and not negative"));
        }
        if !is_valid(self.temperature) {
            let found = self.temperature;
            return Err(Error::out_of_range("temperature of SamplingOptions", found, "finite and not negative"));
        }
        Ok(())
    }
}

with_methods!(SamplingOptions {
    with_samples(samples: usize),
    with_iterations(iterations: usize),
    with_knots(knots: usize),
    with_interpolation(interpolation: Interpolation),
    with_deviations(deviations: impl Into<Vec<f64>>) = deviations.into(),
    with_temperature(temperature: f64),
    with_seed(seed: u64),
    with_threads(threads: usize),
});
