//! The inertia matrix: full, products, solutions.

use mujoco_sys::{self as sys, guard};

use super::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;
use crate::matrix::Matrix;

impl Data {
    /// The inertia matrix M `(nv, nv)` in full.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed.
    #[doc(alias = "mj_fullM")]
    pub fn full_m(&self) -> Result<Matrix> {
        let nv = self.model().nv();
        let mut full = Matrix::zeros(nv, nv);
        self.full_m_into(&mut full)?;
        Ok(full)
    }

    /// Writes the inertia matrix to a matrix of the shape `(nv, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
    #[doc(alias = "mj_fullM")]
    pub fn full_m_into(&self, full: &mut Matrix) -> Result<()> {
        self.check_computed("full_m", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_shape("the output of full_m", full.shape(), (nv, nv))?;
        // SAFETY: the output has nv × nv values, and `qM` is this data's own.
        unsafe { sys::mj_fullM(self.model().as_ptr(), full.as_mut_ptr(), self.raw().qM) };
        Ok(())
    }

    /// `result = M vector`, both of length nv.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong length.
    #[doc(alias = "mj_mulM")]
    pub fn mul_m(&self, result: &mut [f64], vector: &[f64]) -> Result<()> {
        self.check_computed("mul_m", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_length("the result of mul_m", result.len(), nv)?;
        Error::check_length("the vector of mul_m", vector.len(), nv)?;
        // SAFETY: both have nv values.
        unsafe { sys::mj_mulM(self.model().as_ptr(), self.as_ptr(), result.as_mut_ptr(), vector.as_ptr()) };
        Ok(())
    }

    /// Solves `M result = vector`, both of length nv, by the factorisation that the pipeline made. `n` vectors one behind
    /// another are solved at once.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] unless both lengths are the same multiple of nv.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let force = vec![1.0; data.model().nv()];
    /// let mut acceleration = vec![0.0; force.len()];
    /// let mut again = vec![0.0; force.len()];
    /// data.solve_m(&mut acceleration, &force)?;
    /// data.mul_m(&mut again, &acceleration)?;
    /// assert!(again.iter().all(|value| (value - 1.0).abs() < 1e-9));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_solveM")]
    pub fn solve_m(&mut self, result: &mut [f64], vector: &[f64]) -> Result<()> {
        self.check_computed("solve_m", Stage::Position)?;
        let nv = self.model().nv();
        let n = vector.len().checked_div(nv).unwrap_or(0);
        Error::check_length("the vector of solve_m", vector.len(), n.max(1) * nv)?;
        Error::check_length("the result of solve_m", result.len(), vector.len())?;
        // The engine counts all their numbers with a C int.
        let n = i32::try_from(vector.len())
            .map(|_| n as i32)
            .map_err(|_| Error::Unsupported(format!("solve_m of {n} vectors of length {nv} at once")))?;
        // SAFETY: both have n × nv values.
        let status = unsafe {
            guard::mj_solve_m(self.model().as_ptr(), self.as_mut_ptr(), result.as_mut_ptr(), vector.as_ptr(), n)
        };
        ffi::check("mj_solveM", status)
    }
}
