//! Views of meshes.

use std::ops::Range;

use mujoco_sys::adapted::MeshFaces;

use super::{View, ViewMut, range};
use crate::ffi;
use crate::kind;
use crate::model::{Model, ModelMut};

fields!(Mesh on Model {
    /// Range of its vertices in `mesh_vert`.
    #[doc(alias = "vertadr")]
    #[doc(alias = "vertnum")]
    vert_range: {Range<usize>} = |mesh| range(mesh.owner.mesh_vertadr(), mesh.owner.mesh_vertnum(), mesh.index());
    /// Range of its normals in `mesh_normal`.
    #[doc(alias = "normaladr")]
    #[doc(alias = "normalnum")]
    normal_range: {Range<usize>} = |mesh| {
        let MeshFaces { normaladr, normalnum, .. } = mesh.owner.mesh_faces(mesh.index());
        ffi::size(normaladr)..ffi::size(normaladr) + ffi::size(normalnum)
    };
    /// Range of its texture coordinates in `mesh_texcoord`; empty without texture coordinates.
    #[doc(alias = "texcoordadr")]
    #[doc(alias = "texcoordnum")]
    texcoord_range: {Range<usize>} = |mesh| {
        let MeshFaces { texcoordadr, texcoordnum, .. } = mesh.owner.mesh_faces(mesh.index());
        ffi::size(texcoordadr)..ffi::size(texcoordadr) + ffi::size(texcoordnum)
    };
    /// Range of its faces in `mesh_face`.
    #[doc(alias = "faceadr")]
    #[doc(alias = "facenum")]
    face_range: {Range<usize>} = |mesh| range(mesh.owner.mesh_faceadr(), mesh.owner.mesh_facenum(), mesh.index());
    /// Vertices, m, in the mesh frame, whose origin is the centre of mass.
    vert: [[f32; 3]] = mesh_vert at vert_range;
    /// Normals, to which [`facenormal`](Self::facenormal) refers: one for each vertex in 2.2.2.
    normal: [[f32; 3]] = mesh_normal at normal_range, normal_mut in mesh_normal_mut;
    /// Texture coordinates, to which [`facetexcoord`](Self::facetexcoord) refers: one pair for each
    /// vertex in 2.2.2. Empty without texture coordinates.
    texcoord: [[f32; 2]] = mesh_texcoord at texcoord_range, texcoord_mut in mesh_texcoord_mut;
    /// Faces: three vertex indices each, relative to the first vertex of the mesh.
    face: [[i32; 3]] = mesh_face at face_range;
    /// Normals of the corners of each face: three indices in [`normal`](Self::normal). In 2.2.2
    /// these are the vertices.
    facenormal: {&'a [[i32; 3]]} = |mesh| {
        let (faces, count) = (mesh.owner.mesh_faces(mesh.index()), mesh.face_range().len());
        // SAFETY: the engine allocated three indices for each face, and the model is borrowed.
        unsafe { ffi::rows(faces.facenormal, count) }
    };
    /// Texture coordinates of the corners of each face: three indices in
    /// [`texcoord`](Self::texcoord), in 2.2.2 the vertices. Empty without texture coordinates.
    facetexcoord: {&'a [[i32; 3]]} = |mesh| {
        let faces = mesh.owner.mesh_faces(mesh.index());
        let count = if faces.facetexcoord.is_null() { 0 } else { mesh.face_range().len() };
        // SAFETY: as in `facenormal`.
        unsafe { ffi::rows(faces.facetexcoord, count) }
    };
    /// Convex hull as a graph, in the engine's layout: the number of vertices, the number of faces,
    /// the offset of each vertex's edge list, the index of each vertex in the mesh, the edge lists,
    /// and the vertices of all faces. `None` for a mesh compiled without a hull because none of its
    /// geoms can collide. A collision with such a mesh iterates over all of its vertices.
    #[doc(alias = "graphadr")]
    #[doc(alias = "mesh_graph")]
    graph: {Option<&'a [i32]>} = |mesh| {
        let start = usize::try_from(mesh.owner.mesh_graphadr()[mesh.index()]).ok()?;
        let graph = &mesh.owner.mesh_graph()[start..];
        let (vertices, faces) = (ffi::size(graph[0]), ffi::size(graph[1]));
        Some(&graph[..2 + 3 * vertices + 6 * faces])
    };
});
