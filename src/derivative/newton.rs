//! Newton's method for the accelerations, and the Hessian of the constrained dynamics.
//!
//! With constraint forces f(J a − aref) the equations of motion are
//!
//! ```text
//! g(a) = M a + bias − passive − actuator − applied − Jᵀ f(J a − aref) = 0,      H = ∂g/∂a = M + Jᵀ K J,
//! ```
//!
//! where K is the derivative of −f. The engine's Newton solver uses the same K: `efc_D` for a
//! constraint in its quadratic zone, zero for one that is satisfied or in its linear zone, and a
//! block for each elliptic cone in its middle zone (E. Todorov, "Convex and analytically-invertible
//! dynamics with contacts and constraints", ICRA 2014). g is the gradient of a convex function,
//! piecewise quadratic except for the cones, so Newton's method converges in one or two steps from
//! the solver's result.

use mujoco_sys::{mjCNSTRSTATE_CONE, mjCNSTRSTATE_QUADRATIC, mjContact, mjMAXVAL};

use super::residual::Residual;
use crate::data::{ConeHessian, Data, SensorUpdate, Stage};
use crate::error::Result;
use crate::ffi;
use crate::layout::Row;
use crate::math;
use crate::matrix::Matrix;
use crate::model::Model;

/// Largest first step, relative to the largest acceleration. A larger one shows that the solver has
/// not converged.
const MAX_FIRST_STEP: f64 = 1e-4;
/// Step size below which the Hessian of elliptic cones counts as the Hessian of the result.
const SMALL_STEP: f64 = 1e-9;
const MAX_STEPS: usize = 8;
/// Largest number of constraints for which memory is reserved with engines that have no limit.
const MOST_RESERVED: usize = 1000;
/// Smallest pivot of a Cholesky factor. Inertia matrices have larger ones.
const MIN_PIVOT: f64 = 1e-15;

/// Newton's method, with its buffers.
#[derive(Debug)]
pub(super) struct Newton {
    /// H, and then its Cholesky factor, in the lower triangle. The caller may reuse the matrix
    /// after [`solve`](Self::solve).
    pub(super) factor: Matrix,
    /// `J a − aref`.
    pub(super) jar: Vec<f64>,
    /// `efc_state` before the step.
    states: Vec<i32>,
    step: Vec<f64>,
    /// Two dense rows of J.
    rows: [Vec<f64>; 2],
}

impl Newton {
    pub(super) fn new(model: &Model) -> Self {
        let (nv, mut njmax) = (model.nv(), ffi::limit(model.raw().njmax));
        // Newer engines ignore the number in the file, which may have any value.
        if cfg!(engine_since = "2.3.0") {
            njmax = njmax.min(MOST_RESERVED);
        }
        let row = vec![0.0; nv];
        Self {
            factor: Matrix::zeros(nv, nv),
            jar: Vec::with_capacity(njmax),
            states: Vec::with_capacity(njmax),
            step: row.clone(),
            rows: [row.clone(), row],
        }
    }

    /// Writes H to the lower triangle of [`factor`](Self::factor).
    fn assemble(&mut self, data: &Data) -> Result<()> {
        data.full_m_into(&mut self.factor)?;
        let contacts = contacts(data);
        let mut row = 0;
        while row < data.nefc() {
            let state = data.efc_state()[row] as u32;
            if state == mjCNSTRSTATE_CONE {
                let contact = &contacts[data.efc_id()[row] as usize];
                let dim = ffi::size(contact.dim);
                for j in 0..dim {
                    let [left, right] = &mut self.rows;
                    left.fill(0.0);
                    right.fill(0.0);
                    add_row(data, row + j, 1.0, left);
                    (0..dim).for_each(|k| add_row(data, row + k, contact.H[j * dim + k], right));
                    add_product(&mut self.factor, left, right);
                }
                row += dim;
                continue;
            }
            if state == mjCNSTRSTATE_QUADRATIC {
                let [left, right] = &mut self.rows;
                left.fill(0.0);
                add_row(data, row, 1.0, left);
                let inertia = data.efc_D()[row];
                right.iter_mut().zip(&*left).for_each(|(right, left)| *right = inertia * left);
                add_product(&mut self.factor, left, right);
            }
            row += 1;
        }
        Ok(())
    }

    /// Computes the accelerations of the present state to the accuracy of the arithmetic, the
    /// constraint forces, and the sensors as requested. Leaves the residual, `(nv)`, in `value`,
    /// and returns the way to evaluate it; `None` if the constraint solver has not converged.
    pub(super) fn solve(
        &mut self,
        data: &mut Data,
        sensors: SensorUpdate,
        value: &mut [f64],
    ) -> Result<Option<Residual>> {
        if !has_accelerations(data, sensors)? {
            return Ok(None);
        }
        let residual = Residual::of(data);
        Ok(self.refine(data, residual, value)?.then_some(residual))
    }

