//! What of a skin stays as it is while it bends.

use super::{Triangles, finite_or_zero};
use crate::error::Result;
use crate::id::SkinId;
use crate::model::Model;

/// What of a skin stays as it is while it bends. Positions and normals of its vertices are in the scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SkinSurface {
    /// How many vertices it has.
    pub(crate) vertices: usize,
    /// Triangles, three vertices each, counterclockwise from outside.
    pub(crate) indices: Vec<u32>,
    /// For each vertex where it is in the picture that is glued on; zero where none is.
    pub(crate) texcoords: Vec<[f32; 2]>,
}

/// The surface of a skin.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `most` vertices, or for more than `most` triangles.
pub(crate) fn skin(model: &Model, id: SkinId, most: usize) -> Result<SkinSurface> {
    let skin = model.skin(id);
    let (vertices, faces) = (skin.vert().len(), skin.face());
    Triangles::check_room(|| format!("{skin:?}"), vertices.max(faces.len()), most)?;
    let mut surface = SkinSurface { vertices, indices: Vec::with_capacity(3 * faces.len()), texcoords: Vec::new() };
    for face in faces {
        let corners = face.map(|corner| u32::try_from(corner).unwrap_or(u32::MAX));
        if corners.iter().all(|&corner| (corner as usize) < vertices) {
            surface.indices.extend(corners);
        }
    }
    surface.texcoords.extend(skin.texcoord().iter().map(|texcoord| texcoord.map(finite_or_zero)));
    surface.texcoords.resize(vertices, [0.0; 2]);
    Ok(surface)
}
