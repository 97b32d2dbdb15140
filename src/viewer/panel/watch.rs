//! Numbers by their names.

use egui::Ui;

use super::Shown;

#[derive(Default)]
pub(super) struct WatchPanel {}

impl WatchPanel {
    pub fn forget_model(&mut self) {}

    pub fn show(&mut self, _ui: &mut Ui, _shown: &mut Shown<'_>) {}
}
