//! Residual of the controls.

use super::{Needs, Residual, ResidualJacobian, check_model, subtract};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::id::Lineage;
use crate::model::Model;

/// Difference of all controls from a target, with `nu` components.
///
/// At the end of a trajectory the controls count as zero, so a target adds a constant to the
/// terminal cost.
#[derive(Clone, Debug)]
pub struct Controls {
    target: Vec<f64>,
    lineage: Lineage,
}

impl Controls {
    /// Creates the residual. The target is zero.
    pub fn new(model: &Model) -> Self {
        Self { target: vec![0.0; model.nu()], lineage: model.lineage() }
    }

    /// Sets the target, as in `ctrl`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_target(mut self, target: &[f64]) -> Result<Self> {
        Error::check_length("the target of Controls", target.len(), self.target.len())?;
        self.target.copy_from_slice(target);
        Ok(self)
    }
}

impl Residual for Controls {
    fn size(&self) -> usize {
        self.target.len()
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        check_model(data, self.lineage)?;
        subtract(data.ctrl(), &self.target, residual);
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        check_model(data, self.lineage)?;
        for control in 0..self.target.len() {
            jacobian.by_controls_mut(control)[control] = 1.0;
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
