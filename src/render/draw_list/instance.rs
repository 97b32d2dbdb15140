//! Instances, batches, and the appearance of a geom: colour, material and texture.

use super::primitive::Part;
use super::texture_map::TextureMap;
use super::{AuxOutput, DrawListInputs};
use crate::math;
use crate::render::shader::TextureKind;
use crate::scene::{SceneGeom, SceneGeomType};

/// Instance in the instance buffer. `common.wgsl` declares the same structure.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Instance {
    /// Rows of the transformation from the local frame of the shape to world space.
    pub(crate) rows: [[f32; 4]; 3],
    pub(crate) rgba: [f32; 4],
    /// Emission, specularity and shininess. For a line the first is its width, in units of the line
    /// width.
    pub(crate) material: [f32; 3],
    /// Reciprocals of the squared lengths of the columns of the transformation, for normals.
    pub(crate) normal_scale: [f32; 3],
    /// Texture coordinates: scale, and 1 for the coordinates of the vertices, 0 for their local
    /// positions.
    pub(crate) texgen: [f32; 4],
    /// Offset of the texture coordinates.
    pub(crate) texture_offset: [f32; 3],
    /// Index of the geom in the scene plus 1.
    pub(crate) id: u32,
    /// Index of the image among those that are drawn together.
    pub(crate) view: u32,
}

/// Batch key: shape, texture and cull mode. Instances with equal keys are drawn with one draw call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct BatchKey {
    /// Index of the shape in [`Shapes`](crate::render::assets::Shapes).
    pub(crate) shape: u32,
    pub(crate) texture_kind: TextureKind,
    /// Index of the texture, unless the kind is [`TextureKind::None`].
    pub(crate) texture: u32,
    /// The shape is a line.
    pub(crate) line: bool,
    /// Front faces are culled instead of back faces.
    pub(crate) back_faces: bool,
    /// All lights shine on the instances, even in shadows.
    pub(crate) unshadowed: bool,
}

impl BatchKey {
    /// Returns the key of a shape without a texture.
    pub(super) fn untextured(shape: u32) -> Self {
        let texture_kind = TextureKind::None;
        Self { shape, texture_kind, texture: 0, line: false, back_faces: false, unshadowed: false }
    }
}

/// Consecutive instances with equal keys, visibility and place in the order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Batch {
    pub(crate) key: BatchKey,
    pub(crate) visibility: Visibility,
    /// Opaque batches are drawn in ascending order.
    pub(crate) order: u64,
    pub(crate) instances: std::ops::Range<u32>,
}

/// Results of culling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Visibility {
    pub(crate) in_frustum: bool,
    pub(crate) mirror_side: MirrorSide,
    /// Lights in which the instances cast visible shadows, one bit per light.
    pub(crate) shadow_mask: u8,
}

impl Visibility {
    /// Visibility of the mark of a mirror.
    pub(super) const MARK: Self = Self { in_frustum: true, mirror_side: MirrorSide::Across, shadow_mask: 0 };
}

/// Position relative to the mirror.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum MirrorSide {
    /// In front of the mirror: the mirror image is visible.
    InFront,
    /// On both sides of the mirror: the mirror image must be clipped.
    Across,
    /// Behind the mirror, or outside of the mirrored frustum: no mirror image.
    Behind,
}

/// Appearance of a geom, independent of its shape.
pub(super) struct Appearance {
    rgba: [f32; 4],
    material: [f32; 3],
    texture: TextureMap,
    id: u32,
}

impl Appearance {
    pub(super) fn new(index: usize, geom: SceneGeom<'_>, inputs: &DrawListInputs<'_>, is_camera_behind: bool) -> Self {
        let id = index as u32 + 1;
        let untextured = |rgba| Self { rgba, material: [0.0; 3], texture: TextureMap::NONE, id };
        match inputs.aux {
            Some(AuxOutput::SegmentColors) => return untextured(segment_color(geom.segid())),
            Some(AuxOutput::IdColors) => return untextured(id_color(geom.segid())),
            Some(AuxOutput::Ids | AuxOutput::Depth | AuxOutput::DepthAndIds) => return untextured([1.0; 4]),
            None => {}
        }
        let [red, green, blue, alpha] = geom.rgba().map(|number| limited(number, 1e3));
        let is_plane = geom.geom_type() == SceneGeomType::Plane;
        let alpha = if is_camera_behind && is_plane { 0.3 * alpha } else { alpha };
        let mut appearance = untextured([red, green, blue, alpha.clamp(0.0, 1.0)]);
        // 128 is OpenGL's limit of the specular exponent.
        let shininess = limited(128.0 * geom.shininess(), 128.0).max(0.0);
        appearance.material = [limited(geom.emission(), 1e3), limited(geom.specular(), 1e3), shininess];
        if let Some(texture) = geom.texture() {
            appearance.texture = TextureMap::new(inputs.textures.kind(texture.index()), texture.index(), geom);
        }
        appearance
    }

