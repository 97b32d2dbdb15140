//! What is attached to bodies: geoms, sites, cameras and lights.

use mujoco_sys::{mjCAMLIGHT_TARGETBODYCOM, mjGEOM_BOX, mjGEOM_HFIELD, mjGEOM_MESH, mjGEOM_PLANE, mjGEOM_SPHERE};

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{all_bytes, all_ids, all_ids_or_none, all_in, ids, is, is_in, size_is};
use super::view::View;

/// 0, or the same as the body's frame (1) or inertial frame (2).
const LAST_SAMEFRAME: u8 = 2;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    geoms(view)?;

    // The engine computes the distance to a site's zone with its geoms' code, which knows no others for rays.
    all_in(view, field::site_type, mjGEOM_SPHERE.into()..=mjGEOM_BOX.into())?;
    all_ids(view, field::site_bodyid, view.size(size::nbody))?;
    all_ids_or_none(view, field::site_matid, view.size(size::nmat))?;
    all_bytes(view, field::site_sameframe, LAST_SAMEFRAME)?;

    for (mode, body, target) in [
        (field::cam_mode, field::cam_bodyid, field::cam_targetbodyid),
        (field::light_mode, field::light_bodyid, field::light_targetbodyid),
    ] {
        all_in(view, mode, 0..=mjCAMLIGHT_TARGETBODYCOM.into())?;
        all_ids(view, body, view.size(size::nbody))?;
        // A camera may aim at a body without having one: the engine then leaves it as it is.
        all_ids_or_none(view, target, view.size(size::nbody))?;
    }
    all_bytes(view, field::light_directional, 1)?;
    all_bytes(view, field::light_castshadow, 1)?;
    all_bytes(view, field::light_active, 1)
}

fn geoms(view: &View<'_>) -> Result<(), Invalid> {
    bodies(view)?;
    all_in(view, field::geom_type, mjGEOM_PLANE.into()..=mjGEOM_MESH.into())?;
    condim(view, field::geom_condim)?;
    all_ids_or_none(view, field::geom_matid, view.size(size::nmat))?;
    all_bytes(view, field::geom_sameframe, LAST_SAMEFRAME)?;
    for (i, kind) in view.values(field::geom_type).enumerate() {
        match kind as u32 {
            mjGEOM_HFIELD => is_in(view, field::geom_dataid, i, ids(view.size(size::nhfield)))?,
            mjGEOM_MESH => is_in(view, field::geom_dataid, i, ids(view.size(size::nmesh)))?,
            _ => is(view, field::geom_dataid, i, -1, "since only meshes and height fields have data")?,
        }
        let body = view.get(field::geom_bodyid, i) as usize;
        if matches!(kind as u32, mjGEOM_PLANE | mjGEOM_HFIELD) && view.get(field::body_weldid, body) != 0 {
            let wanted = format!("body {body} moves, and planes and height fields cannot");
            return Err(Invalid::element(field::geom_type.name(), i, kind, wanted));
        }
    }
    Ok(())
}

/// Geoms come in the order of their bodies.
fn bodies(view: &View<'_>) -> Result<(), Invalid> {
    let ngeom = view.size(size::ngeom);
    let mut next = 0;
    for body in 0..view.size(size::nbody) {
        is_in(view, field::body_geomnum, body, 0..=(ngeom - next) as i64)?;
        let count = view.get(field::body_geomnum, body) as usize;
        let adr = if count == 0 { -1 } else { next as i64 };
        is(view, field::body_geomadr, body, adr, "the first geom of the body, or -1 for none")?;
        for geom in next..next + count {
            is(view, field::geom_bodyid, geom, body as i64, "the body whose geom it is")?;
        }
        next += count;
    }
    size_is(view, size::ngeom, next as u64, "the sum over the bodies")
}

/// The dimensionality of contacts: a wrong one ends in `mju_error` or in the wrong number of constraint rows.
pub(super) fn condim(view: &View<'_>, field: Field<i32>) -> Result<(), Invalid> {
    match view.values(field).enumerate().find(|(_, value)| ![1, 3, 4, 6].contains(value)) {
        None => Ok(()),
        Some((i, value)) => Err(Invalid::element(field.name(), i, value, "it must be 1, 3, 4 or 6")),
    }
}
