//! A shape in its place, as the graphics card reads it.

use crate::render::shader::Coat;

/// A shape in its place. `instance.wgsl` has the same.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Instance {
    /// The rows of the matrix that places it.
    pub(crate) rows: [[f32; 4]; 3],
    pub(crate) rgba: [f32; 4],
    /// Emission, specularity and shininess.
    pub(crate) material: [f32; 4],
    /// By what positions are multiplied to get texture coordinates.
    pub(crate) texgen: [f32; 4],
    /// One more than the geom's index in the scene.
    pub(crate) id: u32,
}

/// Of which shape, with which picture, culled how: what is the same can be drawn at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Kind {
    /// Which of what the graphics card keeps.
    pub(crate) shape: u32,
    pub(crate) coat: Coat,
    /// The texture, if there is a coat.
    pub(crate) texture: u32,
    /// Whether it is a line.
    pub(crate) line: bool,
    /// Whether its back is seen, and not its front.
    pub(crate) back: bool,
}

/// Instances of one kind, one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Batch {
    pub(crate) kind: Kind,
    pub(crate) place: Place,
    pub(crate) instances: std::ops::Range<u32>,
}

/// Where instances are to be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Place {
    /// Within the frustum.
    pub(crate) seen: bool,
    pub(crate) side: Side,
    /// The lights in which they cast shadows: a bit for each.
    pub(crate) casts: u8,
}

/// On which side of the mirror instances are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Side {
    /// Before it: their mirror image is seen.
    Before,
    /// Partly before it.
    Across,
    /// Behind it, or nowhere near: no mirror image.
    Behind,
}
