//! Layout of the panels. The side panels lie beside the image of the scene, the others over it. All
//! are in layers above the background layer, so that the overlay can always determine if the
//! pointer is over a panel.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use egui::{
    Align2, Area, CollapsingHeader, Color32, Context, CornerRadius, Frame, Id, Margin, Order, RichText, ScrollArea,
    Slider, SliderClamping, TextStyle, TextWrapMode, Ui, Vec2,
};

use crate::viewer::view::View;

/// Width of the side panels and of their content, points. A narrow window has narrower panels,
/// whose content scrolls.
const SIDE_WIDTH: f32 = 286.0;
/// Minimum width of a side panel, points.
const MIN_SIDE_WIDTH: f32 = 100.0;
/// Minimum width of the image between the side panels, points. The info panel fits into it.
const MIN_PICTURE_WIDTH: f32 = 264.0;
/// Gap around the panels, points.
pub(super) const GAP: f32 = 8.0;

/// Returns the widths of the left and right side panels in a window of this width, in points. A
/// closed panel has the width zero. The plots and the instruments, if there are any, are in the
/// right panel.
pub fn side_widths(view: &View, has_instruments: bool, window: f32) -> [f32; 2] {
    let right = view.right_panel || view.profile || view.sensors || (view.instruments && has_instruments);
    let open = [view.left_panel, right];
    let number = open.iter().filter(|open| **open).count().max(1);
    let width = ((window - MIN_PICTURE_WIDTH) / number as f32).floor().clamp(MIN_SIDE_WIDTH, SIDE_WIDTH);
    open.map(|open| if open { width } else { 0.0 })
}

/// Returns whether a window of this width, in points, has place for both side panels and the image.
pub fn has_place_for_sides(window: f32) -> bool {
    window >= 2.0 * SIDE_WIDTH + MIN_PICTURE_WIDTH
}

fn side(context: &Context, id: &'static str, anchor: Align2, width: f32, content: impl FnOnce(&mut Ui)) {
    let height = context.content_rect().height();
    Area::new(Id::unique(id)).anchor(anchor, Vec2::ZERO).order(Order::Middle).show(context, |ui| {
        let frame = side_frame(context);
        let margin = frame.total_margin().sum();
        frame.show(ui, |ui| {
            ui.set_width(width - margin.x);
            ui.set_height(height - margin.y);
            ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                // Leaves space for the scroll bar, which is visible only if needed.
                ui.set_width(
                    SIDE_WIDTH - margin.x - ui.spacing().scroll.bar_width - ui.spacing().scroll.bar_inner_margin,
                );
                ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
                content(ui);
            });
        });
    });
}

/// Shows a panel of this width at the left side of the window.
pub(super) fn left(context: &Context, width: f32, content: impl FnOnce(&mut Ui)) {
    side(context, "left", Align2::LEFT_TOP, width, content);
}

/// Shows a panel of this width at the right side of the window.
pub(super) fn right(context: &Context, width: f32, content: impl FnOnce(&mut Ui)) {
    side(context, "right", Align2::RIGHT_TOP, width, content);
}

/// Shows a panel in the lower left corner of the image, whose left edge is at this position.
pub(super) fn lower_left(context: &Context, left: f32, content: impl FnOnce(&mut Ui)) {
    Area::new(Id::unique("info"))
        .anchor(Align2::LEFT_BOTTOM, [left + GAP, -GAP])
        .order(Order::Middle)
        .interactable(false)
        .show(context, |ui| frame(context).show(ui, content));
}

/// Shows a panel in the centre of the window.
pub(super) fn center(context: &Context, id: &'static str, content: impl FnOnce(&mut Ui)) {
    let frame = frame(context);
    let opaque = frame.fill(frame.fill.to_opaque());
    Area::new(Id::unique(id))
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
        .order(Order::Foreground)
        .default_size(context.content_rect().size())
        .show(context, |ui| opaque.show(ui, content));
}

/// Shows a collapsible section of a panel.
pub(super) fn section(ui: &mut Ui, title: &str, open: bool, content: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(RichText::new(title).strong()).id_salt(title).default_open(open).show_unindented(ui, |ui| {
        content(ui);
        ui.add_space(4.0);
    });
}

