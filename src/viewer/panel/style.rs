//! How the panels look: quiet, dark, and a little transparent, so that the picture stays the main thing.

use egui::{Color32, Context, CornerRadius, FontFamily, FontId, Frame, Margin, Shadow, Stroke, TextStyle, Theme};

/// What is on, chosen or being moved.
pub const ACCENT: Color32 = Color32::from_rgb(86, 180, 233);
/// What asks for attention.
pub const WARNING: Color32 = Color32::from_rgb(230, 159, 0);
/// What has gone wrong.
pub const FAILURE: Color32 = Color32::from_rgb(235, 110, 90);
/// What is said beside.
pub const FAINT: Color32 = Color32::from_gray(150);
const TEXT: Color32 = Color32::from_gray(222);
const GROUND: Color32 = Color32::from_rgba_premultiplied(22, 24, 28, 232);

/// Colours that stay apart for colour-blind eyes (Okabe and Ito, 2008), brightened for a dark ground.
pub const LINES: [Color32; 8] = [
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(230, 159, 0),
    Color32::from_rgb(0, 190, 140),
    Color32::from_rgb(240, 228, 66),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(204, 121, 167),
    Color32::from_rgb(60, 120, 220),
    Color32::from_rgb(200, 200, 200),
];

/// The ground of what lies over the picture.
pub fn frame() -> Frame {
    Frame::new().fill(GROUND).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(10, 8))
}

/// The same where nothing is to be seen through it.
pub fn opaque() -> Frame {
    frame().fill(GROUND.to_opaque())
}

/// The same for a panel at the side of the window.
pub fn side() -> Frame {
    frame().corner_radius(CornerRadius::ZERO)
}

pub fn apply(context: &Context) {
    context.set_theme(Theme::Dark);
    context.style_mut_of(Theme::Dark, |style| {
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
        visuals.panel_fill = GROUND;
        visuals.window_fill = GROUND;
        visuals.window_stroke = Stroke::new(1.0, Color32::from_gray(60));
        visuals.window_shadow = Shadow::NONE;
        visuals.popup_shadow = Shadow::NONE;
        visuals.extreme_bg_color = Color32::from_rgb(12, 13, 16);
        visuals.faint_bg_color = Color32::from_rgb(30, 32, 37);
        visuals.override_text_color = Some(TEXT);
        visuals.selection.bg_fill = Color32::from_rgb(38, 92, 128);
        visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
        visuals.slider_trailing_fill = true;
        visuals.collapsing_header_frame = false;
        visuals.indent_has_left_vline = false;
    });
}
