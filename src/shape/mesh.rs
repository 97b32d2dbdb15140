//! Triangles of the model's meshes, convex hulls and skins.

use super::{Triangles, Vertex, face_normal, finite_or_zero};
use crate::error::Result;
use crate::id::{MeshId, SkinId};
use crate::model::Model;

/// Smooth shading threshold. A vertex normal is used if its angle to the face normal is at most
/// acos(0.8), 37°, or if the mesh has texture coordinates; otherwise the edge is sharp.
const SMOOTH_THRESHOLD: f32 = 0.8;

/// Marks a normal of a mesh that has no shared vertex in the vertex buffer yet.
const UNUSED: u32 = u32::MAX;

/// Generates the triangles of a mesh in its local frame.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `max_vertices` vertices.
pub(crate) fn mesh(model: &Model, id: MeshId, max_vertices: usize) -> Result<Triangles> {
    let mesh = model.mesh(id);
    let (positions, normals, texcoords) = (mesh.vert(), mesh.normal(), mesh.texcoord());
    let faces = mesh.face();
    Triangles::check_size(|| format!("{mesh:?}"), faces.len().saturating_mul(3), max_vertices)?;
    let mut triangles = Triangles { indices: Vec::with_capacity(3 * faces.len()), ..Triangles::default() };
    // Corners with the same smooth normal, vertex and texture coordinates are shared by all
    // adjacent faces.
    let mut shared = vec![UNUSED; normals.len()];
    let of_corners = |indices: &[[i32; 3]], face: usize| {
        indices
            .get(face)
            .map_or([usize::MAX; 3], |corners| corners.map(|corner| usize::try_from(corner).unwrap_or(usize::MAX)))
    };
    for (index, face) in faces.iter().enumerate() {
        let Some(corners) = checked(*face, positions) else { continue };
        let Some(flat) = face_normal(corners.map(|corner| positions[corner])) else { continue };
        let (face_normals, face_texcoords) =
            (of_corners(mesh.facenormal(), index), of_corners(mesh.facetexcoord(), index));
        for (corner, (at, texcoord)) in corners.into_iter().zip(face_normals.into_iter().zip(face_texcoords)) {
            let normal = normals.get(at).copied().unwrap_or(flat);
            let dot = normal.iter().zip(flat).map(|(a, b)| a * b).sum::<f32>();
            let is_smooth = normal.iter().all(|component| component.is_finite())
                && (!texcoords.is_empty() || dot >= SMOOTH_THRESHOLD);
            let texcoord = texcoords.get(texcoord).copied().unwrap_or_default().map(finite_or_zero);
            let normal = if is_smooth { normal } else { flat };
            let vertex = Vertex { position: positions[corner], normal, texcoord, parity: 0.0 };
            if let Some(&known) = shared.get(at).filter(|_| is_smooth)
                && triangles.vertices.get(known as usize) == Some(&vertex)
            {
                triangles.indices.push(known);
                continue;
            }
            let index = triangles.vertices.len() as u32;
            if let Some(shared) = shared.get_mut(at).filter(|_| is_smooth) {
                *shared = index;
            }
            triangles.vertices.push(vertex);
            triangles.indices.push(index);
        }
    }
    Ok(triangles)
}

/// Generates the flat-shaded triangles of the convex hull of a mesh; none if the compiler has not
/// computed the hull.
///
/// # Errors
///
/// As for [`mesh`].
pub(crate) fn hull(model: &Model, id: MeshId, max_vertices: usize) -> Result<Triangles> {
    let mesh = model.mesh(id);
    let Some(&[vertices, _, ref rest @ ..]) = mesh.graph() else { return Ok(Triangles::default()) };
    // For V vertices and F faces, the rest of `mesh_graph` is: V edge offsets, V vertex ids, and
    // V + 3 F edge targets, followed by the 3 F vertices of the faces. The faces are thus the
    // second half of the data after the first 3 V numbers.
    let (_, rest) = rest.split_at(rest.len().min(3 * usize::try_from(vertices).unwrap_or(0)));
    let (faces, _) = rest[rest.len() / 2..].as_chunks::<3>();
    Triangles::check_size(|| format!("the hull of {mesh:?}"), faces.len().saturating_mul(3), max_vertices)?;
    let (positions, texcoords) = (mesh.vert(), mesh.texcoord());
    let mut triangles = Triangles::default();
    for face in faces {
        let Some(corners) = checked(*face, positions) else { continue };
        let texcoord = |corner: usize| texcoords.get(corner).copied().unwrap_or_default();
        triangles.flat(corners.map(|corner| positions[corner]), corners.map(texcoord));
    }
    Ok(triangles)
}

