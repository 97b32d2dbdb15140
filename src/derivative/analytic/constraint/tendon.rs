//! Derivatives of the moment arms of spatial tendons, in the rows of their limits and their
//! friction loss.
//!
//! The moment arms J of a tendon change by `∂J`, so the residual of a row changes by
//! `±(∂J) (a + B v)`. The change `(∂J)ᵀ f` of the force is a part of the change for all tensions
//! (`../tendon.rs`).

use mujoco_sys::{mjCNSTR_FRICTION_TENDON, mjCNSTR_LIMIT_TENDON};

use super::rows::Rows;
use crate::data::Data;
use crate::derivative::analytic::tendon::{Tendons, is_fixed};
use crate::ffi;
use crate::numerics::linear_algebra::add;

/// Adds the change of the moment arms to the derivatives of a row, if the row belongs to a spatial
/// tendon.
pub(super) fn differentiate(rows: &mut Rows, data: &Data, tendons: &mut Tendons, row: usize) {
    if ![mjCNSTR_LIMIT_TENDON, mjCNSTR_FRICTION_TENDON].contains(&(data.efc_type()[row] as u32)) {
        return;
    }
    let tendon = ffi::size(data.efc_id()[row]);
    if is_fixed(data.model(), tendon) {
        return;
    }
    let sign = tendons.sign(data, tendon, row);
    let damping = data.efc_KBIP()[row][1];
    // A moment arm of zero may have another derivative.
    rows.widen(0..data.model().nv());
    let values = rows.residual.row_mut(0);
    add(values, tendons.acceleration_change(tendon), sign);
    add(values, tendons.velocity_change(tendon), sign * damping);
}
