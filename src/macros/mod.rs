//! Macros for public items, and for functions compiled for several instruction sets.

mod vectorised;
mod with_aliases;
mod with_methods;

pub(crate) use self::vectorised::vectorised;
pub(crate) use self::with_aliases::with_aliases;
pub(crate) use self::with_methods::with_methods;
