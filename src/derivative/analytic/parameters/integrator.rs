//! The integrator of a step whose state is fixed: its matrices, w and s.

use super::effects::Damping;
use crate::data::Data;
use crate::derivative::analytic::damped_inertia::DampedInertia;
use crate::derivative::analytic::implicit_step::{self, ImplicitStep};
use crate::derivative::analytic::rigid_body::RigidBodies;
use crate::derivative::analytic::tree::Tree;
use crate::derivative::implicit::has_implicit_damping;
use crate::derivative::rotation::{self, Rotation};
use crate::error::Result;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::{add, add_product, solve_lu, solve_lu_transposed};
use crate::numerics::spatial::Spatial;

/// Integrator, with its buffers.
#[derive(Debug)]
pub(in crate::derivative) struct Integrator {
    kind: Kind,
    inertia: DampedInertia,
    /// `(nv, 1)`: w of the Euler integrator.
    spread: Matrix,
    /// `(nv)`: s, a velocity, and zeros.
    acceleration: Vec<f64>,
    velocity: Vec<f64>,
    zeros: Vec<f64>,
    /// `(nbody)`: motions at `v + s`, v and s, for the implicit integrator.
    motions: [Vec<[Spatial; 2]>; 3],
    rotations: Vec<Rotation>,
    /// Created when the integrator is first used.
    implicit: Option<ImplicitStep>,
}

/// Kind of the integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Without implicit damping.
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
            spread: Matrix::zeros(model.nv(), 1),
            acceleration: zeros.clone(),
            velocity: zeros.clone(),
            zeros,
            motions: [vec![], vec![], vec![]],
            rotations: Vec::with_capacity(model.njnt()),
            implicit: None,
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
        self.kind = Kind::Plain;
        self.acceleration.copy_from_slice(data.qacc());
        let may_damp = model.raw().opt.disableflags as u32 & DisableFlags::DAMPER.bits() == 0;
        if implicit_step::is_used(model) {
            self.kind = Kind::Implicit;
            let step = self.implicit.get_or_insert_with(|| ImplicitStep::new(model, 0));
            step.prepare(data, tree, bodies)?;
            self.acceleration.copy_from_slice(&step.acceleration);
            let values = self.velocity.iter_mut().zip(data.qvel()).zip(&self.acceleration);
            values.for_each(|((sum, qvel), acceleration)| *sum = qvel + acceleration);
            let velocities = [&self.velocity[..], data.qvel(), &self.acceleration];
            for (motions, velocity) in self.motions.iter_mut().zip(velocities) {
                motions.resize(model.nbody(), [[0.0; 6]; 2]);
                bodies.motions(data, tree, (velocity, &self.zeros), motions);
            }
        } else if has_implicit_damping(model) || (changes_damping && may_damp) {
            self.kind = Kind::Euler;
            self.inertia.factor(data, tree);
            let values = self.spread.as_mut_slice().iter_mut().zip(model.dof_damping()).zip(data.qacc());
            values.for_each(|((spread, damping), qacc)| *spread = h * damping * qacc);
            self.inertia.solve(tree, &mut self.spread);
            self.acceleration.iter_mut().zip(self.spread.as_slice()).for_each(|(value, spread)| *value -= spread);
        }
        let (qvel, acceleration) = (data.qvel(), &self.acceleration);
        rotation::differentiate(model, |dof| qvel[dof] + h * acceleration[dof], &mut self.rotations);
        Ok(())
    }

    /// Returns w and s for the derivatives of the terms.
    pub(super) fn damping(&self) -> Option<Damping<'_>> {
        match (self.kind, &self.implicit) {
            (Kind::Implicit, Some(step)) => Some(Damping {
                spread: step.spread.as_slice(),
                acceleration: &step.acceleration,
                motions: Some([&self.motions[0], &self.motions[1], &self.motions[2]]),
            }),
            (Kind::Euler, _) => {
                Some(Damping { spread: self.spread.as_slice(), acceleration: &self.acceleration, motions: None })
            }
            _ => None,
        }
    }

    /// Returns w, unless it is zero.
    pub(in crate::derivative) fn spread(&self) -> Option<&[f64]> {
        self.damping().map(|damping| damping.spread)
    }

    /// Returns `true` if Q depends on more than damping.
    pub(in crate::derivative) fn is_implicit(&self) -> bool {
        self.kind == Kind::Implicit
    }

    /// Replaces X by ∂v', given ∂M w + h ∂Q s, which is overwritten.
    pub(super) fn finish(&self, data: &Data, tree: &Tree, derivative: &mut Matrix, spread_change: &mut Matrix) {
        let model = data.model();
        let h = model.raw().opt.timestep;
        match (self.kind, &self.implicit) {
            (Kind::Implicit, Some(step)) => {
                for dof in 0..model.nv() {
                    add_product(spread_change.row_mut(dof), derivative, step.forces.row(dof), -h);
                }
                solve_lu(&step.factor, spread_change);
            }
            (Kind::Euler, _) => {
                for (dof, &damping) in model.dof_damping().iter().enumerate() {
                    if damping != 0.0 {
                        add(spread_change.row_mut(dof), derivative.row(dof), h * damping);
                    }
                }
                self.inertia.solve(tree, spread_change);
            }
            _ => spread_change.as_mut_slice().fill(0.0),
        }
        let values = derivative.as_mut_slice().iter_mut().zip(spread_change.as_slice());
        values.for_each(|(value, spread)| *value = h * (spread - *value));
    }

    /// Writes the derivatives of the next positions, given those of the next velocities.
    pub(super) fn write_positions(&self, h: f64, velocities: &Matrix, result: &mut Matrix) {
        for dof in 0..velocities.nrows() {
            let position = result.row_mut(dof).iter_mut().zip(velocities.row(dof));
            position.for_each(|(position, velocity)| *position = h * velocity);
        }
        for Rotation { dof, by_velocity, .. } in &self.rotations {
            for axis in 0..3 {
                let position = result.row_mut(dof + axis);
                position.fill(0.0);
                for other in 0..3 {
                    add(position, velocities.row(dof + other), h * by_velocity[3 * axis + other]);
                }
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