    /// Does the same as [`solve`](Self::solve) without sensors, for a caller that does not read the
    /// residual: `value` is a buffer. Returns `false` if the constraint solver has not converged.
    pub(super) fn solve_accelerations(&mut self, data: &mut Data, value: &mut [f64]) -> Result<bool> {
        if !has_accelerations(data, SensorUpdate::Skip)? {
            return Ok(false);
        }
        if data.nefc() == 0 {
            // The engine has solved a linear system.
            return self.factorise(data);
        }
        let residual = Residual::of(data);
        self.refine(data, residual, value)
    }

    /// Computes the Cholesky factor of H. Returns `false` if H is singular.
    fn factorise(&mut self, data: &Data) -> Result<bool> {
        self.assemble(data)?;
        Ok(math::chol_factor(&mut self.factor, MIN_PIVOT)? >= data.model().nv())
    }

    /// Refines `qacc`, the result of the constraint solver, to the accuracy of the arithmetic.
    ///
    /// Updates the constraint forces and leaves the Cholesky factor of H in
    /// [`factor`](Self::factor). Returns `false` if the solver's result was too far from the
    /// solution.
    fn refine(&mut self, data: &mut Data, residual: Residual, value: &mut [f64]) -> Result<bool> {
        self.update(data, residual, value)?;
        for step in 0..MAX_STEPS {
            if !self.factorise(data)? {
                return Ok(false);
            }
            if data.nefc() == 0 {
                // The engine has solved a linear system.
                return Ok(true);
            }
            self.states.clear();
            self.states.extend_from_slice(data.efc_state());
            self.step.copy_from_slice(value);
            math::chol_solve_in_place(&self.factor, &mut self.step)?;
            let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            let size = largest(&self.step) / (1.0 + largest(data.qacc()));
            if step == 0 && (size > MAX_FIRST_STEP || size.is_nan()) {
                return Ok(false);
            }
            for (qacc, step) in data.qacc_mut().iter_mut().zip(&self.step) {
                *qacc -= step;
            }
            self.update(data, residual, value)?;
            let same = self.states == data.efc_state();
            let cones = self.states.contains(&(mjCNSTRSTATE_CONE as i32));
            if same && (!cones || size <= SMALL_STEP) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Computes the constraint forces for the present `qacc`, and leaves H in the lower triangle of
    /// [`factor`](Self::factor).
    pub(super) fn hessian(&mut self, data: &mut Data) -> Result<&Matrix> {
        self.update_constraints(data)?;
        self.assemble(data)?;
        Ok(&self.factor)
    }

    /// Updates the constraint forces for the present `qacc`, and evaluates the residual.
    fn update(&mut self, data: &mut Data, residual: Residual, value: &mut [f64]) -> Result<()> {
        self.update_constraints(data)?;
        residual.evaluate(data, value)
    }

    /// Updates the constraint forces for the present `qacc`.
    pub(super) fn update_constraints(&mut self, data: &mut Data) -> Result<()> {
        let jar = &mut self.jar;
        jar.clear();
        jar.resize(data.nefc(), 0.0);
        if !jar.is_empty() {
            data.mul_jac_vec_into(data.qacc(), jar)?;
            jar.iter_mut().zip(data.efc_aref()).for_each(|(jar, aref)| *jar -= aref);
        }
        data.constraint_update(jar, ConeHessian::Compute)?;
        Ok(())
    }
}

/// Computes the accelerations of the present state, and the sensors as requested. Returns `false`
/// if they are beyond the engine's limit.
fn has_accelerations(data: &mut Data, sensors: SensorUpdate) -> Result<bool> {
    data.forward_skip(Stage::None, sensors)?;
    Ok(data.qacc().iter().all(|value| value.abs() <= mjMAXVAL))
}

/// Returns the contacts, as the engine stores them.
pub(super) fn contacts(data: &Data) -> &[mjContact] {
    // SAFETY: the engine's array holds `ncon` contacts, and nothing writes to them while the data
    // is borrowed.
    unsafe { ffi::array(data.raw().contact, data.ncon()) }
}

/// Returns a row of J, dense or sparse.
pub(super) fn constraint_row(data: &Data, row: usize) -> Row<'_> {
    if data.model().is_sparse() {
        let start = data.efc_J_rowadr()[row] as usize;
        let range = start..start + data.efc_J_rownnz()[row] as usize;
        Row { values: &data.efc_J()[range.clone()], columns: Some(&data.efc_J_colind()[range]) }
    } else {
        let nv = data.model().nv();
        Row { values: &data.efc_J()[row * nv..(row + 1) * nv], columns: None }
    }
}

/// Adds a multiple of a row of J.
pub(crate) fn add_row(data: &Data, row: usize, factor: f64, to: &mut [f64]) {
    constraint_row(data, row).add_to(to, factor);
}

/// Adds the lower triangle of `left · rightᵀ`.
fn add_product(lower: &mut Matrix, left: &[f64], right: &[f64]) {
    for (dof, &value) in left.iter().enumerate() {
        if value != 0.0 {
            lower.row_mut(dof).iter_mut().zip(&right[..=dof]).for_each(|(lower, right)| *lower += value * right);
        }
    }
}
