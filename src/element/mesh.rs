//! Meshes of triangles.

use std::ops::Range;

use super::{View, ViewMut, range};
use crate::ffi;
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Mesh on Model {
    /// Where its vertices are in `mesh_vert` and `mesh_normal`.
    #[doc(alias = "vertadr")]
    #[doc(alias = "vertnum")]
    vert_range: {Range<usize>} = |mesh| range(mesh.owner.mesh_vertadr(), mesh.owner.mesh_vertnum(), mesh.index());
    /// Where the texture coordinates of its vertices are in `mesh_texcoord`; empty if it has none.
    #[doc(alias = "texcoordadr")]
    texcoord_range: {Range<usize>} =
        |mesh| optional_range(mesh.owner.mesh_texcoordadr(), mesh.owner.mesh_vertnum(), mesh.index());
    /// Where its faces are in `mesh_face`.
    #[doc(alias = "faceadr")]
    #[doc(alias = "facenum")]
    face_range: {Range<usize>} = |mesh| range(mesh.owner.mesh_faceadr(), mesh.owner.mesh_facenum(), mesh.index());
    /// Its vertices, m, in its own frame, which has its origin at the centre of mass.
    vert: [[f32; 3]] = mesh_vert at vert_range;
    /// The normal at each vertex.
    normal: [[f32; 3]] = mesh_normal at vert_range, normal_mut in mesh_normal_mut;
    /// The texture coordinates of each vertex; empty if it has none.
    texcoord: [[f32; 2]] = mesh_texcoord at texcoord_range, texcoord_mut in mesh_texcoord_mut;
    /// Its faces: three vertices each, counted from the mesh's first.
    face: [[i32; 3]] = mesh_face at face_range;
    /// Its convex hull as a graph, in the engine's own layout: the number of vertices, the number of faces, then where each
    /// vertex's edges begin, which vertex of the mesh it is, the ends of all edges, and the corners of all faces. `None` if it was
    /// compiled without a hull, since no geom that collides has it: such a geom collides by going over all vertices.
    #[doc(alias = "graphadr")]
    #[doc(alias = "mesh_graph")]
    graph: {Option<&'a [i32]>} = |mesh| {
        let start = usize::try_from(mesh.owner.mesh_graphadr()[mesh.index()]).ok()?;
        let graph = &mesh.owner.mesh_graph()[start..];
        let (vertices, faces) = (ffi::size(graph[0]), ffi::size(graph[1]));
        Some(&graph[..2 + 3 * vertices + 6 * faces])
    };
});

/// The range that starts at an element's address; empty where the address is -1.
pub(super) fn optional_range(addresses: &[i32], counts: &[i32], index: usize) -> Range<usize> {
    if addresses[index] < 0 { 0..0 } else { range(addresses, counts, index) }
}
