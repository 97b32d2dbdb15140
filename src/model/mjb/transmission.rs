//! Couplings: equality constraints, the paths of tendons, and actuators.

use std::ops::Range;

use mujoco_sys::{
    mjBIAS_USER, mjDYN_NONE, mjDYN_USER, mjEQ_CONNECT, mjEQ_JOINT, mjEQ_TENDON, mjEQ_WELD, mjGAIN_USER,
    mjGEOM_CYLINDER, mjGEOM_SPHERE, mjJNT_HINGE, mjJNT_SLIDE, mjTRN_BODY, mjTRN_JOINT, mjTRN_JOINTINPARENT, mjTRN_SITE,
    mjTRN_SLIDERCRANK, mjTRN_TENDON, mjWRAP_CYLINDER, mjWRAP_JOINT, mjWRAP_PULLEY, mjWRAP_SITE, mjWRAP_SPHERE,
};

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{all_bytes, all_ids_or_none, all_in, ids, is, is_in, partition, piece, size_is};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    equalities(view)?;
    tendons(view)?;
    actuators(view)
}

fn equalities(view: &View<'_>) -> Result<(), Invalid> {
    // The next type, `mjEQ_DISTANCE`, has a name but no implementation.
    all_in(view, field::eq_type, 0..=mjEQ_TENDON.into())?;
    #[cfg(not(engine_since = "3.5.0"))]
    all_bytes(view, field::eq_active, 1)?;
    #[cfg(engine_since = "3.5.0")]
    {
        all_bytes(view, field::eq_active0, 1)?;
        types_of_ends(view)?;
    }
    let mut rows = 0;
    for (i, kind) in view.values(field::eq_type).enumerate() {
        let places = ends_of_bodies(view, i);
        // The compiler counts seven rows for a weld, although a weld has six.
        let (least_second, count, added) = match kind as u32 {
            mjEQ_CONNECT => (0, places, 3),
            mjEQ_WELD => (0, places, 7),
            mjEQ_JOINT => (-1, view.size(size::njnt), 1),
            _ => (-1, view.size(size::ntendon), 1),
        };
        rows += added;
        is_in(view, field::eq_obj1id, i, ids(count))?;
        is_in(view, field::eq_obj2id, i, least_second..=count as i64 - 1)?;
        let (first, second) = (view.get(field::eq_obj1id, i), view.get(field::eq_obj2id, i));
        if first == second {
            return Err(Invalid::element(field::eq_obj2id.name(), i, second, "it must differ from eq_obj1id"));
        }
        if kind as u32 == mjEQ_JOINT {
            scalar_joint(view, field::eq_obj1id, i)?;
            scalar_joint(view, field::eq_obj2id, i)?;
        }
    }
    size_is(view, size::nemax, rows, "the rows of all equality constraints")
}

/// Returns the number of the elements that an equality constraint of bodies connects: bodies, or
/// sites in newer engines.
fn ends_of_bodies(view: &View<'_>, i: usize) -> usize {
    #[cfg(engine_since = "3.5.0")]
    if view.get(field::eq_objtype, i) as u32 == mujoco_sys::mjOBJ_SITE {
        return view.size(size::nsite);
    }
    let _ = i;
    view.size(size::nbody)
}

/// Checks that the type of the elements of each equality constraint is one that its own type can
/// have, or "unknown" if this is clear.
#[cfg(engine_since = "3.5.0")]
fn types_of_ends(view: &View<'_>) -> Result<(), Invalid> {
    use mujoco_sys::{mjOBJ_BODY, mjOBJ_JOINT, mjOBJ_SITE, mjOBJ_TENDON, mjOBJ_UNKNOWN};

    for (i, kind) in view.values(field::eq_objtype).enumerate() {
        let known = match view.get(field::eq_type, i) as u32 {
            mjEQ_CONNECT | mjEQ_WELD => [mjOBJ_BODY, mjOBJ_SITE],
            mjEQ_JOINT => [mjOBJ_UNKNOWN, mjOBJ_JOINT],
            _ => [mjOBJ_UNKNOWN, mjOBJ_TENDON],
        };
        if !known.contains(&(kind as u32)) {
            let expected = format!("it must be {} or {}, because of eq_type", known[0], known[1]);
            return Err(Invalid::element(field::eq_objtype.name(), i, kind, expected));
        }
    }
    Ok(())
}

