//! The accelerations to the last digits, and the inertia that constraints add to.
//!
//! With constraint forces f(J a − aref) the balance of forces is
//!
//! ```text
//! g(a) = M a + bias − passive − actuator − applied − Jᵀ f(J a − aref) = 0,      H = ∂g/∂a = M + Jᵀ K J,
//! ```
//!
//! where K, the derivative of −f, is what the solver called Newton uses too: `efc_D` where a constraint pushes back in proportion,
//! zero where it is satisfied or slides, and a block for each elliptic cone between the two (E. Todorov, "Convex and
//! analytically-invertible dynamics with contacts and constraints", ICRA 2014). g is the derivative of a convex function,
//! quadratic piece by piece but for the cones, so one or two steps of Newton's method from what the solver has found end it.

use mujoco_sys::{mjCNSTRSTATE_CONE, mjCNSTRSTATE_QUADRATIC, mjContact};

use super::worker::Worker;
use crate::data::Data;
use crate::error::Result;
use crate::ffi;
use crate::math;
use crate::matrix::Matrix;
use crate::model::Model;

/// A first step that is larger than this, relative to the largest acceleration, shows that the solver has not converged.
const LARGEST_STEP: f64 = 1e-4;
/// After a step of this size the inertia of elliptic cones is that of the result.
const SMALL_STEP: f64 = 1e-9;
const MOST_STEPS: usize = 8;
/// No pivot of an inertia matrix is as small.
const SMALLEST_PIVOT: f64 = 1e-15;

#[derive(Debug)]
pub(super) struct Newton {
    /// H, and then its Cholesky factor, in the lower triangle.
    pub(super) factor: Matrix,
    /// `J a − aref`.
    jar: Vec<f64>,
    states: Vec<i32>,
    step: Vec<f64>,
    /// Two rows of J, spread out.
    rows: [Vec<f64>; 2],
}

impl Newton {
    pub(super) fn new(model: &Model) -> Self {
        let (nv, njmax) = (model.nv(), ffi::size(model.raw().njmax));
        let row = vec![0.0; nv];
        Self {
            factor: Matrix::zeros(nv, nv),
            jar: Vec::with_capacity(njmax),
            states: Vec::with_capacity(njmax),
            step: row.clone(),
            rows: [row.clone(), row],
        }
    }

    /// Writes H to the lower triangle of the factor.
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
}

impl Worker {
    /// Makes `qacc` of the base point, as the solver left it, as exact as numbers allow, with the constraint forces that belong to
    /// it and the factor of H. False if the solver had not come near enough.
    pub(super) fn settle(&mut self) -> Result<bool> {
        self.constrain()?;
        for step in 0..MOST_STEPS {
            self.newton.assemble(&self.data)?;
            if math::chol_factor(&mut self.newton.factor, SMALLEST_PIVOT)? < self.data.model().nv() {
                return Ok(false);
            }
            self.newton.states.clear();
            self.newton.states.extend_from_slice(self.data.efc_state());
            self.newton.step.copy_from_slice(&self.base.forces[0]);
            math::chol_solve_in_place(&self.newton.factor, &mut self.newton.step)?;
            let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            let size = largest(&self.newton.step) / (1.0 + largest(self.data.qacc()));
            if step == 0 && (size > LARGEST_STEP || size.is_nan()) {
                return Ok(false);
            }
            for (qacc, step) in self.data.qacc_mut().iter_mut().zip(&self.newton.step) {
                *qacc -= step;
            }
            self.constrain()?;
            let same = self.newton.states == self.data.efc_state();
            let cones = self.newton.states.contains(&(mjCNSTRSTATE_CONE as i32));
            if same && (!cones || size <= SMALL_STEP) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The constraint forces that belong to `qacc`, and what is left of the balance.
    fn constrain(&mut self) -> Result<()> {
        let jar = &mut self.newton.jar;
        jar.clear();
        jar.resize(self.data.nefc(), 0.0);
        if !jar.is_empty() {
            self.data.mul_jac_vec(jar, self.data.qacc())?;
            jar.iter_mut().zip(self.data.efc_aref()).for_each(|(jar, aref)| *jar -= aref);
        }
        self.data.constraint_update(jar, true)?;
        self.balance(0)
    }
}

fn contacts(data: &Data) -> &[mjContact] {
    // SAFETY: the engine keeps `ncon` contacts there, and nothing writes to them while the data is borrowed.
    unsafe { ffi::array(data.raw().contact, data.ncon()) }
}

/// Adds a multiple of a row of J.
fn add_row(data: &Data, row: usize, factor: f64, to: &mut [f64]) {
    let nv = to.len();
    if data.model().is_sparse() {
        let start = data.efc_J_rowadr()[row] as usize;
        let range = start..start + data.efc_J_rownnz()[row] as usize;
        for (value, &dof) in data.efc_J()[range.clone()].iter().zip(&data.efc_J_colind()[range]) {
            to[dof as usize] += factor * value;
        }
    } else {
        let values = &data.efc_J()[row * nv..(row + 1) * nv];
        to.iter_mut().zip(values).for_each(|(to, value)| *to += factor * value);
    }
}

/// Adds the lower triangle of `left rightᵀ`.
fn add_product(lower: &mut Matrix, left: &[f64], right: &[f64]) {
    for (dof, &value) in left.iter().enumerate() {
        if value != 0.0 {
            lower.row_mut(dof).iter_mut().zip(&right[..=dof]).for_each(|(lower, right)| *lower += value * right);
        }
    }
}