/// Converts the vertex indices of a face, or returns `None` if an index is out of range.
pub(super) fn checked(face: [i32; 3], positions: &[[f32; 3]]) -> Option<[usize; 3]> {
    let corners = face.map(|corner| usize::try_from(corner).unwrap_or(usize::MAX));
    corners.iter().all(|&corner| corner < positions.len()).then_some(corners)
}

/// Constant data of a skin. The scene contains the positions and normals, which change in every
/// frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SkinTopology {
    /// Number of vertices.
    pub(crate) vertices: usize,
    /// Indices of the vertices of each triangle, with counterclockwise front faces.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Explicit texture coordinates of each vertex; zero if the skin has none.
    pub(crate) texcoords: Vec<[f32; 2]>,
}

/// Generates the constant data of a skin.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `max_vertices` vertices or
/// triangles.
pub(crate) fn skin(model: &Model, id: SkinId, max_vertices: usize) -> Result<SkinTopology> {
    let skin = model.skin(id);
    let (vertices, faces) = (skin.vert().len(), skin.face());
    Triangles::check_size(|| format!("{skin:?}"), vertices.max(faces.len()), max_vertices)?;
    let mut topology = SkinTopology { vertices, triangles: Vec::with_capacity(faces.len()), texcoords: Vec::new() };
    for face in faces {
        let corners = face.map(|corner| u32::try_from(corner).unwrap_or(u32::MAX));
        if corners.iter().all(|&corner| (corner as usize) < vertices) {
            topology.triangles.push(corners);
        }
    }
    topology.texcoords.extend(skin.texcoord().iter().map(|texcoord| texcoord.map(finite_or_zero)));
    topology.texcoords.resize(vertices, [0.0; 2]);
    Ok(topology)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::super::test_support::{assert_closed, assert_finite, assert_normals_agree, faces, volume};
    use super::super::{Tessellation, Triangles, sphere};
    use super::{hull, mesh, skin};
    use crate::Model;
    use crate::id::MeshId;

    /// L-shaped prism: base area 3, height 2.
    const NOTCHED: &str = "0 0 0  2 0 0  2 1 0  1 1 0  1 2 0  0 2 0  0 0 2  2 0 2  2 1 2  1 1 2  1 2 2  0 2 2";
    const NOTCHED_FACES: &str = "0 3 1 1 3 2 0 5 3 3 5 4  6 7 9 7 8 9 6 9 11 9 10 11  0 1 7 0 7 6  1 2 8 1 8 7 \
         2 3 9 2 9 8  3 4 10 3 10 9  4 5 11 4 11 10  5 0 6 5 6 11";

    fn model(vertices: &str, faces: &str, more: &str) -> Model {
        // Newer compilers have the setting in the mesh.
        let (compiler, inertia) = if cfg!(engine_since = "2.3.0") {
            ("", "inertia='exact'")
        } else {
            ("<compiler exactmeshinertia='true'/>", "")
        };
        Model::from_xml_str(&format!(
            "<mujoco>{compiler}
             <asset><mesh name='m' vertex='{vertices}' face='{faces}' {inertia} {more}/></asset>
             <worldbody><body><freejoint/><geom type='mesh' mesh='m' density='3'/></body></worldbody></mujoco>"
        ))
        .unwrap()
    }

    fn id(model: &Model) -> MeshId {
        model.mesh("m").unwrap().id()
    }

    #[test]
    fn a_mesh_is_closed_and_its_volume_matches_the_mass_in_the_engine() {
        let model = model(NOTCHED, NOTCHED_FACES, "");
        let mesh = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_closed(&[&mesh]);
        assert!((volume(&[&mesh]) - 6.0).abs() < 1e-5);
        assert!((volume(&[&mesh]) * 3.0 - model.body_mass()[1]).abs() < 1e-5);
        assert_normals_agree(&mesh, 0.8);
    }

    #[test]
    fn a_hull_is_closed_and_encloses_the_mesh() {
        let model = model(NOTCHED, NOTCHED_FACES, "");
        let hull = hull(&model, id(&model), usize::MAX).unwrap();
        assert_closed(&[&hull]);
        // The hull adds a triangular prism at the concave edge: half of 1 by 1, height 2.
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
    fn edges_are_sharp_or_smooth_depending_on_their_angle() {
        let round = sphere(Tessellation::new(28, 16, 1));
        let (vertices, corners) = as_text(&round);
        let model = model(&vertices, &corners, "");
        let smooth = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(smooth.vertices.len(), round.vertices.len(), "vertices are shared");
        assert_closed(&[&smooth]);
        for vertex in &smooth.vertices {
            let along = vertex.position.iter().zip(vertex.normal).map(|(a, b)| a * b).sum::<f32>();
            assert!(along > 0.99, "{vertex:?}");
        }
        let model = self::model("1 1 1  1 -1 -1  -1 1 -1  -1 -1 1", "0 1 2  0 3 1  0 2 3  1 3 2", "");
        let sharp = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(sharp.vertices.len(), 12, "no vertex is shared");
        assert_normals_agree(&sharp, 1.0);
    }

    #[test]
    fn vertices_keep_explicit_texture_coordinates() {
        let model =
            model("0 0 0  1 0 0  0 1 0  0 0 1", "0 2 1  0 1 3  0 3 2  1 2 3", "texcoord='0 0  1 0  0 1  0.25 0.75'");
        let view = model.mesh(id(&model));
        let mesh = mesh(&model, id(&model), usize::MAX).unwrap();
        assert_eq!(mesh.vertices.len(), 4, "all normals are smooth");
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
    fn non_finite_mesh_values_are_replaced() {
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
        assert!(error.to_string().contains("mesh 0 'm' has 60 vertices"), "{error}");
        assert!(hull(&model, id(&model), 2).is_err());
    }

    fn cloth() -> Model {
        Model::from_xml_str(
            "<mujoco><worldbody><body name='B1_1' pos='0 0 1'><freejoint/>
               <composite type='cloth' count='4 3 1' spacing='0.1'><geom type='sphere' size='0.02'/>
                 <skin texcoord='true' inflate='0.01'/></composite></body></worldbody></mujoco>",
        )
        .unwrap()
    }

    #[test]
    #[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers have other composites")]
    fn a_skin_keeps_its_triangles_and_texture_coordinates() {
        let model = cloth();
        let view = model.skins().next().unwrap();
        let topology = skin(&model, view.id(), usize::MAX).unwrap();
        assert_eq!(topology.vertices, view.vert().len());
        let faces: Vec<[u32; 3]> = view.face().iter().map(|face| face.map(|corner| corner as u32)).collect();
        assert_eq!(topology.triangles, faces);
        assert_eq!(topology.texcoords, view.texcoord());
        assert!(topology.texcoords.as_flattened().iter().all(|coordinate| (0.0..=1.0).contains(coordinate)));
        assert!(skin(&model, view.id(), topology.vertices - 1).is_err());
    }

    #[test]
    #[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers have other composites")]
    fn non_finite_skin_texture_coordinates_are_replaced() {
        let mut model = cloth();
        let id = model.skins().next().unwrap().id();
        model.edit().skin_mut(id).texcoord_mut()[3] = [f32::NAN, f32::INFINITY];
        assert_eq!(skin(&model, id, usize::MAX).unwrap().texcoords[3], [0.0; 2]);
    }
}
