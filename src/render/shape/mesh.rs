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

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::super::check::{assert_closed, assert_finite, assert_normals_agree, faces, volume};
    use super::super::{Detail, Triangles, sphere};
    use super::{hull, mesh};
    use crate::{MeshId, Model};

    /// An L of area 3, drawn out by 2.
    const NOTCHED: &str = "0 0 0  2 0 0  2 1 0  1 1 0  1 2 0  0 2 0  0 0 2  2 0 2  2 1 2  1 1 2  1 2 2  0 2 2";
    const NOTCHED_FACES: &str = "0 3 1 1 3 2 0 5 3 3 5 4  6 7 9 7 8 9 6 9 11 9 10 11  0 1 7 0 7 6  1 2 8 1 8 7 \
         2 3 9 2 9 8  3 4 10 3 10 9  4 5 11 4 11 10  5 0 6 5 6 11";

    fn model(vertices: &str, faces: &str, more: &str) -> Model {
        Model::from_xml_str(&format!(
            "<mujoco><compiler exactmeshinertia='true'/>
             <asset><mesh name='m' vertex='{vertices}' face='{faces}' {more}/></asset>
             <worldbody><body><freejoint/><geom type='mesh' mesh='m' density='3'/></body></worldbody></mujoco>"
        ))
        .unwrap()
    }

    fn id(model: &Model) -> MeshId {
        model.mesh("m").unwrap().id()
    }

    #[test]
    fn a_mesh_is_closed_and_its_volume_is_the_one_that_the_engine_has_weighed() {
        let model = model(NOTCHED, NOTCHED_FACES, "");
        let mesh = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_closed(&[&mesh]);
        assert!((volume(&[&mesh]) - 6.0).abs() < 1e-5);
        assert!((volume(&[&mesh]) * 3.0 - model.body_mass()[1]).abs() < 1e-5);
        assert_normals_agree(&mesh, 0.8);
    }

    #[test]
    fn a_hull_is_closed_and_around_the_mesh() {
        let model = model(NOTCHED, NOTCHED_FACES, "");
        let hull = hull(&model, id(&model), usize::MAX).unwrap();
        assert_closed(&[&hull]);
        // The hull cuts the inner corner off: half of 1 by 1, by 2.
        assert!((volume(&[&hull]) - 7.0).abs() < 1e-5);
        assert_normals_agree(&hull, 1.0);
    }

    fn as_text(triangles: &Triangles) -> (String, String) {
        let (mut vertices, mut corners) = (String::new(), String::new());
        for [x, y, z] in triangles.vertices.iter().map(|vertex| vertex.position) {
            write!(vertices, "{x} {y} {z} ").unwrap();
        }
        for corner in &triangles.indices {
            write!(corners, "{corner} ").unwrap();
        }
        (vertices, corners)
    }

    #[test]
    fn edges_are_sharp_or_smooth_as_their_angle_is() {
        let round = sphere(Detail::new(28, 16, 1));
        let (vertices, corners) = as_text(&round);
        let model = model(&vertices, &corners, "");
        let smooth = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(smooth.vertices.len(), round.vertices.len(), "corners are shared");
        assert_closed(&[&smooth]);
        for vertex in &smooth.vertices {
            let along = vertex.position.iter().zip(vertex.normal).map(|(a, b)| a * b).sum::<f32>();
            assert!(along > 0.99, "{vertex:?}");
        }
        let model = self::model("1 1 1  1 -1 -1  -1 1 -1  -1 -1 1", "0 1 2  0 3 1  0 2 3  1 3 2", "");
        let sharp = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(sharp.vertices.len(), 12, "no corner is shared");
        assert_normals_agree(&sharp, 1.0);
    }

    #[test]
    fn where_a_picture_is_glued_on_each_corner_has_its_own_place_in_it() {
        let model =
            model("0 0 0  1 0 0  0 1 0  0 0 1", "0 2 1  0 1 3  0 3 2  1 2 3", "texcoord='0 0  1 0  0 1  0.25 0.75'");
        let view = model.mesh(id(&model));
        let mesh = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(mesh.vertices.len(), 4, "all normals are the vertices' own");
        for vertex in &mesh.vertices {
            let index = view.vert().iter().position(|position| *position == vertex.position).unwrap();
            assert_eq!(vertex.texcoord, view.texcoord()[index]);
            assert_eq!(vertex.normal, view.normal()[index]);
        }
        let hull = hull(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(hull.vertices.len(), 12);
        for vertex in &hull.vertices {
            let index = view.vert().iter().position(|position| *position == vertex.position).unwrap();
            assert_eq!(vertex.texcoord, view.texcoord()[index]);
        }
    }

    #[test]
    fn numbers_that_are_none_do_not_get_through() {
        let mut model =
            model("0 0 0  1 0 0  0 1 0  0 0 1", "0 2 1  0 1 3  0 3 2  1 2 3", "texcoord='0 0  1 0  0 1  0.25 0.75'");
        for (normal, texcoord) in [(f32::NAN, f32::INFINITY), (f32::INFINITY, f32::NAN), (0.0, -f32::INFINITY)] {
            let mut edit = model.edit();
            let mut view = edit.mesh_mut("m").unwrap();
            view.normal_mut()[1] = [normal; 3];
            view.texcoord_mut()[2] = [texcoord; 2];
            for shape in [mesh(&model, id(&model), 100).unwrap(), hull(&model, id(&model), 100).unwrap()] {
                assert_finite(&shape);
                assert_eq!(faces(&shape).count(), 4);
            }
        }
    }

    #[test]
    fn a_mesh_that_is_too_large_is_an_error_that_names_it() {
        let model = model(NOTCHED, NOTCHED_FACES, "");
        assert!(mesh(&model, id(&model), 60).is_ok());
        let error = mesh(&model, id(&model), 59).unwrap_err();
        assert!(error.to_string().contains("mesh 0 'm' has 60 corners"), "{error}");
        assert!(hull(&model, id(&model), 2).is_err());
    }
}
