//! Derivatives of rangefinders.
//!
//! A rangefinder measures the distance t from the origin of its site along the z axis d to a geom,
//! which it meets in the point x with the surface normal n. When degree of freedom j moves the ray
//! and the geom by their twists, the points of both at x move by s and g, and the ray meets the
//! moved surface at
//!
//! ```text
//! ∂t = n · (g − s)/(n · d)
//! ```
//!
//! Planes, spheres, capsules, ellipsoids, cylinders and boxes have a normal in closed form; the
//! others do not have a formula here.

use super::pose::Pose;
use super::{Point, Rows};
use crate::data::{Data, RayOptions};
use crate::enums::GeomType;
use crate::ffi;
use crate::id::Id;
use crate::numerics::spatial::{Vec3, add, dot, scale, sub, velocity_at};

/// Adds the derivatives of a rangefinder, which are NaN if it meets a geom without a formula.
pub(super) fn differentiate(point: Point<'_>, sensor: usize, rows: &mut Rows<'_>) {
    let Point { data, tree, .. } = point;
    let model = data.model();
    let pose = Pose::of_object(data, sensor);
    let direction = pose.axis(2);
    let options = RayOptions::default().with_bodyexclude(Id::new(pose.body, model.lineage()));
    let hit = match data.ray(pose.position, direction, &options) {
        Ok(Some(hit)) => hit,
        // The sensor has a constant value.
        Ok(None) => return,
        Err(_) => return rows.row_mut(0).fill(f64::NAN),
    };
    let geom = hit.geom.index();
    let end = add(&pose.position, &scale(&direction, hit.distance));
    let Some(normal) = normal(data, geom, &end) else { return rows.row_mut(0).fill(f64::NAN) };
    let factor = 1.0 / dot(&normal, &direction);
    for (body, sign) in [(pose.body, -1.0), (ffi::size(model.geom_bodyid()[geom]), 1.0)] {
        let arm = sub(&end, &data.subtree_com()[ffi::size(model.body_rootid()[body])]);
        for dof in tree.chain(tree.last[body]) {
            rows.row_mut(0)[dof] += sign * factor * dot(&normal, &velocity_at(&data.cdof()[dof], &arm));
        }
    }
}

/// Returns a normal of the surface of a geom, of any length, at a point on it.
fn normal(data: &Data, geom: usize, point: &Vec3) -> Option<Vec3> {
    let model = data.model();
    let (center, rotation) = (&data.geom_xpos()[geom], &data.geom_xmat()[geom]);
    let relative = sub(point, center);
    let [x, y, z]: Vec3 = std::array::from_fn(|axis| (0..3).map(|i| rotation[3 * i + axis] * relative[i]).sum());
    let size = model.geom_size()[geom];
    let kind = GeomType::of_field(model.geom_type()[geom]);
    let read = match kind {
        GeomType::Capsule | GeomType::Cylinder => 2,
        GeomType::Ellipsoid | GeomType::Box => 3,
        _ => 0,
    };
    // The surface that a ray meets has another shape if an edit has made a size negative.
    if size[..read].iter().any(|&size| size.is_nan() || size < 0.0) {
        return None;
    }
    let [size_x, size_y, size_z] = size;
    let local = match kind {
        GeomType::Plane => [0.0, 0.0, 1.0],
        GeomType::Sphere => [x, y, z],
        GeomType::Capsule => [x, y, z - z.clamp(-size_y, size_y)],
        GeomType::Ellipsoid => [x / size_x.powi(2), y / size_y.powi(2), z / size_z.powi(2)],
        // The nearer of the side and the ends.
        GeomType::Cylinder if (x.hypot(y) - size_x).abs() < (z.abs() - size_y).abs() => [x, y, 0.0],
        GeomType::Cylinder => [0.0, 0.0, z],
        GeomType::Box => {
            let local = [x, y, z];
            let depth = |axis: &usize| (local[*axis].abs() - [size_x, size_y, size_z][*axis]).abs();
            let face = (0..3).min_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap_or(0);
            std::array::from_fn(|axis| if axis == face { local[axis] } else { 0.0 })
        }
        _ => return None,
    };
    Some(std::array::from_fn(|i| (0..3).map(|axis| rotation[3 * i + axis] * local[axis]).sum()))
}
