//! Derivatives of the generalised forces of `xfrc_applied`, whose forces and torques are constant
//! in the world.

use super::tree::Tree;
use crate::data::Data;
use crate::ffi;
use crate::matrix::Matrix;
use crate::numerics::spatial::{Vec3, cross, cross_motion, dot, sub, velocity_at, wrench};

/// Subtracts the derivatives of the applied forces by the position from the derivatives of the
/// residual.
pub(super) fn differentiate(data: &Data, tree: &Tree, residual: &mut Matrix) {
    let (model, axes) = (data.model(), data.cdof());
    for body in 1..model.nbody() {
        let [fx, fy, fz, tx, ty, tz] = data.xfrc_applied()[body];
        if [fx, fy, fz, tx, ty, tz] == [0.0; 6] {
            continue;
        }
        let force: Vec3 = [fx, fy, fz];
        let arm = sub(&data.xipos()[body], &data.subtree_com()[ffi::size(model.body_rootid()[body])]);
        let applied = wrench(&[tx, ty, tz], &force, &arm);
        for j in tree.chain(tree.last[body]) {
            // The point of application moves.
            let torque = cross(&velocity_at(&axes[j], &arm), &force);
            for k in tree.chain(tree.last[body]) {
                let axis = [axes[k][0], axes[k][1], axes[k][2]];
                let mut change = dot(&axis, &torque);
                // Along a chain, groups are in the order of their indices: j moves the axes of its
                // own group and of later ones.
                if tree.group[j] <= tree.group[k] {
                    change += dot(&cross_motion(&axes[j], &axes[k]), &applied);
                }
                residual[(k, j)] -= change;
            }
        }
    }
}
