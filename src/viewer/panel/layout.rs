//! Layout of the panels. The side panels lie beside the image of the scene, the others over it. All
//! are in layers above the background layer, so that the overlay can always determine if the
//! pointer is over a panel.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use egui::{
    Align, Align2, Area, CollapsingHeader, Color32, Context, CornerRadius, CursorIcon, Frame, Id, Key, Margin, Order,
    Rangef, Rect, Response, RichText, ScrollArea, Sense, Slider, SliderClamping, TextEdit, TextStyle, TextWrapMode, Ui,
    Vec2,
};

use crate::viewer::view::{SIDE_WIDTH, View};

/// Range of the width of a side panel, points. A narrow window has narrower panels, whose content
/// scrolls below [`MIN_CONTENT_WIDTH`].
const SIDE_WIDTHS: Rangef = Rangef { min: 120.0, max: 640.0 };
/// Smallest width of a side panel whose content does not scroll sideways, points.
const NARROW_SIDE_WIDTH: f32 = 240.0;
/// Minimum width of the content of a side panel, points.
const MIN_CONTENT_WIDTH: f32 = 206.0;
/// Width of what is beside a slider in its row: the label, the number, and the gaps, points.
const BESIDE_SLIDER: f32 = 156.0;
/// Width of the number beside a slider, points.
const NUMBER_WIDTH: f32 = 52.0;
/// Minimum width of a slider, points.
const MIN_SLIDER_WIDTH: f32 = 60.0;
/// Minimum width of the image between the side panels, points. The info panel fits into it.
const MIN_PICTURE_WIDTH: f32 = 264.0;
/// Minimum part of the window's width for the image.
const MIN_PICTURE_PART: f32 = 0.4;
/// Gap around the panels, points.
pub(super) const GAP: f32 = 8.0;
/// Width of the strip at the inner edge of a side panel that resizes it, points.
const HANDLE_WIDTH: f32 = 6.0;

/// Returns the widths of the left and right side panels in a window of this width, in points. A
/// closed panel has the width zero. The plots and the instruments, if there are any, are in the
/// right panel.
pub fn side_widths(view: &View, has_instruments: bool, window: f32) -> [f32; 2] {
    let right = view.right_panel || view.profile || view.sensors || (view.instruments && has_instruments);
    let [left, right] = [(view.left_panel, 0), (right, 1)]
        .map(|(open, side)| if open { view.side_widths[side].clamp(SIDE_WIDTHS.min, SIDE_WIDTHS.max) } else { 0.0 });
    // Both become narrower in the same ratio.
    let ratio = (side_room(window) / (left + right)).min(1.0);
    [left, right].map(|width| if width > 0.0 { (ratio * width).floor().max(SIDE_WIDTHS.min) } else { 0.0 })
}

/// Returns whether a window of this width, in points, has place for this number of side panels and
/// the image.
pub fn has_place_for_sides(window: f32, sides: usize) -> bool {
    side_room(window) >= sides as f32 * NARROW_SIDE_WIDTH
}

/// Returns the largest width of both side panels in a window of this width, points.
fn side_room(window: f32) -> f32 {
    window - MIN_PICTURE_WIDTH.max(MIN_PICTURE_PART * window)
}

/// Shows a side panel. Returns its new width if the user resizes it. `other` is the width of the
/// other side panel.
fn side(
    context: &Context,
    id: &'static str,
    anchor: Align2,
    [width, other]: [f32; 2],
    content: impl FnOnce(&mut Ui),
) -> Option<f32> {
    let window = context.content_rect();
    let mut resized = None;
    Area::new(Id::unique(id)).anchor(anchor, Vec2::ZERO).order(Order::Middle).show(context, |ui| {
        let frame = side_frame(context);
        let margin = frame.total_margin().sum();
        frame.show(ui, |ui| {
            ui.set_width(width - margin.x);
            ui.set_height(window.height() - margin.y);
            ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                // Leaves space for the scroll bar, which is visible only if needed.
                let bar = ui.spacing().scroll.bar_width + ui.spacing().scroll.bar_inner_margin;
                let width = (width - margin.x - bar).max(MIN_CONTENT_WIDTH);
                ui.set_width(width);
                ui.spacing_mut().slider_width = (width - BESIDE_SLIDER).max(MIN_SLIDER_WIDTH);
                ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
                content(ui);
            });
        });
        // The handle is in the margin of the frame.
        let is_left = anchor.x() == Align::Min;
        let edge = if is_left { width - HANDLE_WIDTH } else { window.width() - width };
        let strip = Rect::from_min_size(egui::pos2(edge, 0.0), egui::vec2(HANDLE_WIDTH, window.height()));
        let handle = ui.interact(strip, ui.scope_id().with("width"), Sense::click_and_drag());
        if handle.hovered() || handle.dragged() {
            context.set_cursor_icon(CursorIcon::ResizeHorizontal);
            ui.painter().vline(strip.center().x, strip.y_range(), ui.visuals().widgets.hovered.fg_stroke);
        }
        if handle.double_clicked() {
            resized = Some(SIDE_WIDTH);
        } else if let Some(pointer) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
            let wanted = if is_left { pointer.x } else { window.width() - pointer.x };
            let room = side_room(window.width()) - other;
            resized = Some(wanted.round().min(room).clamp(SIDE_WIDTHS.min, SIDE_WIDTHS.max));
        }
    });
    resized
}

