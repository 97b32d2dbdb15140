//! Constant index arrays of sparse matrices. The engine scatters and gathers by them without bounds
//! checks. All of them follow from the kinematic tree and the runs of simple degrees of freedom, so
//! they are recomputed and compared.
//!
//! - *B* has a row for each body, with the degrees of freedom of its ancestors, of itself and of
//!   its descendants.
//! - *D* has a row for each degree of freedom, with those above it, itself and those below it.
//! - *M* is the lower triangle of *D*, in which the rows of simple bodies have only their diagonal.
//! - The maps contain positions in one matrix for each element of another: of the inertia matrix in
//!   its older form (`qM`), *M* and *D*.

use super::super::invalid::Invalid;
use super::super::layout::{Field, field, size};
use super::super::rule::{is, size_is};
use super::super::view::View;

const FOLLOWS: &str = "which follows from the kinematic tree";

/// Checks all index arrays, after the kinematic tree.
pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let parents: Vec<Option<usize>> =
        view.values(field::dof_parentid).map(|parent| usize::try_from(parent).ok()).collect();
    let elements = |rows: &[Vec<usize>]| rows.iter().map(|row| row.len() as u64).sum::<u64>();
    // The size of D, 2 nM - nv, is checked, so it does not exceed an int and neither does the
    // memory for the rows.
    let full = full_rows(&parents);
    let lower = lower_rows(view, &full);
    size_is(view, size::nC, elements(&lower), FOLLOWS)?;
    matrix(view, [field::D_rownnz, field::D_rowadr, field::D_colind], &full)?;
    matrix(view, [field::M_rownnz, field::M_rowadr, field::M_colind], &lower)?;
    for (i, row) in full.iter().enumerate() {
        let diagonal = row.partition_point(|&column| column < i);
        is(view, field::D_diag, i, diagonal as i64, "the position of the diagonal in the row")?;
    }
    maps(view, &parents, &full, &lower)?;
    bodies(view, &full)
}

/// Returns the rows of *D*: for each degree of freedom those above it, itself and those below it,
/// in ascending order.
fn full_rows(parents: &[Option<usize>]) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = Vec::with_capacity(parents.len());
    for (i, parent) in parents.iter().enumerate() {
        // The row of the parent has its ancestors, itself, and descendants that were visited
        // before.
        let mut row = parent.map_or_else(Vec::new, |parent| {
            let above = rows[parent].partition_point(|&column| column <= parent);
            rows[parent][..above].to_vec()
        });
        for &ancestor in &row {
            rows[ancestor].push(i);
        }
        row.push(i);
        rows.push(row);
    }
    rows
}

/// Returns the rows of *M*.
fn lower_rows(view: &View<'_>, full: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let lower = |(i, row): (usize, &Vec<usize>)| match view.get(field::dof_simplenum, i) {
        0 => row[..=row.partition_point(|&column| column < i)].to_vec(),
        _ => vec![i],
    };
    full.iter().enumerate().map(lower).collect()
}

/// Checks the numbers of elements, the addresses and the columns of rows.
fn matrix(view: &View<'_>, fields: [Field<i32>; 3], rows: &[Vec<usize>]) -> Result<(), Invalid> {
    let [number, address, columns] = fields;
    let mut next = 0;
    for (i, row) in rows.iter().enumerate() {
        is(view, number, i, row.len() as i64, FOLLOWS)?;
        is(view, address, i, next as i64, "the end of the previous row")?;
        for &column in row {
            is(view, columns, next, column as i64, FOLLOWS)?;
            next += 1;
        }
    }
    Ok(())
}

