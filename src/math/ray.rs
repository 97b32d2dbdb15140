//! Intersections of rays with single shapes, without a simulation.
//!
//! A ray starts at `pnt` in the direction `vec`, both in metres in the world frame. Distances are
//! multiples of the length of `vec`: the intersection is `pnt + distance · vec`.

use std::ffi::c_int;

use mujoco_sys::{self as sys, mjMINVAL};

use super::count;
use crate::enums::GeomType;
use crate::error::{Error, InvalidKind, Result};
use crate::numerics::spatial::norm;

/// Returns the distance along a ray to a geom at the position `pos` with the rotation matrix `mat`
/// and the engine's three sizes; `None` without an intersection. Planes are one-sided: rays
/// intersect them only from the front.
///
/// # Errors
///
/// [`Error::Invalid`] for a mesh or a height field, whose size does not define the shape, for a
/// zero direction, and for a ray that is not finite.
///
/// ```
/// use mujoco_safe::enums::GeomType;
/// use mujoco_safe::math;
///
/// let upright = math::quat2mat(&[1.0, 0.0, 0.0, 0.0]);
/// let ball = |pnt| math::ray_geom(&[0.0; 3], &upright, &[0.5, 0.0, 0.0], pnt, &[0.0, 0.0, -1.0], GeomType::Sphere);
/// assert_eq!(ball(&[0.0, 0.0, 2.0])?, Some(1.5));
/// assert_eq!(ball(&[1.0, 0.0, 2.0])?, None);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
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
                InvalidKind::Unsuitable,
                "geomtype of ray_geom",
                format!("{other:?}"),
                "a plane, sphere, capsule, ellipsoid, cylinder or box",
            ));
        }
    };
    // SAFETY: the arrays have the lengths that the engine reads, and it accepts all of these types.
    let distance = unsafe {
        sys::adapted::ray_geom(pos.as_ptr(), mat.as_ptr(), size.as_ptr(), pnt.as_ptr(), vec.as_ptr(), number as c_int)
    };
    Ok((distance >= 0.0).then_some(distance))
}

/// Intersection of a ray with a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinHit {
    /// Distance, as a multiple of the length of `vec`.
    pub distance: f64,
    /// Index of the vertex nearest to the intersection.
    pub vertex: usize,
}

/// Returns the first intersection of a ray with the triangles `face`, each of three indices into
/// `vert` (m, world frame), if any.
///
/// # Errors
///
/// [`Error::Invalid`] for an index out of bounds, for a zero direction, and for a ray that is not
/// finite, [`Error::Unsupported`] for more faces or vertices than a C `int` counts.
pub fn ray_skin(face: &[[i32; 3]], vert: &[[f32; 3]], pnt: &[f64; 3], vec: &[f64; 3]) -> Result<Option<SkinHit>> {
    check_ray(pnt, vec)?;
    let (faces, vertices) = (face.as_flattened(), vert.as_flattened());
    count("the faces of ray_skin", faces.len())?;
    count("the vertices of ray_skin", vertices.len())?;
    if let Some(wrong) = faces.iter().find(|&&index| usize::try_from(index).map_or(true, |index| index >= vert.len())) {
        return Err(Error::out_of_range(
            "an index in face of ray_skin",
            wrong,
            format!("the index of one of {} vertices", vert.len()),
        ));
    }
    let mut vertex = -1;
    // SAFETY: the counts are the lengths of `face` and `vert`, and every index is in bounds.
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

/// Rejects a ray with a zero direction, for which the engine divides by zero or ends the process,
/// and a non-finite ray.
pub(crate) fn check_ray(pnt: &[f64; 3], vec: &[f64; 3]) -> Result<()> {
    if !pnt.iter().all(|value| value.is_finite()) {
        return Err(Error::not_finite("the point of a ray", format!("{pnt:?}")));
    }
    let length = norm(vec);
    if length.is_finite() && length >= mjMINVAL {
        Ok(())
    } else {
        Err(Error::out_of_range("the direction of a ray", format!("{vec:?}"), "finite and not zero"))
    }
}
