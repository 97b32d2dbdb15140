//! Derivatives of contacts with frictionless, pyramidal and elliptic cones.
//!
//! The base rows of a contact are the relative velocities of the bodies at its position p, in its
//! frame E (rows n, t₁, t₂): three of translation, three of rotation, of which the first `dim`
//! exist. The rows of an elliptic cone are the base rows; the rows of a pyramid are
//! `normal ± friction · tangent`, so their derivatives are the same combinations.
//!
//! Degree of freedom j changes the contact by the twist of the bodies that it moves: if it moves
//! both, the contact turns with them; else the relative pose of the geoms changes
//! (`contact_geometry.rs`). For the relative velocity u and angular velocity o of the rates
//! `w = a + B v`, and the contact force `φ = Eᵀ f`, torque `θ = Eᵀ f'` in the world,
//!
//! ```text
//! (∂J) w = ∂E u + E ∂u,  ∂E o + E ∂o        ∂u = Σ ± ∂V(p) + o × ∂p
//! (∂J)ᵀ f: wrenches θ + r × φ, φ with the changes ∂θ + ∂p × φ + r × ∂φ, ∂φ
//! ```

use mujoco_sys::mjContact;

use super::Constraints;
use super::chains::{multiply, multiply_transposed};
use super::contact_geometry::ContactGeometry;
use super::rows::{MAX_ROWS, Rows, Slopes};
use crate::data::Data;
use crate::derivative::analytic::tree::Tree;
use crate::derivative::newton::contacts;
use crate::ffi;
use crate::matrix::Matrix;
use crate::numerics::spatial::{
    Spatial, Vec3, add, add_scaled, angular, cross, dot, scale, spatial, sub, velocity_at, wrench,
};

/// Smallest length of the projection of y from which the engine makes the first tangent.
const MIN_PROJECTION: f64 = 1e-6;

/// Signs of the two bodies in the relative velocity, and of the forces on them.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// Returns the dimension of a contact.
pub(super) fn dimension(data: &Data, contact: usize) -> usize {
    ffi::size(contacts(data)[contact].dim)
}

/// Adds the derivatives of a contact to the derivatives of the rows, and the derivatives of its
/// Jacobian to the residual. Returns `false` if the tangents of the contact are not differentiable.
pub(super) fn differentiate(
    constraints: &mut Constraints,
    data: &Data,
    tree: &Tree,
    row: usize,
    count: usize,
    geometry: &ContactGeometry,
    residual: &mut Matrix,
) -> bool {
    let model = data.model();
    let contact = &contacts(data)[ffi::size(data.efc_id()[row])];
    let Some(frame) = Frame::new(contact, geometry) else { return false };
    let bodies = [contact.geom1, contact.geom2].map(|geom| ffi::size(model.geom_bodyid()[ffi::size(geom)]));
    let arms = bodies.map(|body| sub(&contact.pos, &data.subtree_com()[ffi::size(model.body_rootid()[body])]));

    let Constraints { chains, rows, interactions, .. } = constraints;
    let damping = data.efc_KBIP()[row][1];
    chains.set(tree, data.cdof(), bodies, |dof| data.qacc()[dof] + damping * data.qvel()[dof]);
    rows.load(data, row, count, Some(chains.span()));
    let cone = Cone { dim: ffi::size(contact.dim), is_pyramidal: model.is_pyramidal(), friction: &contact.friction };
    let slopes = Slopes::of(data, row);

    let linear_velocity =
        sub(&velocity_at(&chains.velocities[1], &arms[1]), &velocity_at(&chains.velocities[0], &arms[0]));
    let angular_velocity = sub(&angular(&chains.velocities[1]), &angular(&chains.velocities[0]));
    let [base_force, base_torque] = cone.base_force(&data.efc_force()[row..row + count]);
    let force = multiply_transposed(&frame.axes, &base_force);
    let torque = multiply_transposed(&frame.axes, &base_torque);
    let wrenches = arms.map(|arm| wrench(&torque, &force, &arm));

    let is_measured = interactions.begin(bodies, SIGNS);
    if is_measured {
        for row in 0..count {
            let [force, torque] = cone.unit_force(row).map(|base| multiply_transposed(&frame.axes, &base));
            interactions.set_direction(row, arms.map(|arm| wrench(&torque, &force, &arm)));
        }
    }

    for moving in &chains.dofs {
        // Both arms are the same if the degree of freedom moves both bodies.
        let arm = if moving.moves[0] { &arms[0] } else { &arms[1] };
        let twist = spatial(&angular(&moving.axis), &velocity_at(&moving.axis, arm));
        let change = Change::new(geometry, &frame, moving.moves, &twist);

        let mut linear_change = cross(&angular_velocity, &change.position);
        let mut angular_change = [0.0; 3];
        for side in 0..2 {
            let velocity = chains.velocity_change(moving, side);
            add_scaled(&mut linear_change, &velocity_at(&velocity, &arms[side]), SIGNS[side]);
            add_scaled(&mut angular_change, &angular(&velocity), SIGNS[side]);
        }
        let base = [
            add(&multiply(&change.frame, &linear_velocity), &multiply(&frame.axes, &linear_change)),
            add(&multiply(&change.frame, &angular_velocity), &multiply(&frame.axes, &angular_change)),
        ];
        cone.write_column(rows, moving.dof, &base, slopes.residual * change.distance);
        rows.log_inertia[moving.dof] = slopes.log_inertia * change.distance;

        let force_change = multiply_transposed(&change.frame, &base_force);
        let torque_change = add(&multiply_transposed(&change.frame, &base_torque), &cross(&change.position, &force));
        let wrench_changes = arms.map(|arm| wrench(&torque_change, &force_change, &arm));
        for side in 0..2 {
            chains.subtract_force(tree, moving, side, SIGNS[side], (&wrenches[side], &wrench_changes[side]), residual);
        }
        if is_measured {
            interactions.add_change(moving.dof, wrench_changes);
        }
    }
    true
}

