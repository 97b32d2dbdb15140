//! Lower bounds of the depths of geoms, from which the resolution of shadow maps follows.

use crate::render::bounding_volume::BoundingVolume;
use crate::render::view::ViewFrustum;
use crate::scene::{SceneGeom, SceneGeomType};

/// Returns a lower bound of the depths at which a geom is visible, m: at least the depth of the
/// near plane. It is infinite for a geom without a visible face.
pub(super) fn nearest_depth(geom: SceneGeom<'_>, volume: &BoundingVolume, frustum: &ViewFrustum) -> f64 {
    let of_sphere = match volume {
        BoundingVolume::Sphere(sphere) => frustum.depth_of(sphere.centre) - frustum.scale * f64::from(sphere.radius),
        BoundingVolume::Unbounded | BoundingVolume::Empty => 0.0,
    };
    // A large plane or box has a bounding sphere that contains the camera, but its faces may be far
    // away.
    let of_faces = match geom.geom_type() {
        SceneGeomType::Plane => nearest_depth_of_face(geom, 2, 0.0, frustum),
        SceneGeomType::Box => (0..3)
            .map(|axis| nearest_depth_of_face(geom, axis, f64::from(geom.size()[axis]), frustum))
            .fold(f64::INFINITY, f64::min),
        _ => 0.0,
    };
    of_sphere.max(of_faces).max(frustum.range[0])
}

/// Returns the smallest depth at which the plane of a face is visible, m. Of the two faces that are
/// perpendicular to an axis of the geom, at the distance `half` from its centre, the camera sees at
/// most one.
fn nearest_depth_of_face(geom: SceneGeom<'_>, axis: usize, half: f64, frustum: &ViewFrustum) -> f64 {
    let mat = geom.mat().map(f64::from);
    let normal = [mat[axis], mat[3 + axis], mat[6 + axis]];
    let centre = geom.pos().map(f64::from);
    let faces = [half, -half].map(|offset| {
        let point = [0, 1, 2].map(|axis| centre[axis] + offset * normal[axis]);
        frustum.nearest_depth_of_plane(point, if offset < 0.0 { normal.map(|part| -part) } else { normal })
    });
    faces[0].min(faces[1])
}
