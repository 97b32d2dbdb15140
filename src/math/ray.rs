//! Where a ray meets a shape that stands by itself, outside of any simulation.
//!
//! A ray starts at `pnt` and goes along `vec`, both in metres and in the world frame. The distance is in units of the length of
//! `vec`: the point is `pnt + distance · vec`.

use std::ffi::c_int;

use mujoco_sys::{self as sys, mjMINVAL};

use super::count;
use crate::enums::GeomType;
use crate::error::{Error, Result};

/// How far away a ray meets a geom at the position `pos` with the rotation matrix `mat` and the engine's three sizes, if at all.
/// Planes are met from their front only.
///
/// # Errors
///
/// [`Error::Invalid`] for a mesh and a height field, which are more than a size, for a direction that is zero, and for a number
/// that is none.
///
/// ```
/// use mujoco_safe::{GeomType, math};
///
/// let upright = math::quat2mat(&[1.0, 0.0, 0.0, 0.0]);
/// let ball = |pnt| math::ray_geom(&[0.0; 3], &upright, &[0.5, 0.0, 0.0], pnt, &[0.0, 0.0, -1.0], GeomType::Sphere);
/// assert_eq!(ball(&[0.0, 0.0, 2.0])?, Some(1.5));
/// assert_eq!(ball(&[1.0, 0.0, 2.0])?, None);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mju_rayGeom")]
pub fn ray_geom(
    pos: &[f64; 3],
    mat: &[f64; 9],
    size: &[f64; 3],
    pnt: &[f64; 3],
    vec: &[f64; 3],
    geomtype: GeomType,
) -> Result<Option<f64>> {
    check_ray(pnt, vec)?;
    let number = match geomtype {
        GeomType::Plane => sys::mjGEOM_PLANE,
        GeomType::Sphere => sys::mjGEOM_SPHERE,
        GeomType::Capsule => sys::mjGEOM_CAPSULE,
        GeomType::Ellipsoid => sys::mjGEOM_ELLIPSOID,
        GeomType::Cylinder => sys::mjGEOM_CYLINDER,
        GeomType::Box => sys::mjGEOM_BOX,
        other => {
            return Err(Error::invalid(
                "geomtype of ray_geom",
                format!("{other:?}"),
                "a plane, sphere, capsule, ellipsoid, cylinder or box",
            ));
        }
    };
    // SAFETY: three, nine, three, three and three numbers to read, and a type for which the engine raises no error.
    let distance = unsafe {
        sys::mju_rayGeom(pos.as_ptr(), mat.as_ptr(), size.as_ptr(), pnt.as_ptr(), vec.as_ptr(), number as c_int)
    };
    Ok((distance >= 0.0).then_some(distance))
}

/// Where a ray has met a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinHit {
    /// How far away, in units of the length of `vec`.
    pub distance: f64,
    /// The vertex that is nearest to the point.
    pub vertex: usize,
}

/// Where a ray first meets one of the triangles `face`, each of three indices into `vert` (m, world frame), if at all.
///
/// # Errors
///
/// [`Error::Invalid`] for an index of no vertex, for a direction that is zero, and for a number that is none,
/// [`Error::Unsupported`] for more of either than a C int counts.
#[doc(alias = "mju_raySkin")]
pub fn ray_skin(face: &[[i32; 3]], vert: &[[f32; 3]], pnt: &[f64; 3], vec: &[f64; 3]) -> Result<Option<SkinHit>> {
    check_ray(pnt, vec)?;
    let (faces, vertices) = (face.as_flattened(), vert.as_flattened());
    count("the faces of ray_skin", faces.len())?;
    count("the vertices of ray_skin", vertices.len())?;
    if let Some(wrong) = faces.iter().find(|&&index| usize::try_from(index).map_or(true, |index| index >= vert.len())) {
        return Err(Error::invalid(
            "an index in face of ray_skin",
            wrong,
            format!("that of one of {} vertices", vert.len()),
        ));
    }
    let mut vertex = -1;
    // SAFETY: the triangles and vertices are as many as said, and every index is that of a vertex.
    let distance = unsafe {
        sys::mju_raySkin(
            face.len() as c_int,
            vert.len() as c_int,
            faces.as_ptr(),
            vertices.as_ptr(),
            pnt.as_ptr(),
            vec.as_ptr(),
            &raw mut vertex,
        )
    };
    Ok(usize::try_from(vertex).ok().filter(|_| distance >= 0.0).map(|vertex| SkinHit { distance, vertex }))
}

/// Refuses a ray without a direction, for which the engine divides by zero or ends the process.
pub(crate) fn check_ray(pnt: &[f64; 3], vec: &[f64; 3]) -> Result<()> {
    let invalid =
        |what: &str, value: &[f64; 3], expected: &str| Err(Error::invalid(what, format!("{value:?}"), expected));
    if !pnt.iter().all(|value| value.is_finite()) {
        return invalid("the point of a ray", pnt, "finite");
    }
    let length = vec.iter().map(|value| value * value).sum::<f64>().sqrt();
    if length.is_finite() && length >= mjMINVAL {
        Ok(())
    } else {
        invalid("the direction of a ray", vec, "finite and not zero")
    }
}
