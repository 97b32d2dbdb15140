//! The one geom that mirrors the others: the first plane or box with reflectance. Of a box it is the upper side.

use super::instance::Instance;
use crate::render::content::Shapes;
use crate::render::frame::matrix::{Matrix4, dot, mirror, unit};
use crate::scene::{SceneGeom, SceneGeomType};

/// A mirror that the eye is before.
#[derive(Debug, Clone)]
pub(crate) struct Mirror {
    /// From a point to its mirror image.
    pub(crate) matrix: Matrix4,
    /// The height of a point over the mirror, m, is this times it.
    pub(crate) plane: [f32; 4],
    pub(crate) reflectance: f32,
    /// Where it is on the picture: a shape in its place. None for one without end, which is wherever nothing else is.
    pub(crate) mark: Option<(u32, Instance)>,
}

impl Mirror {
    pub(super) fn new(geom: SceneGeom<'_>, head: [f32; 3], shapes: &Shapes) -> Option<Self> {
        let (mut pos, mat, size) = (geom.pos(), geom.mat(), geom.size());
        let normal = unit([mat[2], mat[5], mat[8]].map(f64::from));
        let is_box = geom.geom_type() == SceneGeomType::Box;
        if is_box {
            for axis in 0..3 {
                pos[axis] += size[2] * mat[3 * axis + 2];
            }
        }
        let point = pos.map(f64::from);
        let height = dot(normal, point);
        // From behind nothing is mirrored.
        if dot(normal, head.map(f64::from)) < height {
            return None;
        }
        let is_endless = !is_box && size[0] == 0.0 && size[1] == 0.0;
        let mark = (!is_endless).then(|| {
            let (shape, half) = match shapes.plane(geom.plane()) {
                Some(plane) => (plane.shape, plane.half),
                None => (shapes.square(), [size[0], size[1]]),
            };
            let rows =
                [0, 1, 2].map(|row| [mat[3 * row] * half[0], mat[3 * row + 1] * half[1], mat[3 * row + 2], pos[row]]);
            (shape, Instance { rows, ..bytemuck::Zeroable::zeroed() })
        });
        let [x, y, z] = normal.map(|part| part as f32);
        let reflectance = geom.reflectance().min(1e3);
        Some(Self { matrix: mirror(point, normal), plane: [x, y, z, -height as f32], reflectance, mark })
    }
}
