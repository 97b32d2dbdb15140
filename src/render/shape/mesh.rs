//! A mesh of the model, and its convex hull.

use super::{Triangles, Vertex, face_normal, finite_or_zero};
use crate::error::Result;
use crate::id::MeshId;
use crate::model::Model;

/// The normal at a corner is used if it is within acos(0.8), 37°, of the triangle's own, and where a picture is glued on;
/// otherwise the edge is sharp.
const SMOOTH: f32 = 0.8;

/// No corner has been made of a vertex yet.
const UNUSED: u32 = u32::MAX;

/// A mesh in its own frame.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `most` corners.
pub(crate) fn mesh(model: &Model, id: MeshId, most: usize) -> Result<Triangles> {
    let mesh = model.mesh(id);
    let (positions, normals, texcoords) = (mesh.vert(), mesh.normal(), mesh.texcoord());
    let faces = mesh.face();
    Triangles::check_room(|| format!("{mesh:?}"), faces.len().saturating_mul(3), most)?;
    let mut triangles = Triangles { vertices: Vec::new(), indices: Vec::with_capacity(3 * faces.len()) };
    // A corner with the vertex's own normal is shared by all faces around it.
    let mut shared = vec![UNUSED; positions.len()];
    for face in faces {
        let Some(corners) = corners(*face, positions) else { continue };
        let Some(flat) = face_normal(corners.map(|corner| positions[corner])) else { continue };
        for corner in corners {
            let normal = normals.get(corner).copied().unwrap_or(flat);
            let dot = normal.iter().zip(flat).map(|(a, b)| a * b).sum::<f32>();
            let is_own =
                normal.iter().all(|component| component.is_finite()) && (!texcoords.is_empty() || dot >= SMOOTH);
            if is_own && shared[corner] != UNUSED {
                triangles.indices.push(shared[corner]);
                continue;
            }
            let index = triangles.vertices.len() as u32;
            if is_own {
                shared[corner] = index;
            }
            let texcoord = texcoords.get(corner).copied().unwrap_or_default().map(finite_or_zero);
            let normal = if is_own { normal } else { flat };
            triangles.vertices.push(Vertex { position: positions[corner], normal, texcoord });
            triangles.indices.push(index);
        }
    }
    Ok(triangles)
}

/// The convex hull of a mesh, flat-faced; nothing if the compiler has made none.
///
/// # Errors
///
/// As for [`mesh`].
pub(crate) fn hull(model: &Model, id: MeshId, most: usize) -> Result<Triangles> {
    let mesh = model.mesh(id);
    let Some(&[vertices, _, ref rest @ ..]) = mesh.graph() else { return Ok(Triangles::default()) };
    // Where each vertex's edges begin, and which vertex it is; the ends of all edges: V + V + (V + 3 F) numbers. The corners
    // of the faces, 3 F numbers, are the second half of what follows the first 3 V.
    let (_, rest) = rest.split_at(rest.len().min(3 * usize::try_from(vertices).unwrap_or(0)));
    let (faces, _) = rest[rest.len() / 2..].as_chunks::<3>();
    Triangles::check_room(|| format!("the hull of {mesh:?}"), faces.len().saturating_mul(3), most)?;
    let (positions, texcoords) = (mesh.vert(), mesh.texcoord());
    let mut triangles = Triangles::default();
    for face in faces {
        let Some(corners) = corners(*face, positions) else { continue };
        let texcoord = |corner: usize| texcoords.get(corner).copied().unwrap_or_default();
        triangles.flat(corners.map(|corner| positions[corner]), corners.map(texcoord));
    }
    Ok(triangles)
}

/// The vertices of a face, if there are such.
fn corners(face: [i32; 3], positions: &[[f32; 3]]) -> Option<[usize; 3]> {
    let corners = face.map(|corner| usize::try_from(corner).unwrap_or(usize::MAX));
    corners.iter().all(|&corner| corner < positions.len()).then_some(corners)
}
