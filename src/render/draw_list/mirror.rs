//! Planar mirror: the surface of a reflective plane, or the +z face of a reflective box.

use super::instance::Instance;
use super::is_infinite_plane;
use crate::numerics::spatial::dot;
use crate::render::assets::Shapes;
use crate::render::view::ViewFrustum;
use crate::render::view::matrix::{Matrix4, apply, reflection, unit};
use crate::scene::{SceneGeom, SceneGeomType};

/// Mirror that faces the camera.
#[derive(Debug, Clone)]
pub(crate) struct Mirror {
    /// Reflection at the plane of the mirror.
    pub(crate) reflection: Matrix4,
    /// Plane of the mirror: its product with a point (x, y, z, 1) is the signed distance, m.
    pub(crate) plane: [f32; 4],
    pub(crate) reflectance: f32,
    /// Shape and instance that mark the mirror in the stencil buffer. `None` for an infinite plane,
    /// which needs no stencil test because it covers all of its mirror images.
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
        let offset = dot(&normal, &point);
        if dot(&normal, &camera.map(f64::from)) < offset {
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

    /// Returns the rectangle of an image of this size that contains the mirror, pixels: left, top,
    /// width and height. `None` if the mirror is outside of the image.
    pub(crate) fn bounds(&self, frustum: &ViewFrustum, size: [u32; 2]) -> Option<[u32; 4]> {
        let whole = Some([0, 0, size[0], size[1]]);
        let Some((_, Instance { rows, .. })) = &self.stencil_mark else { return whole };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            let [x, y, z] = rows.map(|row| f64::from(row[0] * corner[0] + row[1] * corner[1] + row[3]));
            let [x, y, _, w] = apply(&frustum.clip, [x, y, z, 1.0]);
            // A corner behind the camera has no place in the image.
            if w.is_nan() || w <= 0.0 {
                return whole;
            }
            for (axis, coordinate) in [x, -y].into_iter().enumerate() {
                let pixels = (0.5 + 0.5 * coordinate / w) * f64::from(size[axis]);
                (low[axis], high[axis]) = (low[axis].min(pixels), high[axis].max(pixels));
            }
        }
        // One pixel more on each side, because rasterisers round positions.
        let [[left, right], [top, bottom]] = [0, 1].map(|axis| {
            let limit = f64::from(size[axis]);
            [low[axis].floor() - 1.0, high[axis].ceil() + 1.0].map(|end| end.clamp(0.0, limit) as u32)
        });
        (left < right && top < bottom).then(|| [left, top, right - left, bottom - top])
    }
}

#[cfg(test)]
mod tests {
    use super::{Instance, Mirror};
    use crate::render::view::ViewFrustum;
    use crate::render::view::matrix::IDENTITY;

    /// Returns a mirror in the plane z = 0 with these half-widths and this centre.
    fn mirror(half: [f32; 2], [x, y]: [f32; 2]) -> Mirror {
        let rows = [[half[0], 0.0, 0.0, x], [0.0, half[1], 0.0, y], [0.0, 0.0, 1.0, 0.0]];
        let instance = Instance { rows, ..bytemuck::Zeroable::zeroed() };
        Mirror { reflection: IDENTITY, plane: [0.0; 4], reflectance: 1.0, stencil_mark: Some((0, instance)) }
    }

    /// Returns a frustum with this last row of the projection, whose other rows are the same as in
    /// the identity.
    fn frustum(w: [f64; 4]) -> ViewFrustum {
        let mut clip = IDENTITY;
        for (column, w) in clip.iter_mut().zip(w) {
            column[3] = w;
        }
        ViewFrustum {
            clip,
            depth: [0.0; 4],
            position: [0.0; 3],
            forward: [0.0; 3],
            range: [0.1, 10.0],
            scale: 1.0,
            corners: [[0.0; 3]; 4],
            pixels_per_metre: 100.0,
            orthographic: false,
            flip_y: false,
        }
    }

    #[test]
    fn bounds_contain_the_mirror_with_one_pixel_more() {
        let orthographic = frustum([0.0, 0.0, 0.0, 1.0]);
        let bounds = |half, centre| mirror(half, centre).bounds(&orthographic, [200, 100]);
        assert_eq!(bounds([0.25, 0.5], [0.5, 0.0]), Some([124, 24, 52, 52]));
        assert_eq!(bounds([0.25, 0.5], [0.5, 1.0]), Some([124, 0, 52, 26]), "positive y is up");
        assert_eq!(bounds([2.0, 2.0], [0.0, 0.0]), Some([0, 0, 200, 100]));
        assert_eq!(bounds([0.5, 0.5], [3.0, 0.0]), None);
    }

    #[test]
    fn a_mirror_that_reaches_behind_the_camera_has_the_bounds_of_the_image() {
        let perspective = frustum([0.0, 1.0, 0.0, 0.5]);
        assert_eq!(mirror([0.1, 1.0], [3.0, 0.0]).bounds(&perspective, [200, 100]), Some([0, 0, 200, 100]));
        assert_eq!(mirror([0.1, 0.4], [3.0, 0.0]).bounds(&perspective, [200, 100]), None);
    }
}