/// Shows items in two columns of the same width.
pub(super) fn two_columns<T>(ui: &mut Ui, items: impl IntoIterator<Item = T>, mut show: impl FnMut(&mut Ui, T)) {
    ui.columns(2, |columns| {
        for (index, item) in items.into_iter().enumerate() {
            show(&mut columns[index % 2], item);
        }
    });
}

/// Shows content beside a label of a fixed width. A longer name is elided and shown by a tooltip.
pub(super) fn labelled<R>(ui: &mut Ui, name: &str, width: f32, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(width);
            ui.set_max_width(width);
            let shown = fit(ui, name, width);
            let label = ui.add(egui::Label::new(&*shown).truncate().selectable(false));
            if shown != name {
                label.on_hover_text(name);
            }
        });
        content(ui)
    })
    .inner
}

/// Elides a text that is wider than `width` in the body font. The middle is replaced, because the
/// ends of the names of similar elements differ.
pub(super) fn fit<'a>(ui: &Ui, text: &'a str, width: f32) -> Cow<'a, str> {
    let font = TextStyle::Body.resolve(ui.style());
    ui.fonts_mut(|fonts| elide(text, width, |character| fonts.glyph_width(&font, character)))
}

/// Replaces the middle of a text by an ellipsis if the text is wider than `width`.
fn elide(text: &str, width: f32, mut glyph_width: impl FnMut(char) -> f32) -> Cow<'_, str> {
    let widths: Vec<f32> = text.chars().map(&mut glyph_width).collect();
    if widths.iter().sum::<f32>() <= width {
        return text.into();
    }
    let (mut head, mut tail) = (0, widths.len());
    let mut room = width - glyph_width('…');
    while head < tail {
        // Characters are taken from the end and from the start in turns.
        let from_end = widths.len() - tail <= head;
        room -= if from_end { widths[tail - 1] } else { widths[head] };
        if room < 0.0 {
            break;
        }
        if from_end { tail -= 1 } else { head += 1 }
    }
    let start: String = text.chars().take(head).collect();
    let end: String = text.chars().skip(tail).collect();
    format!("{start}…{end}").into()
}

/// Shows a slider over a range. Only edits by the user are limited to the range and rounded: a
/// slider that limited the shown value would edit it.
pub(super) fn slider<N: egui::emath::Numeric>(value: &mut N, range: RangeInclusive<N>) -> Slider<'_> {
    Slider::new(value, range).clamping(SliderClamping::Edits)
}

/// Returns the translucent frame of a panel.
pub(super) fn frame(context: &Context) -> Frame {
    let fill = context.global_style().visuals.panel_fill;
    Frame::new().fill(fill).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(10, 8))
}

/// Returns the frame of a side panel. It has no background, because filling a third of the window
/// by the shader of the panels costs a software rasteriser as much time as the rest of the panels:
/// the window's canvas has this colour beside the scene.
fn side_frame(context: &Context) -> Frame {
    frame(context).corner_radius(CornerRadius::ZERO).fill(Color32::TRANSPARENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn long_names_are_elided_in_the_middle() {
        let elided = |text, width| elide(text, width, |_| 1.0).into_owned();
        assert_eq!(elided("right_shoulder1", 15.0), "right_shoulder1");
        assert_eq!(elided("right_shoulder1", 9.0), "righ…der1");
        assert_eq!(elided("right_shoulder2", 8.0), "rig…der2");
        assert_eq!(elided("right_shoulder2", 2.0), "…2");
        assert_eq!(elided("right_shoulder2", 0.0), "…");
        assert_eq!(elided("größenänderung", 7.0), "grö…ung");
    }

    #[test]
    fn side_panels_leave_space_for_the_picture() {
        let mut view = View::new(&sample::cartpole());
        assert_eq!(side_widths(&view, false, 640.0), [0.0; 2]);
        assert_eq!(side_widths(&view, true, 640.0), [0.0, SIDE_WIDTH]);
        view.profile = true;
        assert_eq!(side_widths(&view, false, 640.0), [0.0, SIDE_WIDTH]);
        view.left_panel = true;
        assert_eq!(side_widths(&view, false, 1066.0), [SIDE_WIDTH; 2]);
        for window in [560.0, 640.0, 700.0, 1066.0, 1920.0] {
            let [left, right] = side_widths(&view, false, window);
            assert!(window - left - right >= MIN_PICTURE_WIDTH, "{window}: {left}, {right}");
        }
    }
}
