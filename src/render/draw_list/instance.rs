//! Instances, batches, and the appearance of a geom: colour, material and texture.

use super::primitive::Part;
use super::{AuxOutput, DrawListInputs};
use crate::math;
use crate::render::settings::is_drawable;
use crate::render::shader::TextureKind;
use crate::scene::{SceneGeom, SceneGeomType};

/// Instance in the instance buffer. `common.wgsl` declares the same structure.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Instance {
    /// Rows of the transformation from the local frame of the shape to world space.
    pub(crate) rows: [[f32; 4]; 3],
    pub(crate) rgba: [f32; 4],
    /// Emission, specularity and shininess.
    pub(crate) material: [f32; 3],
    /// Reciprocals of the squared lengths of the columns of the transformation, for normals.
    pub(crate) normal_scale: [f32; 3],
    /// Texture coordinate generation: scale of the local position, and offset of z or [`EXPLICIT_TEXCOORDS`].
    pub(crate) texgen: [f32; 4],
    /// Index of the geom in the scene plus 1.
    pub(crate) id: u32,
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
}

/// Consecutive instances with equal keys and visibility.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Batch {
    pub(crate) key: BatchKey,
    pub(crate) visibility: Visibility,
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

/// Marks explicit texture coordinates, in the last element of [`Instance::texgen`]; `surface.wgsl` tests for it. It
/// exceeds the coordinates of all geoms.
const EXPLICIT_TEXCOORDS: f32 = f32::MIN;

/// Appearance of a geom, independent of its shape.
pub(super) struct Appearance {
    rgba: [f32; 4],
    material: [f32; 3],
    texture_kind: TextureKind,
    texture: u32,
    /// Scale from local positions to texture coordinates. For a 2D texture the last element is 0 or
    /// [`EXPLICIT_TEXCOORDS`].
    texgen: [f32; 3],
    id: u32,
}

impl Appearance {
    pub(super) fn new(index: usize, geom: SceneGeom<'_>, inputs: &DrawListInputs<'_>, is_camera_behind: bool) -> Self {
        let id = index as u32 + 1;
        let untextured =
            |rgba| Self { rgba, material: [0.0; 3], texture_kind: TextureKind::None, texture: 0, texgen: [1.0; 3], id };
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
            appearance.apply_texture(texture.index(), geom, inputs);
        }
        appearance
    }

    fn apply_texture(&mut self, texture: usize, geom: SceneGeom<'_>, inputs: &DrawListInputs<'_>) {
        let kind = inputs.textures.kind(texture);
        // Explicit texture coordinates are two-dimensional and do not apply to cube textures.
        if geom.texcoord() && kind != TextureKind::D2 {
            return;
        }
        (self.texture_kind, self.texture) = (kind, texture as u32);
        if geom.texcoord() {
            self.texgen = [0.0, 0.0, EXPLICIT_TEXCOORDS];
            return;
        }
        let (size, repeat) = (geom.size(), geom.texrepeat());
        let is_in_metres = geom.mesh().is_some() || geom.height_field().is_some() || geom.plane().is_some();
        self.texgen = match kind {
            TextureKind::None => [0.0; 3],
            TextureKind::D2 => {
                let mut scale = repeat;
                for axis in 0..2 {
                    // Local positions of the model's own shapes are in metres, others in units of the geom's size.
                    if is_in_metres && size[axis] > 0.0 {
                        scale[axis] /= size[axis].max(1e-15);
                    }
                    if geom.texuniform() && size[axis] > 0.0 {
                        scale[axis] *= size[axis];
                    }
                }
                [0.5 * scale[0], -0.5 * scale[1], 0.0]
            }
            TextureKind::Cube if geom.texuniform() => size,
            TextureKind::Cube => [1.0; 3],
        }
        .map(|scale| if is_drawable(scale) { scale } else { 0.0 });
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
        let rows = [0, 1, 2].map(|row| {
            if is_in_world {
                let mut identity = [0.0; 4];
                identity[row] = 1.0;
                return identity;
            }
            let [x, y, z] = [mat[3 * row], mat[3 * row + 1], mat[3 * row + 2]];
            [x * part.scale[0], y * part.scale[1], z * part.scale[2], pos[row] + z * part.shift]
        });
        let normal_scale = [0, 1, 2].map(|column| {
            let squared_length = rows.iter().map(|row| row[column] * row[column]).sum::<f32>();
            1.0 / squared_length.max(1e-30)
        });
        let [u, v, w] = [0, 1, 2].map(|axis| self.texgen[axis] * part.texture_scale[axis]);
        let texgen = match self.texture_kind {
            TextureKind::None => [0.0; 4],
            TextureKind::D2 => [u, v, 0.0, self.texgen[2]],
            TextureKind::Cube => [u, v, w, self.texgen[2] * part.texture_shift],
        }
        .map(|number| if number.is_finite() { number } else { 0.0 });
        let Self { rgba, material, texture_kind, texture, id, .. } = *self;
        let key = BatchKey { shape: part.shape, texture_kind, texture, line, back_faces };
        (key, Instance { rows, rgba, material, normal_scale, texgen, id })
    }
}

/// Clamps a number to `-limit..=limit`; returns 0 for NaN.
fn limited(number: f32, limit: f32) -> f32 {
    if number.is_nan() { 0.0 } else { number.clamp(-limit, limit) }
}

/// Returns the colour of a segment, which differs from the colours of adjacent ids: a point of the Halton sequence, as
/// in the engine.
///
/// J. H. Halton, "On the efficiency of certain quasi-random sequences of points", Numerische Mathematik 2 (1960).
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
