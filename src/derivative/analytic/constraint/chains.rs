//! Degrees of freedom that move either of two bodies of a constraint.

use std::ops::Range;

use crate::derivative::analytic::tree::Tree;
use crate::matrix::Matrix;
use crate::numerics::spatial::{Spatial, Vec3, add_scaled, cross_force, cross_motion, dot, sub};

/// Degree of freedom that moves at least one of the bodies.
#[derive(Clone, Copy, Debug)]
pub(in crate::derivative::analytic) struct MovingDof {
    pub(in crate::derivative::analytic) dof: usize,
    pub(in crate::derivative::analytic) axis: Spatial,
    /// True for the bodies that it moves.
    pub(in crate::derivative::analytic) moves: [bool; 2],
    /// Velocities of the bodies by the degrees of freedom before its group.
    before: [Spatial; 2],
}

/// Degrees of freedom that move either of two bodies, and the velocities of the bodies.
#[derive(Debug)]
pub(in crate::derivative::analytic) struct Chains {
    /// In ascending order.
    pub(in crate::derivative::analytic) dofs: Vec<MovingDof>,
    /// Velocities of the bodies, each about the reference point of its tree.
    pub(super) velocities: [Spatial; 2],
}

impl Chains {
    pub(in crate::derivative::analytic) fn new(nv: usize) -> Self {
        Self { dofs: Vec::with_capacity(nv), velocities: [[0.0; 6]; 2] }
    }

    /// Collects the degrees of freedom that move the bodies, and computes the velocities for joint
    /// velocities `rate`.
    pub(in crate::derivative::analytic) fn set(
        &mut self,
        tree: &Tree,
        axes: &[Spatial],
        bodies: [usize; 2],
        rate: impl Fn(usize) -> f64,
    ) {
        self.dofs.clear();
        let mut next = bodies.map(|body| tree.last[body]);
        // Indices decrease along both chains towards the root, so the chains are merged by their
        // largest index.
        while let Some(dof) = next[0].max(next[1]) {
            let moves = next.map(|next| next == Some(dof));
            self.dofs.push(MovingDof { dof, axis: axes[dof], moves, before: [[0.0; 6]; 2] });
            for next in &mut next {
                if *next == Some(dof) {
                    *next = tree.parent[dof];
                }
            }
        }
        self.dofs.reverse();
        let mut velocities = [[0.0; 6]; 2];
        let mut before = velocities;
        let mut group = None;
        for moving in &mut self.dofs {
            if group != Some(tree.group[moving.dof]) {
                group = Some(tree.group[moving.dof]);
                before = velocities;
            }
            moving.before = before;
            for (velocity, moves) in velocities.iter_mut().zip(moving.moves) {
                if moves {
                    add_scaled(velocity, &moving.axis, rate(moving.dof));
                }
            }
        }
        self.velocities = velocities;
    }

    /// Returns the range of degrees of freedom that contains all of the chains.
    pub(super) fn span(&self) -> Range<usize> {
        match (self.dofs.first(), self.dofs.last()) {
            (Some(first), Some(last)) => first.dof..last.dof + 1,
            _ => 0..0,
        }
    }

    /// Returns the change of the velocity of a body, `(∂J) w`, which a degree of freedom causes
    /// because it turns the axes of its own group and of those below it.
    pub(super) fn velocity_change(&self, moving: &MovingDof, side: usize) -> Spatial {
        if moving.moves[side] {
            cross_motion(&moving.axis, &sub(&self.velocities[side], &moving.before[side]))
        } else {
            [0.0; 6]
        }
    }

    /// Subtracts `sign · ∂(Jᵀ W)/∂q_j` from column j of `residual`, where J is the Jacobian of a
    /// body, W a force vector on it, and `change` the derivative of W.
    pub(in crate::derivative::analytic) fn subtract_force(
        &self,
        tree: &Tree,
        moving: &MovingDof,
        side: usize,
        sign: f64,
        (force, change): (&Spatial, &Spatial),
        residual: &mut Matrix,
    ) {
        let j = moving.dof;
        // The axes of the group and of those below it turn, as if the force turned backwards.
        let (turned, first) = if moving.moves[side] {
            (sub(change, &cross_force(&moving.axis, force)), tree.groups[tree.group[j]].first)
        } else {
            (*change, usize::MAX)
        };
        for other in self.dofs.iter().filter(|other| other.moves[side]) {
            let change = if other.dof >= first { &turned } else { change };
            residual[(other.dof, j)] -= sign * dot(&other.axis, change);
        }
    }
}

/// Returns the product of a row-major `(3, 3)` matrix, given as rows, and a vector.
pub(super) fn multiply(rows: &[Vec3; 3], vector: &Vec3) -> Vec3 {
    rows.map(|row| dot(&row, vector))
}

/// Returns the product of the transpose of a matrix, given as rows, and a vector.
pub(super) fn multiply_transposed(rows: &[Vec3; 3], vector: &Vec3) -> Vec3 {
    let mut result = [0.0; 3];
    for (row, &factor) in rows.iter().zip(vector) {
        add_scaled(&mut result, row, factor);
    }
    result
}
