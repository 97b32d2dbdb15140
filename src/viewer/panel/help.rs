//! What keys and mouse do.

use egui::{Context, Grid, RichText, ScrollArea, Ui};

use super::{Shown, layout, style};
use crate::viewer::input::{HelpSection, help};

/// Columns that the tables are put into, at most.
const MOST_COLUMNS: usize = 3;
/// Least width of such a column, points.
const COLUMN: f32 = 395.0;
const ROW: f32 = 17.0;

pub(super) fn show(context: &Context, shown: &Shown<'_>) {
    let sections = help(shown.snapshot.mode);
    let window = context.content_rect().size();
    let room = window - egui::vec2(40.0, 70.0);
    let columns = ((room.x / COLUMN) as usize).clamp(1, MOST_COLUMNS);
    layout::middle(context, "help", |ui| {
        ui.horizontal(|ui| {
            ui.heading("Keys and mouse");
            ui.label(RichText::new("F1 closes this").small().color(style::FAINT));
        });
        ui.add_space(4.0);
        ScrollArea::both().max_height(room.y).max_width(room.x).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                for (index, column) in split(&sections, columns).into_iter().enumerate() {
                    ui.vertical(|ui| {
                        for section in column {
                            table(ui, index, section);
                        }
                    });
                    ui.add_space(18.0);
                }
            });
        });
    });
}

/// Puts tables into columns of about the same length, in their order.
fn split(sections: &[HelpSection], columns: usize) -> Vec<&[HelpSection]> {
    let length = |section: &HelpSection| section.lines.len() + 2;
    let all: usize = sections.iter().map(length).sum();
    let mut parts = Vec::new();
    let (mut start, mut passed) = (0, 0);
    for (index, section) in sections.iter().enumerate() {
        let middle = passed + length(section) / 2;
        if index > start && parts.len() + 1 < columns && middle * columns > all * (parts.len() + 1) {
            parts.push(&sections[start..index]);
            start = index;
        }
        passed += length(section);
    }
    parts.push(&sections[start..]);
    parts
}

fn table(ui: &mut Ui, column: usize, section: &HelpSection) {
    ui.label(RichText::new(section.title).strong().color(style::ACCENT));
    Grid::new((section.title, column)).num_columns(2).spacing([14.0, 2.0]).min_row_height(ROW).show(ui, |ui| {
        for (keys, what) in &section.lines {
            ui.label(RichText::new(keys).monospace());
            ui.label(*what);
            ui.end_row();
        }
    });
    ui.add_space(8.0);
}