/// Shows the left side panel, given the widths of both. Returns its new width if the user resizes
/// it.
pub(super) fn left(context: &Context, [left, right]: [f32; 2], content: impl FnOnce(&mut Ui)) -> Option<f32> {
    side(context, "left", Align2::LEFT_TOP, [left, right], content)
}

/// As [`left`], for the right side panel.
pub(super) fn right(context: &Context, [left, right]: [f32; 2], content: impl FnOnce(&mut Ui)) -> Option<f32> {
    side(context, "right", Align2::RIGHT_TOP, [right, left], content)
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

/// Sections that the user has opened or closed, by title.
#[derive(Clone, Debug, Default)]
pub struct Sections(BTreeMap<String, bool>);

impl Sections {
    /// Returns the sections of a context.
    pub fn of(context: &Context) -> BTreeMap<String, bool> {
        context.data(|data| data.get_temp::<Self>(Id::NULL)).unwrap_or_default().0
    }

    /// Sets the sections of a context before its first pass.
    pub fn set(context: &Context, sections: BTreeMap<String, bool>) {
        context.data_mut(|data| data.insert_temp(Id::NULL, Self(sections)));
    }
}

/// Shows a collapsible section of a panel.
pub(super) fn section(ui: &mut Ui, title: &str, open: bool, content: impl FnOnce(&mut Ui)) {
    let sections = |ui: &Ui, change: &dyn Fn(&mut BTreeMap<String, bool>) -> Option<bool>| {
        ui.data_mut(|data| change(&mut data.get_temp_mut_or_default::<Sections>(Id::NULL).0))
    };
    let open = sections(ui, &|sections| sections.get(title).copied()).unwrap_or(open);
    let header = CollapsingHeader::new(RichText::new(title).strong()).id_salt(title).default_open(open);
    let shown = header.show_unindented(ui, |ui| {
        content(ui);
        ui.add_space(4.0);
    });
    if shown.header_response.clicked() {
        sections(ui, &|sections| sections.insert(title.to_owned(), shown.openness > 0.5));
    }
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
    named(ui, [name, name], width, content)
}

/// Shows content beside a name of an element, which is given in a short form and in full. The full
/// name is shown by a tooltip if the label differs.
pub(super) fn named<R>(ui: &mut Ui, [short, full]: [&str; 2], width: f32, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(width);
            ui.set_max_width(width);
            let shown = fit(ui, short, width);
            let label = ui.add(egui::Label::new(&*shown).truncate().selectable(false));
            if shown != full {
                label.on_hover_text(full);
            }
        });
        content(ui)
    })
    .inner
}

/// Shows a checkbox. A text that is wider than the column is elided and shown by a tooltip.
pub(super) fn checkbox(ui: &mut Ui, on: &mut bool, text: &str) -> Response {
    // The box and its margins need up to 1.5 times the height of a row.
    let shown = fit(ui, text, ui.available_width() - 1.5 * ui.spacing().interact_size.y);
    let checkbox = ui.checkbox(on, &*shown);
    if shown == text { checkbox } else { checkbox.on_hover_text(text) }
}

/// Distributes the width of a row over the name of an element, which is returned, and a slider with
/// a number.
pub(super) fn name_width(ui: &mut Ui) -> f32 {
    let room = ui.available_width() - NUMBER_WIDTH - 2.0 * ui.spacing().item_spacing.x;
    let name = (0.48 * room).max(60.0).floor();
    ui.spacing_mut().slider_width = (room - name).max(MIN_SLIDER_WIDTH);
    name
}

/// Shows a text field of this width, in points, with a button that clears it. Esc clears it too.
pub(super) fn text_field(ui: &mut Ui, text: &mut String, hint: &str, width: f32) -> Response {
    ui.horizontal(|ui| {
        let side = ui.spacing().interact_size.y;
        let edit = TextEdit::singleline(text).hint_text(hint).desired_width(width - side - 14.0);
        let mut field = ui.add(edit);
        let is_cancelled = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape));
        let is_clear = text.is_empty();
        let clear = ui.add_visible(!is_clear, egui::Button::new("×").min_size(egui::vec2(side, 0.0)));
        if !is_clear && (is_cancelled || clear.on_hover_text("clears the text").clicked()) {
            text.clear();
            field.mark_changed();
        }
        field
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
        view.side_widths = [400.0, 300.0];
        assert_eq!(side_widths(&view, false, 1300.0), [400.0, 300.0]);
        assert_eq!(side_widths(&view, false, 875.0), [300.0, 225.0], "both become narrower");
        for window in [560.0, 640.0, 700.0, 1066.0, 1920.0] {
            let [left, right] = side_widths(&view, false, window);
            assert!(window - left - right >= MIN_PICTURE_WIDTH, "{window}: {left}, {right}");
        }
        view.side_widths = [-5.0, 1e9];
        let [left, right] = side_widths(&view, false, 2000.0);
        assert!(left >= SIDE_WIDTHS.min && right <= SIDE_WIDTHS.max);
    }
}
