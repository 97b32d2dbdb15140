//! Macros for public items.

mod engine_enum;
mod with_aliases;
mod with_methods;

pub(crate) use self::engine_enum::engine_enum;
pub(crate) use self::with_aliases::with_aliases;
pub(crate) use self::with_methods::with_methods;
