//! Step of the integrator: conversion of the derivatives of the accelerations a to the derivatives
//! of the next state.
//!
//! An integrator with implicit forces treats forces τ as linear in the velocity over the step: with
//! `Q = ∂τ/∂v`, `W = M − h Q` and `s = W⁻¹ M a`, `v' = v + h s` ("Numerical integration" in the
//! engine's documentation). With `w = a − s = −h W⁻¹ Q a` and `X = −∂a`,
//!
//! ```text
//! ∂v' = ∂v + h (W⁻¹ (∂M w − h Q X + h ∂Q s) − X),        ∂q' = ∂⊕/∂q ∂q + h ∂⊕/∂v ∂v'.
//! ```
//!
//! `∂M w` is the derivative of `M w` at constant w. The Euler integrator has Q = −D for the
//! implicit damping D of the degrees of freedom (`damped_inertia.rs`), which is constant. For the
//! other Q see `implicit_step.rs`. Without implicit forces W is M, and the terms of W cancel.

use std::ops::Range;

use super::damped_inertia::DampedInertia;
use super::implicit_step::{self, ImplicitStep};
use super::rigid_body::RigidBodies;
use super::tree::Tree;
use crate::data::Data;
use crate::derivative::implicit::has_implicit_damping;
use crate::derivative::rotation::{self, Rotation};
use crate::error::Result;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::{add, add_product, solve_lu, solve_lu_transposed};
use crate::numerics::spatial::Spatial;

/// Integrator at a state, with its buffers.
#[derive(Debug)]
pub(in crate::derivative) struct Integrator {
    kind: Kind,
    inertia: DampedInertia,
    /// Created when the integrator is first used.
    implicit: Option<ImplicitStep>,
    /// `(nv, 1)`: w
    spread: Matrix,
    /// `(nv)`: s, v + s, and zeros.
    acceleration: Vec<f64>,
    velocity: Vec<f64>,
    zeros: Vec<f64>,
    rotations: Vec<Rotation>,
    /// `(nbody)`: motions of bodies, and the factors of the forces that they need in
    /// `∂M w + h ∂Q s`.
    motions: [Vec<[Spatial; 2]>; 4],
    factors: [f64; 4],
}

/// Kind of the integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Without implicit forces.
    Plain,
    Euler,
    Implicit,
}

impl Integrator {
    pub(super) fn new(model: &Model) -> Self {
        let zeros = vec![0.0; model.nv()];
        Self {
            kind: Kind::Plain,
            inertia: DampedInertia::default(),
            implicit: None,
            spread: Matrix::zeros(model.nv(), 1),
            acceleration: zeros.clone(),
            velocity: zeros.clone(),
            zeros,
            rotations: Vec::with_capacity(model.njnt()),
            motions: Default::default(),
            factors: [0.0; 4],
        }
    }

    /// Prepares the integrator at the present state. `changes_damping` is true if a parameter is
    /// the damping of a degree of freedom, which is implicit even if it is zero at present.
    pub(super) fn prepare(
        &mut self,
        data: &Data,
        tree: &Tree,
        bodies: &mut RigidBodies,
        changes_damping: bool,
    ) -> Result<()> {
        let model = data.model();
        let h = model.raw().opt.timestep;
        let may_damp = model.raw().opt.disableflags as u32 & DisableFlags::DAMPER.bits() == 0;
        let spread = &mut self.spread;
        self.kind = if implicit_step::is_used(model) {
            let step = self.implicit.get_or_insert_with(|| ImplicitStep::new(model));
            step.prepare(data, tree, bodies, &self.zeros, spread)?;
            Kind::Implicit
        } else if has_implicit_damping(model) || (changes_damping && may_damp) {
            let values = spread.as_mut_slice().iter_mut().zip(model.dof_damping()).zip(data.qacc());
            values.for_each(|((spread, damping), qacc)| *spread = h * damping * qacc);
            self.inertia.factor(data, tree);
            self.inertia.solve(tree, spread);
            Kind::Euler
        } else {
            spread.as_mut_slice().fill(0.0);
            Kind::Plain
        };
        self.acceleration.copy_from_slice(data.qacc());
        add(&mut self.acceleration, self.spread.as_slice(), -1.0);
        self.velocity.copy_from_slice(data.qvel());
        add(&mut self.velocity, &self.acceleration, 1.0);
        let (qvel, acceleration) = (data.qvel(), &self.acceleration);
        rotation::differentiate(model, |dof| qvel[dof] + h * acceleration[dof], &mut self.rotations);
        Ok(())
    }

