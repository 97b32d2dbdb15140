//! Numbers of a simulation by the names of their fields.

use std::fmt;

/// A number to be watched: a field of [`Data`](crate::Data) by the engine's name, and an index into it, counted over rows and
/// columns.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Watch {
    field: &'static str,
    index: usize,
}

impl fmt::Display for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]", self.field, self.index)
    }
}
