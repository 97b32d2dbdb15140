//! Style of the panels: compact, without animations, in dark or light colours.

use egui::{Color32, Context, FontFamily, FontId, Shadow, Stroke, Style, TextStyle, Ui, Visuals};

use super::layout;
use crate::viewer::options::Theme;

/// Range of the scale of the panels.
const SCALES: std::ops::RangeInclusive<f64> = 0.25..=4.0;

/// Factor of a step of the scale.
const SCALE_STEP: f64 = 1.1;

/// Number of colours of curves.
pub(super) const CURVE_COLORS: usize = 8;

/// Palettes of the curves on a dark and on a light background: distinguishable with colour
/// blindness (Okabe and Ito, 2008), brightened or darkened.
const CURVES: [[Color32; CURVE_COLORS]; 2] = [
    [
        Color32::from_rgb(86, 180, 233),
        Color32::from_rgb(230, 159, 0),
        Color32::from_rgb(0, 190, 140),
        Color32::from_rgb(240, 228, 66),
        Color32::from_rgb(235, 105, 30),
        Color32::from_rgb(224, 140, 186),
        Color32::from_rgb(120, 140, 255),
        Color32::from_rgb(210, 210, 210),
    ],
    [
        Color32::from_rgb(40, 130, 185),
        Color32::from_rgb(195, 125, 0),
        Color32::from_rgb(0, 140, 100),
        Color32::from_rgb(140, 125, 0),
        Color32::from_rgb(190, 75, 0),
        Color32::from_rgb(180, 80, 140),
        Color32::from_rgb(0, 70, 170),
        Color32::from_rgb(90, 90, 90),
    ],
];

/// Returns the colour of a curve. Curves beyond the palette repeat it, with dashed lines.
pub(super) fn curve_color(ui: &Ui, index: usize) -> Color32 {
    CURVES[usize::from(!ui.visuals().dark_mode)][index % CURVE_COLORS]
}

/// Returns the colour of headings and active elements.
pub(super) fn accent(ui: &Ui) -> Color32 {
    ui.visuals().hyperlink_color
}

/// Returns the colour of warnings.
pub(super) fn warning(ui: &Ui) -> Color32 {
    ui.visuals().warn_fg_color
}

/// Returns the colour of errors.
pub(super) fn failure(ui: &Ui) -> Color32 {
    ui.visuals().error_fg_color
}

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 56.0;

/// Shows the theme and the scale of the panels.
pub(super) fn show(ui: &mut Ui) {
    let before = style_of(ui.ctx());
    let (mut theme, mut scale) = before;
    layout::labelled(ui, "theme", LABEL_WIDTH, |ui| {
        ui.selectable_value(&mut theme, Theme::Dark, "dark");
        ui.selectable_value(&mut theme, Theme::Light, "light");
    });
    layout::labelled(ui, "scale", LABEL_WIDTH, |ui| {
        // Buttons instead of a slider, which would move while it is dragged.
        for (text, factor) in [("−", 1.0 / SCALE_STEP), ("+", SCALE_STEP)] {
            if ui.button(text).clicked() {
                scale *= factor;
            }
        }
        ui.label(format!("{:.0} %", 100.0 * scale));
    });
    if (theme, scale) != before {
        apply_style(ui.ctx(), theme, scale);
        // A change of the theme is visible in the next pass only, which egui does not request.
        ui.ctx().request_repaint();
    }
}

/// Returns the theme and the scale of the panels.
pub fn style_of(context: &Context) -> (Theme, f64) {
    let theme = match context.theme() {
        egui::Theme::Dark => Theme::Dark,
        egui::Theme::Light => Theme::Light,
    };
    (theme, context.zoom_factor().into())
}

/// Applies the style of the panels, at a scale relative to the scale of the display.
pub fn apply_style(context: &Context, theme: Theme, scale: f64) {
    let (theme, colours): (_, fn(&mut Visuals)) = match theme {
        Theme::Dark => (egui::Theme::Dark, dark),
        Theme::Light => (egui::Theme::Light, light),
    };
    context.set_theme(theme);
    context.style_mut_of(theme, |style| {
        compact(style);
        colours(&mut style.visuals);
        style.visuals.window_fill = style.visuals.panel_fill;
    });
    context.set_zoom_factor(limited_scale(scale) as f32);
}

/// Returns the scale of the panels for a wanted one.
pub fn limited_scale(scale: f64) -> f64 {
    if scale.is_finite() { scale.clamp(*SCALES.start(), *SCALES.end()) } else { 1.0 }
}

fn compact(style: &mut Style) {
    use FontFamily::{Monospace, Proportional};
    style.text_styles = [
        (TextStyle::Heading, FontId::new(16.0, Proportional)),
        (TextStyle::Body, FontId::new(13.0, Proportional)),
        (TextStyle::Button, FontId::new(13.0, Proportional)),
        (TextStyle::Small, FontId::new(11.0, Proportional)),
        (TextStyle::Monospace, FontId::new(12.0, Monospace)),
    ]
    .into();
    style.spacing.item_spacing = egui::vec2(6.0, 4.0);
    style.spacing.button_padding = egui::vec2(6.0, 2.0);
    style.spacing.slider_width = 96.0;
    style.spacing.interact_size.y = 18.0;
    style.spacing.scroll.floating = false;
    style.spacing.scroll.bar_width = 6.0;
    style.animation_time = 0.0;
    let visuals = &mut style.visuals;
    visuals.window_shadow = Shadow::NONE;
    visuals.popup_shadow = Shadow::NONE;
    visuals.slider_trailing_fill = true;
    visuals.collapsing_header_frame = false;
    visuals.indent_has_left_vline = false;
}

fn dark(visuals: &mut Visuals) {
    visuals.panel_fill = Color32::from_rgba_premultiplied(22, 24, 28, 232);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_gray(60));
    visuals.extreme_bg_color = Color32::from_rgb(12, 13, 16);
    visuals.faint_bg_color = Color32::from_rgb(30, 32, 37);
    visuals.override_text_color = Some(Color32::from_gray(222));
    visuals.weak_text_color = Some(Color32::from_gray(150));
    visuals.hyperlink_color = Color32::from_rgb(86, 180, 233);
    visuals.warn_fg_color = Color32::from_rgb(230, 159, 0);
    visuals.error_fg_color = Color32::from_rgb(235, 110, 90);
    visuals.selection.bg_fill = Color32::from_rgb(38, 92, 128);
    visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
}

fn light(visuals: &mut Visuals) {
    visuals.panel_fill = Color32::from_rgba_premultiplied(221, 222, 224, 232);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_gray(180));
    visuals.extreme_bg_color = Color32::WHITE;
    visuals.faint_bg_color = Color32::from_gray(232);
    visuals.override_text_color = Some(Color32::from_gray(25));
    visuals.weak_text_color = Some(Color32::from_gray(95));
    visuals.hyperlink_color = Color32::from_rgb(0, 85, 150);
    visuals.warn_fg_color = Color32::from_rgb(160, 85, 0);
    visuals.error_fg_color = Color32::from_rgb(185, 35, 20);
    visuals.selection.bg_fill = Color32::from_rgb(140, 195, 232);
    visuals.selection.stroke = Stroke::new(1.0, Color32::BLACK);
}
