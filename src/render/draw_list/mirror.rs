//! Planar mirror: the surface of a reflective plane, or the +z face of a reflective box.

use super::instance::Instance;
use super::is_infinite_plane;
use crate::render::assets::Shapes;
use crate::render::view::matrix::{Matrix4, dot, reflection, unit};
use crate::scene::{SceneGeom, SceneGeomType};

/// Mirror that faces the camera.
#[derive(Debug, Clone)]
pub(crate) struct Mirror {
    /// Reflection at the plane of the mirror.
    pub(crate) reflection: Matrix4,
    /// Plane of the mirror: its product with a point (x, y, z, 1) is the signed distance, m.
    pub(crate) plane: [f32; 4],
    pub(crate) reflectance: f32,
    /// Shape and instance that mark the mirror in the stencil buffer. `None` for an infinite plane, which needs no
    /// stencil test because it covers all of its mirror images.
    pub(crate) stencil_mark: Option<(u32, Instance)>,
}

impl Mirror {
    /// Creates the mirror of a geom, unless the camera is behind it.
    pub(super) fn new(geom: SceneGeom<'_>, camera: [f32; 3], shapes: &Shapes) -> Option<Self> {
        let (mut pos, mat, size) = (geom.pos(), geom.mat(), geom.size());
        let normal = unit([mat[2], mat[5], mat[8]].map(f64::from));
        if geom.geom_type() == SceneGeomType::Box {
            for axis in 0..3 {
                pos[axis] += size[2] * mat[3 * axis + 2];
            }
        }
        let point = pos.map(f64::from);
        let offset = dot(normal, point);
        if dot(normal, camera.map(f64::from)) < offset {
            return None;
        }
        let stencil_mark = (!is_infinite_plane(geom)).then(|| {
            let (shape, half) = match shapes.plane(geom.plane()) {
                Some(plane) => (plane.shape, plane.half),
                None => (shapes.square(), [size[0], size[1]]),
            };
            let rows =
                [0, 1, 2].map(|row| [mat[3 * row] * half[0], mat[3 * row + 1] * half[1], mat[3 * row + 2], pos[row]]);
            (shape, Instance { rows, ..bytemuck::Zeroable::zeroed() })
        });
        let [x, y, z] = normal.map(|part| part as f32);
        Some(Self {
            reflection: reflection(point, normal),
            plane: [x, y, z, -offset as f32],
            reflectance: geom.reflectance().min(1e3),
            stencil_mark,
        })
    }
}
