//! Assets: skins, height fields, textures and materials.

use std::fmt;
use std::ops::Range;

use super::{View, ViewMut, range};
use crate::enums::TextureType;
use crate::ffi;
use crate::id::{BodyId, Id, MaterialId, TextureId};
use crate::kind;
use crate::model::{Model, ModelMut};

/// Returns the range that starts at an element's address; empty for the address -1.
fn optional_range(addresses: &[i32], counts: &[i32], index: usize) -> Range<usize> {
    if addresses[index] < 0 { 0..0 } else { range(addresses, counts, index) }
}

fields!(Skin on Model {
    /// Material, if any.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |skin| skin.optional_id_in(skin.owner.skin_matid());
    /// Visualisation group, from 0 to 5.
    group: i32 = skin_group, set_group if [0, 1, 2, 3, 4, 5];
    /// Red, green, blue and opacity, used without a material.
    rgba: [f32; 4] = skin_rgba, rgba_mut in skin_rgba_mut;
    /// Outward offset along the normals, m.
    inflate: f32 = skin_inflate, set_inflate in skin_inflate_mut;
    /// Range of its vertices in `skin_vert`.
    #[doc(alias = "vertadr")]
    #[doc(alias = "vertnum")]
    vert_range: {Range<usize>} = |skin| range(skin.owner.skin_vertadr(), skin.owner.skin_vertnum(), skin.index());
    /// Range of its texture coordinates in `skin_texcoord`; empty without texture coordinates.
    #[doc(alias = "texcoordadr")]
    texcoord_range: {Range<usize>} =
        |skin| optional_range(skin.owner.skin_texcoordadr(), skin.owner.skin_vertnum(), skin.index());
    /// Range of its faces in `skin_face`.
    #[doc(alias = "faceadr")]
    #[doc(alias = "facenum")]
    face_range: {Range<usize>} = |skin| range(skin.owner.skin_faceadr(), skin.owner.skin_facenum(), skin.index());
    /// Range of its bones in `skin_bonebindpos` and `skin_bonebindquat`.
    #[doc(alias = "boneadr")]
    #[doc(alias = "bonenum")]
    bone_range: {Range<usize>} = |skin| range(skin.owner.skin_boneadr(), skin.owner.skin_bonenum(), skin.index());
    /// Range of the vertex weights of all its bones, in order, in `skin_bonevertweight`.
    bonevert_range: {Range<usize>} = |skin| {
        let bone = |bone| range(skin.owner.skin_bonevertadr(), skin.owner.skin_bonevertnum(), bone);
        let bones = skin.bone_range();
        if bones.is_empty() { 0..0 } else { bone(bones.start).start..bone(bones.end - 1).end }
    };
    /// Vertices in the bind pose, m.
    vert: [[f32; 3]] = skin_vert at vert_range, vert_mut in skin_vert_mut;
    /// Texture coordinates of the vertices; empty without texture coordinates.
    texcoord: [[f32; 2]] = skin_texcoord at texcoord_range, texcoord_mut in skin_texcoord_mut;
    /// Faces: three vertex indices each, relative to the first vertex of the skin.
    face: [[i32; 3]] = skin_face at face_range;
    /// Bind position of each bone, m.
    bonebindpos: [[f32; 3]] = skin_bonebindpos at bone_range, bonebindpos_mut in skin_bonebindpos_mut;
    /// Bind orientation of each bone: a unit quaternion `[w, x, y, z]`.
    bonebindquat: [[f32; 4]] = skin_bonebindquat at bone_range, bonebindquat_mut in skin_bonebindquat_mut;
    /// Weights of the vertices of all bones: see [`bones`](Self::bones).
    bonevertweight: [f32] = skin_bonevertweight at bonevert_range, bonevertweight_mut in skin_bonevertweight_mut;
    /// Bones, each with its vertices and their weights.
    bones: {Bones<'a>} = |skin| Bones { model: skin.owner, range: skin.bone_range() };
});

/// Bone of a skin: a body and the vertices that follow it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bone<'a> {
    /// Body.
    pub body: BodyId,
    /// Vertices that follow the body, relative to the first vertex of the skin.
    pub vertid: &'a [i32],
    /// Weight of each of these vertices.
    pub vertweight: &'a [f32],
}

/// Iterator over the bones of a skin.
#[derive(Clone)]
pub struct Bones<'a> {
    model: &'a Model,
    range: Range<usize>,
}

impl<'a> Iterator for Bones<'a> {
    type Item = Bone<'a>;

