//! Implementations of serde's traits for results and matrices (feature `serde`). Types with an
//! invariant are validated when they are deserialised.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::data::{ContactForce, StateSpec, WarningCount};
use crate::derivative::StateSpace;
use crate::matrix::{Matrix, MatrixView};

/// Serialised form of a matrix: its shape, and its values in row-major order.
#[derive(Serialize)]
#[serde(rename = "Matrix")]
struct Rows<'m> {
    nrows: usize,
    ncols: usize,
    values: &'m [f64],
}

/// Unvalidated input for a matrix.
#[derive(Deserialize)]
#[serde(rename = "Matrix", deny_unknown_fields)]
struct Unvalidated {
    nrows: usize,
    ncols: usize,
    values: Vec<f64>,
}

impl Serialize for MatrixView<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Rows { nrows: self.nrows(), ncols: self.ncols(), values: self.as_slice() }.serialize(serializer)
    }
}

impl Serialize for Matrix {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.view().serialize(serializer)
    }
}

/// Largest number of rows or columns of a deserialised matrix without values, above the needs of
/// any model. Without this limit, a loop over 2⁶⁴ empty rows would practically never end.
pub(crate) const MOST_WITHOUT_VALUES: usize = 1 << 20;

impl<'de> Deserialize<'de> for Matrix {
    /// Returns an error unless the number of values is `nrows * ncols`, or if a matrix without
    /// values has more than 2²⁰ rows or columns.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Unvalidated { nrows, ncols, values } = Unvalidated::deserialize(deserializer)?;
        // The engine and nalgebra do not check the shape.
        if nrows.checked_mul(ncols) != Some(values.len()) {
            let found = values.len();
            return Err(de::Error::custom(format!("a matrix of {nrows} rows and {ncols} columns has {found} values")));
        }
        if values.is_empty() && nrows.max(ncols) > MOST_WITHOUT_VALUES {
            return Err(de::Error::custom(format!(
                "a matrix without values has {nrows} rows and {ncols} columns; at most {MOST_WITHOUT_VALUES} are allowed"
            )));
        }
        Ok(Self::from_row_major(nrows, ncols, values))
    }
}

impl Serialize for StateSpec {
    /// Writes the names of the components (`"QPOS | QVEL"`) in human-readable formats, and the bits
    /// in others.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        bitflags::serde::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for StateSpec {
    /// Returns an error for a name or a bit that is not a component of a state.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spec: Self = bitflags::serde::deserialize(deserializer)?;
        Self::from_bits(spec.bits())
            .ok_or_else(|| de::Error::custom(format!("unknown components of a state: {:#x}", spec.bits())))
    }
}

/// Implements both traits for structs with public fields and without invariants.
macro_rules! plain {
    ($($remote:literal $name:ident = $shape:ident { $($field:ident: $type:ty),* $(,)? })*) => {$(
        #[derive(Serialize, Deserialize)]
        #[serde(remote = $remote)]
        struct $shape { $($field: $type),* }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                $shape::serialize(self, serializer)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $shape::deserialize(deserializer)
            }
        }
    )*};
}

plain! {
    "StateSpace" StateSpace = StateSpaceFields { a: Matrix, b: Matrix, c: Matrix, d: Matrix }
    "ContactForce" ContactForce = ContactForceFields { force: [f64; 3], torque: [f64; 3] }
    "WarningCount" WarningCount = WarningCountFields { number: usize, lastinfo: i32 }
}
