//! Sensors: the object, the computation stage and the number of values of each type.

use mujoco_sys::{
    mjDATATYPE_AXIS, mjDATATYPE_POSITIVE, mjDATATYPE_QUATERNION, mjDATATYPE_REAL, mjGEOM_HFIELD, mjJNT_BALL,
    mjJNT_HINGE, mjJNT_SLIDE, mjOBJ_ACTUATOR, mjOBJ_BODY, mjOBJ_CAMERA, mjOBJ_GEOM, mjOBJ_JOINT, mjOBJ_SITE,
    mjOBJ_TENDON, mjOBJ_UNKNOWN, mjOBJ_XBODY, mjSTAGE_ACC, mjSTAGE_POS, mjSTAGE_VEL,
};
use mujoco_sys::{
    mjSENS_ACCELEROMETER, mjSENS_ACTUATORFRC, mjSENS_ACTUATORPOS, mjSENS_ACTUATORVEL, mjSENS_BALLANGVEL,
    mjSENS_BALLQUAT, mjSENS_CLOCK, mjSENS_FORCE, mjSENS_FRAMEANGACC, mjSENS_FRAMEANGVEL, mjSENS_FRAMELINACC,
    mjSENS_FRAMELINVEL, mjSENS_FRAMEPOS, mjSENS_FRAMEQUAT, mjSENS_FRAMEXAXIS, mjSENS_FRAMEYAXIS, mjSENS_FRAMEZAXIS,
    mjSENS_GYRO, mjSENS_JOINTLIMITFRC, mjSENS_JOINTLIMITPOS, mjSENS_JOINTLIMITVEL, mjSENS_JOINTPOS, mjSENS_JOINTVEL,
    mjSENS_MAGNETOMETER, mjSENS_RANGEFINDER, mjSENS_SUBTREEANGMOM, mjSENS_SUBTREECOM, mjSENS_SUBTREELINVEL,
    mjSENS_TENDONLIMITFRC, mjSENS_TENDONLIMITPOS, mjSENS_TENDONLIMITVEL, mjSENS_TENDONPOS, mjSENS_TENDONVEL,
    mjSENS_TORQUE, mjSENS_TOUCH, mjSENS_USER, mjSENS_VELOCIMETER,
};

use super::custom::count;
use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{all_in, ids, is, is_in, size_is};
use super::view::View;
use crate::model::engine_limits::{are_ray_safe_sizes, rays_overrun_grid};

/// The object of a type of sensor.
#[derive(Clone, Copy, PartialEq)]
enum On {
    Site,
    /// A slide or hinge joint.
    Scalar,
    /// A ball joint.
    Ball,
    Joint,
    Tendon,
    Actuator,
    Body,
    /// A body, geom, site or camera.
    Frame,
    /// A body, geom, site or camera, optionally measured relative to another one.
    Relative,
    Nothing,
}

