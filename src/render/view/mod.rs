//! View frustum, lights and the uniforms derived from them.

mod light;
pub(crate) mod matrix;
mod shadow_region;
mod uniform;

pub(crate) use self::light::{ActiveLight, LightFeatures, Lights, MAX_SHADOWS};
use self::matrix::{Matrix4, apply, look_to, orthographic, perspective, product, row, similarity};
pub(crate) use self::shadow_region::{ShadowRegion, reduction};
pub(crate) use self::uniform::{Place, UniformData, ViewUniforms};
use super::settings::is_drawable;
use crate::error::{Error, Result};
use crate::numerics::spatial::dot;
use crate::scene::{Scene, Viewpoint};

/// Distance of the skybox as a fraction of the far plane, so that its corners are nearer than the
/// far plane.
const SKY_FRACTION: f64 = 0.7;

/// View frustum and projection of a frame, in model space.
#[derive(Debug, Clone)]
pub(crate) struct ViewFrustum {
    /// Projection from world space to clip space, whose depth is 1 in the near plane and 0 in the
    /// far plane: depths in single precision are then precise at every distance, as in the images
    /// of engines from 3.0.1.
    pub(crate) clip: Matrix4,
    /// Row vector whose product with a point (x, y, z, 1) is its depth, m.
    pub(crate) depth: [f64; 4],
    /// Position of the camera, midway between the eyes.
    pub(crate) position: [f64; 3],
    /// Viewing direction.
    pub(crate) forward: [f64; 3],
    /// Distances of the near and the far plane, m.
    pub(crate) range: [f64; 2],
    /// Scale from model space to room space.
    pub(crate) scale: f64,
    /// Directions from the camera to the four corners of the image in the near plane.
    pub(crate) corners: [[f64; 3]; 4],
    /// Size in pixels of a metre at a distance of one metre, or at every distance in an
    /// orthographic projection: the larger one of both axes.
    pub(crate) pixels_per_metre: f64,
    pub(crate) orthographic: bool,
    /// The frame is rendered upside down.
    pub(crate) flip_y: bool,
}

impl ViewFrustum {
    /// Computes the frustum of a viewpoint of the scene for an image size.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the scene was never updated or the viewpoint is degenerate.
    pub(crate) fn new(scene: &Scene, viewpoint: &Viewpoint, [width, height]: [u32; 2]) -> Result<Self> {
        check(viewpoint)?;
        let wide = |vector: [f32; 3]| vector.map(f64::from);
        let camera = scene.camera_in_model()?;
        let [bottom, top] = [viewpoint.frustum_bottom, viewpoint.frustum_top].map(f64::from);
        let range = [viewpoint.frustum_near, viewpoint.frustum_far].map(f64::from);
        let half = viewpoint.half_width(f64::from(width) / f64::from(height));
        let center = f64::from(viewpoint.frustum_center);
        let project = if viewpoint.orthographic { orthographic } else { perspective };
        let projection = reversed(project([center - half, center + half], [bottom, top], range));
        let mut view = look_to(wide(viewpoint.pos), wide(viewpoint.forward), wide(viewpoint.up));
        let mut scale = 1.0;
        if let Some(transform) = scene.transform() {
            scale = f64::from(transform.scale);
            view = product(&view, &similarity(transform.rotate.map(f64::from), scale, wide(transform.translate)));
        }
        // The rows of the view matrix are the camera axes in model space, times the scale.
        let axes = [0, 1, 2].map(|axis| row(&view, axis)).map(|[x, y, z, _]| [x, y, z]);
        let corners = [[-1.0, bottom], [1.0, bottom], [1.0, top], [-1.0, top]].map(|[side, up]| {
            let at = [center + side * half, up, -range[0]];
            [0, 1, 2].map(|axis| (0..3).map(|k| at[k] * axes[k][axis]).sum::<f64>())
        });
        let pixels = (0.5 * f64::from(width) / half).max(f64::from(height) / (top - bottom));
        Ok(Self {
            clip: product(&projection, &view),
            depth: row(&view, 2).map(|number| -number),
            position: camera.pos,
            forward: camera.forward,
            range,
            scale,
            corners,
            pixels_per_metre: if viewpoint.orthographic { pixels } else { pixels * range[0] },
            orthographic: viewpoint.orthographic,
            flip_y: false,
        })
    }

    /// Flips the frustum vertically, to render upside down. Rows are then in OpenGL's order, and
    /// the MSAA samples have OpenGL's positions: otherwise the sample pattern would be mirrored,
    /// and edges would differ slightly from the engine's.
    pub(crate) fn flipped(mut self) -> Self {
        for column in &mut self.clip {
            column[1] = -column[1];
        }
        Self { flip_y: !self.flip_y, ..self }
    }

    /// Returns three rows for an image of `size`: the products of the first two with a point (x, y,
    /// z, 1), divided by the product of the last, are the position of the point in the image,
    /// pixels to the right and up from the centre.
    pub(crate) fn pixel_rows(&self, size: [u32; 2]) -> [[f32; 4]; 3] {
        let [half_width, half_height] = size.map(|length| 0.5 * f64::from(length));
        let up = if self.flip_y { -half_height } else { half_height };
        [(0, half_width), (1, up), (3, 1.0)]
            .map(|(index, factor)| row(&self.clip, index).map(|number| (factor * number) as f32))
    }

