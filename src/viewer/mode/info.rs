//! What a mode says in the info panel.

use std::fmt::{Arguments, Write};

/// A line of the info panel.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub(crate) struct InfoLine {
    pub name: &'static str,
    pub value: String,
}

/// Lines that are written over, each in the memory that it had.
pub(crate) struct InfoLines<'l> {
    lines: &'l mut Vec<InfoLine>,
    used: usize,
}

impl<'l> InfoLines<'l> {
    pub fn new(lines: &'l mut Vec<InfoLine>) -> Self {
        Self { lines, used: 0 }
    }

    pub fn push(&mut self, name: &'static str, value: Arguments<'_>) {
        if self.used == self.lines.len() {
            self.lines.push(InfoLine::default());
        }
        let line = &mut self.lines[self.used];
        line.name = name;
        line.value.clear();
        // Writing to a string cannot fail.
        let _ = line.value.write_fmt(value);
        self.used += 1;
    }

    /// Forgets the lines of before that were not written over.
    pub fn finish(self) {
        self.lines.truncate(self.used);
    }
}
