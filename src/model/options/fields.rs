//! Conversion between the engine's structs of settings and Rust structs, and range checks that
//! several settings share.

use std::fmt::{Debug, Display};

use crate::error::{Error, Result};

/// Conversion between a Rust type and the engine's representation `Raw`.
pub(in crate::model) trait Mirror<Raw>: Sized {
    fn read(raw: Raw) -> Self;
    fn write(self) -> Raw;

    /// Writes the value, and keeps fields of the engine's structure that the Rust type does not
    /// have.
    fn write_into(self, raw: &mut Raw) {
        *raw = self.write();
    }
}

/// Implements [`Mirror`] for types with the same representation on both sides.
macro_rules! same {
    ($($type:ty),*) => {$(
        impl Mirror<$type> for $type {
            fn read(raw: $type) -> Self {
                raw
            }

            fn write(self) -> $type {
                self
            }
        }
    )*};
}
same!(f32, f64, [f32; 3], [f32; 4], [f64; 3]);

/// A count. The engine's compiler accepts negative counts, which mean zero.
impl Mirror<i32> for usize {
    fn read(raw: i32) -> Self {
        Self::try_from(raw).unwrap_or(0)
    }

    /// Saturates a count that was not checked, so that it cannot become negative.
    fn write(self) -> i32 {
        i32::try_from(self).unwrap_or(i32::MAX)
    }
}

/// A switch: on for any value except zero.
impl Mirror<i32> for bool {
    fn read(raw: i32) -> Self {
        raw != 0
    }

    fn write(self) -> i32 {
        self.into()
    }
}

/// Declares a struct that mirrors a struct of the engine: the documentation, type and default of
/// each field. A missing field is a compile error.
macro_rules! mirror {
    (
        $(#[$meta:meta])*
        $name:ident = $raw:ident {
            $($(#[$field_meta:meta])* $field:ident: $type:ty = $default:expr,)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
        #[non_exhaustive]
        pub struct $name {
            $(
                $(#[$field_meta])*
                #[doc = concat!("\n\nBy default `", stringify!($default), "`.")]
                pub $field: $type,
            )*
        }

        impl Default for $name {
            /// Returns the engine's defaults.
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        #[cfg(feature = "viewer")]
        impl $name {
            /// Returns the name and the value of each setting.
            pub(crate) fn settings(&mut self) -> impl Iterator<Item = (&'static str, $crate::model::options::SettingMut<'_>)> {
                [$((stringify!($field), (&mut self.$field).into()),)*].into_iter()
            }
        }

        impl $crate::model::options::fields::Mirror<$raw> for $name {
            fn read(raw: $raw) -> Self {
                Self { $($field: $crate::model::options::fields::Mirror::read(raw.$field),)* }
            }

            fn write(self) -> $raw {
                // SAFETY: all-zero bytes are a valid structure of numbers. Newer engines have
                // fields that `write_into` keeps.
                let mut raw: $raw = unsafe { std::mem::zeroed() };
                self.write_into(&mut raw);
                raw
            }

            fn write_into(self, raw: &mut $raw) {
                $($crate::model::options::fields::Mirror::write_into(self.$field, &mut raw.$field);)*
            }
        }
    };
}
pub(super) use mirror;

/// Value of a setting, for the viewer's panels.
#[cfg(feature = "viewer")]
#[derive(Debug)]
pub(crate) enum SettingMut<'a> {
    Count(&'a mut usize),
    Number(&'a mut f32),
    Double(&'a mut f64),
    Switch(&'a mut bool),
    Rgb(&'a mut [f32; 3]),
    Rgba(&'a mut [f32; 4]),
    Vector(&'a mut [f64; 3]),
}

#[cfg(feature = "viewer")]
macro_rules! setting {
    ($($variant:ident($type:ty)),*) => {$(
        impl<'a> From<&'a mut $type> for SettingMut<'a> {
            fn from(value: &'a mut $type) -> Self {
                Self::$variant(value)
            }
        }
    )*};
}
#[cfg(feature = "viewer")]
setting!(Count(usize), Number(f32), Double(f64), Switch(bool), Rgb([f32; 3]), Rgba([f32; 4]), Vector([f64; 3]));

/// Range checks for the fields of one struct. Contains the prefix of field names in errors.
pub(super) struct Checks(pub(super) &'static str);

impl Checks {
    /// Returns an error with `expected` unless the condition holds.
    pub(super) fn require(&self, holds: bool, name: &str, value: impl Display, expected: impl Display) -> Result<()> {
        if holds {
            return Ok(());
        }
        Err(Error::out_of_range(format!("{}{name}", self.0), value, expected.to_string()))
    }

    pub(super) fn positive(&self, name: &str, value: impl Into<f64> + Display + Copy) -> Result<()> {
        let number = value.into();
        self.require(number.is_finite() && number > 0.0, name, value, "positive and finite")
    }

    pub(super) fn not_negative(&self, name: &str, value: impl Into<f64> + Display + Copy) -> Result<()> {
        let number = value.into();
        self.require(number.is_finite() && number >= 0.0, name, value, "finite and not negative")
    }

    pub(super) fn finite<T: Into<f64> + Debug + Copy>(&self, name: &str, values: &[T]) -> Result<()> {
        if values.iter().all(|&value| value.into().is_finite()) {
            return Ok(());
        }
        Err(Error::not_finite(format!("{}{name}", self.0), format!("{values:?}")))
    }
}
