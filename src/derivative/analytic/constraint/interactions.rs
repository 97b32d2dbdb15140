//! Derivatives of the constraint forces on subtrees, for sensors of the force between a body and
//! its parent.
//!
//! Contacts, `connect` and `weld` constraints between a subtree and the rest of the model exert a
//! force vector `X = ±Σ f_r D_r` on it, where D_r is the force vector of a unit force of row r on
//! a body inside, about the reference point of its tree. So `∂X = ±Σ (f_r ∂D_r + D_r ∂f_r)`, with
//! ∂f from `rows.rs`. Forces between two bodies of the subtree cancel if they act at one point. The
//! points of a `connect` or `weld` constraint differ while it is violated.

use super::rows::{MAX_ROWS, Rows};
use crate::data::Data;
use crate::enums::SensorType;
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::linear_algebra::add;
use crate::numerics::spatial::{Spatial, add_scaled};

/// Constraint forces on subtrees, with their derivatives.
#[derive(Debug)]
pub(in crate::derivative::analytic) struct Interactions {
    /// Roots of the subtrees: the bodies of force and torque sensors, each once.
    roots: Vec<usize>,
    /// `(roots, nbody)`: true for bodies of the subtree.
    contains: Vec<bool>,
    /// `(roots)`: X.
    forces: Vec<Spatial>,
    /// `(6 roots, 3 nv)`: ∂X by positions, velocities and accelerations.
    derivatives: Matrix,
    /// False if no sensor is wanted.
    is_wanted: bool,
    /// `(roots)`: true for the sides of the present constraint that are in the subtree.
    sides: Vec<[bool; 2]>,
    /// Signs of the forces on the two sides.
    signs: [f64; 2],
    /// D of each row and side.
    directions: [[Spatial; 2]; MAX_ROWS],
    /// `(3 nv)`: ∂f of a row.
    row: Vec<f64>,
}

impl Interactions {
    pub(super) fn new(model: &Model) -> Self {
        let kind = |sensor: usize| SensorType::from_raw(model.sensor_type()[sensor]);
        let is_force = |&sensor: &usize| matches!(kind(sensor), Some(SensorType::Force | SensorType::Torque));
        let body = |sensor: usize| ffi::size(model.site_bodyid()[ffi::size(model.sensor_objid()[sensor])]);
        let mut roots: Vec<usize> = (0..model.nsensor()).filter(is_force).map(body).collect();
        roots.sort_unstable();
        roots.dedup();
        let mut contains = Vec::with_capacity(roots.len() * model.nbody());
        for &root in &roots {
            let first = contains.len();
            for body in 0..model.nbody() {
                // Parents have smaller indices.
                let is_inside = body == root || body > root && contains[first + ffi::size(model.body_parentid()[body])];
                contains.push(is_inside);
            }
        }
        Self {
            forces: vec![[0.0; 6]; roots.len()],
            derivatives: Matrix::zeros(6 * roots.len(), 3 * model.nv()),
            is_wanted: false,
            sides: vec![[false; 2]; roots.len()],
            signs: [0.0; 2],
            directions: [[[0.0; 6]; 2]; MAX_ROWS],
            row: vec![0.0; 3 * model.nv()],
            roots,
            contains,
        }
    }

    /// Starts the sums of a state.
    pub(super) fn clear(&mut self, is_wanted: bool) {
        self.is_wanted = is_wanted && !self.roots.is_empty();
        if self.is_wanted {
            self.forces.fill([0.0; 6]);
            self.derivatives.as_mut_slice().fill(0.0);
            self.sides.fill([false; 2]);
        }
    }

    /// Starts a constraint between two bodies, with the signs of the forces on them. Returns
    /// `false` if no sensor measures it.
    pub(super) fn begin(&mut self, bodies: [usize; 2], signs: [f64; 2]) -> bool {
        if !self.is_wanted {
            return false;
        }
        self.signs = signs;
        let nbody = self.contains.len() / self.roots.len();
        for (side, contains) in self.sides.iter_mut().zip(self.contains.chunks_exact(nbody)) {
            *side = bodies.map(|body| contains[body]);
        }
        self.is_measured()
    }

    /// Returns `true` if a sensor measures the present constraint.
    fn is_measured(&self) -> bool {
        self.sides.as_flattened().contains(&true)
    }

    /// Sets D of a row.
    pub(super) fn set_direction(&mut self, row: usize, directions: [Spatial; 2]) {
        self.directions[row] = directions;
    }

    /// Adds the changes `Σ f_r ∂D_r` by the position of a degree of freedom.
    pub(super) fn add_change(&mut self, dof: usize, changes: [Spatial; 2]) {
        for (index, sides) in self.sides.iter().enumerate() {
            for side in (0..2).filter(|&side| sides[side]) {
                for (component, value) in changes[side].into_iter().enumerate() {
                    self.derivatives[(6 * index + component, dof)] += self.signs[side] * value;
                }
            }
        }
    }

    /// Adds the forces of a constraint, whose rows are loaded, and `Σ D_r ∂f_r`. Does nothing
    /// unless it was started.
    pub(super) fn finish(&mut self, data: &Data, rows: &mut Rows) {
        if !self.is_wanted || !self.is_measured() {
            return;
        }
        for row in 0..rows.count {
            self.row.fill(0.0);
            rows.add_force(data, row, &mut self.row);
            for (index, sides) in self.sides.iter().enumerate() {
                for side in (0..2).filter(|&side| sides[side]) {
                    let direction = &self.directions[row][side];
                    add_scaled(
                        &mut self.forces[index],
                        direction,
                        self.signs[side] * data.efc_force()[rows.first + row],
                    );
                    for (component, value) in direction.iter().enumerate() {
                        add(self.derivatives.row_mut(6 * index + component), &self.row, self.signs[side] * value);
                    }
                }
            }
        }
        self.sides.fill([false; 2]);
    }

    /// Returns X of the subtree of a body.
    pub(in crate::derivative::analytic) fn force(&self, body: usize) -> &Spatial {
        &self.forces[self.index(body)]
    }

    /// Returns ∂X of the subtree of a body by an input: a position, a velocity or an acceleration.
    pub(in crate::derivative::analytic) fn change(&self, body: usize, input: usize) -> Spatial {
        let first = 6 * self.index(body);
        std::array::from_fn(|component| self.derivatives[(first + component, input)])
    }

    /// Returns `true` if a body is in the subtree of `root`, the body of a sensor.
    pub(in crate::derivative::analytic) fn is_inside(&self, body: usize, root: usize) -> bool {
        let nbody = self.contains.len() / self.roots.len();
        self.contains[self.index(root) * nbody + body]
    }

    fn index(&self, body: usize) -> usize {
        self.roots.binary_search(&body).expect("Bug: a body without force and torque sensors")
    }
}
