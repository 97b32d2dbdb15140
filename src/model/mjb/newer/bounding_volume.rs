//! Hierarchies of bounding volumes: one for the geoms of each body, then one for the faces of each
//! mesh.
//!
//! The engine descends from the root to the children without bounds checks. A hierarchy lists a
//! node, the nodes below its first child and the nodes below its second child. A leaf has no
//! children, and refers to a geom or to a face.

use super::super::invalid::Invalid;
use super::super::layout::{Field, field, size};
use super::super::rule::{is, is_in, size_is};
use super::super::view::View;

/// Checks all hierarchies, after geoms and faces.
pub(in super::super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let mut next = 0;
    for body in 0..view.size(size::nbody) {
        let first = i64::from(view.get(field::body_geomadr, body));
        let geoms = [first, first + i64::from(view.get(field::body_geomnum, body))];
        next = hierarchy(view, [field::body_bvhadr, field::body_bvhnum], body, next, geoms)?;
    }
    for mesh in 0..view.size(size::nmesh) {
        // A ray begins at the root, which must exist.
        is_in(view, field::mesh_bvhnum, mesh, 1..=i32::MAX.into())?;
        let faces = [0, i64::from(view.get(field::mesh_facenum, mesh))];
        next = hierarchy(view, [field::mesh_bvhadr, field::mesh_bvhnum], mesh, next, faces)?;
    }
    // With fusestatic the compiler counts more nodes than there are. Nothing refers to the others,
    // which are at the end.
    size_is(view, size::nbvh, view.size(size::nbvhstatic) as u64, "the number of nodes without flexes")
}

/// Checks the hierarchy of an owner, whose leaves have ids from `first` to `end - 1`, and returns
/// its end.
fn hierarchy(
    view: &View<'_>,
    [address, number]: [Field<i32>; 2],
    owner: usize,
    start: usize,
    [first, end]: [i64; 2],
) -> Result<usize, Invalid> {
    let room = view.size(size::nbvhstatic).min(view.size(size::nbvh)).saturating_sub(start);
    is_in(view, number, owner, 0..=room as i64)?;
    let count = view.get(number, owner) as usize;
    if count == 0 {
        is(view, address, owner, -1, "because it has no bounding volumes")?;
        return Ok(start);
    }
    is(view, address, owner, start as i64, "the end of the previous hierarchy")?;

    // The nodes whose subtrees follow: the depth, and the parent of a second child.
    let mut pending = vec![(0, None)];
    let mut node = 0;
    while let Some((depth, parent)) = pending.pop() {
        if node == count {
            let expected = format!("{} more nodes follow from the children", pending.len() + 1);
            return Err(Invalid::element(number.name(), owner, count, expected));
        }
        let at = start + node;
        if let Some(parent) = parent {
            is(view, field::bvh_child, 2 * parent + 1, node as i64, "the node after those below the first child")?;
        }
        is(view, field::bvh_depth, at, depth, "the depth of the node")?;
        let is_leaf = (2 * at..2 * at + 2).all(|i| view.get(field::bvh_child, i) == -1);
        if !is_leaf {
            is(view, field::bvh_child, 2 * at, node as i64 + 1, "the next node")?;
            pending.push((depth + 1, Some(at)));
            pending.push((depth + 1, None));
        }
        // With fusestatic the compiler assigns some of the ids to other nodes. The engine raises an
        // error for a leaf without an id.
        if view.get(field::bvh_nodeid, at) != -1 {
            is_in(view, field::bvh_nodeid, at, first..=end - 1)?;
        }
        node += 1;
    }
    is(view, number, owner, node as i64, "the number of nodes from the root on")?;
    Ok(start + count)
}
