//! Texts under check.

use std::rc::Rc;

use super::place::Place;
use crate::error::Error;

/// Text of a model, or of a file that it includes.
#[derive(Clone, Copy)]
pub(super) struct Source<'t> {
    pub(super) name: &'t str,
    pub(super) text: &'t [u8],
    pub(super) place: &'t Rc<Place>,
    /// Number of texts that include it.
    pub(super) includes: usize,
    /// Number of elements around it.
    pub(super) elements: usize,
}

impl Source<'_> {
    /// Returns the error about a position in the text.
    pub(super) fn error(&self, position: usize, why: &str) -> Error {
        Error::Load { source_name: self.name.to_owned(), message: at_line(why, self.text, position) }
    }
}

/// Appends the line of a position to a message.
pub(super) fn at_line(message: &str, text: &[u8], position: usize) -> String {
    let line = text[..position].split(|&byte| byte == b'\n').count();
    format!("{message}, line {line}")
}
