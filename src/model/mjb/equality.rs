//! Equality constraints: which objects each type ties together.

use mujoco_sys::{mjEQ_CONNECT, mjEQ_JOINT, mjEQ_TENDON, mjEQ_WELD, mjJNT_HINGE, mjJNT_SLIDE};

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{all_bytes, all_in, ids, is_in, size_is};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    // The type after the last one here, `mjEQ_DISTANCE`, has a name but no implementation.
    all_in(view, field::eq_type, 0..=mjEQ_TENDON.into())?;
    all_bytes(view, field::eq_active, 1)?;
    let mut rows = 0;
    for (i, kind) in view.values(field::eq_type).enumerate() {
        // The compiler counts seven rows for a weld, which makes six.
        let (least_second, count, added) = match kind as u32 {
            mjEQ_CONNECT => (0, view.size(size::nbody), 3),
            mjEQ_WELD => (0, view.size(size::nbody), 7),
            mjEQ_JOINT => (-1, view.size(size::njnt), 1),
            _ => (-1, view.size(size::ntendon), 1),
        };
        rows += added;
        is_in(view, field::eq_obj1id, i, ids(count))?;
        is_in(view, field::eq_obj2id, i, least_second..=count as i64 - 1)?;
        let (one, other) = (view.get(field::eq_obj1id, i), view.get(field::eq_obj2id, i));
        if one == other {
            return Err(Invalid::element(field::eq_obj2id.name(), i, other, "the first object is the same"));
        }
        if kind as u32 == mjEQ_JOINT {
            scalar_joint(view, field::eq_obj1id, i)?;
            scalar_joint(view, field::eq_obj2id, i)?;
        }
    }
    size_is(view, size::nemax, rows, "the rows of all equality constraints")
}

/// A joint that has a single position, if it is one.
fn scalar_joint(view: &View<'_>, field: Field<i32>, i: usize) -> Result<(), Invalid> {
    let Ok(joint) = usize::try_from(view.get(field, i)) else { return Ok(()) };
    match view.get(field::jnt_type, joint) as u32 {
        mjJNT_SLIDE | mjJNT_HINGE => Ok(()),
        _ => Err(Invalid::element(field.name(), i, joint, "only slide and hinge joints can be tied together")),
    }
}