/// Checks that a joint, if the element refers to one, has a single position.
fn scalar_joint(view: &View<'_>, field: Field<i32>, i: usize) -> Result<(), Invalid> {
    let Ok(joint) = usize::try_from(view.get(field, i)) else { return Ok(()) };
    match view.get(field::jnt_type, joint) as u32 {
        mjJNT_SLIDE | mjJNT_HINGE => Ok(()),
        _ => Err(Invalid::element(field.name(), i, joint, "only slide and hinge joints can be coupled")),
    }
}

/// Checks tendons and their paths.
///
/// A fixed tendon is a list of joints. A spatial tendon is a list of sites with geoms and pulleys
/// between them. The engine reads two or three elements of a path at a time without checking them.
/// The rules below are the grammar of the compiler.
fn tendons(view: &View<'_>) -> Result<(), Invalid> {
    all_ids_or_none(view, field::tendon_matid, view.size(size::nmat))?;
    all_bytes(view, field::tendon_limited, 1)?;
    partition(view, field::tendon_adr, field::tendon_num, 1, size::nwrap)?;
    all_in(view, field::wrap_type, mjWRAP_JOINT.into()..=mjWRAP_CYLINDER.into())?;
    path_elements(view)?;
    let mut last_tendon_of_joint = vec![usize::MAX; view.size(size::njnt)];
    for tendon in 0..view.size(size::ntendon) {
        let path = piece(view, field::tendon_adr, field::tendon_num, tendon);
        if view.get(field::wrap_type, path.start) as u32 == mjWRAP_JOINT {
            fixed_path(view, tendon, path, &mut last_tendon_of_joint)?;
        } else {
            spatial_path(view, path)?;
        }
    }
    #[cfg(engine_since = "3.5.0")]
    {
        all_bytes(view, field::tendon_actfrclimited, 1)?;
        super::newer::check_trees_of_tendons(view)?;
    }
    Ok(())
}

/// Checks that each element of a path refers to an existing object of the right shape.
fn path_elements(view: &View<'_>) -> Result<(), Invalid> {
    for (i, kind) in view.values(field::wrap_type).enumerate() {
        let kind = kind as u32;
        match kind {
            mjWRAP_JOINT => is_in(view, field::wrap_objid, i, ids(view.size(size::njnt)))?,
            mjWRAP_PULLEY => is(view, field::wrap_objid, i, -1, "because a pulley has no object")?,
            mjWRAP_SITE => is_in(view, field::wrap_objid, i, ids(view.size(size::nsite)))?,
            _ => {
                is_in(view, field::wrap_objid, i, ids(view.size(size::ngeom)))?;
                let geom = view.get(field::wrap_objid, i) as usize;
                let expected = if kind == mjWRAP_SPHERE { mjGEOM_SPHERE } else { mjGEOM_CYLINDER };
                if view.get(field::geom_type, geom) as u32 != expected {
                    let expected = format!("it must be a geom of type {expected}, as wrap_type states");
                    return Err(Invalid::element(field::wrap_objid.name(), i, geom, expected));
                }
                side_site(view, i)?;
            }
        }
    }
    Ok(())
}

/// Checks the parameter of a geom in a path: the id, as a real number, of the site on whose side
/// the tendon passes, or -1.
fn side_site(view: &View<'_>, i: usize) -> Result<(), Invalid> {
    let value = view.get(field::wrap_prm, i);
    let nsite = view.size(size::nsite) as f64;
    if value >= -1.0 && value < nsite && value.fract() == 0.0 {
        return Ok(());
    }
    Err(Invalid::element(field::wrap_prm.name(), i, value, format!("it must be -1 or the id of one of {nsite} sites")))
}