    /// Computes the motions of bodies for the derivatives by their inertia, after the preparation:
    /// `M w` is inverse dynamics with the acceleration w and without velocity, and the Coriolis
    /// forces in Q depend on it as in `implicit_step.rs`.
    pub(super) fn compute_motions(&mut self, data: &Data, tree: &Tree, bodies: &mut RigidBodies) {
        let model = data.model();
        let h = model.raw().opt.timestep;
        self.factors = match self.kind {
            Kind::Plain => [0.0; 4],
            Kind::Euler => [1.0, 0.0, 0.0, 0.0],
            Kind::Implicit => [1.0, -h, h, h],
        };
        let Self { acceleration, velocity, zeros, spread, .. } = self;
        let inputs: [(&[f64], &[f64]); 4] =
            [(zeros, spread.as_slice()), (velocity, zeros), (data.qvel(), zeros), (acceleration, zeros)];
        for ((motions, input), factor) in self.motions.iter_mut().zip(inputs).zip(self.factors) {
            if factor != 0.0 {
                motions.resize(model.nbody(), [[0.0; 6]; 2]);
                bodies.motions(data, tree, input, motions);
            }
        }
    }

    /// Returns the motions of a body whose factors are not zero, with these.
    pub(super) fn motions_of(&self, body: usize) -> impl Iterator<Item = (f64, [Spatial; 2])> + '_ {
        let used = self.factors.iter().zip(&self.motions).filter(|(factor, _)| **factor != 0.0);
        used.map(move |(&factor, motions)| (factor, motions[body]))
    }

    /// Returns w.
    pub(in crate::derivative) fn spread(&self) -> &[f64] {
        self.spread.as_slice()
    }

    /// Returns s.
    pub(super) fn acceleration(&self) -> &[f64] {
        &self.acceleration
    }

    /// Returns `true` if Q depends on more than damping.
    pub(in crate::derivative) fn is_implicit(&self) -> bool {
        self.kind == Kind::Implicit
    }

    /// Replaces X by the derivatives of the next velocity, and computes the derivatives of the
    /// rotations. `sum` is a buffer of the size of X.
    pub(super) fn differentiate(
        &mut self,
        data: &Data,
        tree: &Tree,
        bodies: &mut RigidBodies,
        derivative: &mut Matrix,
        sum: &mut Matrix,
    ) -> Result<()> {
        self.prepare(data, tree, bodies, false)?;
        if self.kind != Kind::Plain {
            sum.as_mut_slice().fill(0.0);
            bodies.differentiate_inertia(data, tree, self.spread.as_slice(), sum);
        }
        if let (Kind::Implicit, Some(step)) = (self.kind, &mut self.implicit) {
            step.add_changes(data, tree, bodies, [&self.velocity, &self.acceleration, &self.zeros], sum);
        }
        self.finish(data, tree, derivative, sum);
        let nv = derivative.nrows();
        (0..nv).for_each(|dof| derivative[(dof, nv + dof)] += 1.0);
        Ok(())
    }

    /// Replaces X by the change `h (W⁻¹ (∂M w − h Q X + h ∂Q s) − X)` of the next velocity, given
    /// ∂M w + h ∂Q s, which is overwritten.
    pub(super) fn finish(&self, data: &Data, tree: &Tree, derivative: &mut Matrix, sum: &mut Matrix) {
        let model = data.model();
        let h = model.raw().opt.timestep;
        match (self.kind, &self.implicit) {
            (Kind::Implicit, Some(step)) => {
                for dof in 0..model.nv() {
                    // A product with the matrix combines the rows of X.
                    add_product(sum.row_mut(dof), derivative, step.forces.row(dof), -h);
                }
                solve_lu(&step.factor, sum);
            }
            (Kind::Euler, _) => {
                for (dof, &damping) in model.dof_damping().iter().enumerate() {
                    if damping != 0.0 {
                        add(sum.row_mut(dof), derivative.row(dof), h * damping);
                    }
                }
                self.inertia.solve(tree, sum);
            }
            _ => return derivative.as_mut_slice().iter_mut().for_each(|value| *value *= -h),
        }
        let values = derivative.as_mut_slice().iter_mut().zip(sum.as_slice());
        values.for_each(|(value, sum)| *value = h * (sum - *value));
    }

    /// Writes the derivatives of the next positions and velocities, except for
    /// [those](Self::add_position) of the positions by the present ones, given the derivatives of
    /// the next velocities. `columns` selects those that `result` has.
    pub(super) fn write(&self, h: f64, velocities: &Matrix, columns: Range<usize>, result: &mut Matrix) {
        let nv = velocities.nrows();
        for dof in 0..nv {
            let velocity = &velocities.row(dof)[columns.clone()];
            result.row_mut(nv + dof).copy_from_slice(velocity);
            let position = result.row_mut(dof).iter_mut().zip(velocity);
            position.for_each(|(position, velocity)| *position = h * velocity);
        }
        for Rotation { dof, by_velocity, .. } in &self.rotations {
            for axis in 0..3 {
                let position = result.row_mut(dof + axis);
                position.fill(0.0);
                for other in 0..3 {
                    let velocity = &velocities.row(dof + other)[columns.clone()];
                    add(position, velocity, h * by_velocity[3 * axis + other]);
                }
            }
        }
    }

    /// Adds the derivatives of the next positions by the present ones at a constant next velocity,
    /// `∂⊕/∂q`.
    pub(super) fn add_position(&self, nv: usize, a: &mut Matrix) {
        (0..nv).for_each(|dof| a[(dof, dof)] += 1.0);
        for Rotation { dof, by_position, .. } in &self.rotations {
            for (at, value) in by_position.iter().enumerate() {
                let (axis, other) = (at / 3, at % 3);
                let identity = if axis == other { 1.0 } else { 0.0 };
                a[(dof + axis, dof + other)] += value - identity;
            }
        }
    }

    /// Converts gradients by the next positions and velocities: writes `h (ℓ + h Qᵀ η)`, of which
    /// the solution with H is μ, and h η.
    pub(super) fn transpose(&self, data: &Data, tree: &Tree, gradient: &[f64], weights: &mut [Matrix; 2]) {
        let model = data.model();
        let (nv, h) = (model.nv(), model.raw().opt.timestep);
        let (by_position, by_velocity) = (&gradient[..nv], &gradient[nv..2 * nv]);
        let [of_residual, of_spread] = weights;
        let of_residual = of_residual.as_mut_slice();
        for (dof, value) in of_residual.iter_mut().enumerate() {
            *value = by_velocity[dof] + h * by_position[dof];
        }
        for Rotation { dof, by_velocity: matrix, .. } in &self.rotations {
            for other in 0..3 {
                let product: f64 = (0..3).map(|axis| matrix[3 * axis + other] * by_position[dof + axis]).sum();
                of_residual[dof + other] = by_velocity[dof + other] + h * product;
            }
        }
        of_spread.as_mut_slice().copy_from_slice(of_residual);
        match (self.kind, &self.implicit) {
            (Kind::Implicit, Some(step)) => {
                solve_lu_transposed(&step.factor, of_spread.as_mut_slice());
                add_product(of_residual, &step.forces, of_spread.as_slice(), h);
            }
            (Kind::Euler, _) => {
                self.inertia.solve(tree, of_spread);
                let values = of_residual.iter_mut().zip(model.dof_damping()).zip(of_spread.as_slice());
                values.for_each(|((value, damping), spread)| *value -= h * damping * spread);
            }
            _ => of_spread.as_mut_slice().fill(0.0),
        }
        for value in of_residual.iter_mut().chain(of_spread.as_mut_slice()) {
            *value *= h;
        }
    }
}
