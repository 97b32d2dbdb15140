//! Documentation of the engine's fields at run time:
//! [`Model::field_docs`](crate::Model::field_docs), [`Model::fields`](crate::Model::fields) and the
//! same functions of the other structs. The texts are taken from the engine's headers, in the
//! engine's spelling.

use std::fmt;

use mujoco_sys::FIELDS;

use crate::error::{Error, Result, near_names};

/// Documentation of a field of one of the engine's structs. `Display` writes its name and
/// documentation: `nv: number of degrees of freedom = dim(qvel)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct FieldDoc {
    /// Name in the engine. Names in [`Visual`](crate::model::Visual) are dotted: `global.fovy`.
    pub name: &'static str,
    /// C type of one value.
    pub ctype: &'static str,
    /// Number of rows: a number, or a size of the model such as `nbody`.
    pub rows: &'static str,
    /// Number of columns, likewise.
    pub columns: &'static str,
    /// Comment of the engine's header.
    pub docs: &'static str,
    /// `true` for an array or a vector.
    pub is_array: bool,
}

impl FieldDoc {
    /// Returns the fields of a struct, in the engine's order.
    pub(crate) fn all(structure: &'static str) -> impl Iterator<Item = Self> {
        FIELDS.lines().skip(1).filter_map(move |line| {
            let mut cells = line.split('\t');
            if cells.next() != Some(structure) {
                return None;
            }
            let mut cell = || cells.next().expect("Bug: a line of the field table is too short");
            let (kind, ctype, name) = (cell(), cell(), cell());
            let is_array = matches!(kind, "array" | "arena" | "vector");
            Some(Self { name, ctype, rows: cell(), columns: cell(), docs: cell(), is_array })
        })
    }

    /// Returns the name and documentation of a field.
    pub(crate) fn docs_of(structure: &'static str, name: &str) -> Result<String> {
        Self::find(structure, name)
            .map(|field| field.to_string())
            .ok_or_else(|| Self::unknown(structure, name, Self::all(structure).map(|field| field.name)))
    }

    fn find(structure: &'static str, name: &str) -> Option<Self> {
        Self::all(structure).find(|field| field.name == name)
    }

    /// Returns the error about an unknown field, with similar names among `known`, and with the
    /// struct that has a field of this name.
    pub(crate) fn unknown(structure: &'static str, name: &str, known: impl Iterator<Item = &'static str>) -> Error {
        const STRUCTURES: [&str; 5] = ["Model", "Data", "Option", "Visual", "Statistic"];
        let owner = STRUCTURES.into_iter().find(|&other| other != structure && Self::find(other, name).is_some());
        Error::NoSuchField { structure, name: name.to_owned(), near: near_names(name, known), owner }
    }

    /// Returns the shape as rows and columns: `(nbody, 3)`, or `(nq)` for one column. Empty for a
    /// single value.
    ///
    /// ```
    /// use mujoco_safe::Data;
    ///
    /// let shapes: Vec<String> = Data::fields().filter(|field| field.name.starts_with('x')).map(|field| field.shape()).collect();
    /// assert_eq!(shapes[..4], ["(nbody, 6)", "(nbody, 3)", "(nbody, 4)", "(nbody, 9)"]);
    /// ```
    pub fn shape(&self) -> String {
        match (self.is_array, self.columns) {
            (false, _) => String::new(),
            (true, "1") => format!("({})", self.rows),
            (true, columns) => format!("({}, {columns})", self.rows),
        }
    }
}

impl fmt::Display for FieldDoc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.name, self.docs)
    }
}

/// Declares `field_docs` and `fields` of a type: the type, its struct in the engine, and a field
/// and its documentation for the examples.
macro_rules! field_docs {
    ($module:ident::$type:ident, $structure:literal, $name:literal, $docs:literal) => {
        /// # Field documentation
        impl $type {
            #[doc = concat!("Returns the engine's documentation of a field of `mj", $structure, "`, by the field's name in the engine.")]
            ///
            /// # Errors
            ///
            /// [`Error::NoSuchField`](crate::Error::NoSuchField) with similar names, and with the
            /// struct that has the field if another one has it.
            ///
            /// ```
            #[doc = concat!("use mujoco_safe::{Error, ", stringify!($module), "::", stringify!($type), "};")]
            ///
            #[doc = concat!("let docs = ", stringify!($type), "::field_docs(\"", $name, "\")?;")]
            #[doc = concat!("assert_eq!(docs, \"", $name, ": ", $docs, "\");")]
            #[doc = concat!("let error = ", stringify!($type), "::field_docs(\"", $name, "x\").unwrap_err();")]
            #[doc = concat!("assert!(error.to_string().contains(\"", $name, "\"));")]
            /// # Ok::<(), Error>(())
            /// ```
            #[doc(alias = "show_docs")]
            pub fn field_docs(name: &str) -> $crate::Result<String> {
                $crate::field_docs::FieldDoc::docs_of($structure, name)
            }

            #[doc = concat!("Returns the fields of `mj", $structure, "`, each with the engine's documentation.")]
            ///
            /// ```
            #[doc = concat!("let mut fields = mujoco_safe::", stringify!($module), "::", stringify!($type), "::fields();")]
            #[doc = concat!("assert!(fields.any(|field| field.name == \"", $name, "\"));")]
            /// ```
            pub fn fields() -> impl Iterator<Item = $crate::field_docs::FieldDoc> {
                $crate::field_docs::FieldDoc::all($structure)
            }
        }
    };
}
pub(crate) use field_docs;
