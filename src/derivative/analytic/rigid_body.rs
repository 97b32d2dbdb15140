//! Derivatives of inverse dynamics of the rigid bodies, `τ = M a + c`, by positions and velocities.
//!
//! The recursive Newton–Euler algorithm is differentiated as in J. Carpentier and N. Mansard,
//! "Analytical derivatives of rigid body dynamics algorithms", RSS 2018, with the spatial vectors
//! of R. Featherstone, "Rigid Body Dynamics Algorithms", 2008. All vectors are in the world's axes,
//! about the fixed point that the engine's `cdof` and `cinert` use for the tree. The derivatives do
//! not depend on that point, so its own motion with the position does not matter.
//!
//! For a degree of freedom j of group g with the axis S (`cdof`), velocity and acceleration before
//! (⁻) and after (⁺) the group, where the acceleration of the world is minus gravity,
//!
//! ```text
//! ψ = v⁻ × S        χ = a⁻ × S + v⁻ × ψ        σ = (v⁻ + v⁺) × S
//! ```
//!
//! are the derivatives of the velocity by the position, of the acceleration by the position, and of
//! the acceleration by the velocity, of all bodies that j moves, in axes that move with j. A body
//! has the force F = I a + v ×* I v and the derivative B of F by v: B u = v ×* I u + u ×* I v − I
//! (v × u). By Jacobi's identity, it is zero for a translation u. With I, B and F summed over the
//! bodies that the lower of the two degrees of freedom moves,
//!
//! ```text
//! ∂τ_k/∂q_j = S_k · (I χ_j + B ψ_j  [+ S_j ×* F if k is above the group of j])
//! ∂τ_k/∂v_j = S_k · (I σ_j + B S_j)
//! ```

use super::tree::Tree;
use crate::data::Data;
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::spatial::{
    Inertia, Spatial, add, add_scaled, angular, cross_force, cross_motion, dot, momentum, sub,
};

/// Motion before and after a group.
#[derive(Clone, Copy, Debug, Default)]
struct Motion {
    velocity: Spatial,
    acceleration: Spatial,
}

/// Sums over the bodies of a subtree.
#[derive(Clone, Copy, Debug)]
struct Subtree {
    inertia: Inertia,
    /// Columns of B by rotations. Those by translations are zero.
    bias: [Spatial; 3],
    force: Spatial,
}

const EMPTY: Subtree = Subtree { inertia: [0.0; 10], bias: [[0.0; 6]; 3], force: [0.0; 6] };

impl Subtree {
    /// Returns the change of F by changes of the acceleration and the velocity of all bodies, `I ∂a
    /// + B ∂v`.
    #[inline]
    fn change(&self, acceleration: &Spatial, velocity: &Spatial) -> Spatial {
        let mut change = momentum(&self.inertia, acceleration);
        for (column, &rotation) in self.bias.iter().zip(velocity) {
            add_scaled(&mut change, column, rotation);
        }
        change
    }
}

/// Changes of motion that a degree of freedom causes.
#[derive(Clone, Copy, Debug, Default)]
struct Change {
    psi: Spatial,
    chi: Spatial,
    sigma: Spatial,
}

/// Derivatives of inverse dynamics, with their buffers.
#[derive(Debug)]
pub(super) struct RigidBodies {
    /// `(groups)`
    before: Vec<Motion>,
    after: Vec<Motion>,
    /// `(nbody)`
    subtrees: Vec<Subtree>,
    /// `(nv)`
    changes: Vec<Change>,
}

impl RigidBodies {
    pub(super) fn new(model: &Model, tree: &Tree) -> Self {
        let motion = vec![Motion::default(); tree.groups.len()];
        Self {
            before: motion.clone(),
            after: motion,
            subtrees: vec![EMPTY; model.nbody()],
            changes: vec![Change::default(); model.nv()],
        }
    }

