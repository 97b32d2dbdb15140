//! Flexes of a scene.

use std::ffi::c_int;
use std::mem::MaybeUninit;

use mujoco_sys::adapted;

use super::Scene;
use crate::ffi;

/// Flex in the pose of the last update: a rope, a cloth or a soft body. Engines before 3.0 have
/// none.
#[derive(Clone, Copy, Debug)]
pub struct SceneFlex<'s> {
    /// Index of the flex in the model.
    pub flex: usize,
    /// Positions of the vertices, m, world frame. Zero before the first update.
    pub vertices: &'s [[f32; 3]],
    /// Two indices of vertices for each edge.
    pub edges: &'s [[i32; 2]],
    /// Positions of the corners of each face, m, world frame: the outer surface, or the faces of
    /// the elements.
    pub faces: &'s [[[f32; 3]; 3]],
    /// Unit normals at the corners of each face.
    pub normals: &'s [[[f32; 3]; 3]],
    /// Texture coordinates of the corners of each face; zero if the flex has none.
    pub texcoords: &'s [[[f32; 2]; 3]],
    /// `true` if the options of the last update show the vertices.
    pub shows_vertices: bool,
    /// `true` if the options of the last update show the edges.
    pub shows_edges: bool,
}

impl Scene {
    /// Iterates over all flexes of the model. [`update`](Self::update) sets their poses if one of
    /// the flags of flexes is set, and the faces that [`FLEXFACE`](super::VisualFlags::FLEXFACE) or
    /// [`FLEXSKIN`](super::VisualFlags::FLEXSKIN) show.
    pub fn flexes(&self) -> impl ExactSizeIterator<Item = SceneFlex<'_>> + '_ {
        // SAFETY: a valid scene, of which the function reads a number.
        let count = unsafe { adapted::scene_flexes(self.as_ptr()) };
        (0..ffi::size(count)).map(|flex| self.flex(flex))
    }

    fn flex(&self, flex: usize) -> SceneFlex<'_> {
        let mut raw = MaybeUninit::uninit();
        // SAFETY: a flex of the scene. The function writes the complete struct.
        let raw = unsafe {
            adapted::scene_flex(self.as_ptr(), flex as c_int, raw.as_mut_ptr());
            raw.assume_init()
        };
        let faces = ffi::size(raw.facenum);
        // SAFETY: the engine allocated the arrays with these lengths, they were set to zero when
        // the scene was created, and only `&mut self` writes to them.
        unsafe {
            SceneFlex {
                flex,
                vertices: ffi::rows(raw.vert, ffi::size(raw.vertnum)),
                edges: ffi::rows(raw.edge, ffi::size(raw.edgenum)),
                faces: ffi::rows::<_, 3>(raw.face, 3 * faces).as_chunks().0,
                normals: ffi::rows::<_, 3>(raw.normal, 3 * faces).as_chunks().0,
                texcoords: ffi::rows::<_, 2>(raw.texcoord, 3 * faces).as_chunks().0,
                shows_vertices: raw.shows_vertices != 0,
                shows_edges: raw.shows_edges != 0,
            }
        }
    }
}
