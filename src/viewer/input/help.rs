//! The table as a text: for the screen, and for the terminal.

use crate::viewer::mode::Mode;

/// A table of the help.
#[derive(Clone, Debug)]
pub(crate) struct HelpSection {
    pub title: &'static str,
    /// What to press, and what it does.
    pub lines: Vec<(String, String)>,
}

/// The help for a mode.
pub(crate) fn help(mode: Mode) -> Vec<HelpSection> {
    let _ = mode;
    Vec::new()
}

/// The same as a text of at most so many columns.
pub(crate) fn help_text(mode: Mode, columns: usize) -> String {
    let _ = columns;
    format!("{:?}", help(mode))
}
