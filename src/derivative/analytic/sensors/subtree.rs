//! Derivatives of the centre of mass, its velocity, and the angular momentum of a subtree.
//!
//! Degree of freedom j moves a part of the subtree: all of it, or the bodies below j. Let I be the
//! inertia of this part, and h its momentum, about the fixed reference point of the tree. With the
//! change ψ_j of velocities (`rigid_body.rs`), and the mass m, the centre of mass c and the linear
//! momentum p of the whole subtree,
//!
//! ```text
//! ∂h/∂q_j = S_j ×* h + I ψ_j,      ∂h/∂v_j = I S_j,      ∂c/∂q_j = (I S_j)_linear/m
//! ```
//!
//! The velocity is h_linear/m. The angular momentum about c is `h_angular − r × h_linear`, with r
//! from the reference point to c, and changes also by `−∂c × p`. (D. Orin, A. Goswami and S.-H.
//! Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 2013.)

use super::{Point, Rows};
use crate::data::Data;
use crate::enums::SensorType;
use crate::ffi;
use crate::model::Model;
use crate::numerics::spatial::{
    Spatial, Vec3, add, add_scaled, angular, cross, cross_force, linear, momentum, scale, sub,
};

/// Sums the momenta of subtrees, `(nbody)`. For the world only the linear part has a meaning,
/// because trees have different reference points.
pub(super) fn sum_momenta(data: &Data, momenta: &mut [Spatial]) {
    for ((sum, inertia), velocity) in momenta.iter_mut().zip(data.cinert()).zip(data.cvel()) {
        *sum = momentum(inertia, velocity);
    }
    for body in (1..momenta.len()).rev() {
        let momentum = momenta[body];
        add_scaled(&mut momenta[ffi::size(data.model().body_parentid()[body])], &momentum, 1.0);
    }
}

pub(super) fn differentiate(point: Point<'_>, sensor: usize, momenta: &[Spatial], rows: &mut Rows<'_>) {
    let Point { data, tree, bodies, .. } = point;
    let model = data.model();
    let nv = model.nv();
    let kind = SensorType::from_raw(model.sensor_type()[sensor]);
    let body = ffi::size(model.sensor_objid()[sensor]);
    let inverse_mass = 1.0 / model.body_subtreemass()[body];
    let mut add_dof = |dof: usize, part: usize| {
        let (axis, inertia) = (&data.cdof()[dof], bodies.subtree_inertia(part));
        let by_velocity = momentum(inertia, axis);
        let by_position = add(&cross_force(axis, &momenta[part]), &momentum(inertia, bodies.velocity_change(dof)));
        let shift = scale(&linear(&by_velocity), inverse_mass);
        let [by_position, by_velocity]: [Vec3; 2] = match kind {
            Some(SensorType::SubtreeCom) => [shift, [0.0; 3]],
            Some(SensorType::SubtreeLinearVelocity) => {
                [&by_position, &by_velocity].map(|change| scale(&linear(change), inverse_mass))
            }
            _ => {
                let root = ffi::size(model.body_rootid()[part]);
                let arm = sub(&data.subtree_com()[body], &data.subtree_com()[root]);
                let about_centre = |change: &Spatial| sub(&angular(change), &cross(&arm, &linear(change)));
                let carried = cross(&shift, &linear(&momenta[body]));
                [sub(&about_centre(&by_position), &carried), about_centre(&by_velocity)]
            }
        };
        rows.add(dof, &by_position);
        rows.add(nv + dof, &by_velocity);
    };
    for dof in 0..nv {
        let part = ffi::size(model.dof_bodyid()[dof]);
        if is_below(model, part, body) {
            add_dof(dof, part);
        }
    }
    for dof in tree.chain(tree.last[body]).filter(|&dof| ffi::size(model.dof_bodyid()[dof]) != body) {
        add_dof(dof, body);
    }
}

/// Largest deviation of the mass of a subtree from the sum of masses, relative to the sum.
const MASS_TOLERANCE: f64 = 1e-12;

/// Returns `true` if the masses of the subtrees below a body are sums of masses. After an edit of
/// masses they are not, until the constants are updated. The engine computes angular momenta from
/// both, and 2.2.2 also centres of mass.
pub(super) fn has_sums(model: &Model, root: usize) -> bool {
    let (masses, subtrees, parents) = (model.body_mass(), model.body_subtreemass(), model.body_parentid());
    let children = |body: usize| (body + 1..model.nbody()).filter(move |&child| ffi::size(parents[child]) == body);
    (root..model.nbody()).filter(|&body| is_below(model, body, root)).all(|body| {
        let sum = masses[body] + children(body).map(|child| subtrees[child]).sum::<f64>();
        (subtrees[body] - sum).abs() <= MASS_TOLERANCE * sum.abs()
    })
}

/// Returns `true` if a body is in the subtree of another.
fn is_below(model: &Model, mut body: usize, root: usize) -> bool {
    // Parents have smaller indices.
    while body > root {
        body = ffi::size(model.body_parentid()[body]);
    }
    body == root
}
