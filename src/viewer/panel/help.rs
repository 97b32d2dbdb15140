//! What keys and mouse do.

use egui::{Context, Grid, RichText, ScrollArea, Ui};

use super::{Shown, layout, style};
use crate::viewer::input::{HelpSection, help};

/// Columns that the tables are put into, at most.
const MOST_COLUMNS: usize = 3;
/// Widths of what to press and of what it does, points.
const WIDTHS: [f32; 2] = [138.0, 236.0];
const ROW: f32 = 15.0;

pub(super) fn show(context: &Context, shown: &Shown<'_>) {
    let sections = help(shown.snapshot.mode);
    let room = context.content_rect().size() - egui::vec2(40.0, 64.0);
    let columns = ((room.x / (WIDTHS[0] + WIDTHS[1] + 24.0)) as usize).clamp(1, MOST_COLUMNS);
    layout::middle(context, "help", |ui| {
        ui.horizontal(|ui| {
            ui.heading("Keys and mouse");
            ui.label(RichText::new("F1 closes this").small().color(style::FAINT));
        });
        ui.add_space(4.0);
        let wanted = columns as f32 * (WIDTHS[0] + WIDTHS[1] + 24.0) - 14.0;
        ui.set_min_width(wanted.min(room.x));
        ScrollArea::both()
            .auto_shrink([false, true])
            .min_scrolled_height(room.y)
            .max_height(room.y)
            .max_width(room.x)
            .show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    ui.spacing_mut().item_spacing.x = 14.0;
                    for column in split(&sections, columns) {
                        ui.vertical(|ui| column.into_iter().for_each(|section| table(ui, section)));
                    }
                });
            });
    });
}

/// Puts tables into columns: the longest first, each into the shortest column. What comes first stays on top and at the left.
fn split(sections: &[HelpSection], columns: usize) -> Vec<Vec<&HelpSection>> {
    let length = |section: usize| sections[section].lines.len() + 2;
    let mut order: Vec<usize> = (0..sections.len()).collect();
    order.sort_by_key(|&section| std::cmp::Reverse(length(section)));
    let mut parts = vec![Vec::new(); columns];
    for section in order {
        let shortest = parts
            .iter_mut()
            .min_by_key(|part: &&mut Vec<usize>| part.iter().map(|&other| length(other)).sum::<usize>());
        shortest.expect("Bug: no column").push(section);
    }
    for part in &mut parts {
        part.sort_unstable();
    }
    parts.sort_by_key(|part| part.first().copied());
    parts.into_iter().map(|part| part.into_iter().map(|section| &sections[section]).collect()).collect()
}

fn table(ui: &mut Ui, section: &HelpSection) {
    ui.label(RichText::new(section.title).strong().color(style::ACCENT));
    Grid::new(section.title).num_columns(2).spacing([8.0, 1.0]).min_row_height(ROW).show(ui, |ui| {
        for (keys, what) in &section.lines {
            cell(ui, WIDTHS[0], RichText::new(keys).monospace().size(11.0));
            cell(ui, WIDTHS[1], RichText::new(*what).size(12.0));
            ui.end_row();
        }
    });
    ui.add_space(6.0);
}

/// A text in a column of a fixed width, in as many lines as it needs.
fn cell(ui: &mut Ui, width: f32, text: RichText) {
    ui.vertical(|ui| {
        ui.set_width(width);
        ui.add(egui::Label::new(text).wrap());
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_is_in_one_column_in_order() {
        let section = |title, lines| HelpSection { title, lines: vec![(String::new(), ""); lines] };
        let sections = [section("a", 3), section("b", 10), section("c", 2), section("d", 4)];
        let names = |columns| {
            let parts = split(&sections, columns);
            parts.iter().map(|part| part.iter().map(|section| section.title).collect::<String>()).collect::<Vec<_>>()
        };
        assert_eq!(names(1), ["abcd"]);
        assert_eq!(names(2), ["acd", "b"]);
    }
}