/// Checks that a fixed tendon consists of joints only, and of each joint once. The compiler allows
/// a repeated joint, with which the engine can write out of bounds: a row of its sparse Jacobian
/// has room for `nv` elements, and the engine writes one for each joint in the path.
///
/// `last_tendon_of_joint` is the last tendon so far that contains each joint.
fn fixed_path(
    view: &View<'_>,
    tendon: usize,
    path: Range<usize>,
    last_tendon_of_joint: &mut [usize],
) -> Result<(), Invalid> {
    for i in path {
        is(view, field::wrap_type, i, mjWRAP_JOINT.into(), "because the path begins with a joint")?;
        let joint = view.get(field::wrap_objid, i) as usize;
        if last_tendon_of_joint[joint] == tendon {
            let expected = format!("tendon {tendon} already contains that joint");
            return Err(Invalid::element(field::wrap_objid.name(), i, joint, expected));
        }
        last_tendon_of_joint[joint] = tendon;
    }
    Ok(())
}

/// Checks the path of a spatial tendon. It has at least two elements. Each geom is between two
/// sites. Pulleys are not adjacent and not last, and every site has a site or a geom next to it.
fn spatial_path(view: &View<'_>, path: Range<usize>) -> Result<(), Invalid> {
    // The rule for sites treats the end of the path like a pulley. A geom or a pulley must not be
    // next to the end.
    let kind = |i: usize| view.get(field::wrap_type, i) as u32;
    let before = |i: usize| (i > path.start).then(|| kind(i - 1));
    let after = |i: usize| (i + 1 < path.end).then(|| kind(i + 1));
    for i in path.clone() {
        let invalid = |expected: &str| Err(Invalid::element(field::wrap_type.name(), i, kind(i), expected));
        match kind(i) {
            mjWRAP_SITE => {
                let is_end = |neighbour: Option<u32>| neighbour.is_none_or(|kind| kind == mjWRAP_PULLEY);
                if is_end(before(i)) && is_end(after(i)) {
                    return invalid("a site must be next to a site or a geom");
                }
            }
            mjWRAP_PULLEY => {
                if after(i).is_none_or(|kind| kind == mjWRAP_PULLEY) {
                    return invalid("a pulley must be followed by a site");
                }
            }
            mjWRAP_JOINT => return invalid("only a path that begins with a joint may have joints"),
            _ => {
                if before(i) != Some(mjWRAP_SITE) || after(i) != Some(mjWRAP_SITE) {
                    return invalid("a geom must have sites on both sides");
                }
            }
        }
    }
    Ok(())
}

fn actuators(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::actuator_trntype, 0..=mjTRN_BODY.into())?;
    all_in(view, field::actuator_dyntype, 0..=mjDYN_USER.into())?;
    all_in(view, field::actuator_gaintype, 0..=mjGAIN_USER.into())?;
    all_in(view, field::actuator_biastype, 0..=mjBIAS_USER.into())?;
    all_bytes(view, field::actuator_ctrllimited, 1)?;
    all_bytes(view, field::actuator_forcelimited, 1)?;
    all_bytes(view, field::actuator_actlimited, 1)?;
    for (i, kind) in view.values(field::actuator_trntype).enumerate() {
        let count = match kind as u32 {
            mjTRN_JOINT | mjTRN_JOINTINPARENT => size::njnt,
            mjTRN_SLIDERCRANK | mjTRN_SITE => size::nsite,
            mjTRN_TENDON => size::ntendon,
            _ => size::nbody,
        };
        is_in(view, field::actuator_trnid, 2 * i, ids(view.size(count)))?;
        let second = 2 * i + 1;
        match kind as u32 {
            mjTRN_SLIDERCRANK => is_in(view, field::actuator_trnid, second, ids(view.size(size::nsite)))?,
            mjTRN_SITE => is_in(view, field::actuator_trnid, second, -1..=view.size(size::nsite) as i64 - 1)?,
            _ => {
                is(view, field::actuator_trnid, second, -1, "because only slider-cranks and sites have a second site")?;
            }
        }
    }
    #[cfg(not(engine_since = "3.5.0"))]
    adhesion(view)?;
    #[cfg(engine_since = "3.5.0")]
    moments(view)?;
    activations(view)
}

