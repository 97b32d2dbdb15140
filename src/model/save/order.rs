//! Order of the pairs and exclusions of contacts, which the compiler sorts by their bodies.
//!
//! The sort of some builds of 2.2.2 is not stable, so pairs of the same two bodies can be in
//! another order after each load.

use super::arrays::{Arrays, decode};
use crate::kind::Kind;
use crate::model::Model;

/// Elements that the compiler sorts: the size that counts them, their kind, and the addresses of
/// their names.
const SORTED: [(&str, Kind, &str); 2] =
    [("npair", Kind::Pair, "name_pairadr"), ("nexclude", Kind::Exclude, "name_excludeadr")];

/// Orders in which the sorted elements of two models have the same places.
pub(super) struct Orders {
    /// For each kind in [`SORTED`], the elements of both models in a common order.
    sorted: [[Vec<usize>; 2]; SORTED.len()],
}

impl Orders {
    /// Compares elements by their names, and then by their numbers.
    pub(super) fn of(models: [(&Model, &Arrays<'_>); 2]) -> Self {
        Self { sorted: SORTED.map(|(rows, kind, _)| models.map(|(model, arrays)| order(model, arrays, rows, kind))) }
    }

    /// Returns the elements of both models in a common order, or `None` for rows that are not
    /// sorted.
    pub(super) fn of_rows(&self, rows: &str) -> Option<&[Vec<usize>; 2]> {
        SORTED.iter().position(|(sorted, ..)| *sorted == rows).map(|at| &self.sorted[at])
    }

    /// Returns `true` if the orders in the two models differ, so that names have other places.
    pub(super) fn move_names(&self) -> bool {
        self.sorted.iter().any(|[own, other]| own != other)
    }
}

/// Returns `true` for an array of places of names.
pub(super) fn is_place_of_names(array: &str) -> bool {
    array == "names_map" || SORTED.iter().any(|(.., places)| *places == array)
}

/// Returns the names in the text of all names, sorted.
pub(super) fn sorted_names(text: &[u8]) -> Vec<&[u8]> {
    let mut names: Vec<&[u8]> = text.split(|&byte| byte == 0).collect();
    names.sort_unstable();
    names
}

fn order(model: &Model, arrays: &Arrays<'_>, rows: &str, kind: Kind) -> Vec<usize> {
    let fields =
        || Model::fields().filter(|field| field.is_array && field.rows == rows && !is_place_of_names(field.name));
    let numbers = |element: usize| -> Vec<f64> {
        fields()
            .flat_map(|field| {
                let row = arrays.row_length(&field);
                decode(field.ctype, &arrays.bytes(field.name)[element * row..][..row])
            })
            .collect()
    };
    let count = fields().next().map_or(0, |field| arrays.bytes(field.name).len() / arrays.row_length(&field));
    let mut elements: Vec<_> =
        (0..count).map(|element| (model.name_at(kind, element), numbers(element), element)).collect();
    elements.sort_by(|(name, numbers, _), (other_name, other, _)| {
        let by_numbers = || numbers.iter().zip(other).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
        name.cmp(other_name).then_with(|| by_numbers().unwrap_or(std::cmp::Ordering::Equal))
    });
    elements.into_iter().map(|(.., element)| element).collect()
}
