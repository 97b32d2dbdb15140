//! Candidates: the previous plan, and random variations of it.

use super::SamplingOptions;
use super::spline::Grid;
use crate::control::feedback::control_range;
use crate::model::Model;
use crate::rollout::Random;

/// Knots of the plan and of the candidates.
#[derive(Debug)]
pub(super) struct Candidates {
    pub(super) grid: Grid,
    /// `(rows, nu)`: knots of the plan.
    pub(super) plan: Vec<f64>,
    /// `(samples, rows, nu)`
    knots: Vec<f64>,
    /// Knots of a plan that holds the initial controls.
    initial: Vec<f64>,
    /// Ranges of the knots, and the unit of the noise.
    ranges: Vec<([f64; 2], f64)>,
    /// Number of iterations since the last restart.
    iterations: u64,
}

impl Candidates {
    pub(super) fn new(horizon: usize, options: &SamplingOptions, nu: usize) -> Self {
        let grid = Grid::new(options.interpolation, horizon, options.knots);
        let length = grid.rows(horizon) * nu;
        Self {
            grid,
            plan: vec![0.0; length],
            knots: vec![0.0; options.samples * length],
            initial: vec![0.0; length],
            ranges: Vec::with_capacity(nu),
            iterations: 0,
        }
    }

    /// Takes the control ranges of a model. The knots of a spline that is added to a regulator are
    /// at most the width of the range.
    pub(super) fn adopt_ranges(&mut self, model: &Model, is_added: bool) {
        self.ranges.clear();
        self.ranges.extend((0..model.nu()).map(|index| match control_range(model, index) {
            [low, high] if low.is_finite() && high.is_finite() => {
                let width = high - low;
                (if is_added { [-width, width] } else { [low, high] }, 0.5 * width)
            }
            range => (if is_added { [f64::NEG_INFINITY, f64::INFINITY] } else { range }, 1.0),
        }));
    }

    /// Sets the initial controls `(nu)`.
    pub(super) fn set_initial(&mut self, ctrl: &[f64]) {
        self.initial.chunks_exact_mut(ctrl.len().max(1)).for_each(|knot| knot.copy_from_slice(ctrl));
    }

    /// Discards the plan and restarts the sequence of the noise.
    pub(super) fn restart(&mut self) {
        self.grid.restart();
        self.plan.copy_from_slice(&self.initial);
        self.iterations = 0;
    }

    /// Moves the start of the plan forward by some steps.
    pub(super) fn shift(&mut self, steps: usize) {
        self.grid.shift(steps, &mut self.plan, self.ranges.len());
    }

    /// Writes the candidates of an iteration: the plan, the regulator alone if there is one, and
    /// variations of the plan.
    pub(super) fn draw(&mut self, options: &SamplingOptions, has_regulator: bool) {
        let Self { plan, knots, ranges, iterations, .. } = self;
        let length = plan.len().max(1);
        for (index, candidate) in knots.chunks_exact_mut(length).enumerate() {
            candidate.copy_from_slice(plan);
            match index {
                0 => continue,
                1 if has_regulator => {
                    candidate.fill(0.0);
                    continue;
                }
                _ => {}
            }
            let deviation = options.deviations[index % options.deviations.len()];
            let mut random = Random::new(options.seed, index, *iterations);
            for (knot, &([low, high], unit)) in candidate.iter_mut().zip(ranges.iter().cycle()) {
                // Not `f64::clamp`, which panics if the ends of an edited range are in the wrong
                // order.
                *knot = (*knot + deviation * unit * random.normal()).max(low).min(high);
            }
        }
        *iterations += 1;
    }

    /// Returns the knots of a candidate.
    pub(super) fn knots(&self, index: usize) -> &[f64] {
        &self.knots[index * self.plan.len()..][..self.plan.len()]
    }

    /// Selects a candidate as the plan.
    pub(super) fn select(&mut self, index: usize) {
        let length = self.plan.len();
        self.plan.copy_from_slice(&self.knots[index * length..][..length]);
    }

    /// Sets the plan to the mean of the candidates with these weights, whose sum must be positive.
    pub(super) fn average(&mut self, weights: &[f64]) {
        let sum: f64 = weights.iter().sum();
        self.plan.fill(0.0);
        for (candidate, weight) in self.knots.chunks_exact(self.plan.len().max(1)).zip(weights) {
            for (knot, value) in self.plan.iter_mut().zip(candidate) {
                *knot += weight / sum * value;
            }
        }
    }
}
