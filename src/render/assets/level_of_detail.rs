//! Levels of detail of round shapes.

use std::sync::{Arc, Mutex, PoisonError};

use super::shape_buffers::ShapeBuffers;
use crate::render::{Gpu, Lighting, RenderError};
use crate::shape::{self, Tessellation, Triangles};

/// Round shape, tessellated in several levels of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RoundShape {
    Sphere,
    Hemisphere,
    /// Lateral surface of a cylinder.
    Cylinder,
    /// Lateral surface of a cylinder that is much longer than wide.
    LongCylinder,
    Disk,
    Cone,
}

/// Level of detail of a round shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DetailLevel {
    /// For colour images: level 0 has the model's tessellation, higher levels have fewer vertices.
    Color(usize),
    /// For depth and segmentation images: index into [`DEPTH_LEVELS`], independent of the model's
    /// tessellation.
    Depth(usize),
}

/// Number of levels of detail for colour images.
pub(crate) const COLOR_LEVELS: usize = 3;

/// Largest subdivisions of a level for colour images.
struct ColorLevel {
    slices: u32,
    /// Along the meridian of a sphere, and along a long cylinder.
    stacks: u32,
    /// Along straight surfaces, where they affect only the per-vertex lighting.
    straight_stacks: u32,
}

/// The outline of a round shape depends mainly on its slices, so the other subdivisions are reduced
/// first.
const COLOR: [ColorLevel; COLOR_LEVELS] = [
    ColorLevel { slices: Tessellation::MAX, stacks: Tessellation::MAX, straight_stacks: Tessellation::MAX },
    ColorLevel { slices: 28, stacks: 10, straight_stacks: 4 },
    ColorLevel { slices: 14, stacks: 6, straight_stacks: 3 },
];

/// Number of slices of each level for depth and segmentation images.
pub(crate) const DEPTH_LEVELS: [u32; 6] = [8, 16, 32, 64, 128, Tessellation::MAX];

impl RoundShape {
    pub(super) const ALL: [Self; 6] =
        [Self::Sphere, Self::Hemisphere, Self::Cylinder, Self::LongCylinder, Self::Disk, Self::Cone];

    /// Generates the triangles of all levels for colour images.
    pub(super) fn color_levels(self, tessellation: Tessellation, lighting: Lighting) -> [Triangles; COLOR_LEVELS] {
        COLOR.map(|limits| {
            let tessellation = tessellation.limited(limits.slices, limits.stacks);
            let Tessellation { slices, stacks, .. } = tessellation;
            let straight_stacks = stacks.min(limits.straight_stacks);
            // Straight surfaces need stacks only for per-vertex lighting.
            let lit_stacks = if lighting == Lighting::PerVertex { straight_stacks } else { 2 };
            match self {
                Self::Sphere => shape::sphere(tessellation),
                Self::Hemisphere => shape::hemisphere(tessellation),
                Self::Cylinder => shape::cylinder(slices, lit_stacks),
                Self::LongCylinder => shape::cylinder(slices, stacks),
                Self::Disk => shape::disk(slices, (lit_stacks / 2).max(1)),
                Self::Cone => shape::cone(slices, straight_stacks),
            }
        })
    }

    /// Generates the triangles of all levels for colour images without lighting: the surfaces of
    /// [`color_levels`](Self::color_levels) with one stack if they are straight. `None` for curved
    /// surfaces, which need all stacks.
    pub(super) fn unlit_levels(self, tessellation: Tessellation) -> Option<[Triangles; COLOR_LEVELS]> {
        let generate = match self {
            Self::Sphere | Self::Hemisphere => return None,
            Self::Cylinder | Self::LongCylinder => shape::cylinder,
            Self::Disk => shape::disk,
            Self::Cone => shape::cone,
        };
        Some(COLOR.map(|limits| generate(tessellation.limited(limits.slices, limits.stacks).slices, 1)))
    }

    /// Generates the triangles of all levels for depth and segmentation images. Doubly curved
    /// surfaces have cells of equal width and height. Straight surfaces may have long cells because
    /// no vertex is lit.
    pub(super) fn depth_levels(self) -> [Triangles; DEPTH_LEVELS.len()] {
        DEPTH_LEVELS.map(|slices| match self {
            Self::Sphere => shape::sphere(Tessellation { slices, stacks: slices / 2, quads: 1 }),
            Self::Hemisphere => shape::hemisphere(Tessellation { slices, stacks: slices / 2, quads: 1 }),
            Self::Cylinder => shape::cylinder(slices, 2),
            Self::LongCylinder => shape::cylinder(slices, 16),
            Self::Disk => shape::disk(slices, 1),
            Self::Cone => shape::cone(slices, 1),
        })
    }
}

/// Round shapes for depth and segmentation images, which depend on no model: the renderers of a
/// [`Gpu`] share them.
#[derive(Debug, Default)]
pub(crate) struct DepthLevels(Mutex<Option<Arc<[ShapeBuffers]>>>);

impl DepthLevels {
    /// Returns the levels of all shapes, which are created on first use.
    pub(super) fn get(&self, gpu: &Gpu) -> Result<Arc<[ShapeBuffers]>, RenderError> {
        let mut levels = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(levels) = &*levels {
            return Ok(levels.clone());
        }
        let triangles = RoundShape::ALL.into_iter().flat_map(RoundShape::depth_levels);
        let created = triangles.map(|triangles| ShapeBuffers::new(gpu, &triangles)).collect::<Result<_, _>>()?;
        Ok(levels.insert(created).clone())
    }

    /// Removes the shapes, because an error, such as a lack of memory, may have left an invalid
    /// buffer.
    pub(crate) fn clear(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}