/// Checks the maps between matrices.
fn maps(view: &View<'_>, parents: &[Option<usize>], full: &[Vec<usize>], lower: &[Vec<usize>]) -> Result<(), Invalid> {
    let (starts_full, starts_lower) = (starts(full), starts(lower));
    // The position of an element of M, which exists unless the row belongs to a simple body.
    let in_lower = |i: usize, j: usize| {
        let (row, column) = (i.max(j), i.min(j));
        lower[row].binary_search(&column).map_or(-1, |at| (starts_lower[row] + at) as i64)
    };
    for (i, row) in full.iter().enumerate() {
        for (at, &j) in row.iter().enumerate() {
            is(view, field::mapM2D, starts_full[i] + at, in_lower(i, j), "the position of the element in M")?;
        }
    }
    for (i, row) in lower.iter().enumerate() {
        // The older form has the diagonal first, and then the ancestors upwards.
        let (mut ancestor, mut in_older) = (i, i64::from(view.get(field::dof_Madr, i)));
        for (at, &j) in row.iter().enumerate().rev() {
            while ancestor != j {
                ancestor = parents[ancestor].expect("Bug: a row of M has a column that is no ancestor");
                in_older += 1;
            }
            let place = starts_lower[i] + at;
            is(view, field::mapM2M, place, in_older, "the position of the element in qM")?;
            let in_full = full[i].partition_point(|&column| column < j);
            is(view, field::mapD2M, place, (starts_full[i] + in_full) as i64, "the position of the element in D")?;
        }
    }
    Ok(())
}

/// Returns the position of the first element of each row.
fn starts(rows: &[Vec<usize>]) -> Vec<usize> {
    let ends = rows.iter().scan(0, |end, row| {
        *end += row.len();
        Some(*end - row.len())
    });
    ends.collect()
}

/// Checks *B*. The row of a body with degrees of freedom has the same elements as their rows in
/// *D*.
fn bodies(view: &View<'_>, full: &[Vec<usize>]) -> Result<(), Invalid> {
    let nbody = view.size(size::nbody);
    // Degrees of freedom are in the depth-first order of the bodies, so the degrees of freedom of a
    // subtree are a range.
    let mut first = vec![view.size(size::nv); nbody];
    let mut end = vec![0; nbody];
    for body in (0..nbody).rev() {
        let count = view.get(field::body_dofnum, body) as usize;
        if count > 0 {
            let start = view.get(field::body_dofadr, body) as usize;
            first[body] = first[body].min(start);
            end[body] = end[body].max(start + count);
        }
        if body > 0 {
            let parent = view.get(field::body_parentid, body) as usize;
            first[parent] = first[parent].min(first[body]);
            end[parent] = end[parent].max(end[body]);
        }
    }
    let mut next = 0;
    for body in 0..nbody {
        let parent = view.get(field::body_parentid, body) as usize;
        let above = last_dof(view, if body == 0 { None } else { Some(parent) });
        let ancestors = above.map_or(&[][..], |dof| {
            let row = &full[dof];
            &row[..=row.partition_point(|&column| column < dof)]
        });
        let length = ancestors.len() + end[body].saturating_sub(first[body]);
        let limit = view.size(size::nB);
        if next + length > limit {
            let expected = format!("the rows up to body {body} have {} elements", next + length);
            return Err(Invalid::scalar(size::nB.name(), limit, expected));
        }
        is(view, field::B_rownnz, body, length as i64, FOLLOWS)?;
        is(view, field::B_rowadr, body, next as i64, "the end of the previous row")?;
        for column in ancestors.iter().copied().chain(first[body]..end[body]) {
            is(view, field::B_colind, next, column as i64, FOLLOWS)?;
            next += 1;
        }
    }
    size_is(view, size::nB, next as u64, FOLLOWS)
}

/// Returns the last degree of freedom of a body or of the next ancestor that has any.
fn last_dof(view: &View<'_>, mut body: Option<usize>) -> Option<usize> {
    while let Some(i) = body {
        let count = view.get(field::body_dofnum, i) as usize;
        if count > 0 {
            return Some(view.get(field::body_dofadr, i) as usize + count - 1);
        }
        body = (i > 0).then(|| view.get(field::body_parentid, i) as usize);
    }
    None
}
