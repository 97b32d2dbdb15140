//! Constraints: storage formats, products with the Jacobian, and cost.

use std::ptr;

use mujoco_sys::{self as sys, guard};

use super::{Data, PipelineFlags};
use crate::error::{Error, Result};
use crate::model::Model;

/// # Constraints
impl Model {
    /// Returns `true` if friction cones are pyramidal.
    #[doc(alias = "mj_isPyramidal")]
    pub fn is_pyramidal(&self) -> bool {
        // SAFETY: reads the options of a valid model.
        unsafe { sys::mj_isPyramidal(self.as_ptr()) != 0 }
    }

    /// Returns `true` if the Jacobians of constraints and tendons are sparse matrices.
    #[doc(alias = "mj_isSparse")]
    pub fn is_sparse(&self) -> bool {
        // SAFETY: as above.
        unsafe { sys::mj_isSparse(self.as_ptr()) != 0 }
    }

    /// Returns `true` if a solver uses the dual problem: PGS, or the no-slip solver after any other
    /// solver.
    #[doc(alias = "mj_isDual")]
    pub fn is_dual(&self) -> bool {
        // SAFETY: as above.
        unsafe { sys::mj_isDual(self.as_ptr()) != 0 }
    }
}

/// Effect of [`Data::constraint_update`] on the Hessians of elliptic cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ConeHessian {
    /// Stores the Hessians in the contacts.
    Compute,
    /// Leaves the Hessians unchanged.
    Skip,
}

/// # Constraints
impl Data {
    /// Computes `result = J vector` with the Jacobian J of the constraints: `result` of length
    /// nefc, `vector` of length nv.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before the constraint rows were computed, [`Error::Shape`] for a
    /// wrong length.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("squat")?;
    /// data.forward()?;
    /// let mut velocity = vec![0.0; data.nefc()];
    /// data.mul_jac_vec_into(data.qvel(), &mut velocity)?;
    /// assert_eq!(velocity, data.efc_vel());
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_mulJacVec")]
    pub fn mul_jac_vec_into(&self, vector: &[f64], result: &mut [f64]) -> Result<()> {
        self.check_constraint("mul_jac_vec")?;
        Error::check_length("the result of mul_jac_vec_into", result.len(), self.nefc())?;
        Error::check_length("the vector of mul_jac_vec_into", vector.len(), self.model().nv())?;
        // SAFETY: nefc and nv elements, and the rows were computed for this model. The function
        // only reads the data.
        unsafe {
            sys::mj_mulJacVec(self.model().as_ptr(), self.as_ptr().cast_mut(), result.as_mut_ptr(), vector.as_ptr());
        };
        Ok(())
    }

    /// Computes `result = Jᵀ vector` with the Jacobian J of the constraints: `result` of length nv,
    /// `vector` of length nefc. Without constraints the result is zero. (The engine does not write
    /// the result in that case.)
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before the constraint rows were computed, [`Error::Shape`] for a
    /// wrong length.
    #[doc(alias = "mj_mulJacTVec")]
    pub fn mul_jac_t_vec_into(&self, vector: &[f64], result: &mut [f64]) -> Result<()> {
        self.check_constraint("mul_jac_t_vec")?;
        Error::check_length("the result of mul_jac_t_vec_into", result.len(), self.model().nv())?;
        Error::check_length("the vector of mul_jac_t_vec_into", vector.len(), self.nefc())?;
        if vector.is_empty() {
            result.fill(0.0);
            return Ok(());
        }
        // SAFETY: nv and nefc elements, and the rows were computed for this model. The function
        // only reads the data.
        unsafe {
            sys::mj_mulJacTVec(self.model().as_ptr(), self.as_ptr().cast_mut(), result.as_mut_ptr(), vector.as_ptr());
        };
        Ok(())
    }

    /// Computes the constraint forces `efc_force`, the constraint states `efc_state` and
    /// `qfrc_constraint` from `jar = J qacc − aref` of length nefc. Returns the cost of the
    /// constraints, which the primal solvers minimise (Todorov, Convex and analytically-invertible
    /// dynamics with contacts and constraints, ICRA 2014).
    ///
    /// With [`ConeHessian::Compute`] the engine also stores the Hessians of elliptic cones in its
    /// contacts.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before the constraint rows were computed, [`Error::Shape`] for a
    /// wrong length.
    ///
    /// ```
    /// use mujoco_safe::data::ConeHessian;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("squat")?;
    /// data.forward()?;
    /// // Inequality constraints with positive residuals exert no force.
    /// let cost = data.constraint_update(&vec![1.0; data.nefc()], ConeHessian::Skip)?;
    /// assert_eq!(cost, 0.0);
    /// assert!(data.qfrc_constraint().iter().all(|&force| force == 0.0));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_constraintUpdate")]
    pub fn constraint_update(&mut self, jar: &[f64], cone_hessian: ConeHessian) -> Result<f64> {
        self.check_constraint("constraint_update")?;
        Error::check_length("jar of constraint_update", jar.len(), self.nefc())?;
        let flag = (cone_hessian == ConeHessian::Compute).into();
        let mut cost = 0.0;
        self.run("mj_constraintUpdate", self.after(PipelineFlags::SOLVED), |m, d| {
            // SAFETY: nefc elements, a valid pointer for the cost, and rows that were computed for
            // this model.
            unsafe { guard::mj_constraint_update(m, d, jar.as_ptr(), ptr::from_mut(&mut cost), flag) }
        })?;
        Ok(cost)
    }

    fn check_constraint(&self, call: &'static str) -> Result<()> {
        self.check_parts(call, PipelineFlags::CONSTRAINT)
    }
}