    /// Returns the depth of a point, m.
    pub(crate) fn depth_of(&self, point: [f32; 3]) -> f64 {
        let [x, y, z] = point.map(f64::from);
        dot(&[self.depth[0], self.depth[1], self.depth[2]], &[x, y, z]) + self.depth[3]
    }

    /// Returns the size in pixels of a metre in room space at a depth, at the centre of the image.
    pub(crate) fn pixels_at(&self, depth: f64) -> f64 {
        if self.orthographic { self.pixels_per_metre } else { self.pixels_per_metre / depth }
    }

    /// Returns the change of the depth along a vector, m.
    pub(crate) fn depth_along(&self, vector: [f64; 3]) -> f64 {
        dot(&[self.depth[0], self.depth[1], self.depth[2]], &vector)
    }

    /// Returns the smallest depth at which a plane is visible, m: infinite if the camera is on the
    /// plane or behind it, or if no ray through the image meets the plane.
    pub(crate) fn nearest_depth_of_plane(&self, point: [f64; 3], normal: [f64; 3]) -> f64 {
        let height = dot(&normal, &[0, 1, 2].map(|axis| self.position[axis] - point[axis]));
        if self.orthographic {
            return self.nearest_depth_of_plane_along_axis(height, normal);
        }
        // The reciprocal of the depth is an affine function of the pixel, whose maximum is in a
        // corner of the image.
        let reciprocals = self.corners.map(|ray| -dot(&normal, &ray) / (height * self.depth_along(ray)));
        let largest = reciprocals.into_iter().fold(0.0, f64::max);
        if height > 0.0 && largest > 0.0 { 1.0 / largest } else { f64::INFINITY }
    }

    /// Returns the smallest depth at which a plane is visible in an orthographic projection, as
    /// [`nearest_depth_of_plane`](Self::nearest_depth_of_plane). `height` is the height of the
    /// camera above the plane.
    fn nearest_depth_of_plane_along_axis(&self, height: f64, normal: [f64; 3]) -> f64 {
        let descent = -dot(&normal, &self.forward);
        // The rays are parallel to the optical axis, and the depth is an affine function of the
        // pixel.
        let depths = self.corners.map(|corner| {
            let along = dot(&corner, &self.forward);
            // The axes of the camera are scaled, and corners are in room space.
            let across = [0, 1, 2].map(|axis| (corner[axis] - along * self.forward[axis]) / (self.scale * self.scale));
            self.scale * (height + dot(&normal, &across)) / descent
        });
        let [nearest, farthest] =
            [depths.into_iter().fold(f64::INFINITY, f64::min), depths.into_iter().fold(f64::NEG_INFINITY, f64::max)];
        if descent > 0.0 && farthest > 0.0 { nearest.max(0.0) } else { f64::INFINITY }
    }

    /// Returns the distance of the skybox from the camera, in model units.
    pub(crate) fn sky_distance(&self) -> f64 {
        SKY_FRACTION * self.range[1] / self.scale
    }

    /// Returns the frustum of the mirror image, for a reflection matrix.
    pub(crate) fn mirrored(&self, reflection: &Matrix4) -> Self {
        let [x, y, z] = self.position;
        let [x, y, z, _] = apply(reflection, [x, y, z, 1.0]);
        Self {
            clip: product(&self.clip, reflection),
            depth: reflection.map(|column| (0..4).map(|k| column[k] * self.depth[k]).sum()),
            position: [x, y, z],
            ..self.clone()
        }
    }

    /// Returns the planes of the frustum: left, right, bottom, top, near, far. The product of a
    /// plane with a point (x, y, z, 1) is its signed distance in room space, m, positive inside.
    pub(crate) fn planes(&self) -> [[f32; 4]; 6] {
        let [x, y, z, w] = [0, 1, 2, 3].map(|index| row(&self.clip, index));
        let plane = |sign: f64, with: [f64; 4], base: [f64; 4]| {
            let plane = [0, 1, 2, 3].map(|k| base[k] + sign * with[k]);
            let length = dot(&[plane[0], plane[1], plane[2]], &[plane[0], plane[1], plane[2]]).sqrt();
            plane.map(|number| (number / length) as f32)
        };
        [
            plane(1.0, x, w),
            plane(-1.0, x, w),
            plane(1.0, y, w),
            plane(-1.0, y, w),
            plane(-1.0, z, w),
            plane(1.0, z, [0.0; 4]),
        ]
    }
}

/// Reverses the depth of a projection.
fn reversed(projection: Matrix4) -> Matrix4 {
    projection.map(|[x, y, z, w]| [x, y, w - z, w])
}

fn check(viewpoint: &Viewpoint) -> Result<()> {
    let frustum = [
        viewpoint.frustum_center,
        viewpoint.frustum_width,
        viewpoint.frustum_bottom,
        viewpoint.frustum_top,
        viewpoint.frustum_near,
        viewpoint.frustum_far,
    ];
    let numbers = viewpoint.pos.iter().chain(&viewpoint.forward).chain(&viewpoint.up).chain(&frustum);
    let is_ordered = viewpoint.frustum_near > 1e-15
        && viewpoint.frustum_far > viewpoint.frustum_near
        && viewpoint.frustum_top > viewpoint.frustum_bottom
        && viewpoint.frustum_width >= 0.0;
    if numbers.into_iter().all(|&number| is_drawable(number)) && is_ordered {
        return Ok(());
    }
    Err(Error::out_of_range(
        "the viewpoint of the scene",
        format!("{viewpoint:?}"),
        "from an updated scene, with magnitudes below 1e15 and a frustum of 0 < near < far and bottom < top",
    ))
}
