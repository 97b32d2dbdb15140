//! The matrix `W = M + h D` of the Euler integrator with implicit damping D.
//!
//! D is diagonal, so W has the sparsity of M: an entry is zero unless one degree of freedom is
//! above the other in the tree. The factorisation `W = Lᵀ Δ L`, Δ diagonal, keeps this sparsity (R.
//! Featherstone, "Efficient factorization of the joint-space inertia matrix for branched kinematic
//! trees", IJRR 2005). Values are stored as in the `qM` of 2.2.2: for each degree of freedom, the
//! values of its chain to the root.

use super::tree::Tree;
use crate::data::Data;
use crate::ffi;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add;
use crate::numerics::vectorised;

/// Sparse factor of `M + h D`.
#[derive(Debug, Default)]
pub(super) struct DampedInertia {
    /// W, and then Δ on the diagonal and L below it.
    values: Vec<f64>,
    /// `(nv)`: address of the diagonal entry of each degree of freedom.
    start: Vec<usize>,
}

impl DampedInertia {
    /// Factorises `M + h D` at the present position.
    pub(super) fn factor(&mut self, data: &Data, tree: &Tree) {
        let model = data.model();
        self.values.clear();
        self.start.clear();
        let Self { values, start } = self;
        for (dof, &damping) in model.dof_damping().iter().enumerate() {
            start.push(values.len());
            push_row(data, tree, dof, values);
            values[start[dof]] += model.raw().opt.timestep * damping;
        }
        for dof in (0..start.len()).rev() {
            let pivot = values[start[dof]];
            let length = tree.chain(tree.parent[dof]).count();
            for (offset, above) in tree.chain(tree.parent[dof]).enumerate() {
                let at = start[dof] + 1 + offset;
                let factor = values[at] / pivot;
                // The row of `above` is the rest of this chain. Its entries are before the entries
                // of `dof`.
                for rest in 0..length - offset {
                    values[start[above] + rest] -= factor * values[at + rest];
                }
            }
            values[start[dof] + 1..=start[dof] + length].iter_mut().for_each(|value| *value /= pivot);
        }
    }

    /// Computes `W⁻¹ X` in place. Row k of X, of any width, belongs to degree of freedom k.
    pub(super) fn solve(&self, tree: &Tree, matrix: &mut Matrix) {
        let width = matrix.ncols();
        solve(self, tree, width, matrix.as_mut_slice());
    }
}

vectorised! {
/// Computes `W⁻¹ X` in place, for rows of X of this width.
fn solve(factor: &DampedInertia, tree: &Tree, width: usize, values: &mut [f64]) {
    let elements = &factor.values;
    for (dof, &start) in factor.start.iter().enumerate().rev() {
        let (above, row) = values.split_at_mut(dof * width);
        let row = &mut row[..width];
        for (ancestor, &factor) in tree.chain(tree.parent[dof]).zip(&elements[start + 1..]) {
            add(&mut above[ancestor * width..(ancestor + 1) * width], row, -factor);
        }
        let inverse = 1.0 / elements[start];
        for value in row {
            *value *= inverse;
        }
    }
    for (dof, &start) in factor.start.iter().enumerate() {
        let (above, row) = values.split_at_mut(dof * width);
        for (ancestor, &factor) in tree.chain(tree.parent[dof]).zip(&elements[start + 1..]) {
            add(&mut row[..width], &above[ancestor * width..(ancestor + 1) * width], -factor);
        }
    }
}
}

/// Appends the elements of a row of the inertia matrix for a degree of freedom and those above it.
fn push_row(data: &Data, tree: &Tree, dof: usize, values: &mut Vec<f64>) {
    let Some(row) = data.inertia_row(dof) else {
        let start = ffi::size(data.model().dof_Madr()[dof]);
        values.extend_from_slice(&data.inertia_elements()[start..start + tree.chain(Some(dof)).count()]);
        return;
    };
    // Columns increase, and the chain leads to lower degrees of freedom. Elements that are always
    // zero are not stored.
    let mut stored = row.iter().rev().peekable();
    for above in tree.chain(Some(dof)) {
        values.push(stored.next_if(|&(column, _)| column == above).map_or(0.0, |(_, value)| value));
    }
}