/// Checks the size of the sparse moment matrix, in which each actuator has space for all degrees of
/// freedom, except with a joint.
#[cfg(engine_since = "3.5.0")]
fn moments(view: &View<'_>) -> Result<(), Invalid> {
    let mut elements = 0;
    for (i, kind) in view.values(field::actuator_trntype).enumerate() {
        elements += match kind as u32 {
            mjTRN_JOINT | mjTRN_JOINTINPARENT => {
                let joint = view.get(field::actuator_trnid, 2 * i) as usize;
                super::tree::joint_size(view.get(field::jnt_type, joint)).1
            }
            _ => view.size(size::nv),
        } as u64;
    }
    size_is(view, size::nJmom, elements, "the elements of all rows")
}

/// Rejects adhesion without room for constraints. The transmission of an adhesive actuator assumes
/// that each contact of its body has constraint rows. If `njmax` is 0, the engine creates none,
/// raises no warning, and writes at a negative offset from a null pointer.
///
/// If the constraint buffer has room for only some of the rows, the same happens after a warning
/// that the buffer is full. The file does not reveal this, so the code that steps such a model must
/// treat the warning as an error.
#[cfg(not(engine_since = "3.5.0"))]
fn adhesion(view: &View<'_>) -> Result<(), Invalid> {
    let adhesive = view.values(field::actuator_trntype).position(|kind| kind as u32 == mjTRN_BODY);
    match adhesive {
        Some(i) if view.size(size::njmax) == 0 => {
            Err(Invalid::scalar("njmax", 0, format!("actuator {i} is adhesive and needs the constraints of contacts")))
        }
        _ => Ok(()),
    }
}

/// Checks that each actuator with dynamics has the next activation. More than one activation, which
/// user dynamics can have, is not supported.
#[cfg(engine_since = "3.5.0")]
fn activations(view: &View<'_>) -> Result<(), Invalid> {
    all_bytes(view, field::actuator_actearly, 1)?;
    let mut next = 0;
    for (i, kind) in view.values(field::actuator_dyntype).enumerate() {
        let count = i64::from(kind as u32 != mjDYN_NONE);
        is(view, field::actuator_actnum, i, count, "because of actuator_dyntype")?;
        let address = if count == 0 { -1 } else { next };
        is(view, field::actuator_actadr, i, address, "the end of the previous activation, or -1 for none")?;
        next += count;
    }
    size_is(view, size::na, next as u64, "the sum of actuator_actnum")
}

/// Checks that the actuators with an activation are the last `na`, because the engine assigns
/// activation `i - (nu - na)` to actuator `i`.
#[cfg(not(engine_since = "3.5.0"))]
fn activations(view: &View<'_>) -> Result<(), Invalid> {
    let (nu, na) = (view.size(size::nu), view.size(size::na));
    if na > nu {
        return Err(Invalid::scalar("na", na, format!("the model has only {nu} actuators")));
    }
    for (i, kind) in view.values(field::actuator_dyntype).enumerate() {
        let is_stateful = i >= nu - na;
        if is_stateful != (kind as u32 != mjDYN_NONE) {
            let expected = format!("na is {na}, so exactly the last {na} of {nu} actuators have an activation");
            return Err(Invalid::element(field::actuator_dyntype.name(), i, kind, expected));
        }
    }
    Ok(())
}
