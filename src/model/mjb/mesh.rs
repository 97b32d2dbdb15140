//! Meshes: vertices, texture coordinates and faces. Their convex hulls are in `graph`.

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{is_in, optional_partition, partition, piece};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    partition(view, field::mesh_vertadr, field::mesh_vertnum, 1, size::nmeshvert)?;
    optional_partition(view, field::mesh_texcoordadr, field::mesh_vertnum, size::nmeshtexvert)?;
    partition(view, field::mesh_faceadr, field::mesh_facenum, 0, size::nmeshface)?;
    for mesh in 0..view.size(size::nmesh) {
        let vertices = view.get(field::mesh_vertnum, mesh);
        faces(view, field::mesh_face, piece(view, field::mesh_faceadr, field::mesh_facenum, mesh), vertices)?;
    }
    // The engine looks for the vertex that is farthest in a direction, and takes -1 for its id if none compares greater than
    // -1e10.
    for (i, value) in view.values(field::mesh_vert).enumerate() {
        if value.is_nan() || value.abs() > LARGEST_COORDINATE {
            let wanted = format!("it must be within {LARGEST_COORDINATE} of zero");
            return Err(Invalid::element(field::mesh_vert.name(), i, value, wanted));
        }
    }
    Ok(())
}

const LARGEST_COORDINATE: f32 = 1e9;

/// Each corner of the given faces is one of the vertices.
pub(super) fn faces(
    view: &View<'_>,
    corner: Field<i32>,
    faces: std::ops::Range<usize>,
    vertices: i32,
) -> Result<(), Invalid> {
    (3 * faces.start..3 * faces.end).try_for_each(|i| is_in(view, corner, i, 0..=i64::from(vertices) - 1))
}
