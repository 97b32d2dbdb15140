//! Fields of the views that 2.2.2 does not have. The build script generates them from the table of
//! fields of the linked engine: `build/views.rs`.

#![allow(non_snake_case, reason = "the engine's own spelling, which users search for")]
#![allow(unused_braces, reason = "a constant as a number of columns")]
#![allow(clippy::elidable_lifetime_names, reason = "some methods return values with the lifetime")]

use std::fmt::Debug;

#[cfg(engine_since = "3.3.0")]
use super::of_parts;
#[cfg(engine_since = "3.0.0")]
use super::to_next;
#[allow(unused_imports, reason = "2.2.2 has no newer fields")]
use super::{Owner, View, range};
use crate::data::Data;
use crate::kind;
use crate::model::Model;

/// Fields for the `Display` output of a view.
pub(super) trait NewerFields<'a> {
    /// Returns the names and the values.
    fn newer_fields(&self) -> Vec<(&'static str, Box<dyn Debug + 'a>)>;
}

include!(concat!(env!("OUT_DIR"), "/views.rs"));
