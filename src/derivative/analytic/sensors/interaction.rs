//! Derivatives of force and torque sensors.
//!
//! They measure the force vector `W = F − X − A` that the parent exerts on a body, in the axes and
//! about the origin of a site. F is the force vector of inverse dynamics for the bodies of its
//! subtree (`../rigid_body.rs`), X the force vector of the constraints between them and the others
//! (`../constraint/interactions.rs`), and A the force vector of `xfrc_applied` on them. With I, B
//! and F of the bodies that degree of freedom j moves within the subtree,
//!
//! ```text
//! ∂F/∂q_j = I χ_j + B ψ_j + S_j ×* F,      ∂F/∂v_j = I σ_j + B S_j,      ∂F/∂a_j = I S_j
//! ```
//!
//! in the world's axes. If j moves the site, its axes see `∂W − S_j ×* W`. The point of application
//! of an applied force moves by `∂x`, which changes the torque by `∂x × f`.

use super::pose::Pose;
use super::{Point, Rows};
use crate::enums::SensorType;
use crate::ffi;
use crate::numerics::linear_algebra::add;
use crate::numerics::spatial::{
    Spatial, Vec3, add_scaled, cross, cross_force, linear, scale, spatial, sub, velocity_at, wrench,
};

pub(super) fn differentiate(point: Point<'_>, sensor: usize, rows: &mut Rows<'_>) {
    let Point { data, tree, bodies, interactions, deceleration, .. } = point;
    let model = data.model();
    let nv = model.nv();
    let pose = Pose::of_object(data, sensor);
    let root = pose.body;
    let is_torque = SensorType::from_raw(model.sensor_type()[sensor]) == Some(SensorType::Torque);
    let measured = |change: &Spatial| pose.to_local(&if is_torque { pose.torque(change) } else { linear(change) });

    let applied = || {
        (1..model.nbody()).filter(|&body| interactions.is_inside(body, root)).filter_map(|body| {
            let [fx, fy, fz, tx, ty, tz] = data.xfrc_applied()[body];
            let arm = sub(&data.xipos()[body], &data.subtree_com()[ffi::size(model.body_rootid()[body])]);
            ([fx, fy, fz, tx, ty, tz] != [0.0; 6]).then_some((body, arm, [fx, fy, fz], [tx, ty, tz]))
        })
    };
    let mut total = sub(bodies.subtree_force(root), interactions.force(root));
    for (_, arm, force, torque) in applied() {
        add_scaled(&mut total, &wrench(&torque, &force, &arm), -1.0);
    }

    for dof in 0..nv {
        let axis = &data.cdof()[dof];
        let moves = |body: usize| tree.chain(tree.last[body]).any(|other| other == dof);
        let own = ffi::size(model.dof_bodyid()[dof]);
        let moves_site = moves(root);
        let moved = if moves_site { Some(root) } else { interactions.is_inside(own, root).then_some(own) };
        let mut changes: [Spatial; 3] =
            [0, nv, 2 * nv].map(|first| scale(&interactions.change(root, first + dof), -1.0));
        let [by_position, by_velocity, by_acceleration] = &mut changes;
        if let Some(moved) = moved {
            let (chi, sigma) = bodies.acceleration_changes(dof);
            add_scaled(by_position, &bodies.subtree_change(moved, chi, bodies.velocity_change(dof)), 1.0);
            add_scaled(by_position, &cross_force(axis, bodies.subtree_force(moved)), 1.0);
            add_scaled(by_velocity, &bodies.subtree_change(moved, sigma, axis), 1.0);
            add_scaled(by_acceleration, &bodies.subtree_change(moved, axis, &[0.0; 6]), 1.0);
        }
        for (_, arm, force, _) in applied().filter(|&(body, ..)| moves(body)) {
            let torque: Vec3 = cross(&velocity_at(axis, &arm), &force);
            add_scaled(by_position, &spatial(&torque, &[0.0; 3]), -1.0);
        }
        if moves_site {
            add_scaled(by_position, &cross_force(axis, &total), -1.0);
        }
        rows.add(dof, &measured(by_position));
        rows.add(nv + dof, &measured(by_velocity));
        for (component, value) in measured(by_acceleration).into_iter().enumerate() {
            add(rows.row_mut(component), deceleration.row(dof), -value);
        }
    }
}
