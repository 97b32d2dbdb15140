//! Allocated regions of shadow maps, and their resolution.

use super::ViewFrustum;
use super::matrix::{IDENTITY, Matrix4, row};
use crate::numerics::spatial::dot;

/// Allocated region of a shadow map: its resolution, its first texel, its size, and its depth
/// range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ShadowRegion {
    /// Width of a texel of the region, in texels of the full map: a power of two; see
    /// [`reduction`].
    pub(crate) reduction: u32,
    pub(crate) origin: [u32; 2],
    pub(crate) size: [u32; 2],
    /// First texel of the region in its texture.
    pub(crate) place: [u32; 2],
    /// Number of frames since the map was cleared; see [`depth_range`](Self::depth_range).
    pub(crate) frames_since_clear: u32,
}

impl ShadowRegion {
    /// Depth range of the frame in which the map is cleared.
    pub(crate) const CLEARED_RANGE: [f32; 2] = [0.5, 1.0];

    /// Returns the transformation from the clip space of the light to the clip space of the region,
    /// for a full map of `size` texels. The full map has a border of one texel, to which nothing is
    /// rendered.
    pub(crate) fn clip_to_region(&self, size: u32) -> Matrix4 {
        let mut matrix = IDENTITY;
        let inner = f64::from(size) - 2.0;
        let [x, y] = self.in_full_texels();
        for (axis, [origin, length]) in [x, y].into_iter().enumerate() {
            matrix[axis][axis] = inner / length;
            // A point has the coordinate 1 + (x + 1) / 2 * inner in texels of the full map.
            matrix[3][axis] = 2.0 * (1.0 + inner / 2.0 - origin) / length - 1.0;
        }
        matrix[1][1] = -matrix[1][1];
        matrix[3][1] = -matrix[3][1];
        matrix
    }

    /// Returns the nearest and the farthest depth of the frame. The range of each frame is nearer
    /// than the range of the previous frame by a factor of two. Depths of previous frames in the
    /// map are thus behind everything in this frame, which has the same effect as clearing the map.
    /// Powers of two are exact, so all frames of a scene are equal.
    pub(crate) fn depth_range(&self) -> [f32; 2] {
        let far = 0.5_f32.powi(self.frames_since_clear as i32);
        [far / 2.0, far]
    }

    /// Returns the transformation from the clip space of the light to texels and depths of the
    /// region. It ignores the border, as does the engine.
    pub(super) fn clip_to_texels(&self, size: u32) -> Matrix4 {
        let mut matrix = IDENTITY;
        let [near, far] = self.depth_range().map(f64::from);
        (matrix[2][2], matrix[3][2]) = (far - near, near);
        let half = f64::from(size) / 2.0 / f64::from(self.reduction);
        for (axis, (origin, place)) in self.origin.into_iter().zip(self.place).enumerate() {
            matrix[axis][axis] = half;
            matrix[3][axis] = half - f64::from(origin) + f64::from(place);
        }
        matrix
    }

    /// Returns the first texel and the length along x and y, in texels of the full map.
    fn in_full_texels(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            [self.origin[axis], self.size[axis]].map(|length| f64::from(length) * f64::from(self.reduction))
        })
    }
}

/// Largest width of a texel of a reduced shadow map in the image, pixels, on a surface that faces
/// the light and the camera.
const MAX_TEXEL: f64 = 0.25;

/// Smallest width of a reduced shadow map, texels.
const MIN_SIZE: u32 = 64;

/// Returns the factor by which a shadow map of `size` texels is reduced in width and height: the
/// largest power of two with which no texel is wider than [`MAX_TEXEL`] on a visible surface.
/// `nearest` is a lower bound of the depths of visible surfaces, m.
///
/// A texel has the width `texel * w` at the point p, where w is the last clip coordinate of the
/// light: its depth in a spotlight, and 1 in a directional light. In the image this is proportional
/// to `w / depth`. With p = camera + depth * ray, the quotient is `w(camera) / depth + w(ray)`. The
/// second term is an affine function of the pixel, whose maximum is in a corner of the image.
pub(crate) fn reduction(light: &Matrix4, size: u32, frustum: &ViewFrustum, nearest: f64) -> u32 {
    let length = |[x, y, z, _]: [f64; 4]| dot(&[x, y, z], &[x, y, z]).sqrt();
    let texel = 2.0 / (length(row(light, 0)).min(length(row(light, 1))) * f64::from(size));
    let [x, y, z, offset] = row(light, 3);
    let of_camera = dot(&[x, y, z], &frustum.position) + offset;
    // In an orthographic projection the width in the image is proportional to w, which has no bound
    // far away if the light shines forwards.
    if frustum.orthographic && [x, y, z] != [0.0; 3] {
        return 1;
    }
    let of_rays = frustum.corners.map(|ray| dot(&[x, y, z], &ray) / frustum.depth_along(ray));
    let quotient = if frustum.orthographic {
        offset
    } else {
        of_camera.max(0.0) / nearest + of_rays.into_iter().fold(f64::NEG_INFINITY, f64::max)
    };
    let pixels = frustum.pixels_per_metre * frustum.scale * texel * quotient;
    let reduction = |halvings: u32| 1_u32 << halvings;
    let fits = |&halvings: &u32| {
        size / reduction(halvings) >= MIN_SIZE && f64::from(reduction(halvings)) * pixels <= MAX_TEXEL
    };
    (0..=16).rev().find(fits).map_or(1, reduction)
}

