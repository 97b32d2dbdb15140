//! The convex hulls of meshes, which the collision code climbs over from vertex to neighbour.
//!
//! A hull is a run of ints in `mesh_graph`: the numbers of vertices *V* and faces *F*; for each vertex where its list of
//! neighbours begins, and its id in the mesh; the lists, each ended by -1 (*V* + 3 *F* ints, since a closed triangulated
//! surface has 3 *F* / 2 edges); the three corners of each face.

use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{is, is_in, size_is};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let end = view.size(size::nmeshgraph);
    let mut next = 0;
    for mesh in 0..view.size(size::nmesh) {
        if view.get(field::mesh_graphadr, mesh) == -1 {
            continue;
        }
        is(view, field::mesh_graphadr, mesh, next as i64, "where the hull before it ends, or -1 for none")?;
        next = hull(view, mesh, next, end)?;
    }
    size_is(view, size::nmeshgraph, next as u64, "the sum over the hulls")
}

/// Checks the hull of a mesh and returns where it ends.
fn hull(view: &View<'_>, mesh: usize, start: usize, end: usize) -> Result<usize, Invalid> {
    let short = |call: i64| {
        let wanted = format!("the hull of mesh {mesh} calls for {call} from {start} on");
        Invalid::scalar(size::nmeshgraph.name(), end, wanted)
    };
    if end - start < 2 {
        return Err(short(2));
    }
    let mesh_vertices = i64::from(view.get(field::mesh_vertnum, mesh));
    is_in(view, field::mesh_graph, start, 1..=mesh_vertices)?;
    is_in(view, field::mesh_graph, start + 1, 0..=i32::MAX.into())?;
    let vertices = i64::from(view.get(field::mesh_graph, start));
    let faces = i64::from(view.get(field::mesh_graph, start + 1));
    let lists = vertices + 3 * faces;
    let total = 2 + 2 * vertices + lists + 3 * faces;
    if total > (end - start) as i64 {
        return Err(short(total));
    }

    let mut at = start + 2;
    let mut run = |length: i64, range: std::ops::RangeInclusive<i64>| {
        let from = at;
        at += length as usize;
        (from..at).try_for_each(|i| is_in(view, field::mesh_graph, i, range.clone()))
    };
    run(vertices, 0..=lists - 1)?;
    run(vertices, 0..=mesh_vertices - 1)?;
    run(lists, -1..=vertices - 1)?;
    run(3 * faces, 0..=mesh_vertices - 1)?;
    // With an end at the very last place, no list runs on into what follows.
    is(
        view,
        field::mesh_graph,
        start + (2 + 2 * vertices + lists - 1) as usize,
        -1,
        "the end of the last list of neighbours",
    )?;
    Ok(at)
}
