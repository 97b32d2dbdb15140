//! Quantities that the compiler derives from the writable arrays of a model:
//! `knowledge/derived.tsv`.
//!
//! An array without a line in the table has no mutable accessor, because nobody has examined what
//! depends on it. `updated by` is
//!
//! - `none`: nothing depends on the array;
//! - `edit`: what depends on it is updated at the end of an edit, before any simulation with the
//!   model. Quantities after a semicolon are updated by `ModelMut::update_constants`;
//! - `constants`: what depends on it is updated by `ModelMut::update_constants`;
//! - `computed`: the array itself depends on others, and `update_constants` overwrites it.

use std::fmt::Write as _;

const TABLE: &str = include_str!("knowledge/derived.tsv");

/// Returns the columns of an array: by what the derived quantities are updated, their names, and
/// those that nothing updates.
fn columns(array: &str) -> Option<[&'static str; 3]> {
    let line = TABLE.lines().skip(1).find(|line| line.split('\t').next() == Some(array))?;
    let columns: Vec<&str> = line.split('\t').skip(1).collect();
    Some(columns.try_into().unwrap_or_else(|_| panic!("not a line of derived.tsv: {line}")))
}

/// Returns `true` if it is known what the compiler derives from an array.
pub(super) fn is_known(array: &str) -> bool {
    columns(array).is_some()
}

/// Returns by what the quantities that depend on an array are updated, or `None` for an array that
/// itself depends on others.
pub(super) fn updated_by(array: &str) -> Option<&'static str> {
    columns(array).map(|[updated_by, ..]| updated_by).filter(|updated_by| *updated_by != "computed")
}

/// Returns the documentation of a mutable accessor: what an edit updates, and when.
pub(super) fn documentation(array: &str) -> String {
    let Some([updated_by, derived, not_updated]) = columns(array) else { return String::new() };
    let constants = "[`update_constants`](crate::ModelMut::update_constants)";
    let names = |list: &str| {
        if !list.split(' ').all(|name| name.contains(['.', '_'])) {
            return list.to_owned();
        }
        list.split(' ').map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let updated = |what, derived| format!("{constants} updates {what}: {}.", names(derived));
    let mut text = match updated_by {
        "edit" => {
            let (bounds, others) = derived.split_once(';').unwrap_or((derived, ""));
            let others = if others.is_empty() { String::new() } else { format!(" {}", updated("the others", others)) };
            format!(
                "The engine finds the contacts of the new values at once, and as fast as before after {constants} or [`edit_model`](crate::Data::edit_model). Derived quantities: {}.{others}",
                names(bounds)
            )
        }
        "constants" => updated("the quantities that depend on it", derived),
        "computed" => format!("{constants} overwrites it."),
        _ => String::new(),
    };
    if !not_updated.is_empty() {
        let _ = write!(text, " Not updated: {not_updated}.");
    }
    if text.is_empty() { text } else { format!("    ///\n    /// {}\n", text.trim()) }
}

#[cfg(test)]
mod tests {
    use super::{TABLE, columns};

    /// Field tables of the engines with all tests.
    const FIELDS: [&str; 4] = [
        include_str!("../mujoco-sys/fields/v2_2_2.tsv"),
        include_str!("../mujoco-sys/fields/v3_5_0.tsv"),
        include_str!("../mujoco-sys/fields/v3_17_0.tsv"),
        include_str!("../mujoco-sys/fields/v4_0_1.tsv"),
    ];

    #[test]
    fn the_table_names_arrays_of_the_engine() {
        let is_field =
            |name: &str| FIELDS.iter().any(|table| table.lines().any(|line| line.split('\t').nth(3) == Some(name)));
        for line in TABLE.lines().skip(1) {
            let array = line.split('\t').next().unwrap();
            assert!(is_field(array), "{array}");
            let [updated_by, derived, _] = columns(array).unwrap();
            assert!(["none", "edit", "constants", "computed"].contains(&updated_by), "{line}");
            for name in derived.split([' ', ';']).filter(|name| name.contains('_')) {
                assert!(is_field(name), "{name} of {array}");
            }
        }
    }
}