#[cfg(test)]
mod tests {
    use super::super::matrix::{apply, look_to, orthographic, perspective, product};
    use super::{MAX_TEXEL, Matrix4, ViewFrustum, reduction, row};
    use crate::scene::{Camera, CameraView, Categories, Scene, SceneOptions};
    use crate::{Data, sample};

    /// Returns the frustum of a camera that views the origin from a distance of 4 m.
    fn frustum(size: u32) -> ViewFrustum {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 1000).unwrap();
        let mut camera =
            Camera { view: CameraView::Free, lookat: [0.0; 3], distance: 4.0, azimuth: 30.0, elevation: -40.0 };
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        ViewFrustum::new(&scene, &scene.viewpoint(), [size; 2]).unwrap()
    }

    fn lights() -> [Matrix4; 3] {
        let above = look_to([1.0, 0.5, 3.0], [0.1, 0.2, -1.0], [0.0, 1.0, 0.0]);
        let aside = look_to([-6.0, 8.0, 5.0], [0.6, -0.8, -0.5], [0.0, 0.0, 1.0]);
        let spot = perspective([-0.05, 0.05], [-0.05, 0.05], [0.1, 50.0]);
        [
            product(&spot, &above),
            product(&spot, &aside),
            product(&orthographic([-3.0, 3.0], [-3.0, 3.0], [0.1, 50.0]), &above),
        ]
    }

    /// Returns the visible points of the plane z = 0 at the centres of pixels, and their depths:
    /// all pixels of small images, and of others every nth in both directions, with the last.
    fn points_of_the_floor(frustum: &ViewFrustum, size: u32) -> Vec<([f64; 3], f64)> {
        let [first, second, _, last] = frustum.corners;
        let centre = |pixel: u32| (f64::from(pixel) + 0.5) / f64::from(size);
        let ray = |x: u32, y: u32| {
            [0, 1, 2].map(|k| first[k] + centre(x) * (second[k] - first[k]) + centre(y) * (last[k] - first[k]))
        };
        let places: Vec<u32> = (0..size).step_by((size / 64).max(1) as usize).chain([size - 1]).collect();
        let rays = places.iter().flat_map(|&y| places.iter().map(move |&x| ray(x, y)));
        rays.filter(|ray| ray[2] < 0.0)
            .map(|ray| [0, 1, 2].map(|k| frustum.position[k] - frustum.position[2] / ray[2] * ray[k]))
            .map(|point| (point, frustum.depth_of(point.map(|number| number as f32))))
            .collect()
    }

    #[test]
    fn the_nearest_depth_of_a_plane_is_a_tight_lower_bound() {
        let frustum = frustum(200);
        let depths = points_of_the_floor(&frustum, 200).into_iter().map(|(_, depth)| depth);
        let nearest = depths.fold(f64::INFINITY, f64::min);
        let bound = frustum.nearest_depth_of_plane([5.0, -7.0, 0.0], [0.0, 0.0, 1.0]);
        assert!(bound < nearest && bound > 0.98 * nearest, "{bound} {nearest}");
        let behind = frustum.nearest_depth_of_plane([0.0, 0.0, 9.0], [0.0, 0.0, 1.0]);
        assert_eq!(behind, f64::INFINITY, "the camera is behind this plane");
    }

    #[test]
    fn a_texel_of_a_reduced_map_is_narrow_in_the_image_but_not_too_narrow() {
        const SIZE: u32 = 4096;
        for pixels in [64, 84, 256, 1024] {
            let frustum = frustum(pixels);
            let nearest = frustum.nearest_depth_of_plane([0.0; 3], [0.0, 0.0, 1.0]);
            let points = points_of_the_floor(&frustum, pixels);
            for light in lights() {
                let reduction = f64::from(reduction(&light, SIZE, &frustum, nearest));
                let [x, y, z, _] = row(&light, 0);
                let per_metre = (x * x + y * y + z * z).sqrt();
                let widest = points
                    .iter()
                    .map(|&([x, y, z], depth)| {
                        let [.., w] = apply(&light, [x, y, z, 1.0]);
                        let metres = reduction * 2.0 / f64::from(SIZE) * w / per_metre;
                        metres * frustum.pixels_per_metre / depth
                    })
                    .fold(0.0, f64::max);
                assert!(widest <= MAX_TEXEL || reduction == 1.0, "{widest} pixels at {pixels} x {pixels}");
                assert!(widest > 0.2 * MAX_TEXEL || reduction >= 64.0 || reduction == 1.0, "{widest} at {pixels}");
            }
        }
    }
}