    /// Writes `∂τ/∂q` at the given velocities and accelerations to the first nv columns of
    /// `result`, and `∂τ/∂v` to the next nv, where they are not zero.
    pub(super) fn differentiate(
        &mut self,
        data: &Data,
        tree: &Tree,
        gravity: [f64; 3],
        (qvel, qacc): (&[f64], &[f64]),
        result: &mut Matrix,
    ) {
        let (model, axes) = (data.model(), data.cdof());
        let nv = model.nv();
        self.sweep(tree, axes, Some(qvel), qacc, gravity);
        self.sum_subtrees::<true>(data, tree, gravity);
        let Self { before, after, subtrees, changes } = self;
        for ((change, axis), &group) in changes.iter_mut().zip(axes).zip(&tree.group) {
            let before = &before[group];
            change.psi = cross_motion(&before.velocity, axis);
            change.chi = cross_motion(&before.acceleration, axis);
            add_scaled(&mut change.chi, &cross_motion(&before.velocity, &change.psi), 1.0);
            change.sigma = cross_motion(&add(&before.velocity, &after[group].velocity), axis);
        }
        for (j, (axis, change)) in axes.iter().zip(&*changes).enumerate() {
            let subtree = &subtrees[ffi::size(model.dof_bodyid()[j])];
            let by_position = subtree.change(&change.chi, &change.psi);
            let by_velocity = subtree.change(&change.sigma, axis);
            let group = tree.groups[tree.group[j]];
            for (k, axis) in group.dofs().zip(&axes[group.dofs()]) {
                let row = result.row_mut(k);
                row[j] = dot(axis, &by_position);
                row[nv + j] = dot(axis, &by_velocity);
            }
            let with_force = add(&by_position, &cross_force(axis, &subtree.force));
            // Derivatives of τ_j by the degrees of freedom above: I and B act on them through their
            // products with S_j.
            let axis_inertia = momentum(&subtree.inertia, axis);
            let axis_bias = subtree.bias.map(|column| dot(&column, axis));
            for k in tree.chain(tree.parent[group.first]) {
                let row = result.row_mut(k);
                row[j] = dot(&axes[k], &with_force);
                row[nv + j] = dot(&axes[k], &by_velocity);
                let (above, row) = (&changes[k], result.row_mut(j));
                row[k] = dot(&axis_inertia, &above.chi) + dot(&axis_bias, &angular(&above.psi));
                row[nv + k] = dot(&axis_inertia, &above.sigma) + dot(&axis_bias, &angular(&axes[k]));
            }
        }
    }

    /// Returns ψ of a degree of freedom.
    pub(super) fn velocity_change(&self, dof: usize) -> &Spatial {
        &self.changes[dof].psi
    }

    /// Returns χ and σ of a degree of freedom.
    pub(super) fn acceleration_changes(&self, dof: usize) -> (&Spatial, &Spatial) {
        (&self.changes[dof].chi, &self.changes[dof].sigma)
    }

    /// Returns the acceleration of the bodies whose last degree of freedom is `dof`.
    pub(super) fn acceleration(&self, tree: &Tree, dof: usize) -> &Spatial {
        &self.after[tree.group[dof]].acceleration
    }

    /// Returns the sum F of the forces on the bodies of a subtree.
    pub(super) fn subtree_force(&self, body: usize) -> &Spatial {
        &self.subtrees[body].force
    }

    /// Returns the change of F by changes of the acceleration and the velocity of all bodies of a
    /// subtree, `I ∂a + B ∂v`.
    pub(super) fn subtree_change(&self, body: usize, acceleration: &Spatial, velocity: &Spatial) -> Spatial {
        self.subtrees[body].change(acceleration, velocity)
    }

    /// Returns the inertia of a subtree. The inertia of the world's subtree is unused.
    pub(super) fn subtree_inertia(&self, body: usize) -> &Inertia {
        &self.subtrees[body].inertia
    }

    /// Writes `∂(M a)/∂q` at constant `a` to the first nv columns of `result`, where it is not
    /// zero.
    ///
    /// This is the derivative of inverse dynamics without velocity and gravity.
    pub(super) fn differentiate_inertia(&mut self, data: &Data, tree: &Tree, qacc: &[f64], result: &mut Matrix) {
        let (model, axes) = (data.model(), data.cdof());
        self.sweep(tree, axes, None, qacc, [0.0; 3]);
        self.sum_subtrees::<false>(data, tree, [0.0; 3]);
        let Self { before, subtrees, changes, .. } = self;
        for ((change, axis), &group) in changes.iter_mut().zip(axes).zip(&tree.group) {
            change.chi = cross_motion(&before[group].acceleration, axis);
        }
        for (j, (axis, change)) in axes.iter().zip(&*changes).enumerate() {
            let subtree = &subtrees[ffi::size(model.dof_bodyid()[j])];
            let by_position = momentum(&subtree.inertia, &change.chi);
            let group = tree.groups[tree.group[j]];
            for (k, axis) in group.dofs().zip(&axes[group.dofs()]) {
                result[(k, j)] = dot(axis, &by_position);
            }
            let with_force = add(&by_position, &cross_force(axis, &subtree.force));
            let axis_inertia = momentum(&subtree.inertia, axis);
            for k in tree.chain(tree.parent[group.first]) {
                result[(k, j)] = dot(&axes[k], &with_force);
                result[(j, k)] = dot(&axis_inertia, &changes[k].chi);
            }
        }
    }