    /// Creates the instance of a part of the geom, and its batch key.
    pub(super) fn instance(
        &self,
        geom: SceneGeom<'_>,
        part: &Part,
        line: bool,
        back_faces: bool,
    ) -> (BatchKey, Instance) {
        let (pos, mat) = (geom.pos(), geom.mat());
        // The vertices of skins and flexes are in world space.
        let is_in_world = matches!(geom.geom_type(), SceneGeomType::Skin | SceneGeomType::Flex);
        let rows: [[f32; 4]; 3] = if is_in_world {
            [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]
        } else {
            let row = |row: usize| {
                let [x, y, z] = [mat[3 * row], mat[3 * row + 1], mat[3 * row + 2]];
                if let Some([from, to]) = part.edge {
                    let along = |vector: [f32; 3]| x * vector[0] + y * vector[1] + z * vector[2];
                    return [0.0, 0.0, along(to) - along(from), pos[row] + along(from)];
                }
                [x * part.scale[0], y * part.scale[1], z * part.scale[2], pos[row] + z * part.shift]
            };
            [row(0), row(1), row(2)]
        };
        let [a, b, c] = rows;
        let normal_scale = [0, 1, 2].map(|k| 1.0 / (a[k] * a[k] + b[k] * b[k] + c[k] * c[k]).max(1e-30));
        let Self { rgba, mut material, ref texture, id } = *self;
        if line {
            material[0] = line_width(geom);
        }
        let texture = if part.is_textured { texture } else { &TextureMap::NONE };
        let (texgen, texture_offset) = texture.of_part(part);
        let TextureMap { kind: texture_kind, texture, .. } = *texture;
        let unshadowed = part.is_unshadowed;
        let key = BatchKey { shape: part.shape, texture_kind, texture, line, back_faces, unshadowed };
        (key, Instance { rows, rgba, material, normal_scale, texgen, texture_offset, id, view: 0 })
    }
}

/// Returns the width of the lines of a geom, in units of the line width. The engine uses the size
/// of the geom from 2.3.3 on.
fn line_width(geom: SceneGeom<'_>) -> f32 {
    match geom.geom_type() {
        SceneGeomType::LineBox => 1.5,
        _ if cfg!(engine_since = "2.3.3") => geom.size()[0],
        _ => 3.0,
    }
}

/// Clamps a number to `-limit..=limit`; returns 0 for NaN.
fn limited(number: f32, limit: f32) -> f32 {
    if number.is_nan() { 0.0 } else { number.clamp(-limit, limit) }
}

/// Returns the colour of a segment, which differs from the colours of adjacent ids: a point of the
/// Halton sequence, as in the engine.
///
/// J. H. Halton, "On the efficiency of certain quasi-random sequences of points", Numerische
/// Mathematik 2 (1960).
fn segment_color(segid: usize) -> [f32; 4] {
    let index = u32::try_from(segid + 10).unwrap_or(u32::MAX);
    // The engine's sequence is undefined for indices that exceed a C int.
    let [red, green, blue] = [2, 3, 5].map(|base| 0.1 + 0.8 * math::halton(index, base).unwrap_or_default() as f32);
    [red, green, blue, 1.0]
}

/// Encodes an id plus 1 as a 24-bit colour, with the lowest bits in red.
fn id_color(segid: usize) -> [f32; 4] {
    let number = segid as u64 + 1;
    let [red, green, blue] = [0, 8, 16].map(|shift| ((number >> shift) & 0xFF) as f32 / 255.0);
    [red, green, blue, 1.0]
}

#[cfg(test)]
mod tests {
    use super::{id_color, segment_color};

    #[test]
    fn segment_colours_follow_the_halton_sequence() {
        // 10 is 1010 in base 2, 101 in base 3 and 20 in base 5.
        let expected = [5.0 / 16.0, 10.0 / 27.0, 2.0 / 25.0].map(|number: f32| 0.1 + 0.8 * number);
        for (found, expected) in segment_color(0).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn id_colour_encodes_the_id() {
        assert_eq!(id_color(0), [1.0 / 255.0, 0.0, 0.0, 1.0]);
        assert_eq!(id_color(0x03_02_00), [1.0 / 255.0, 2.0 / 255.0, 3.0 / 255.0, 1.0]);
    }
}
