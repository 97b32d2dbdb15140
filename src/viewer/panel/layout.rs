//! Where the panels are. All of them lie over the picture, in layers above the background, so that whether the pointer is over one
//! of them can be told at any time.

use egui::{Align2, Area, CollapsingHeader, Context, Id, Order, RichText, ScrollArea, TextWrapMode, Ui, Vec2};

use super::style;

/// Width of the panels at the sides, points.
pub(super) const SIDE: f32 = 286.0;
/// Between a panel and what is next to it.
pub(super) const GAP: f32 = 8.0;

fn side(context: &Context, id: &'static str, anchor: Align2, content: impl FnOnce(&mut Ui)) {
    let height = context.content_rect().height();
    Area::new(Id::unique(id)).anchor(anchor, Vec2::ZERO).order(Order::Middle).show(context, |ui| {
        let frame = style::side();
        let margin = frame.total_margin().sum();
        frame.show(ui, |ui| {
            let width = SIDE - margin.x;
            ui.set_width(width);
            ui.set_height(height - margin.y);
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                // Beside the bar, that comes and goes.
                ui.set_width(width - ui.spacing().scroll.bar_width - ui.spacing().scroll.bar_inner_margin);
                ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
                content(ui);
            });
        });
    });
}

/// A panel at the left side of the window.
pub(super) fn left(context: &Context, content: impl FnOnce(&mut Ui)) {
    side(context, "left", Align2::LEFT_TOP, content);
}

/// A panel at the right side of the window.
pub(super) fn right(context: &Context, content: impl FnOnce(&mut Ui)) {
    side(context, "right", Align2::RIGHT_TOP, content);
}

/// In the lower left corner, beside the left panel.
pub(super) fn lower_left(context: &Context, beside: bool, content: impl FnOnce(&mut Ui)) {
    let left = GAP + if beside { SIDE } else { 0.0 };
    Area::new(Id::unique("lower left"))
        .anchor(Align2::LEFT_BOTTOM, [left, -GAP])
        .order(Order::Middle)
        .interactable(false)
        .show(context, |ui| style::frame().show(ui, content));
}

/// In the middle of the window.
pub(super) fn middle(context: &Context, id: &'static str, content: impl FnOnce(&mut Ui)) {
    Area::new(Id::unique(id))
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
        .order(Order::Foreground)
        .default_size(context.content_rect().size())
        .show(context, |ui| style::opaque().show(ui, content));
}

/// A part of a panel, that opens and closes.
pub(super) fn section(ui: &mut Ui, title: &str, open: bool, content: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(RichText::new(title).strong()).id_salt(title).default_open(open).show_unindented(ui, |ui| {
        content(ui);
        ui.add_space(4.0);
    });
}

/// Things side by side in two columns of the same width.
pub(super) fn pairs<T>(ui: &mut Ui, things: impl IntoIterator<Item = T>, mut show: impl FnMut(&mut Ui, T)) {
    ui.columns(2, |columns| {
        for (index, thing) in things.into_iter().enumerate() {
            show(&mut columns[index % 2], thing);
        }
    });
}

/// A name of a fixed width, cut where it is longer, and something beside it.
pub(super) fn named<R>(ui: &mut Ui, name: &str, width: f32, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(width);
            ui.set_max_width(width);
            ui.add(egui::Label::new(name).truncate().selectable(false));
        });
        content(ui)
    })
    .inner
}