    fn next(&mut self) -> Option<Bone<'a>> {
        let (bone, model) = (self.range.next()?, self.model);
        let vertices = range(model.skin_bonevertadr(), model.skin_bonevertnum(), bone);
        Some(Bone {
            body: Id::new(ffi::size(model.skin_bonebodyid()[bone]), model.lineage()),
            vertid: &model.skin_bonevertid()[vertices.clone()],
            vertweight: &model.skin_bonevertweight()[vertices],
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.range.size_hint()
    }
}

impl ExactSizeIterator for Bones<'_> {}

impl fmt::Debug for Bones<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.clone()).finish()
    }
}

fields!(HeightField on Model {
    /// Half-extents along x and y, maximum elevation, and depth of the base below, m.
    size: [f64; 4] = hfield_size;
    /// Number of rows of the elevation grid, along y.
    nrow: {usize} = |field| ffi::size(field.owner.hfield_nrow()[field.index()]);
    /// Number of columns of the elevation grid, along x.
    ncol: {usize} = |field| ffi::size(field.owner.hfield_ncol()[field.index()]);
    /// Range of its elevations in `hfield_data`.
    #[doc(alias = "adr")]
    data_range: {Range<usize>} = |field| {
        let start = ffi::size(field.owner.hfield_adr()[field.index()]);
        start..start + field.nrow() * field.ncol()
    };
    /// Elevations, row-major, as fractions of the maximum elevation. `(nrow · ncol)`
    data: [f32] = hfield_data at data_range, data_mut in hfield_data_mut;
});

/// # Methods of [`TextureMut`](super::TextureMut)
impl ViewMut<'_, ModelMut<'_>, kind::Texture> {
    /// Returns a mutable reference to `rgb`.
    pub fn rgb_mut(&mut self) -> &mut [u8] {
        let range = self.view().in_model().rgb_range();
        &mut self.owner.texture_bytes_mut()[range]
    }
}

fields!(Texture on Model {
    /// Mapping of the texture onto a surface.
    texture_type: {TextureType} = |texture| TextureType::of_field(texture.owner.tex_type()[texture.index()]);
    /// Height in pixels. The six faces of a cube map are stacked vertically.
    height: {usize} = |texture| ffi::size(texture.owner.tex_height()[texture.index()]);
    /// Width in pixels.
    width: {usize} = |texture| ffi::size(texture.owner.tex_width()[texture.index()]);
    /// Number of bytes of a pixel: 3 for red, green and blue. Engines from 3.2.1 also have textures
    /// with 1 byte, for grey, and with 4.
    #[doc(alias = "nchannel")]
    channels: {usize} = |texture| texture.owner.texture_channels(texture.index());
    /// Range of its bytes in the pixels of all textures.
    #[doc(alias = "adr")]
    rgb_range: {Range<usize>} = |texture| {
        let start = ffi::size(texture.owner.tex_adr()[texture.index()]);
        start..start + texture.channels() * texture.height() * texture.width()
    };
    /// Pixels, row-major: red, green and blue of each. `(height · width · channels)`
    #[doc(alias = "tex_rgb")]
    #[doc(alias = "tex_data")]
    rgb: {&'a [u8]} = |texture| &texture.owner.texture_bytes()[texture.rgb_range()];
});

fields!(Material on Model {
    /// Texture, if any.
    #[doc(alias = "texid")]
    texture: {Option<TextureId>} = |material| {
        let texture = material.owner.material_texture(material.index())?;
        Some(Id::new(texture, material.owner.lineage()))
    };
    /// Returns `true` if the texture has a uniform scale in space. Otherwise it is stretched over
    /// each object.
    texuniform: bool = mat_texuniform, set_texuniform;
    /// Number of texture repetitions along each axis: per object, or per metre for a uniform
    /// texture.
    texrepeat: [f32; 2] = mat_texrepeat, texrepeat_mut in mat_texrepeat_mut;
    /// Emission as a fraction of the colour, from 0 to 1.
    emission: f32 = mat_emission, set_emission in mat_emission_mut;
    /// Strength of specular highlights, from 0 to 1.
    specular: f32 = mat_specular, set_specular in mat_specular_mut;
    /// Shininess, from 0 to 1: larger values give smaller highlights.
    shininess: f32 = mat_shininess, set_shininess in mat_shininess_mut;
    /// Reflectance of mirror-like surfaces, from 0 to 1.
    reflectance: f32 = mat_reflectance, set_reflectance in mat_reflectance_mut;
    /// Red, green, blue and opacity.
    rgba: [f32; 4] = mat_rgba, rgba_mut in mat_rgba_mut;
});
