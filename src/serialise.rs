//! Plain results as data, in the feature `serde`. What has an invariant is checked on its way in.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::data::{ContactForce, StateSpec, WarningCount};
use crate::derivative::StateSpace;
use crate::matrix::{Matrix, MatrixView};

/// A matrix: its shape, and its values row by row.
#[derive(Serialize)]
#[serde(rename = "Matrix")]
struct Rows<'m> {
    nrows: usize,
    ncols: usize,
    values: &'m [f64],
}

/// The same, that nobody has looked at yet.
#[derive(Deserialize)]
#[serde(rename = "Matrix", deny_unknown_fields)]
struct Unchecked {
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

/// The largest size that plain data may claim without values that prove it: more than any model has. A matrix of 2⁶⁴ empty rows
/// would keep every loop over its rows busy for ever.
pub(crate) const MOST_WITHOUT_VALUES: usize = 1 << 20;

impl<'de> Deserialize<'de> for Matrix {
    /// An error if there are not `nrows * ncols` values, or more than 2²⁰ rows or columns without values.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Unchecked { nrows, ncols, values } = Unchecked::deserialize(deserializer)?;
        // The engine and nalgebra trust the shape.
        if nrows.checked_mul(ncols) != Some(values.len()) {
            let found = values.len();
            return Err(de::Error::custom(format!("a matrix of {nrows} rows and {ncols} columns has {found} values")));
        }
        if values.is_empty() && nrows.max(ncols) > MOST_WITHOUT_VALUES {
            return Err(de::Error::custom(format!(
                "a matrix of {nrows} rows and {ncols} columns has no values, and more than {MOST_WITHOUT_VALUES} rows or columns"
            )));
        }
        Ok(Self::from_row_major(nrows, ncols, values))
    }
}

impl Serialize for StateSpec {
    /// For people, the names of the parts (`"QPOS | QVEL"`); otherwise the bits.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        bitflags::serde::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for StateSpec {
    /// An error if there is a name or a bit that no part of a state has.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spec: Self = bitflags::serde::deserialize(deserializer)?;
        Self::from_bits(spec.bits())
            .ok_or_else(|| de::Error::custom(format!("no parts of a state: {:#x}", spec.bits())))
    }
}

/// Types of public fields, which have no invariant.
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
    "WarningCount" WarningCount = WarningCountFields { number: usize, last_info: i32 }
}
