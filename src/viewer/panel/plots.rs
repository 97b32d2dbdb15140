//! Numbers over time.

use egui::Context;

use super::Shown;
use crate::viewer::snapshot::Snapshot;

#[derive(Default)]
pub(super) struct Plots {}

impl Plots {
    pub fn take(&mut self, _snapshot: &Snapshot) {}

    pub fn show(&mut self, _context: &Context, _shown: &mut Shown<'_>) {}
}
