//! Correspondence of contacts and constraints, which engines may list in another order.

use std::borrow::Cow;

use super::quantities::{Quantity, Rows, Series, find};
use crate::sys;

/// Row of the trace for each row here.
#[derive(Default)]
pub(super) struct Order {
    contacts: Option<Vec<usize>>,
    pub(super) constraints: Option<Vec<usize>>,
}

impl Order {
    /// Matches contacts of the same geoms by their positions, and constraints by their types, their
    /// objects and their order. Without a complete match, rows remain in their order.
    pub(super) fn of(there: &[Series], here: &[Series]) -> Self {
        let mut order = Self::default();
        let both = |name| find(there, name).zip(find(here, name)).filter(|(a, b)| a.values.len() == b.values.len());
        let Some((geoms, positions)) = both("contact.geom").zip(both("contact.pos")) else { return order };
        let [pairs_there, pairs_here] = [geoms.0, geoms.1].map(|values| {
            let (pairs, _) = values.values.as_chunks::<2>();
            pairs.iter().map(|[a, b]| [a.min(*b), a.max(*b)]).collect::<Vec<_>>()
        });
        let distance = |a: usize, b: usize| {
            let point = |values: &Series, row: usize| {
                values.values.get(3 * row..3 * row + 3).map_or([0.0; 3], |at| [at[0], at[1], at[2]])
            };
            let (a, b) = (point(positions.0, a), point(positions.1, b));
            (0..3).map(|axis| (a[axis] - b[axis]).abs()).sum()
        };
        order.contacts = matched(&pairs_there, &pairs_here, distance);
        let Some((types, ids)) = both("efc_type").zip(both("efc_id")) else { return order };
        let Some(contacts) = &order.contacts else { return order };
        let key = |types: &Series, ids: &Series, rename: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> {
            let rows = types.values.iter().zip(&ids.values);
            rows.map(|(&of, &id)| [of, if is_contact(of) { rename(id) } else { id }]).collect()
        };
        let rename = |id: f64| contacts.iter().position(|&there| there as f64 == id).map_or(-1.0, |here| here as f64);
        let (there, here) = (key(types.0, ids.0, &rename), key(types.1, ids.1, &|id| id));
        // Rows of one object are in the same order.
        order.constraints = matched(&there, &here, |row, _| row as f64);
        order
    }
}

/// Returns `true` for the type of a contact's rows.
pub(super) fn is_contact(efc_type: f64) -> bool {
    efc_type >= f64::from(sys::mjCNSTR_CONTACT_FRICTIONLESS)
}

/// Returns a row of the same key for each row, the nearest one that is still free.
fn matched<K: PartialEq>(there: &[K], here: &[K], distance: impl Fn(usize, usize) -> f64) -> Option<Vec<usize>> {
    let mut is_free = vec![true; there.len()];
    let mut find = |(row, key): (usize, &K)| {
        let same = (0..there.len()).filter(|&other| is_free[other] && there[other] == *key);
        let nearest = same.min_by(|&a, &b| distance(a, row).total_cmp(&distance(b, row)))?;
        is_free[nearest] = false;
        Some(nearest)
    };
    here.iter().enumerate().map(&mut find).collect()
}

/// Returns the values of the trace in the order of the rows here.
pub(super) fn align<'v>(quantity: &Quantity, there: &'v Series, order: &Order) -> Cow<'v, Series> {
    let rows = match quantity.rows {
        Rows::Contacts => &order.contacts,
        Rows::Constraints => &order.constraints,
        _ => return Cow::Borrowed(there),
    };
    let Some(rows) = rows.as_ref().filter(|rows| rows.len() * there.columns == there.values.len()) else {
        return Cow::Borrowed(there);
    };
    if rows.iter().enumerate().all(|(here, there)| here == *there) {
        return Cow::Borrowed(there);
    }
    let values = rows.iter().flat_map(|row| &there.values[row * there.columns..][..there.columns]).copied().collect();
    Cow::Owned(Series { values, ..there.clone() })
}
