//! Rows of one constraint: conversion of the derivatives of their residuals to the derivatives of
//! the constraint forces.
//!
//! A row has the residual `jar = J a − aref`, `aref = −B J v − K I (pos − margin)`, and the force
//! f(jar) of inertia D, which also depends on the position: `D = 1/R`, `R = (1 − I)/I · constant`,
//! where the impedance I is a function of pos with the derivative P. The engine leaves K, B, I and
//! P of each row in `efc_KBIP`. In every zone f is proportional to D, so
//!
//! ```text
//! ∂f = −𝒦 ∂jar + f ∂ln D,        ∂ln D = P ∂pos / (I (1 − I)),
//! ∂jar = (∂J)(a + B v) + K (I ∂pos + P (pos − margin) ∂pos),
//! ∂(Jᵀ f) = (∂J)ᵀ f + Jᵀ ∂f,     ∂(Jᵀ f)/∂v = −Jᵀ 𝒦 B J,
//! ```
//!
//! where `𝒦 = −∂f/∂jar` is D in the quadratic zone, zero in the linear zone and if the constraint
//! is satisfied, and the block `contact.H` in the middle zone of an elliptic cone.

use std::ops::Range;

use mujoco_sys::{mjCNSTRSTATE_CONE, mjCNSTRSTATE_QUADRATIC};

use crate::data::Data;
use crate::derivative::newton::{add_row, contacts};
use crate::ffi;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add;

/// Maximum number of rows of a constraint: a contact with a pyramidal cone and five friction
/// components.
pub(in crate::derivative::analytic) const MAX_ROWS: usize = 10;

/// Rows of a constraint, with columns for all degrees of freedom.
#[derive(Debug)]
pub(super) struct Rows {
    /// `(MAX_ROWS, nv)`: J.
    pub(super) jacobian: Matrix,
    /// `(MAX_ROWS, nv)`: `∂jar` by the position.
    pub(super) residual: Matrix,
    /// `(nv)`: `∂ln D`.
    pub(super) log_inertia: Vec<f64>,
    /// Number of the first row of the constraint, and their count.
    pub(super) first: usize,
    pub(super) count: usize,
    /// Degrees of freedom whose columns may not be zero.
    pub(super) span: Range<usize>,
    /// `(nv)`: derivatives of the force of a row, by position and by velocity.
    by_position: Vec<f64>,
    by_velocity: Vec<f64>,
}

impl Rows {
    pub(super) fn new(nv: usize) -> Self {
        let (matrix, row) = (Matrix::zeros(MAX_ROWS, nv), vec![0.0; nv]);
        Self {
            jacobian: matrix.clone(),
            residual: matrix,
            log_inertia: row.clone(),
            first: 0,
            count: 0,
            span: 0..0,
            by_position: row.clone(),
            by_velocity: row,
        }
    }

    /// Loads the Jacobian of a constraint, and clears the derivatives. Without a span, the span of
    /// the Jacobian is used.
    pub(super) fn load(&mut self, data: &Data, first: usize, count: usize, span: Option<Range<usize>>) {
        (self.first, self.count) = (first, count);
        for row in 0..count {
            let values = self.jacobian.row_mut(row);
            values.fill(0.0);
            add_row(data, first + row, 1.0, values);
        }
        self.span = span.unwrap_or_else(|| {
            let is_used = |&dof: &usize| (0..count).any(|row| self.jacobian[(row, dof)] != 0.0);
            let nv = self.log_inertia.len();
            let start = (0..nv).find(is_used).unwrap_or(0);
            start..(start..nv).rev().find(is_used).map_or(start, |last| last + 1)
        });
        for row in 0..count {
            self.residual.row_mut(row)[self.span.clone()].fill(0.0);
        }
        self.log_inertia[self.span.clone()].fill(0.0);
    }

    /// Extends the span, which the new one contains.
    pub(super) fn widen(&mut self, span: Range<usize>) {
        for dof in span.clone().filter(|dof| !self.span.contains(dof)) {
            self.log_inertia[dof] = 0.0;
            (0..self.count).for_each(|row| self.residual[(row, dof)] = 0.0);
        }
        self.span = span;
    }

