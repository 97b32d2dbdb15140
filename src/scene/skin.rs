//! The skins of a scene: surfaces that follow the bodies.

use super::Scene;
use crate::ffi;
use crate::id::{Id, SkinId};

/// A skin in the pose of the last update. Its faces are the model's [`skin_face`](crate::Model::skin_face).
#[derive(Clone, Copy, Debug)]
pub struct SceneSkin<'s> {
    /// Which one.
    pub skin: SkinId,
    /// Positions of its vertices, m, world frame. Zero before the first update, and where its group is not shown.
    pub vertices: &'s [[f32; 3]],
    /// Unit normals at its vertices. Zero where the vertices are.
    pub normals: &'s [[f32; 3]],
}

impl Scene {
    /// All skins of the model. They are brought up to date by [`update`](Self::update) with
    /// [`VisualFlags::SKIN`](super::VisualFlags::SKIN).
    pub fn skins(&self) -> impl ExactSizeIterator<Item = SceneSkin<'_>> + '_ {
        let raw = self.raw();
        let count = ffi::size(raw.nskin);
        // SAFETY: the engine allocated one number of each for each skin, and filled them in when the scene was made.
        let (starts, lengths) = unsafe { (ffi::array(raw.skinvertadr, count), ffi::array(raw.skinvertnum, count)) };
        // SAFETY: allocated for all vertices of the model, and zeroed, when the scene was made; only written to through `&mut`.
        let (vertices, normals) =
            unsafe { (ffi::rows(raw.skinvert, self.skin_vertices), ffi::rows(raw.skinnormal, self.skin_vertices)) };
        starts.iter().zip(lengths).enumerate().map(move |(skin, (&start, &length))| {
            let range = ffi::size(start)..ffi::size(start) + ffi::size(length);
            SceneSkin {
                skin: Id::new(skin, self.lineage),
                vertices: &vertices[range.clone()],
                normals: &normals[range],
            }
        })
    }
}
