//! Step of the Euler integrator with implicit damping D: conversion of the derivatives of the
//! residual to the derivatives of the next state.
//!
//! With ∂a = −H⁻¹ ∂g, the matrices `W = M + h D` and `s = W⁻¹ M a` of the integrator, and
//! `w = a − s = h W⁻¹ D a`,
//!
//! ```text
//! ∂v' = ∂v + h W⁻¹ (∂M w + M ∂a) = ∂v + h (W⁻¹ (∂M w + h D X) − X),      X = H⁻¹ ∂g,
//! ∂q' = ∂⊕/∂q ∂q + h ∂⊕/∂v ∂v'.
//! ```
//!
//! `∂M w` is the derivative of `M w` by the position at constant w. Without damping, W is M and the
//! terms of W cancel.

use super::damped_inertia::DampedInertia;
use super::rigid_body::RigidBodies;
use super::tree::Tree;
use crate::data::Data;
use crate::derivative::implicit::has_implicit_damping;
use crate::derivative::rotation::{self, Rotation};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::linear_algebra::add;

/// Buffers of the integrator.
#[derive(Debug)]
pub(super) struct Euler {
    inertia: DampedInertia,
    /// `(nv, 1)`: w
    spread: Matrix,
    /// `(nv, nx + nu)`: ∂M w + h D X, and then its product with W⁻¹.
    damped: Matrix,
    pub(super) rotations: Vec<Rotation>,
}

impl Euler {
    pub(super) fn new(model: &Model, width: usize) -> Self {
        Self {
            inertia: DampedInertia::default(),
            spread: Matrix::zeros(model.nv(), 1),
            damped: Matrix::zeros(model.nv(), width),
            rotations: Vec::with_capacity(model.njnt()),
        }
    }

    /// Replaces X by the derivatives of the next velocity, and computes the derivatives of the
    /// rotations.
    pub(super) fn differentiate(
        &mut self,
        data: &Data,
        tree: &Tree,
        bodies: &mut RigidBodies,
        derivative: &mut Matrix,
    ) {
        let model = data.model();
        let (nv, h) = (model.nv(), model.raw().opt.timestep);
        let damping = model.dof_damping();
        let spread = self.spread.as_mut_slice();
        spread.fill(0.0);
        if has_implicit_damping(model) {
            self.inertia.factor(data, tree);
            for ((spread, damping), qacc) in spread.iter_mut().zip(damping).zip(data.qacc()) {
                *spread = h * damping * qacc;
            }
            self.inertia.solve(tree, &mut self.spread);
            self.damped.as_mut_slice().fill(0.0);
            bodies.differentiate_inertia(data, tree, self.spread.as_slice(), &mut self.damped);
            for (dof, &damping) in damping.iter().enumerate() {
                if damping != 0.0 {
                    add(self.damped.row_mut(dof), derivative.row(dof), h * damping);
                }
            }
            self.inertia.solve(tree, &mut self.damped);
            let values = derivative.as_mut_slice().iter_mut().zip(self.damped.as_slice());
            values.for_each(|(value, damped)| *value = h * (damped - *value));
        } else {
            derivative.as_mut_slice().iter_mut().for_each(|value| *value *= -h);
        }
        (0..nv).for_each(|dof| derivative[(dof, nv + dof)] += 1.0);
        let (qvel, qacc, spread) = (data.qvel(), data.qacc(), self.spread.as_slice());
        rotation::differentiate(model, |dof| qvel[dof] + h * (qacc[dof] - spread[dof]), &mut self.rotations);
    }

    /// Writes the derivatives of the next positions and velocities, given the derivatives of the
    /// next velocities. `columns` selects the columns of `velocities` that `result` has: the
    /// columns of A or of B.
    pub(super) fn write(&self, h: f64, velocities: &Matrix, columns: std::ops::Range<usize>, result: &mut Matrix) {
        let nv = velocities.nrows();
        for dof in 0..nv {
            let velocity = &velocities.row(dof)[columns.clone()];
            result.row_mut(nv + dof).copy_from_slice(velocity);
            let position = result.row_mut(dof);
            position.iter_mut().zip(velocity).for_each(|(position, velocity)| *position = h * velocity);
            if columns.contains(&dof) {
                position[dof - columns.start] += 1.0;
            }
        }
        for Rotation { dof, by_position, by_velocity } in &self.rotations {
            for axis in 0..3 {
                let position = result.row_mut(dof + axis);
                position.fill(0.0);
                for other in 0..3 {
                    let velocity = &velocities.row(dof + other)[columns.clone()];
                    add(position, velocity, h * by_velocity[3 * axis + other]);
                    if columns.contains(&(dof + other)) {
                        position[dof + other - columns.start] += by_position[3 * axis + other];
                    }
                }
            }
        }
    }
}