    /// Computes the velocity and the acceleration of each body, `(nbody)`, at the given velocities
    /// and accelerations without gravity.
    pub(super) fn motions(
        &mut self,
        data: &Data,
        tree: &Tree,
        (qvel, qacc): (&[f64], &[f64]),
        motions: &mut [[Spatial; 2]],
    ) {
        self.sweep(tree, data.cdof(), Some(qvel), qacc, [0.0; 3]);
        for (motion, last) in motions.iter_mut().zip(&tree.last) {
            *motion = last.map_or([[0.0; 6]; 2], |dof| {
                let Motion { velocity, acceleration } = self.after[tree.group[dof]];
                [velocity, acceleration]
            });
        }
    }

    /// Computes the motion before and after each group, from the root to the leaves. Velocities are
    /// zero without `qvel`.
    fn sweep(&mut self, tree: &Tree, axes: &[Spatial], qvel: Option<&[f64]>, qacc: &[f64], gravity: [f64; 3]) {
        for (index, group) in tree.groups.iter().enumerate() {
            let before = match group.parent {
                Some(parent) => self.after[parent],
                None => world(gravity),
            };
            let mut after = before;
            for dof in group.dofs() {
                add_scaled(&mut after.acceleration, &axes[dof], qacc[dof]);
                if let Some(qvel) = qvel {
                    add_scaled(&mut after.velocity, &axes[dof], qvel[dof]);
                }
            }
            if qvel.is_some() {
                let relative = sub(&after.velocity, &before.velocity);
                add_scaled(&mut after.acceleration, &cross_motion(&before.velocity, &relative), 1.0);
            }
            (self.before[index], self.after[index]) = (before, after);
        }
    }

    /// Sums inertia, force, and with `BIAS` also B over subtrees.
    fn sum_subtrees<const BIAS: bool>(&mut self, data: &Data, tree: &Tree, gravity: [f64; 3]) {
        let (model, inertias) = (data.model(), data.cinert());
        for (body, inertia) in inertias.iter().enumerate().skip(1) {
            let motion = tree.last[body].map_or_else(|| world(gravity), |dof| self.after[tree.group[dof]]);
            let subtree = &mut self.subtrees[body];
            subtree.inertia = *inertia;
            subtree.force = momentum(inertia, &motion.acceleration);
            if BIAS {
                let velocity = &motion.velocity;
                let momentum_of_body = momentum(inertia, velocity);
                add_scaled(&mut subtree.force, &cross_force(velocity, &momentum_of_body), 1.0);
                for (axis, column) in subtree.bias.iter_mut().enumerate() {
                    let mut unit = [0.0; 6];
                    unit[axis] = 1.0;
                    let turned =
                        add(&cross_force(velocity, &momentum(inertia, &unit)), &cross_force(&unit, &momentum_of_body));
                    *column = sub(&turned, &momentum(inertia, &cross_motion(velocity, &unit)));
                }
            }
        }
        for body in (1..model.nbody()).rev() {
            let parent = ffi::size(model.body_parentid()[body]);
            if parent > 0 {
                let subtree = self.subtrees[body];
                let sum = &mut self.subtrees[parent];
                add_scaled(&mut sum.inertia, &subtree.inertia, 1.0);
                add_scaled(&mut sum.force, &subtree.force, 1.0);
                if BIAS {
                    for (sum, column) in sum.bias.iter_mut().zip(&subtree.bias) {
                        add_scaled(sum, column, 1.0);
                    }
                }
            }
        }
    }
}

/// Returns the motion of the world: gravity acts as an acceleration upwards.
fn world(gravity: [f64; 3]) -> Motion {
    Motion { velocity: [0.0; 6], acceleration: [0.0, 0.0, 0.0, -gravity[0], -gravity[1], -gravity[2]] }
}
