//! The iterations of the dual method.

use super::{Constraint, Qp, QpProblem, QpStatus, Side};

/// Violation of a constraint that counts as zero, relative to `1 + |x|`.
const TOLERANCE: f64 = 1e-12;
/// The same for a constraint whose normal depends on the working set, so that rounding errors do
/// not contradict it.
const LOOSE_TOLERANCE: f64 = 1e-9;

impl Qp {
    /// Finds the minimum. Returns the status, the number of iterations, and a constraint that
    /// contradicts others.
    pub(super) fn iterate(&mut self, x: &mut [f64], problem: &QpProblem<'_>) -> (QpStatus, u32, Option<usize>) {
        if let Some((c, _)) = problem.constraints {
            for (norm, row) in self.norms.iter_mut().zip(c.rows()) {
                *norm = row.iter().map(|value| value * value).sum::<f64>().sqrt();
            }
        }
        self.ignored.fill(false);
        if !self.working.start(problem.h) {
            return (QpStatus::NotPositiveDefinite, 0, None);
        }
        self.start_from_last(x, problem);
        let limit = 100 + 4 * (self.n + problem.rows()) as u32;
        let mut iterations = 0;
        while let Some((constraint, violation)) = self.most_violated(x, problem) {
            let mut violation = violation;
            let mut multiplier = 0.0;
            loop {
                if iterations == limit {
                    return (QpStatus::IterationLimit, iterations, None);
                }
                iterations += 1;
                let slope = self.working.prepare(constraint, problem);
                let (longest, blocking) = self.working.longest_step();
                // The step after which the constraint holds.
                let complete = slope.map(|slope| violation / slope);
                if slope.is_none() && violation <= LOOSE_TOLERANCE * scale(x) * self.norm(constraint) {
                    self.ignored[constraint.index] = true;
                    break;
                }
                if complete.is_none() && blocking.is_none() {
                    return (QpStatus::Infeasible, iterations, Some(constraint.index));
                }
                let length = complete.map_or(longest, |complete| complete.min(longest));
                self.working.advance(length);
                multiplier += length;
                if let Some(slope) = slope {
                    x.iter_mut().zip(&self.working.step).for_each(|(x, step)| *x += length * step);
                    violation -= length * slope;
                }
                match blocking {
                    Some(place) if complete.is_none_or(|complete| longest < complete) => self.working.remove(place),
                    _ => {
                        self.working.push(constraint, problem, multiplier);
                        break;
                    }
                }
            }
        }
        (QpStatus::Solved, iterations, None)
    }

    /// Sets `x` to the minimum on those constraints of the last solution whose multipliers have the
    /// right signs.
    fn start_from_last(&mut self, x: &mut [f64], problem: &QpProblem<'_>) {
        for place in 0..self.last.len() {
            let constraint = self.last[place];
            let exists = constraint.index < self.n + problem.rows() && constraint.limit(problem).is_finite();
            if exists && self.working.prepare(constraint, problem).is_some() {
                self.working.push(constraint, problem, 0.0);
            }
        }
        while let Some(place) = self.working.minimise(x, problem) {
            self.working.remove(place);
        }
    }

    fn norm(&self, constraint: Constraint) -> f64 {
        if constraint.index < self.n { 1.0 } else { self.norms[constraint.index - self.n] }
    }

    /// Returns the constraint with the largest violation relative to the length of its normal, and
    /// the violation. Equations are first.
    fn most_violated(&self, x: &[f64], problem: &QpProblem<'_>) -> Option<(Constraint, f64)> {
        let tolerance = TOLERANCE * scale(x);
        let mut most: Option<(Constraint, f64)> = None;
        let mut largest = 0.0;
        for index in 0..self.n + problem.rows() {
            let [lower, upper] = problem.limits(index);
            if lower == f64::NEG_INFINITY && upper == f64::INFINITY {
                continue;
            }
            let (value, norm) = match index.checked_sub(self.n) {
                None => (x[index], 1.0),
                Some(row) => {
                    let value = problem.row(index).iter().zip(x).map(|(c, x)| c * x).sum();
                    (value, self.norms[row])
                }
            };
            let (side, violation) =
                if lower - value > value - upper { (Side::Lower, lower - value) } else { (Side::Upper, value - upper) };
            if violation <= tolerance * norm || self.ignored[index] || self.working.contains(index) {
                continue;
            }
            let relative = if lower == upper { f64::INFINITY } else { violation / norm };
            if most.is_none() || relative > largest {
                largest = relative;
                most = Some((Constraint { index, side }, violation));
            }
        }
        most
    }
}

/// Returns the size with which violations are compared.
fn scale(x: &[f64]) -> f64 {
    1.0 + x.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}
