//! Derivatives of the inertia matrix by the position.
//!
//! For l above k or equal to it, `M_kl = S_l · I_k S_k` with the inertia I_k of the bodies that k
//! moves. Degree of freedom j moves none of these vectors relative to each other if it moves l.
//! Otherwise
//!
//! ```text
//! ∂M_kl/∂q_j = S_l · S_j ×* (I_k S_k)                        if j moves k, but not l,
//! ∂M_kl/∂q_j = S_l · (S_j ×* (I_j S_k) − I_j (S_j × S_k))    if j is below k, so that it moves a part of the bodies,
//! ```
//!
//! and zero for all others (R. Featherstone, "Rigid Body Dynamics Algorithms", Springer 2008,
//! section 6.2).

use super::rigid_body::RigidBodies;
use super::tree::Tree;
use crate::data::Data;
use crate::ffi;
use crate::matrix::Matrix;
use crate::numerics::spatial::{Spatial, cross_force, cross_motion, dot, momentum, sub};

/// Writes the derivatives of the stored elements of the inertia matrix, a row for each degree of
/// freedom, after the inertias of the subtrees were computed.
pub(super) fn differentiate(data: &Data, tree: &Tree, bodies: &RigidBodies, result: &mut Matrix) {
    let (model, axes) = (data.model(), data.cdof());
    result.as_mut_slice().fill(0.0);
    let subtree = |dof: usize| bodies.subtree_inertia(ffi::size(model.dof_bodyid()[dof]));
    for k in 0..model.nv() {
        let momentum_of_k = momentum(subtree(k), &axes[k]);
        // Those that move k.
        for j in tree.groups[tree.group[k]].dofs().chain(above(tree, k)) {
            write(data, tree, (j, k), &cross_force(&axes[j], &momentum_of_k), result.row_mut(j));
        }
        // Those that k moves, here as `above`, change its inertia.
        let (axis, inertia) = (&axes[k], subtree(k));
        for above in above(tree, k) {
            let turned = cross_force(axis, &momentum(inertia, &axes[above]));
            let change = sub(&turned, &momentum(inertia, &cross_motion(axis, &axes[above])));
            write(data, tree, (k, above), &change, result.row_mut(k));
        }
    }
}

/// Returns the degrees of freedom of the groups above the group of `dof`.
fn above(tree: &Tree, dof: usize) -> impl Iterator<Item = usize> {
    tree.chain(tree.parent[tree.groups[tree.group[dof]].first])
}

/// Writes the derivatives of the elements of row k of the inertia matrix by degree of freedom j,
/// given the derivative of the momentum `I_k S_k`.
fn write(data: &Data, tree: &Tree, (j, k): (usize, usize), change: &Spatial, result: &mut [f64]) {
    let (start, row) = data.inertia_place(k);
    let mut element = |index: usize, l: usize| {
        if tree.group[l] < tree.group[j] {
            result[start + index] = dot(&data.cdof()[l], change);
        }
    };
    match row {
        Some(row) => row.iter().enumerate().for_each(|(index, (l, _))| element(index, l)),
        None => tree.chain(Some(k)).enumerate().for_each(|(index, l)| element(index, l)),
    }
}
