//! Elements attached to bodies: geoms, sites, cameras and lights. Also the explicit contact pairs
//! of geoms, and the pairs of bodies that are excluded from contact.

use mujoco_sys::{mjCAMLIGHT_TARGETBODYCOM, mjGEOM_BOX, mjGEOM_HFIELD, mjGEOM_MESH, mjGEOM_PLANE, mjGEOM_SPHERE};

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{all_bytes, all_ids, all_ids_or_none, all_in, ids, is, is_in, size_is};
use super::view::View;

/// Largest `*_sameframe` flag: 0 for none, 1 for the body frame, 2 for the inertial frame. Newer
/// engines have 3 and 4 for their orientations.
const LAST_SAMEFRAME: u8 = if cfg!(engine_since = "3.5.0") { 4 } else { 2 };

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    geoms(view)?;

    // The engine intersects rays with the shape of a site by the code for geoms, which supports no
    // other types.
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
        // A targeting mode without a target body is valid: the engine does not rotate the camera or
        // light then.
        all_ids_or_none(view, target, view.size(size::nbody))?;
    }
    all_bytes(view, field::light_castshadow, 1)?;
    all_bytes(view, field::light_active, 1)?;
    #[cfg(not(engine_since = "3.5.0"))]
    all_bytes(view, field::light_directional, 1)?;
    #[cfg(engine_since = "3.5.0")]
    newer_types(view)?;
    Ok(())
}

/// Checks the types of newer cameras and lights, and that no element has a plugin. The resolution
/// of a camera may have any value: the engine compares it with the values of a sensor.
#[cfg(engine_since = "3.5.0")]
fn newer_types(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::cam_projection, 0..=mujoco_sys::mjPROJ_ORTHOGRAPHIC.into())?;
    all_in(view, field::cam_output, 0..=(1 << mujoco_sys::mjNCAMOUT) - 1)?;
    all_in(view, field::light_type, 0..=mujoco_sys::mjLIGHT_IMAGE.into())?;
    all_ids_or_none(view, field::light_texid, view.size(size::ntex))?;
    for plugins in [field::body_plugin, field::geom_plugin, field::actuator_plugin, field::sensor_plugin] {
        all_ids_or_none(view, plugins, view.size(size::nplugin))?;
    }
    Ok(())
}

fn geoms(view: &View<'_>) -> Result<(), Invalid> {
    geoms_of_bodies(view)?;
    all_in(view, field::geom_type, mjGEOM_PLANE.into()..=mjGEOM_MESH.into())?;
    condim(view, field::geom_condim)?;
    all_ids_or_none(view, field::geom_matid, view.size(size::nmat))?;
    all_bytes(view, field::geom_sameframe, LAST_SAMEFRAME)?;
    for (i, kind) in view.values(field::geom_type).enumerate() {
        match kind as u32 {
            mjGEOM_HFIELD => is_in(view, field::geom_dataid, i, ids(view.size(size::nhfield)))?,
            mjGEOM_MESH => is_in(view, field::geom_dataid, i, ids(view.size(size::nmesh)))?,
            // Newer compilers keep the mesh to which they fitted a shape.
            _ if cfg!(engine_since = "3.5.0") => {
                is_in(view, field::geom_dataid, i, -1..=view.size(size::nmesh) as i64 - 1)?;
            }
            _ => is(view, field::geom_dataid, i, -1, "because only meshes and height fields have data")?,
        }
        let body = view.get(field::geom_bodyid, i) as usize;
        if matches!(kind as u32, mjGEOM_PLANE | mjGEOM_HFIELD) && view.get(field::body_weldid, body) != 0 {
            let expected = format!("body {body} moves, and planes and height fields cannot");
            return Err(Invalid::element(field::geom_type.name(), i, kind, expected));
        }
    }
    Ok(())
}

/// Checks that geoms are in the order of their bodies.
fn geoms_of_bodies(view: &View<'_>) -> Result<(), Invalid> {
    let ngeom = view.size(size::ngeom);
    let mut next = 0;
    for body in 0..view.size(size::nbody) {
        is_in(view, field::body_geomnum, body, 0..=(ngeom - next) as i64)?;
        let count = view.get(field::body_geomnum, body) as usize;
        let adr = if count == 0 { -1 } else { next as i64 };
        is(view, field::body_geomadr, body, adr, "the first geom of the body, or -1 for none")?;
        for geom in next..next + count {
            is(view, field::geom_bodyid, geom, body as i64, "the body of the geom")?;
        }
        next += count;
    }
    size_is(view, size::ngeom, next as u64, "the sum over the bodies")
}

/// Checks the dimensionality of contacts. An invalid one ends in `mju_error` or in the wrong number
/// of constraint rows.
fn condim(view: &View<'_>, field: Field<i32>) -> Result<(), Invalid> {
    match view.values(field).enumerate().find(|(_, value)| ![1, 3, 4, 6].contains(value)) {
        None => Ok(()),
        Some((i, value)) => Err(Invalid::element(field.name(), i, value, "it must be 1, 3, 4 or 6")),
    }
}

/// Checks the pairs of geoms that are tested for contact, and the pairs of bodies that are not. The
/// engine searches both by a signature that packs the ids of the bodies, in a list that it assumes
/// to be sorted.
pub(super) fn check_pairs(view: &View<'_>) -> Result<(), Invalid> {
    condim(view, field::pair_dim)?;
    all_ids(view, field::pair_geom1, view.size(size::ngeom))?;
    all_ids(view, field::pair_geom2, view.size(size::ngeom))?;
    for i in 0..view.size(size::npair) {
        let body = |geom| i64::from(view.get(field::geom_bodyid, view.get(geom, i) as usize));
        let (first, second) = (body(field::pair_geom1), body(field::pair_geom2));
        let expected = signature(first.min(second), first.max(second));
        is(view, field::pair_signature, i, expected, "the signature of the bodies of its geoms")?;
    }
    sorted(view, field::pair_signature)?;

    for (i, value) in view.values(field::exclude_signature).enumerate() {
        let nbody = view.size(size::nbody) as i64;
        let (first, second) = ((i64::from(value) >> 16) - FIRST_BODY, (i64::from(value) & 0xFFFF) - FIRST_BODY);
        if !(0 <= first && first <= second && second < nbody) {
            let expected =
                format!("it encodes the bodies {first} and {second}; both must be below {nbody}, the smaller id first");
            return Err(Invalid::element(field::exclude_signature.name(), i, value, expected));
        }
    }
    sorted(view, field::exclude_signature)
}

/// Number of the world in signatures.
const FIRST_BODY: i64 = if cfg!(engine_since = "3.5.0") { 0 } else { 1 };

/// Returns the signature of a pair of bodies. It fits into an int, because the number of bodies is
/// below 2^15.
fn signature(first: i64, second: i64) -> i64 {
    ((first + FIRST_BODY) << 16) + second + FIRST_BODY
}

fn sorted(view: &View<'_>, field: Field<i32>) -> Result<(), Invalid> {
    for i in 1..view.len(field) {
        let (previous, value) = (view.get(field, i - 1), view.get(field, i));
        if value < previous {
            return Err(Invalid::element(
                field.name(),
                i,
                value,
                format!("signatures must ascend, and the previous one is {previous}"),
            ));
        }
    }
    Ok(())
}
