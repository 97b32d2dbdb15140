//! Height fields beyond which a rangefinder would make the engine read, in the step that its compiler takes for a test.

use super::tag::Tag;
use crate::error::{Error, Result};
use crate::model::hazard::is_misread_by_rays;

/// What the tags that were seen say about it.
#[derive(Default)]
pub(super) struct Rangefinders {
    /// Whether there is one.
    found: bool,
    /// Whether there is a geom with a height field, or a default of one.
    used: bool,
    /// The first height field of such a size, as text, and the text that has or names it.
    misread: Option<(String, String)>,
}

impl Rangefinders {
    pub(super) fn note(&mut self, tag: &Tag<'_>, source_name: &str) {
        match tag.name {
            b"rangefinder" => self.found = true,
            b"geom" => self.used |= tag.attribute(b"hfield").is_some(),
            // A number that does not fit has been refused.
            b"hfield" => {
                // Without any the compiler takes those of a file.
                let size = |name| tag.integer(name).and_then(|size| u64::try_from(size).ok()).filter(|&size| size > 0);
                let size = [size(b"nrow"), size(b"ncol")];
                self.note_field(size[0].zip(size[1]).map(<[u64; 2]>::from), source_name);
            }
            _ => {}
        }
    }

    /// Takes note of the rows and columns of a height field.
    pub(super) fn note_field(&mut self, size: Option<[u64; 2]>, source_name: &str) {
        let Some([rows, columns]) = size else { return };
        if self.misread.is_none() && is_misread_by_rays(rows, columns) {
            self.misread = Some((format!("{rows} rows and {columns} columns"), source_name.to_owned()));
        }
    }

    /// An error if a rangefinder may meet such a height field.
    pub(super) fn check(self) -> Result<()> {
        let Some((size, source_name)) = self.misread.filter(|_| self.found && self.used) else { return Ok(()) };
        let message = format!(
            "a rangefinder would read beyond a height field of {size}; it needs two or more of each and no more rows than \
             columns, so turn it by 90°"
        );
        Err(Error::Load { source_name, message })
    }
}
