//! Tendons and their paths.
//!
//! A fixed tendon is a list of joints. A spatial one is a list of sites with geoms and pulleys between them, which the engine
//! reads two and three elements at a time without checking what it gets: the grammar below is the compiler's.

use mujoco_sys::{
    mjGEOM_CYLINDER, mjGEOM_SPHERE, mjWRAP_CYLINDER, mjWRAP_JOINT, mjWRAP_PULLEY, mjWRAP_SITE, mjWRAP_SPHERE,
};

use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{all_bytes, all_ids_or_none, all_in, ids, is, is_in, partition, piece};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    all_ids_or_none(view, field::tendon_matid, view.size(size::nmat))?;
    all_bytes(view, field::tendon_limited, 1)?;
    partition(view, field::tendon_adr, field::tendon_num, 1, size::nwrap)?;
    all_in(view, field::wrap_type, mjWRAP_JOINT.into()..=mjWRAP_CYLINDER.into())?;
    objects(view)?;
    let mut user = vec![usize::MAX; view.size(size::njnt)];
    for tendon in 0..view.size(size::ntendon) {
        let path = piece(view, field::tendon_adr, field::tendon_num, tendon);
        if view.get(field::wrap_type, path.start) as u32 == mjWRAP_JOINT {
            fixed(view, tendon, path, &mut user)?;
        } else {
            spatial(view, path)?;
        }
    }
    Ok(())
}

/// Each element of a path refers to an object that exists and has the shape the element says.
fn objects(view: &View<'_>) -> Result<(), Invalid> {
    for (i, kind) in view.values(field::wrap_type).enumerate() {
        let kind = kind as u32;
        match kind {
            mjWRAP_JOINT => is_in(view, field::wrap_objid, i, ids(view.size(size::njnt)))?,
            mjWRAP_PULLEY => is(view, field::wrap_objid, i, -1, "since a pulley is no object")?,
            mjWRAP_SITE => is_in(view, field::wrap_objid, i, ids(view.size(size::nsite)))?,
            _ => {
                is_in(view, field::wrap_objid, i, ids(view.size(size::ngeom)))?;
                let geom = view.get(field::wrap_objid, i) as usize;
                let wanted = if kind == mjWRAP_SPHERE { mjGEOM_SPHERE } else { mjGEOM_CYLINDER };
                if view.get(field::geom_type, geom) as u32 != wanted {
                    let wanted = format!("the path wraps around a geom of type {wanted} there");
                    return Err(Invalid::element(field::wrap_objid.name(), i, geom, wanted));
                }
                side_site(view, i)?;
            }
        }
    }
    Ok(())
}

/// The parameter of a geom in a path is the id of the site on whose side the tendon passes, or -1, as a real number.
fn side_site(view: &View<'_>, i: usize) -> Result<(), Invalid> {
    let value = view.get(field::wrap_prm, i);
    let nsite = view.size(size::nsite) as f64;
    if value >= -1.0 && value < nsite && value.fract() == 0.0 {
        return Ok(());
    }
    Err(Invalid::element(field::wrap_prm.name(), i, value, format!("it must be -1 or the id of one of {nsite} sites")))
}

/// Joints only, and none twice. The compiler lets a joint be repeated, but the engine's sparse Jacobian has room for `nv`
/// elements in a row and takes one for each joint in the path: a repeated one makes it write past the end.
fn fixed(view: &View<'_>, tendon: usize, path: std::ops::Range<usize>, user: &mut [usize]) -> Result<(), Invalid> {
    for i in path {
        is(view, field::wrap_type, i, mjWRAP_JOINT.into(), "since the tendon's path begins with a joint")?;
        let joint = view.get(field::wrap_objid, i) as usize;
        if user[joint] == tendon {
            let wanted = format!("tendon {tendon} has that joint already");
            return Err(Invalid::element(field::wrap_objid.name(), i, joint, wanted));
        }
        user[joint] = tendon;
    }
    Ok(())
}

/// At least two elements. Geoms lie between two sites; pulleys are neither neighbours nor last, and leave no site alone.
fn spatial(view: &View<'_>, path: std::ops::Range<usize>) -> Result<(), Invalid> {
    // A path's ends are like pulleys to a site, and like nothing a geom or a pulley may have beside it.
    let kind = |i: usize| view.get(field::wrap_type, i) as u32;
    let before = |i: usize| (i > path.start).then(|| kind(i - 1));
    let after = |i: usize| (i + 1 < path.end).then(|| kind(i + 1));
    for i in path.clone() {
        let wrong = |wanted: &str| Err(Invalid::element(field::wrap_type.name(), i, kind(i), wanted));
        match kind(i) {
            mjWRAP_SITE => {
                let alone = |neighbour: Option<u32>| neighbour.is_none_or(|kind| kind == mjWRAP_PULLEY);
                if alone(before(i)) && alone(after(i)) {
                    return wrong("a site needs a site or a geom beside it");
                }
            }
            mjWRAP_PULLEY => {
                if after(i).is_none_or(|kind| kind == mjWRAP_PULLEY) {
                    return wrong("after a pulley must come a site");
                }
            }
            mjWRAP_JOINT => return wrong("only a path that begins with a joint may have joints"),
            _ => {
                if before(i) != Some(mjWRAP_SITE) || after(i) != Some(mjWRAP_SITE) {
                    return wrong("a geom must have sites on both sides");
                }
            }
        }
    }
    Ok(())
}
