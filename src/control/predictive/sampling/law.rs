//! Control law of a candidate.

use super::spline::Grid;
use crate::control::Lqr;
use crate::control::feedback::{Feedback, clamp};
use crate::control::ilqr::ControlLaw;
use crate::data::Data;
use crate::error::Result;

/// Spline, or regulator plus spline, within the ranges of the controls.
pub(super) struct Law<'p> {
    pub(super) grid: Grid,
    /// `(rows, nu)`
    pub(super) knots: &'p [f64],
    pub(super) regulator: Option<&'p Lqr>,
}

impl ControlLaw for Law<'_> {
    fn apply(&self, step: usize, data: &mut Data, feedback: &mut Feedback) -> Result<()> {
        match self.regulator {
            None => data.ctrl_mut().fill(0.0),
            Some(regulator) => {
                feedback.measure(data, regulator.qpos0(), None, regulator.act0())?;
                data.ctrl_mut().copy_from_slice(regulator.ctrl0());
                feedback.subtract(regulator.gain(), data.ctrl_mut());
                // The spline is added to the clamped controls, so it takes effect even if the
                // regulator demands more than the range.
                clamp(data);
            }
        }
        self.grid.add(step, self.knots, data.ctrl_mut());
        clamp(data);
        Ok(())
    }
}