/// Returns the number of values of a type of sensor, their data type, the stage that computes them,
/// and the object. Returns `None` for a user sensor, for which these are arbitrary.
fn rule(kind: u32) -> Option<(i64, u32, u32, On)> {
    use On::{Actuator, Ball, Body, Frame, Joint, Nothing, Relative, Scalar, Site, Tendon};
    let (pos, vel, acc) = (mjSTAGE_POS, mjSTAGE_VEL, mjSTAGE_ACC);
    let (real, positive, axis, quaternion) =
        (mjDATATYPE_REAL, mjDATATYPE_POSITIVE, mjDATATYPE_AXIS, mjDATATYPE_QUATERNION);
    Some(match kind {
        mjSENS_TOUCH => (1, positive, acc, Site),
        mjSENS_ACCELEROMETER | mjSENS_FORCE | mjSENS_TORQUE => (3, real, acc, Site),
        mjSENS_VELOCIMETER | mjSENS_GYRO => (3, real, vel, Site),
        mjSENS_MAGNETOMETER => (3, real, pos, Site),
        mjSENS_RANGEFINDER => (1, positive, pos, Site),
        mjSENS_JOINTPOS => (1, real, pos, Scalar),
        mjSENS_JOINTVEL => (1, real, vel, Scalar),
        mjSENS_TENDONPOS | mjSENS_TENDONLIMITPOS => (1, real, pos, Tendon),
        mjSENS_TENDONVEL | mjSENS_TENDONLIMITVEL => (1, real, vel, Tendon),
        mjSENS_TENDONLIMITFRC => (1, real, acc, Tendon),
        mjSENS_ACTUATORPOS => (1, real, pos, Actuator),
        mjSENS_ACTUATORVEL => (1, real, vel, Actuator),
        mjSENS_ACTUATORFRC => (1, real, acc, Actuator),
        mjSENS_BALLQUAT => (4, quaternion, pos, Ball),
        mjSENS_BALLANGVEL => (3, real, vel, Ball),
        mjSENS_JOINTLIMITPOS => (1, real, pos, Joint),
        mjSENS_JOINTLIMITVEL => (1, real, vel, Joint),
        mjSENS_JOINTLIMITFRC => (1, real, acc, Joint),
        mjSENS_FRAMEPOS => (3, real, pos, Relative),
        mjSENS_FRAMEQUAT => (4, quaternion, pos, Relative),
        mjSENS_FRAMEXAXIS | mjSENS_FRAMEYAXIS | mjSENS_FRAMEZAXIS => (3, axis, pos, Relative),
        mjSENS_FRAMELINVEL | mjSENS_FRAMEANGVEL => (3, real, vel, Relative),
        mjSENS_FRAMELINACC | mjSENS_FRAMEANGACC => (3, real, acc, Frame),
        mjSENS_SUBTREECOM => (3, real, pos, Body),
        mjSENS_SUBTREELINVEL | mjSENS_SUBTREEANGMOM => (3, real, vel, Body),
        mjSENS_CLOCK => (1, real, pos, Nothing),
        _ => return None,
    })
}

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::sensor_type, 0..=mjSENS_USER.into())?;
    all_in(view, field::sensor_datatype, 0..=mjDATATYPE_QUATERNION.into())?;
    let mut next = 0;
    for (i, kind) in view.values(field::sensor_type).enumerate() {
        #[cfg(engine_since = "3.5.0")]
        let is_checked = super::newer::check_sensor(view, i)?;
        #[cfg(not(engine_since = "3.5.0"))]
        let is_checked = false;
        match rule(kind as u32) {
            _ if is_checked => {}
            Some((dim, datatype, stage, on)) => {
                let why = format!("as for all sensors of type {kind}");
                is(view, field::sensor_dim, i, dim, &why)?;
                is(view, field::sensor_datatype, i, datatype.into(), &why)?;
                is(view, field::sensor_needstage, i, stage.into(), &why)?;
                object(view, i, on)?;
            }
            None => user(view, i)?,
        }
        is(view, field::sensor_adr, i, next, "the end of the previous one")?;
        next += i64::from(view.get(field::sensor_dim, i));
    }
    size_is(view, size::nsensordata, next as u64, "the sum of sensor_dim")?;
    rangefinders(view)
}

/// Rejects rangefinders together with height fields on which the engine's ray functions read out of
/// bounds. Rangefinders cast rays at all geoms.
fn rangefinders(view: &View<'_>) -> Result<(), Invalid> {
    if !view.values(field::sensor_type).any(|kind| kind as u32 == mjSENS_RANGEFINDER) {
        return Ok(());
    }
    for (geom, kind) in view.values(field::geom_type).enumerate() {
        if kind as u32 != mjGEOM_HFIELD {
            continue;
        }
        let data = view.get(field::geom_dataid, geom);
        let hfield = data as usize;
        let [rows, columns] = [field::hfield_nrow, field::hfield_ncol].map(|count| view.get(count, hfield) as u64);
        let sizes: [f64; 4] = std::array::from_fn(|i| view.get(field::hfield_size, 4 * hfield + i));
        if rays_overrun_grid(rows, columns) || !are_ray_safe_sizes(&sizes) {
            let expected = "a rangefinder would read out of bounds of that height field; it needs two or more rows, no more rows \
                            than columns, and sizes from 1e-100 to 1e100";
            return Err(Invalid::element(field::geom_dataid.name(), geom, data, expected));
        }
    }
    Ok(())
}

