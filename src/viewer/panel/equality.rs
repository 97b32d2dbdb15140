//! Equality constraints on and off.

use egui::Ui;

use super::{Shown, name_of};
use crate::viewer::request::Request;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let model = shown.snapshot.model.clone();
    for equality in model.equalities() {
        let mut active = equality.active();
        let text = format!("{} ({:?})", name_of(equality.name(), equality.index()), equality.equality_type());
        if ui.checkbox(&mut active, text).changed() {
            shown.ask(Request::SetEquality(equality.id(), active));
        }
    }
}
