//! Derivatives of the moment arms of actuators that act on a site, such as the propellers of a
//! drone.
//!
//! Such an actuator exerts its force times the `gear`, a force vector W that is fixed in the axes
//! of the site: `m_k = S_k · W`. If degree of freedom j moves the site, W turns with it,
//! `∂W = S_j ×* W`. So do the axes of the group of j and of those below it, for which the product
//! does not change. For k above the group of j
//!
//! ```text
//! ∂m_k/∂q_j = S_k · (S_j ×* W),
//! ```
//!
//! and zero for all others. The length of the actuator is zero. With a reference site, the actuator
//! has no formula here.

use super::super::tree::Tree;
use crate::data::Data;
use crate::enums::TransmissionType;
use crate::ffi;
use crate::model::Model;
use crate::numerics::spatial::{Vec3, cross_force, dot, sub, wrench};

/// Returns the site on which an actuator acts without a reference site.
pub(in crate::derivative::analytic) fn site_of(model: &Model, actuator: usize) -> Option<usize> {
    let is_site = model.actuator_trntype()[actuator] == TransmissionType::Site.raw();
    let [site, reference] = model.actuator_trnid()[actuator];
    (is_site && reference < 0).then(|| ffi::size(site))
}

/// Calls a function with each k, j and `∂m_k/∂q_j` that may not be zero.
pub(super) fn for_each_change(data: &Data, tree: &Tree, actuator: usize, mut call: impl FnMut(usize, usize, f64)) {
    let (model, axes) = (data.model(), data.cdof());
    let Some(site) = site_of(model, actuator) else { return };
    let [fx, fy, fz, tx, ty, tz] = model.actuator_gear()[actuator];
    let rotation = &data.site_xmat()[site];
    let to_world = |vector: Vec3| -> Vec3 {
        std::array::from_fn(|i| (0..3).map(|axis| rotation[3 * i + axis] * vector[axis]).sum())
    };
    let body = ffi::size(model.site_bodyid()[site]);
    let arm = sub(&data.site_xpos()[site], &data.subtree_com()[ffi::size(model.body_rootid()[body])]);
    let force = wrench(&to_world([tx, ty, tz]), &to_world([fx, fy, fz]), &arm);
    for j in tree.chain(tree.last[body]) {
        let turned = cross_force(&axes[j], &force);
        for k in tree.chain(tree.parent[tree.groups[tree.group[j]].first]) {
            call(k, j, dot(&axes[k], &turned));
        }
    }
}
