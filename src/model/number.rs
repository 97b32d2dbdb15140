//! Numbers in the model's arrays, by the name of the array: parameters of batches.

use mujoco_sys::{mjGEOM_HFIELD, mjGEOM_MESH, mjGEOM_SDF};

use super::Model;
use crate::error::{Error, InvalidKind, Result};
use crate::field_docs::FieldDoc;
use crate::kind::Kind;

/// Array of floating-point numbers that a program can choose: it is writable, and does not depend
/// on others.
#[derive(Clone, Copy)]
pub(crate) struct NumberArray {
    pub(crate) name: &'static str,
    /// Size of the model that is the number of rows, such as `nbody`.
    pub(crate) counted: &'static str,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// `true` if other quantities are derived from the numbers.
    pub(crate) has_derived: bool,
}

const NO_ARRAY: &str = "it is no array of the model";

/// Sizes that count the elements of a kind.
const KINDS: &[(&str, Kind)] = &[
    ("nbody", Kind::Body),
    ("njnt", Kind::Joint),
    ("ngeom", Kind::Geom),
    ("nsite", Kind::Site),
    ("ncam", Kind::Camera),
    ("nlight", Kind::Light),
    ("nmat", Kind::Material),
    ("nskin", Kind::Skin),
    ("npair", Kind::Pair),
    ("neq", Kind::Equality),
    ("ntendon", Kind::Tendon),
    ("nactuator", Kind::Actuator),
    // Before 3.11 each actuator has one control.
    #[cfg(not(engine_since = "3.11.0"))]
    ("nu", Kind::Actuator),
    ("nsensor", Kind::Sensor),
    ("nkey", Kind::Keyframe),
];

impl NumberArray {
    /// Returns the name of a number: `jnt_range[1] of joint 'hinge'`, or `dof_solref[3][0]` in an
    /// array whose rows are no elements.
    pub(crate) fn described(&self, model: &Model, row: usize, column: usize) -> String {
        let name = self.name;
        let column = if self.columns == 1 { String::new() } else { format!("[{column}]") };
        match KINDS.iter().find(|(size, _)| *size == self.counted) {
            Some(&(_, kind)) => format!("{name}{column} of {}", model.described(kind, row)),
            None => format!("{name}[{row}]{column}"),
        }
    }
}

impl Model {
    /// Returns the array with a name, in which a number exists.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchField`] for an unknown name, [`Error::Unsupported`] for an array whose
    /// numbers a program cannot choose and for the size of a geom with an asset, and
    /// [`Error::Invalid`] for a number outside of the array.
    pub(crate) fn find_number(&self, array: &str, row: usize, column: usize) -> Result<NumberArray> {
        let Some(found) = self.number_array(array) else {
            // An unknown name is an error with the similar names.
            Self::field_docs(array)?;
            let why = Self::fields().find(|field| field.name == array).map_or(NO_ARRAY, |field| reason(&field));
            return Err(Error::Unsupported(format!("{array} as a parameter: {why}")));
        };
        if array == "eq_data" {
            return Err(Error::Unsupported(format!("{array} as a parameter: update_constants computes a part of it")));
        }
        for (what, index, count) in [("row", row, found.rows), ("column", column, found.columns)] {
            if index >= count {
                let what = format!("the {what} of {array}");
                return Err(Error::invalid(InvalidKind::OutOfRange, what, index, format!("less than {count}")));
            }
        }
        if array == "geom_size" && [mjGEOM_HFIELD, mjGEOM_MESH, mjGEOM_SDF].contains(&(self.geom_type()[row] as u32)) {
            let geom = self.described(Kind::Geom, row);
            return Err(Error::Unsupported(format!("geom_size as a parameter: the asset of {geom} determines it")));
        }
        Ok(found)
    }
}

/// Returns the reason why the numbers of a field cannot be chosen.
fn reason(doc: &FieldDoc) -> &'static str {
    match doc.ctype {
        _ if !doc.is_array => NO_ARRAY,
        "mjtNum" | "float" => {
            "it depends on other arrays, from which update_constants computes it, or its effects with this engine are not known"
        }
        _ => "it determines the engine's memory accesses, or is a switch, and is the same in all simulations",
    }
}