    /// Subtracts `∂(Jᵀ f)` at constant J from the derivatives of the residual of the equations of
    /// motion, by positions and velocities.
    pub(super) fn subtract_from(&mut self, data: &Data, residual: &mut Matrix) {
        let (nv, span) = (self.log_inertia.len(), self.span.clone());
        for row in 0..self.count {
            if !self.differentiate_force(data, row) {
                continue;
            }
            let (by_position, by_velocity) = (&self.by_position[span.clone()], &self.by_velocity[span.clone()]);
            for dof in span.clone() {
                let factor = self.jacobian[(row, dof)];
                if factor != 0.0 {
                    let (positions, velocities) = residual.row_mut(dof)[..2 * nv].split_at_mut(nv);
                    add(&mut positions[span.clone()], by_position, -factor);
                    add(&mut velocities[span.clone()], by_velocity, factor);
                }
            }
        }
    }

    /// Adds the derivatives of the force of a row by positions, velocities and accelerations to
    /// `derivative`, `(3 nv)`.
    pub(super) fn add_force(&mut self, data: &Data, row: usize, derivative: &mut [f64]) {
        if !self.differentiate_force(data, row) {
            return;
        }
        let (nv, span) = (self.log_inertia.len(), self.span.clone());
        let (positions, rest) = derivative.split_at_mut(nv);
        let (velocities, accelerations) = rest.split_at_mut(nv);
        add(&mut positions[span.clone()], &self.by_position[span.clone()], 1.0);
        add(&mut velocities[span.clone()], &self.by_velocity[span.clone()], -1.0);
        let (first, count, jacobian) = (self.first, self.count, &self.jacobian);
        for_each_stiffness(data, first, count, row, |other, stiffness| {
            add(&mut accelerations[span.clone()], &jacobian.row(other)[span.clone()], -stiffness);
        });
    }

    /// Computes the derivatives of the force of a row by the position, and minus those by the
    /// velocity, at constant acceleration. Returns `false` for a constant force.
    fn differentiate_force(&mut self, data: &Data, row: usize) -> bool {
        let (first, count, span) = (self.first, self.count, self.span.clone());
        let Self { jacobian, residual, log_inertia, by_position, by_velocity, .. } = self;
        let (by_position, by_velocity) = (&mut by_position[span.clone()], &mut by_velocity[span.clone()]);
        by_position.fill(0.0);
        by_velocity.fill(0.0);
        let mut is_constant = true;
        for_each_stiffness(data, first, count, row, |other, stiffness| {
            is_constant = false;
            add(by_position, &residual.row(other)[span.clone()], -stiffness);
            let damping = stiffness * data.efc_KBIP()[first + other][1];
            add(by_velocity, &jacobian.row(other)[span.clone()], damping);
        });
        if is_constant {
            return false;
        }
        add(by_position, &log_inertia[span], data.efc_force()[first + row]);
        true
    }
}

/// Calls a function for each entry of a row of 𝒦, with its column, unless the row is zero.
#[inline]
fn for_each_stiffness(data: &Data, first: usize, count: usize, row: usize, mut call: impl FnMut(usize, f64)) {
    if data.efc_state()[first] as u32 == mjCNSTRSTATE_CONE {
        let contact = &contacts(data)[ffi::size(data.efc_id()[first + row])];
        (0..count).for_each(|other| call(other, contact.H[row * count + other]));
    } else if data.efc_state()[first + row] as u32 == mjCNSTRSTATE_QUADRATIC {
        call(row, data.efc_D()[first + row]);
    }
}

/// Slopes of a row's quantities by its position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    /// `∂jar/∂pos`: `K (I + P (pos − margin))`.
    pub(super) residual: f64,
    /// `∂ln D/∂pos`: `P / (I (1 − I))`.
    pub(super) log_inertia: f64,
}

impl Slopes {
    pub(super) fn of(data: &Data, row: usize) -> Self {
        let [stiffness, _, impedance, slope] = data.efc_KBIP()[row];
        let beyond = data.efc_pos()[row] - data.efc_margin()[row];
        Self {
            residual: stiffness * (impedance + slope * beyond),
            log_inertia: slope / (impedance * (1.0 - impedance)),
        }
    }
}
