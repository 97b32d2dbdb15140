//! Where a picture is drawn from.

use super::matrix::{Matrix4, apply, dot, frustum, look, placed, product, row};
use crate::error::{Error, Result};
use crate::render::settings::is_drawable;
use crate::scene::{Scene, Viewpoint};

/// Where a picture is drawn from, in the model's frame.
#[derive(Debug, Clone)]
pub(crate) struct Eye {
    /// From the world to the cube that is seen.
    pub(crate) clip: Matrix4,
    /// The depth of a point, m, is this row times it.
    pub(crate) depth: [f64; 4],
    /// Where the head is, and where it looks.
    pub(crate) head: [f64; 3],
    pub(crate) gaze: [f64; 3],
    /// The near and the far side of the frustum, m.
    pub(crate) range: [f64; 2],
    /// The scale of the model in the room.
    pub(crate) scale: f64,
    /// The corners of the far side of what is seen, as directions from the head.
    pub(crate) corners: [[f64; 3]; 4],
    /// Pixels that a metre has at a distance of one metre.
    pub(crate) pixels: f64,
    /// Whether the picture is upside down.
    pub(crate) turned: bool,
}

impl Eye {
    /// That of a scene for pictures of a size; `viewpoint` is the middle between the eyes or one of them.
    ///
    /// # Errors
    ///
    /// If the scene has no viewpoint yet, or one from which nothing can be seen.
    pub(crate) fn new(scene: &Scene, viewpoint: &Viewpoint, [width, height]: [u32; 2]) -> Result<Self> {
        check(viewpoint)?;
        let wide = |vector: [f32; 3]| vector.map(f64::from);
        let head = scene.camera_in_model()?;
        let [bottom, top] = [viewpoint.frustum_bottom, viewpoint.frustum_top].map(f64::from);
        let range = [viewpoint.frustum_near, viewpoint.frustum_far].map(f64::from);
        let half = 0.5 * f64::from(width) / f64::from(height) * (top - bottom);
        let center = f64::from(viewpoint.frustum_center);
        let projection = frustum([center - half, center + half], [bottom, top], range);
        let mut view = look(wide(viewpoint.pos), wide(viewpoint.forward), wide(viewpoint.up));
        let mut scale = 1.0;
        if let Some(transform) = scene.transform() {
            scale = f64::from(transform.scale);
            view = product(&view, &placed(transform.rotate.map(f64::from), scale, wide(transform.translate)));
        }
        // The rows of the view are the eye's axes in the model's frame, times the scale.
        let axes = [0, 1, 2].map(|axis| row(&view, axis)).map(|[x, y, z, _]| [x, y, z]);
        let corners = [[-1.0, bottom], [1.0, bottom], [1.0, top], [-1.0, top]].map(|[side, up]| {
            let at = [center + side * half, up, -range[0]];
            [0, 1, 2].map(|axis| (0..3).map(|k| at[k] * axes[k][axis]).sum::<f64>())
        });
        let depth = row(&view, 2).map(|number| -number);
        let clip = product(&projection, &view);
        let pixels = f64::from(height) * range[0] / (top - bottom);
        Ok(Self { clip, depth, head: head.pos, gaze: head.forward, range, scale, corners, pixels, turned: false })
    }

    /// The same eye, for a picture that is drawn upside down. Its rows are in OpenGL's order then, and the samples of its pixels
    /// where OpenGL has them: otherwise they would lie in a mirrored pattern, and edges would be a little different.
    pub(crate) fn turned(mut self) -> Self {
        for column in &mut self.clip {
            column[1] = -column[1];
        }
        Self { turned: !self.turned, ..self }
    }

    /// The depth of a point, m.
    pub(crate) fn depth_of(&self, point: [f32; 3]) -> f64 {
        let [x, y, z] = point.map(f64::from);
        dot([self.depth[0], self.depth[1], self.depth[2]], [x, y, z]) + self.depth[3]
    }

    /// The same eye in a mirror.
    pub(crate) fn mirrored(&self, mirror: &Matrix4) -> Self {
        let clip = product(&self.clip, mirror);
        let rows = mirror.map(|column| (0..4).map(|k| column[k] * self.depth[k]).sum());
        let [x, y, z] = self.head;
        let [x, y, z, _] = apply(mirror, [x, y, z, 1.0]);
        Self { clip, depth: rows, head: [x, y, z], ..self.clone() }
    }

    /// The planes that bound what is seen: left, right, bottom, top, near, far. A point is seen where the products with all are
    /// positive; they are distances in metres of the room.
    pub(crate) fn planes(&self) -> [[f32; 4]; 6] {
        let [x, y, z, w] = [0, 1, 2, 3].map(|index| row(&self.clip, index));
        let plane = |sign: f64, with: [f64; 4], base: [f64; 4]| {
            let plane = [0, 1, 2, 3].map(|k| base[k] + sign * with[k]);
            let length = dot([plane[0], plane[1], plane[2]], [plane[0], plane[1], plane[2]]).sqrt();
            plane.map(|number| (number / length) as f32)
        };
        [
            plane(1.0, x, w),
            plane(-1.0, x, w),
            plane(1.0, y, w),
            plane(-1.0, y, w),
            plane(1.0, z, [0.0; 4]),
            plane(-1.0, z, w),
        ]
    }
}

fn check(viewpoint: &Viewpoint) -> Result<()> {
    let frustum = [
        viewpoint.frustum_center,
        viewpoint.frustum_bottom,
        viewpoint.frustum_top,
        viewpoint.frustum_near,
        viewpoint.frustum_far,
    ];
    let numbers = viewpoint.pos.iter().chain(&viewpoint.forward).chain(&viewpoint.up).chain(&frustum);
    let is_ordered = viewpoint.frustum_near > 1e-15
        && viewpoint.frustum_far > viewpoint.frustum_near
        && viewpoint.frustum_top > viewpoint.frustum_bottom;
    if numbers.into_iter().all(|&number| is_drawable(number)) && is_ordered {
        return Ok(());
    }
    Err(Error::invalid(
        "the viewpoint of the scene",
        format!("{viewpoint:?}"),
        "that of a scene that was updated, below 1e15, with a frustum of 0 < near < far and bottom < top",
    ))
}
