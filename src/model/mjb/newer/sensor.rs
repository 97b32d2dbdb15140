//! Sensors of types that 2.2.2 does not have, and rangefinders, which can measure at each pixel of
//! a camera.

use mujoco_sys::{
    mjDATATYPE_AXIS, mjDATATYPE_POSITIVE, mjDATATYPE_REAL, mjGEOM_HFIELD, mjJNT_HINGE, mjJNT_SLIDE, mjOBJ_BODY,
    mjOBJ_CAMERA, mjOBJ_GEOM, mjOBJ_JOINT, mjOBJ_SITE, mjOBJ_TENDON, mjOBJ_UNKNOWN, mjOBJ_XBODY, mjSTAGE_ACC,
    mjSTAGE_POS,
};
use mujoco_sys::{
    mjSENS_CAMPROJECTION, mjSENS_CONTACT, mjSENS_E_KINETIC, mjSENS_E_POTENTIAL, mjSENS_GEOMDIST, mjSENS_GEOMFROMTO,
    mjSENS_GEOMNORMAL, mjSENS_INSIDESITE, mjSENS_JOINTACTFRC, mjSENS_RANGEFINDER, mjSENS_TENDONACTFRC,
};

use super::super::custom::count;
use super::super::invalid::Invalid;
use super::super::layout::{Field, field};
use super::super::rule::{ids, is, is_in};
use super::super::view::View;

/// Types of elements with a frame, to which a sensor can be attached.
const FRAMES: &[u32] = &[mjOBJ_BODY, mjOBJ_XBODY, mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_CAMERA];
const SHAPES: &[u32] = &[mjOBJ_BODY, mjOBJ_GEOM];
const NOTHING: &[u32] = &[mjOBJ_UNKNOWN];

/// Numbers in each field of the data of a ray, and of a contact. The sensor has a mask of them.
const RAY_FIELDS: [i64; 6] = [1, 3, 3, 3, 3, 1];
const CONTACT_FIELDS: [i64; 7] = [1, 3, 3, 1, 3, 3, 3];

/// Largest value of the reduction of contacts: the net force.
const LAST_REDUCTION: i64 = 3;

/// Number of integer parameters of a sensor.
const PARAMETERS: usize = 3;

/// Checks a sensor of such a type. Returns `false` for the other types, whose integer parameters
/// are zero.
pub(in super::super) fn check(view: &View<'_>, i: usize) -> Result<bool, Invalid> {
    let kind = view.get(field::sensor_type, i) as u32;
    let (objects, references): (&[u32], &[u32]) = match kind {
        mjSENS_RANGEFINDER => (&[mjOBJ_SITE, mjOBJ_CAMERA], NOTHING),
        mjSENS_CAMPROJECTION => (&[mjOBJ_SITE], &[mjOBJ_CAMERA]),
        mjSENS_JOINTACTFRC => (&[mjOBJ_JOINT], NOTHING),
        mjSENS_TENDONACTFRC => (&[mjOBJ_TENDON], NOTHING),
        mjSENS_INSIDESITE => (FRAMES, &[mjOBJ_SITE]),
        mjSENS_GEOMDIST | mjSENS_GEOMNORMAL | mjSENS_GEOMFROMTO => (SHAPES, SHAPES),
        mjSENS_CONTACT => (
            &[mjOBJ_SITE, mjOBJ_BODY, mjOBJ_XBODY, mjOBJ_GEOM, mjOBJ_UNKNOWN],
            &[mjOBJ_BODY, mjOBJ_XBODY, mjOBJ_GEOM, mjOBJ_UNKNOWN],
        ),
        mjSENS_E_POTENTIAL | mjSENS_E_KINETIC => (NOTHING, NOTHING),
        _ => {
            parameters(view, i, 0)?;
            return Ok(false);
        }
    };
    object(view, field::sensor_objtype, field::sensor_objid, i, objects)?;
    object(view, field::sensor_reftype, field::sensor_refid, i, references)?;

    let (dimension, datatype, stage) = match kind {
        mjSENS_RANGEFINDER => (rays(view, i)?, mjDATATYPE_REAL, mjSTAGE_POS),
        mjSENS_CONTACT => (contacts(view, i)?, mjDATATYPE_REAL, mjSTAGE_ACC),
        mjSENS_CAMPROJECTION => (2, mjDATATYPE_REAL, mjSTAGE_POS),
        mjSENS_JOINTACTFRC | mjSENS_TENDONACTFRC => (1, mjDATATYPE_REAL, mjSTAGE_ACC),
        mjSENS_INSIDESITE => (1, mjDATATYPE_POSITIVE, mjSTAGE_POS),
        mjSENS_GEOMNORMAL => (3, mjDATATYPE_AXIS, mjSTAGE_POS),
        mjSENS_GEOMFROMTO => (6, mjDATATYPE_REAL, mjSTAGE_POS),
        _ => (1, mjDATATYPE_REAL, mjSTAGE_POS),
    };
    if !matches!(kind, mjSENS_RANGEFINDER | mjSENS_CONTACT) {
        parameters(view, i, 0)?;
    }
    if kind == mjSENS_JOINTACTFRC {
        scalar_joint(view, i)?;
    }
    if matches!(kind, mjSENS_GEOMDIST | mjSENS_GEOMNORMAL | mjSENS_GEOMFROMTO) {
        convex(view, field::sensor_objtype, field::sensor_objid, i)?;
        convex(view, field::sensor_reftype, field::sensor_refid, i)?;
    }
    let why = format!("as for all sensors of type {kind} with these parameters");
    is(view, field::sensor_dim, i, dimension, &why)?;
    is(view, field::sensor_datatype, i, datatype.into(), &why)?;
    is(view, field::sensor_needstage, i, stage.into(), &why)?;
    Ok(true)
}

