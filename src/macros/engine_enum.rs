//! Enums over constants of the engine.

/// Declares an enum over the engine's constants.
macro_rules! engine_enum {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $constant:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$variant_doc])* #[doc = concat!("\n\nEngine constant `", stringify!($constant), "`.")] $variant),*
        }

        impl $name {
            /// Returns [`Error::Unsupported`](crate::Error::Unsupported) for a variant that only
            /// other versions of the engine have.
            #[allow(dead_code, reason = "not every enum is passed to the engine")]
            pub(crate) fn check_supported(self) -> crate::error::Result<()> {
                let what = format_args!(concat!(stringify!($name), "::{:?}"), self);
                crate::error::Error::check_constant(self.constant(), what)
            }

            /// Returns the name of the engine constant.
            #[allow(dead_code, reason = "not every enum is passed to the engine")]
            pub(crate) fn constant(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($constant),)*
                }
            }

            /// Returns the variant of an engine constant, or `None` for an unknown value.
            #[allow(dead_code, reason = "not every enum is read back from the engine")]
            #[inline]
            pub(crate) fn from_raw(raw: i32) -> Option<Self> {
                match raw {
                    $(raw if raw == sys::$constant as i32 => Some(Self::$variant),)*
                    _ => None,
                }
            }

            /// Returns the engine constant.
            #[allow(dead_code, reason = "not every enum is passed to the engine")]
            pub(crate) fn raw(self) -> i32 {
                (match self {
                    $(Self::$variant => sys::$constant,)*
                }) as i32
            }

            /// Returns the variant of a field that was validated when the model was loaded.
            #[allow(dead_code, reason = "not every enum is read back from the engine")]
            #[inline]
            pub(crate) fn of_field(raw: i32) -> Self {
                Self::from_raw(raw).unwrap_or_else(|| panic!(concat!("Bug: a model with ", stringify!($name), " {}"), raw))
            }
        }
    };
}
pub(crate) use engine_enum;