/// Checks a user sensor. A callback computes its values, but the engine postprocesses them by their
/// data type, regardless of their number.
fn user(view: &View<'_>, i: usize) -> Result<(), Invalid> {
    is_in(view, field::sensor_needstage, i, mjSTAGE_POS.into()..=mjSTAGE_ACC.into())?;
    match view.get(field::sensor_datatype, i) as u32 {
        mjDATATYPE_AXIS => is(view, field::sensor_dim, i, 3, "because it is an axis")?,
        mjDATATYPE_QUATERNION => is(view, field::sensor_dim, i, 4, "because it is a quaternion")?,
        _ => is_in(view, field::sensor_dim, i, 0..=view.size(size::nsensordata) as i64)?,
    }
    let kind = view.get(field::sensor_objtype, i);
    // Since 3.0 the object is optional.
    if cfg!(engine_since = "3.5.0") && kind as u32 == mjOBJ_UNKNOWN {
        is(view, field::sensor_objid, i, -1, "because it has no object")?;
        return no_reference(view, i);
    }
    let Some(count) = count(view, kind) else {
        return Err(Invalid::element(field::sensor_objtype.name(), i, kind, "it must be a type of object"));
    };
    is_in(view, field::sensor_objid, i, ids(count))?;
    no_reference(view, i)
}

/// Checks the measured object and the reference object.
fn object(view: &View<'_>, i: usize, on: On) -> Result<(), Invalid> {
    let expected = match on {
        On::Site => mjOBJ_SITE,
        On::Scalar | On::Ball | On::Joint => mjOBJ_JOINT,
        On::Tendon => mjOBJ_TENDON,
        On::Actuator => mjOBJ_ACTUATOR,
        On::Body => mjOBJ_BODY,
        On::Nothing => mjOBJ_UNKNOWN,
        On::Frame | On::Relative => view.get(field::sensor_objtype, i) as u32,
    };
    let why = "the type of object that this type of sensor measures";
    is(view, field::sensor_objtype, i, expected.into(), why)?;
    if on == On::Nothing {
        is(view, field::sensor_objid, i, -1, "because it measures no object")?;
        return no_reference(view, i);
    }
    let needs_frame = matches!(on, On::Frame | On::Relative);
    if needs_frame && !has_frame(expected) {
        return Err(not_a_frame(field::sensor_objtype.name(), i, expected));
    }
    is_in(view, field::sensor_objid, i, ids(count(view, expected as i32).unwrap_or(0)))?;
    if matches!(on, On::Scalar | On::Ball) {
        joint(view, i, on)?;
    }
    if on != On::Relative || view.get(field::sensor_reftype, i) as u32 == mjOBJ_UNKNOWN {
        return no_reference(view, i);
    }
    let reference = view.get(field::sensor_reftype, i);
    if !has_frame(reference as u32) {
        return Err(not_a_frame(field::sensor_reftype.name(), i, reference as u32));
    }
    is_in(view, field::sensor_refid, i, ids(count(view, reference).unwrap_or(0)))
}

fn no_reference(view: &View<'_>, i: usize) -> Result<(), Invalid> {
    let why = "because it has no reference object";
    is(view, field::sensor_reftype, i, mjOBJ_UNKNOWN.into(), why)?;
    is(view, field::sensor_refid, i, -1, why)
}

/// Checks that the joint has the number of positions that the sensor reads.
fn joint(view: &View<'_>, i: usize, on: On) -> Result<(), Invalid> {
    let id = view.get(field::sensor_objid, i) as usize;
    let fits = match view.get(field::jnt_type, id) as u32 {
        mjJNT_SLIDE | mjJNT_HINGE => on == On::Scalar,
        mjJNT_BALL => on == On::Ball,
        _ => false,
    };
    if fits {
        return Ok(());
    }
    let expected = if on == On::Ball { "it must be a ball joint" } else { "it must be a slide or hinge joint" };
    Err(Invalid::element(field::sensor_objid.name(), i, id, expected))
}

fn has_frame(kind: u32) -> bool {
    [mjOBJ_BODY, mjOBJ_XBODY, mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_CAMERA].contains(&kind)
}

fn not_a_frame(name: &str, i: usize, kind: u32) -> Invalid {
    Invalid::element(name, i, kind as i32, "it must be the type of a body, geom, site or camera")
}
