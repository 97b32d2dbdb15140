//! Generates the functions that read and write single numbers of the model's arrays by the name of
//! the array: parameters of batches.

use std::fmt::Write as _;

use crate::accessors::{Field, Form, form, head, size};
use crate::derived;

const HEAD: &str = "use crate::model::{Model, ModelMut, NumberArray};

";

/// Returns the functions that read and write a number of an array by the array's name, for those
/// writable arrays of the model that do not depend on others.
pub(crate) fn generate(fields: &[Field<'_>]) -> String {
    let [mut arrays, mut readers, mut writers] = [const { String::new() }; 3];
    for field in fields {
        let Some(updated_by) = derived::updated_by(field.name) else { continue };
        let (name, rows) = (field.name, size(*field, field.rows));
        let (columns, place) = match form(*field) {
            Form::Slice => ("1".to_owned(), "[row]"),
            Form::Rows(columns) => (columns, "[row][column]"),
            Form::Matrix => (size(*field, field.columns), ".row(row)[column]"),
            Form::Packed => continue,
        };
        let _ = writeln!(
            arrays,
            "            \"{name}\" => (\"{name}\", \"{}\", {rows}, {columns}, {}),",
            field.rows,
            updated_by != "none"
        );
        let number = format!("self.{name}(){place}");
        let number = if field.ctype == "float" { format!("f64::from({number})") } else { number };
        let _ = writeln!(readers, "            \"{name}\" => {number},");
        let place = place.replace(".row(row)", ".into_row(row)");
        let value = if field.ctype == "float" { "value as f32" } else { "value" };
        let _ = writeln!(writers, "            \"{name}\" => self.{name}_mut(){place} = {value},");
    }
    head(HEAD, "", "Model")
        + "    /// Returns the properties of an array whose numbers a program can choose, or `None` for any
    /// other name.
    #[allow(clippy::too_many_lines, reason = \"one line per array\")]
    pub(crate) fn number_array(&self, array: &str) -> Option<NumberArray> {
        let (name, counted, rows, columns, has_derived) = match array {
" + &arrays
        + "            _ => return None,
        };
        Some(NumberArray { name, counted, rows, columns, has_derived })
    }

    /// Returns a number of such an array.
    #[allow(clippy::too_many_lines, reason = \"one line per array\")]
    pub(crate) fn number(&self, array: &str, row: usize, column: usize) -> f64 {
        match array {
" + &readers
        + "            _ => unreachable!(\"Bug: {array} is no array of numbers\"),
        }
    }
}

impl ModelMut<'_> {
    /// Writes a number of such an array.
    #[allow(clippy::too_many_lines, clippy::cast_possible_truncation, reason = \"one line per array; arrays of f32\")]
    pub(crate) fn set_number(&mut self, array: &str, row: usize, column: usize, value: f64) {
        match array {
" + &writers
        + "            _ => unreachable!(\"Bug: {array} is no array of numbers\"),
        }
    }
}
"
}
