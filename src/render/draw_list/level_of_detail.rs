//! Selection of the level of detail of a geom: for colour images by its size on the screen, for
//! depth by the required precision.

use super::AuxOutput;
use crate::render::assets::{COLOR_LEVELS, DEPTH_LEVELS, DetailLevel};
use crate::render::bounding_volume::BoundingVolume;
use crate::render::view::ViewFrustum;
use crate::scene::{SceneGeom, SceneGeomType};
use crate::shape::Tessellation;

/// Level of detail of a geom.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// Level of round shapes.
    pub(super) round: DetailLevel,
    /// Distance along each axis at which vertices of meshes may be merged, m.
    pub(super) mesh: f32,
}

impl Detail {
    /// The geoms as the model has them.
    pub(super) const FULL: Self = Self { round: DetailLevel::Color(0), mesh: 0.0 };

    pub(super) fn new(
        geom: SceneGeom<'_>,
        volume: &BoundingVolume,
        frustum: &ViewFrustum,
        aux: Option<AuxOutput>,
    ) -> Self {
        /// Radii below which the next level is used, pixels. In images of 22 humanoids the coarser
        /// levels change at most 0.7 % of the pixels by more than 8 of 255 (bench `render`,
        /// argument `pictures`).
        const MAX_RADII: [f64; COLOR_LEVELS - 1] = [6.0, 1.5];
        /// Distance at which vertices of meshes are merged, pixels. In images of an arm of 215,000
        /// small triangles this changes at most 0.3 % of the pixels by more than 8 of 255 (bench
        /// `render`, argument `pictures`). Where meshes of different colours
        /// coincide, merging can change which of them is in front: in four images of robosuite's
        /// Panda, up to 2.3 % of the pixels at 84×84 and 0.3 % at 256×256.
        const MERGED: f64 = 1.0;
        /// Largest distance between a geom and its triangles, relative to the distance from the
        /// camera. At a viewing angle of 15° this is 1/5000 of the depth.
        const PRECISION: f64 = 5e-5;
        /// Largest distance between the outlines of a geom and of its triangles in images of depths
        /// and segments, pixels.
        const OUTLINE: f64 = 0.25;
        let (BoundingVolume::Sphere(sphere), true) = (volume, aux.is_none_or(AuxOutput::has_depth)) else {
            return Self::FULL;
        };
        let [x, y, z] = geom.size();
        let radius = match geom.geom_type() {
            SceneGeomType::Sphere | SceneGeomType::Ellipsoid => x.max(y).max(z),
            _ => x.max(y),
        };
        let nearest = (frustum.depth_of(sphere.centre) - f64::from(sphere.radius)).max(frustum.range[0]);
        let room_radius = frustum.scale * f64::from(radius);
        if aux.is_some() {
            let error = (PRECISION * nearest).min(OUTLINE / frustum.pixels_at(nearest));
            // The chord errors of the two directions of a sphere add up.
            let is_precise = |&slices: &u32| 2.0 * Tessellation::chord_error(slices) * room_radius <= error;
            let level = DEPTH_LEVELS.iter().position(is_precise).unwrap_or(DEPTH_LEVELS.len() - 1);
            return Self { round: DetailLevel::Depth(level), ..Self::FULL };
        }
        let pixels_per_metre = frustum.pixels_at(nearest);
        let pixels = pixels_per_metre * room_radius;
        let round = DetailLevel::Color(MAX_RADII.iter().take_while(|&&max| pixels < max).count());
        let pixel = 1.0 / (pixels_per_metre * frustum.scale);
        // Coarser levels have no texture coordinates.
        let shows_texcoords = geom.texcoord() && geom.texture().is_some();
        Self { round, mesh: if shows_texcoords { 0.0 } else { (MERGED * pixel) as f32 } }
    }
}
