//! Convergence of the constraint solver in steps that are differenced.
//!
//! The derivatives of the forces can be wrong while the forces are right, and the reverse: from a
//! warm start at rest, the forces are right at once, and after a cold start, their errors are the
//! same on both sides of a difference. So a difference is compared with the same difference after
//! twice as many iterations.

use super::kinks::Scale;
use super::perturbation::PerturbedData;
use crate::data::Data;
use crate::error::Result;

/// Number of islands whose iterations the engine records.
const ISLANDS: usize = 20;

/// Number of iterations that every engine records for an island.
const RECORDED: usize = 200;

/// Returns `true` if the solver stopped at the limit of its iterations in the last step. PGS almost
/// always does, because steps for differences have no tolerance.
pub(super) fn is_solver_at_limit(data: &Data) -> bool {
    let limit = usize::try_from(data.model().raw().opt.iterations).unwrap_or(0);
    data.nefc() > 0 && (0..ISLANDS).any(|island| data.solver_statistics(island).len() >= limit.min(RECORDED))
}

/// Buffers of the check of a solver, of the length nv.
#[derive(Debug)]
pub(super) struct SolverCheck {
    present: Vec<f64>,
    with_more: Vec<f64>,
}

impl SolverCheck {
    pub(super) fn new(nv: usize) -> Self {
        Self { present: vec![0.0; nv], with_more: vec![0.0; nv] }
    }

    /// Returns `true` if a difference by the positions and velocities changes with the number of
    /// iterations. The simulation is at the base point before and after the call.
    pub(super) fn depends_on_iterations(&mut self, point: &mut PerturbedData, eps: f64) -> Result<bool> {
        let limit = point.data.model().raw().opt.iterations;
        let more = limit.saturating_mul(2).saturating_add(1);
        for (difference, iterations) in [(&mut self.present, limit), (&mut self.with_more, more)] {
            difference.fill(0.0);
            for sign in [1.0, -1.0] {
                point.perturb_motion(sign * eps)?;
                point.data.step_for_differences_with(iterations)?;
                let weight = sign / (2.0 * eps);
                difference.iter_mut().zip(point.data.qvel()).for_each(|(sum, value)| *sum += weight * value);
                point.restore()?;
            }
        }
        let scale = Scale::of(self.with_more.iter().copied());
        let mut pairs = self.present.iter().zip(&self.with_more);
        Ok(pairs.any(|(present, with_more)| scale.disagreement(present - with_more, *with_more) > 1.0))
    }
}