/// Checks the type of an element, and its id or -1 for none.
fn object(view: &View<'_>, kind: Field<i32>, id: Field<i32>, i: usize, known: &[u32]) -> Result<(), Invalid> {
    let value = view.get(kind, i);
    if !known.contains(&(value as u32)) {
        return Err(Invalid::element(kind.name(), i, value, format!("it must be one of {known:?}")));
    }
    match count(view, value) {
        Some(count) => is_in(view, id, i, ids(count)),
        None => is(view, id, i, -1, "because it has no object"),
    }
}

/// Returns the number of values of a rangefinder: the fields of each ray.
fn rays(view: &View<'_>, i: usize) -> Result<i64, Invalid> {
    parameters(view, i, 1)?;
    let size = numbers(view, i, &RAY_FIELDS)?;
    if view.get(field::sensor_objtype, i) as u32 != mjOBJ_CAMERA {
        return Ok(size);
    }
    let camera = view.get(field::sensor_objid, i) as usize;
    // A camera may have any resolution, but this one must have pixels.
    let [width, height] = [0, 1].map(|axis| i64::from(view.get(field::cam_resolution, 2 * camera + axis)));
    if width < 1 || height < 1 {
        let expected = format!("the camera has the resolution {width} × {height}, which must be positive");
        return Err(Invalid::element(field::sensor_objid.name(), i, camera, expected));
    }
    // Below 2^31 in the end, because it is compared with an int.
    Ok(size.saturating_mul(width).saturating_mul(height))
}

/// Returns the number of values of a contact sensor: the fields of each of its contacts.
fn contacts(view: &View<'_>, i: usize) -> Result<i64, Invalid> {
    is_in(view, field::sensor_intprm, PARAMETERS * i + 1, 0..=LAST_REDUCTION)?;
    is_in(view, field::sensor_intprm, PARAMETERS * i + 2, 1..=i32::MAX.into())?;
    let contacts = i64::from(view.get(field::sensor_intprm, PARAMETERS * i + 2));
    Ok(numbers(view, i, &CONTACT_FIELDS)? * contacts)
}

/// Returns the number of values in the fields of the sensor's mask.
fn numbers(view: &View<'_>, i: usize, fields: &[i64]) -> Result<i64, Invalid> {
    is_in(view, field::sensor_intprm, PARAMETERS * i, 1..=(1 << fields.len()) - 1)?;
    let mask = view.get(field::sensor_intprm, PARAMETERS * i);
    Ok(fields.iter().enumerate().filter(|(bit, _)| mask & (1 << bit) != 0).map(|(_, size)| size).sum())
}

/// Checks that the integer parameters from `first` on are zero.
fn parameters(view: &View<'_>, i: usize, first: usize) -> Result<(), Invalid> {
    let unused = PARAMETERS * i + first..PARAMETERS * (i + 1);
    unused.into_iter().try_for_each(|at| is(view, field::sensor_intprm, at, 0, "because the sensor does not use it"))
}

/// Checks that the joint of the sensor has a single degree of freedom.
fn scalar_joint(view: &View<'_>, i: usize) -> Result<(), Invalid> {
    let joint = view.get(field::sensor_objid, i) as usize;
    match view.get(field::jnt_type, joint) as u32 {
        mjJNT_SLIDE | mjJNT_HINGE => Ok(()),
        _ => Err(Invalid::element(field::sensor_objid.name(), i, joint, "it must be a slide or hinge joint")),
    }
}

/// Checks that a geom of a distance sensor is not a height field, for which the engine computes no
/// distance.
fn convex(view: &View<'_>, kind: Field<i32>, id: Field<i32>, i: usize) -> Result<(), Invalid> {
    let object = view.get(id, i) as usize;
    let is_field = view.get(kind, i) as u32 == mjOBJ_GEOM && view.get(field::geom_type, object) as u32 == mjGEOM_HFIELD;
    if is_field { Err(Invalid::element(id.name(), i, object, "it must not be a height field")) } else { Ok(()) }
}
