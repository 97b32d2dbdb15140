//! Meshes: vertices, normals, texture coordinates, faces, and the polygons of convex hulls.

use super::super::invalid::Invalid;
use super::super::layout::{Field, field, size};
use super::super::rule::{ids, is, is_in, optional_partition, partition, piece};
use super::super::view::View;

/// Checks all arrays of meshes except convex hulls, bounding volumes and paths.
pub(in super::super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    partition(view, field::mesh_vertadr, field::mesh_vertnum, 1, size::nmeshvert)?;
    partition(view, field::mesh_normaladr, field::mesh_normalnum, 0, size::nmeshnormal)?;
    for mesh in 0..view.size(size::nmesh) {
        let least = i64::from(view.get(field::mesh_texcoordadr, mesh) != -1);
        let most = if least == 0 { 0 } else { i32::MAX.into() };
        is_in(view, field::mesh_texcoordnum, mesh, least..=most)?;
        is(view, field::mesh_octadr, mesh, -1, "because there are no octrees")?;
        is(view, field::mesh_octnum, mesh, 0, "because there are no octrees")?;
    }
    optional_partition(view, field::mesh_texcoordadr, field::mesh_texcoordnum, size::nmeshtexcoord)?;
    partition(view, field::mesh_faceadr, field::mesh_facenum, 1, size::nmeshface)?;
    for mesh in 0..view.size(size::nmesh) {
        let faces = piece(view, field::mesh_faceadr, field::mesh_facenum, mesh);
        let count = |number: Field<i32>| view.get(number, mesh) as usize;
        for i in 3 * faces.start..3 * faces.end {
            is_in(view, field::mesh_face, i, ids(count(field::mesh_vertnum)))?;
            is_in(view, field::mesh_facenormal, i, ids(count(field::mesh_normalnum)))?;
            // Without texture coordinates the indices are zero.
            is_in(view, field::mesh_facetexcoord, i, ids(count(field::mesh_texcoordnum).max(1)))?;
        }
    }
    polygons(view)
}

/// Checks the polygons that merge the faces of a convex hull in one plane, and the map from
/// vertices to polygons, which follows.
fn polygons(view: &View<'_>) -> Result<(), Invalid> {
    partition(view, field::mesh_polyadr, field::mesh_polynum, 0, size::nmeshpoly)?;
    partition(view, field::mesh_polyvertadr, field::mesh_polyvertnum, 3, size::nmeshpolyvert)?;
    partition(view, field::mesh_polymapadr, field::mesh_polymapnum, 0, size::nmeshpolymap)?;
    for mesh in 0..view.size(size::nmesh) {
        let vertices = piece(view, field::mesh_vertadr, field::mesh_vertnum, mesh);
        // The polygons at each vertex, in ascending order.
        let mut map = vec![Vec::new(); vertices.len()];
        for (polygon, i) in piece(view, field::mesh_polyadr, field::mesh_polynum, mesh).enumerate() {
            for at in piece(view, field::mesh_polyvertadr, field::mesh_polyvertnum, i) {
                is_in(view, field::mesh_polyvert, at, ids(vertices.len()))?;
                map[view.get(field::mesh_polyvert, at) as usize].push(polygon);
            }
        }
        for (vertex, polygons) in vertices.zip(map) {
            is(view, field::mesh_polymapnum, vertex, polygons.len() as i64, "the number of polygons at the vertex")?;
            let places = piece(view, field::mesh_polymapadr, field::mesh_polymapnum, vertex);
            for (at, polygon) in places.zip(polygons) {
                is(view, field::mesh_polymap, at, polygon as i64, "the next polygon at the vertex")?;
            }
        }
    }
    Ok(())
}
