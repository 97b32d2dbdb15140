//! Moments of the actuators as a full matrix.

use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::matrix::Matrix;

/// # Actuator moments
impl Data {
    /// Returns the moments of all actuators as a full matrix with a row per force of the actuators,
    /// `(nu, nv)` unless an actuator has several controls or forces. Row `i` is the derivative of
    /// `actuator_length[i]` with respect to each degree of freedom, including the gear:
    /// `momentᵀ · force` is [`qfrc_actuator`](Self::qfrc_actuator).
    ///
    /// The engine's array `actuator_moment` is this matrix in engines before 3.2.5. Newer engines
    /// store sparse rows, which `moment_rownnz`, `moment_rowadr` and `moment_colind` describe.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.ctrl_mut().fill(0.1);
    /// data.forward()?;
    /// let moment = data.full_moment()?;
    /// for dof in 0..data.model().nv() {
    ///     let actuators = 0..data.model().nu();
    ///     let force: f64 = actuators.map(|actuator| moment[(actuator, dof)] * data.actuator_force()[actuator]).sum();
    ///     assert!((force - data.qfrc_actuator()[dof]).abs() < 1e-12);
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "actuator_moment")]
    #[doc(alias = "moment_rownnz")]
    pub fn full_moment(&self) -> Result<Matrix> {
        let mut full = Matrix::zeros(self.model().actuator_length0().len(), self.model().nv());
        self.full_moment_into(&mut full)?;
        Ok(full)
    }

    /// Writes the moments of all actuators to a full matrix, without an allocation. See
    /// [`full_moment`](Self::full_moment).
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
    #[doc(alias = "actuator_moment")]
    pub fn full_moment_into(&self, full: &mut Matrix) -> Result<()> {
        self.check_computed("full_moment", Stage::Position)?;
        let shape = (self.model().actuator_length0().len(), self.model().nv());
        Error::check_shape("the output of full_moment", full.shape(), shape)?;
        for output in 0..shape.0 {
            self.moment_row(output).write_into(full.row_mut(output));
        }
        Ok(())
    }
}
