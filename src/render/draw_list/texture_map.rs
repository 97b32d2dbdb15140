//! Mapping of textures to geoms.
//!
//! Engines before 3.12 project a 2D texture along z on every shape without texture coordinates of
//! its own. From 3.12 on, unit shapes have texture coordinates from 0 to 1, planes have their
//! texture in a corner, and the number of repetitions applies to all texture coordinates.

use super::primitive::Part;
use crate::render::settings::is_drawable;
use crate::render::shader::TextureKind;
use crate::scene::{SceneGeom, SceneGeomType};

/// Unit shapes have texture coordinates, and texture coordinates are repeated.
const SHAPES_HAVE_TEXCOORDS: bool = cfg!(engine_since = "3.12.0");

/// Texture of a geom, and its mapping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TextureMap {
    pub(super) kind: TextureKind,
    /// Index of the texture, unless the kind is [`TextureKind::None`].
    pub(super) texture: u32,
    /// The texture coordinates of the vertices are used instead of their local positions.
    is_explicit: bool,
    /// Scale of the source of the texture coordinates, and offset.
    scale: [f32; 3],
    offset: [f32; 2],
}

impl TextureMap {
    pub(super) const NONE: Self =
        Self { kind: TextureKind::None, texture: 0, is_explicit: false, scale: [0.0; 3], offset: [0.0; 2] };

    pub(super) fn new(kind: TextureKind, texture: usize, geom: SceneGeom<'_>) -> Self {
        let map = Self { kind, texture: texture as u32, ..Self::NONE };
        match kind {
            TextureKind::None => Self::NONE,
            // Texture coordinates are two-dimensional and do not apply to cube textures.
            TextureKind::Cube if geom.texcoord() || is_skin_with_texcoords(geom.geom_type()) => Self::NONE,
            TextureKind::Cube => Self { scale: if geom.texuniform() { geom.size() } else { [1.0; 3] }, ..map },
            TextureKind::D2 if geom.texcoord() || has_texcoords(geom.geom_type()) => {
                let [x, y] = if SHAPES_HAVE_TEXCOORDS { repetitions(geom) } else { [1.0; 2] };
                Self { is_explicit: true, scale: [x, y, 0.0], ..map }
            }
            TextureKind::D2 if SHAPES_HAVE_TEXCOORDS && geom.geom_type() == SceneGeomType::Plane => {
                let (repeat, is_infinite) = (repetitions(geom), geom.size()[..2].iter().any(|&length| length <= 0.0));
                let axis = |axis: usize, sign: f32| {
                    let (length, repeat) = (geom.size()[axis], repeat[axis]);
                    // The local position is in metres on planes that are infinite along this axis.
                    let (scale, offset) = match geom.plane() {
                        _ if length <= 0.0 => (0.5 * repeat, 0.0),
                        Some(_) => (0.5 * repeat / length, 0.5 * repeat),
                        None if is_infinite => (0.5 * repeat / length, 0.5 * repeat),
                        None => (0.5 * repeat, 0.5 * repeat),
                    };
                    (sign * scale, if is_infinite { offset - 0.5 } else { offset })
                };
                let [(x, left), (y, top)] = [axis(0, 1.0), axis(1, -1.0)];
                Self { scale: [x, y, 0.0], offset: [left, top], ..map }
            }
            TextureKind::D2 => {
                let [x, y] = projected_repetitions(geom);
                Self { scale: [0.5 * x, -0.5 * y, 0.0], offset: [-0.5; 2], ..map }
            }
        }
    }

    /// Returns the values of [`Instance`](super::Instance) for a part of the geom: `texgen` and
    /// `texture_offset`.
    pub(super) fn of_part(&self, part: &Part) -> ([f32; 4], [f32; 3]) {
        let finite = |number: f32| if is_drawable(number) { number } else { 0.0 };
        let scale = self.scale.map(finite);
        let [left, top] = self.offset.map(finite);
        let (texgen, offset) = match self.kind {
            TextureKind::None => ([0.0; 4], [0.0; 3]),
            TextureKind::D2 if self.is_explicit => {
                let ([x, y], [right, up]) = (part.texcoord_scale, part.texcoord_shift);
                ([scale[0] * x, scale[1] * y, 0.0, 1.0], [scale[0] * right, scale[1] * up, 0.0])
            }
            TextureKind::D2 => {
                let [x, y, _] = part.texture_scale;
                ([scale[0] * x, scale[1] * y, 0.0, 0.0], [left, top, 0.0])
            }
            TextureKind::Cube => {
                let [x, y, z] = [0, 1, 2].map(|axis| scale[axis] * part.texture_scale[axis]);
                ([x, y, z, 0.0], [0.0, 0.0, scale[2] * part.texture_shift])
            }
        };
        (texgen.map(finite), offset.map(finite))
    }
}

/// Returns `true` for a skin with engines from 3.12, which draw even one without texture
/// coordinates as if it had some. They are zero, unless the image has shadow maps: then they are
/// left over from what the engine drew before.
fn is_skin_with_texcoords(geom_type: SceneGeomType) -> bool {
    SHAPES_HAVE_TEXCOORDS && geom_type == SceneGeomType::Skin
}

/// Returns `true` if the unit shapes of a geom type have texture coordinates that the engine uses.
/// The texture coordinates of planes follow from their positions.
fn has_texcoords(geom_type: SceneGeomType) -> bool {
    use SceneGeomType as Type;
    is_skin_with_texcoords(geom_type)
        || SHAPES_HAVE_TEXCOORDS
            && matches!(
                geom_type,
                Type::Sphere
                    | Type::Ellipsoid
                    | Type::Box
                    | Type::Cylinder
                    | Type::Capsule
                    | Type::Arrow
                    | Type::Arrow1
                    | Type::Arrow2
                    | Type::Triangle
            )
}

/// Returns the number of repetitions of texture coordinates from 0 to 1, with engines from 3.12.
fn repetitions(geom: SceneGeom<'_>) -> [f32; 2] {
    let (size, repeat) = (geom.size(), geom.texrepeat());
    [0, 1].map(|axis| {
        let repeat = if repeat[axis] > 0.0 { repeat[axis] } else { 1.0 };
        if geom.texuniform() && size[axis] > 0.0 { repeat * size[axis] } else { repeat }
    })
}

/// Returns the number of repetitions of a texture that is projected along z, for local positions
/// from -1 to 1.
fn projected_repetitions(geom: SceneGeom<'_>) -> [f32; 2] {
    let (size, repeat) = (geom.size(), geom.texrepeat());
    // Older engines take any shape with data for one of the model's own, in 3.5.0 also a shape that
    // was fitted to a mesh.
    let is_in_metres = geom.mesh().is_some()
        || geom.height_field().is_some()
        || geom.plane().is_some()
        || !SHAPES_HAVE_TEXCOORDS && geom.has_data();
    [0, 1].map(|axis| {
        let (mut scale, length) = (repeat[axis], size[axis]);
        if length > 0.0 {
            // Local positions of the model's own shapes are in metres, others in units of the
            // geom's size.
            if is_in_metres {
                scale /= length.max(1e-15);
            }
            if geom.texuniform() {
                scale *= length;
            }
        }
        scale
    })
}
