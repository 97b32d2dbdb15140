//! Skins: surfaces that bend with the bodies below them.

use std::fmt;
use std::ops::Range;

use super::mesh::optional_range;
use super::{View, ViewMut, range};
use crate::ffi;
use crate::id::{BodyId, Id, MaterialId, kind};
use crate::model::{Model, ModelMut};

fields!(Skin on Model {
    /// Its material, if it has one.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |skin| skin.optional_id_in(skin.owner.skin_matid());
    /// The group, for display: the visualiser has six.
    group: i32 = skin_group, set_group if [0, 1, 2, 3, 4, 5];
    /// Red, green, blue and opacity, where no material gives them.
    rgba: [f32; 4] = skin_rgba, rgba_mut in skin_rgba_mut;
    /// How far it is moved outwards, m.
    inflate: f32 = skin_inflate, set_inflate in skin_inflate_mut;
    /// Where its vertices are in `skin_vert`.
    #[doc(alias = "vertadr")]
    #[doc(alias = "vertnum")]
    vert_range: {Range<usize>} = |skin| range(skin.owner.skin_vertadr(), skin.owner.skin_vertnum(), skin.index());
    /// Where the texture coordinates of its vertices are in `skin_texcoord`; empty if it has none.
    #[doc(alias = "texcoordadr")]
    texcoord_range: {Range<usize>} =
        |skin| optional_range(skin.owner.skin_texcoordadr(), skin.owner.skin_vertnum(), skin.index());
    /// Where its faces are in `skin_face`.
    #[doc(alias = "faceadr")]
    #[doc(alias = "facenum")]
    face_range: {Range<usize>} = |skin| range(skin.owner.skin_faceadr(), skin.owner.skin_facenum(), skin.index());
    /// Where its bones are in `skin_bonebindpos` and `skin_bonebindquat`.
    #[doc(alias = "boneadr")]
    #[doc(alias = "bonenum")]
    bone_range: {Range<usize>} = |skin| range(skin.owner.skin_boneadr(), skin.owner.skin_bonenum(), skin.index());
    /// Where the weights of its bones are in `skin_bonevertweight`, those of all bones after each other.
    bonevert_range: {Range<usize>} = |skin| {
        let bone = |bone| range(skin.owner.skin_bonevertadr(), skin.owner.skin_bonevertnum(), bone);
        let bones = skin.bone_range();
        if bones.is_empty() { 0..0 } else { bone(bones.start).start..bone(bones.end - 1).end }
    };
    /// Its vertices, m, in the position that the bones were bound in.
    vert: [[f32; 3]] = skin_vert at vert_range, vert_mut in skin_vert_mut;
    /// The texture coordinates of each vertex; empty if it has none.
    texcoord: [[f32; 2]] = skin_texcoord at texcoord_range, texcoord_mut in skin_texcoord_mut;
    /// Its faces: three vertices each, counted from the skin's first.
    face: [[i32; 3]] = skin_face at face_range;
    /// The position of each bone, m, as it was bound.
    bonebindpos: [[f32; 3]] = skin_bonebindpos at bone_range, bonebindpos_mut in skin_bonebindpos_mut;
    /// The orientation of each bone as it was bound: a unit quaternion `[w, x, y, z]`.
    bonebindquat: [[f32; 4]] = skin_bonebindquat at bone_range, bonebindquat_mut in skin_bonebindquat_mut;
    /// How strongly each vertex of each bone follows it: see [`bones`](Self::bones).
    bonevertweight: [f32] = skin_bonevertweight at bonevert_range, bonevertweight_mut in skin_bonevertweight_mut;
    /// Its bones, each with the vertices that it carries.
    bones: {Bones<'a>} = |skin| Bones { model: skin.owner, range: skin.bone_range() };
});

/// A body that carries vertices of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bone<'a> {
    /// The body.
    pub body: BodyId,
    /// The vertices that it carries, counted from the skin's first.
    pub vertid: &'a [i32],
    /// How strongly each of them follows it.
    pub vertweight: &'a [f32],
}

/// The bones of a skin: an iterator over them.
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