/// Frame of a contact, with the projection from which its tangents are made.
struct Frame {
    /// n, t₁ and t₂.
    axes: [Vec3; 3],
    /// `n · y`
    along: f64,
    /// `1 / |y − n (n · y)|`
    inverse_length: f64,
}

impl Frame {
    fn new(contact: &mjContact, geometry: &ContactGeometry) -> Option<Self> {
        let axes: [Vec3; 3] = std::array::from_fn(|row| std::array::from_fn(|i| contact.frame[3 * row + i]));
        let along = dot(&axes[0], &geometry.hint);
        let mut projection = geometry.hint;
        add_scaled(&mut projection, &axes[0], -along);
        let length = dot(&projection, &projection).sqrt();
        (length > MIN_PROJECTION).then(|| Self { axes, along, inverse_length: 1.0 / length })
    }
}

/// Derivatives of a contact by a degree of freedom.
struct Change {
    position: Vec3,
    frame: [Vec3; 3],
    distance: f64,
}

impl Change {
    fn new(geometry: &ContactGeometry, frame: &Frame, moves: [bool; 2], twist: &Spatial) -> Self {
        let by_twist = |rows: &[Spatial; 3]| rows.map(|row| dot(&row, twist));
        let (mut position, mut normal, mut hint) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        let mut distance = 0.0;
        // A motion of the first geom alone is a motion of both, minus one of the second.
        let relative = match moves {
            [false, true] => 1.0,
            [true, false] => -1.0,
            _ => 0.0,
        };
        if relative != 0.0 {
            position = scale(&by_twist(&geometry.position), relative);
            normal = scale(&by_twist(&geometry.normal), relative);
            distance = relative * dot(&geometry.distance, twist);
            if let Some(rows) = &geometry.hint_by_twist {
                hint = scale(&by_twist(rows), relative);
            }
        }
        let [n, first, _] = &frame.axes;
        if moves[0] {
            let turn = angular(twist);
            position = add(&position, &[twist[3], twist[4], twist[5]]);
            normal = add(&normal, &cross(&turn, n));
            if geometry.hint_by_twist.is_some() {
                hint = add(&hint, &cross(&turn, &geometry.hint));
            }
        }
        // The derivatives of y − n (n · y), of its direction, and of n × t₁.
        let mut tangent = hint;
        add_scaled(&mut tangent, &normal, -frame.along);
        add_scaled(&mut tangent, n, -(dot(&normal, &geometry.hint) + dot(n, &hint)));
        let along = dot(first, &tangent);
        add_scaled(&mut tangent, first, -along);
        let tangent = scale(&tangent, frame.inverse_length);
        let second = add(&cross(&normal, first), &cross(n, &tangent));
        Self { position, frame: [normal, tangent, second], distance }
    }
}

/// Relation of the rows of a contact to its base rows.
struct Cone<'a> {
    dim: usize,
    is_pyramidal: bool,
    friction: &'a [f64; 5],
}

impl Cone<'_> {
    /// Returns force and torque along the base rows.
    fn base_force(&self, forces: &[f64]) -> [Vec3; 2] {
        let mut base = [0.0; 6];
        if self.dim == 1 || !self.is_pyramidal {
            base[..self.dim].copy_from_slice(forces);
        } else {
            for (friction, edges) in forces.chunks_exact(2).enumerate() {
                base[0] += edges[0] + edges[1];
                base[friction + 1] += self.friction[friction] * (edges[0] - edges[1]);
            }
        }
        [0, 3].map(|start| std::array::from_fn(|i| base[start + i]))
    }

    /// Returns force and torque along the base rows of a unit force of a row.
    fn unit_force(&self, row: usize) -> [Vec3; 2] {
        let mut forces = [0.0; MAX_ROWS];
        forces[row] = 1.0;
        self.base_force(&forces[..self.row_count()])
    }

    fn row_count(&self) -> usize {
        if self.dim == 1 || !self.is_pyramidal { self.dim } else { 2 * (self.dim - 1) }
    }

    /// Writes a column of the derivatives of the rows' residuals, given the derivatives of the base
    /// rows and of the reference.
    fn write_column(&self, rows: &mut Rows, dof: usize, &[linear, angular]: &[Vec3; 2], reference: f64) {
        let base = spatial(&linear, &angular);
        if self.dim == 1 || !self.is_pyramidal {
            for (row, value) in base.into_iter().take(self.dim).enumerate() {
                // Only the normal row has a position.
                rows.residual[(row, dof)] = if row == 0 { value + reference } else { value };
            }
        } else {
            for friction in 1..self.dim {
                let tangent = self.friction[friction - 1] * base[friction];
                rows.residual[(2 * friction - 2, dof)] = base[0] + tangent + reference;
                rows.residual[(2 * friction - 1, dof)] = base[0] - tangent + reference;
            }
        }
    }
}
