//! A struct of the engine's as one of Rust, field by field.

/// A value of Rust's for one that the engine keeps as `Raw`.
pub(super) trait Mirror<Raw> {
    fn read(raw: Raw) -> Self;
    fn write(self) -> Raw;
}

/// Numbers that are the same on both sides.
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

/// A count. The engine's compiler lets negative ones through, which mean none.
impl Mirror<i32> for usize {
    fn read(raw: i32) -> Self {
        Self::try_from(raw).unwrap_or(0)
    }

    /// A count that was not checked before it is written is the largest that there is, not a negative one.
    fn write(self) -> i32 {
        i32::try_from(self).unwrap_or(i32::MAX)
    }
}

/// A switch, which any number but zero turns on.
impl Mirror<i32> for bool {
    fn read(raw: i32) -> Self {
        raw != 0
    }

    fn write(self) -> i32 {
        self.into()
    }
}

/// Declares a struct that mirrors one of the engine's: the documentation, type and default of each field. A field that the
/// engine's has and this one has not is an error of the compiler.
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
            /// The engine's defaults.
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $crate::model::options::mirror::Mirror<$raw> for $name {
            fn read(raw: $raw) -> Self {
                Self { $($field: $crate::model::options::mirror::Mirror::read(raw.$field),)* }
            }

            fn write(self) -> $raw {
                $raw { $($field: $crate::model::options::mirror::Mirror::write(self.$field),)* }
            }
        }
    };
}
pub(super) use mirror;
