//! How the simulation stands.

use egui::{Grid, RichText, Ui};

use super::{Shown, style};
use crate::viewer::input::Modifiers;
use crate::viewer::snapshot::Status;

/// A window that is not drawn for so long rests.
const REST: std::time::Duration = std::time::Duration::from_millis(600);

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>) {
    let (snapshot, options, facts) = (shown.snapshot, &shown.view.options, shown.facts);
    if facts.rate.is_some() {
        // Once more when it rests, to say so.
        ui.ctx().request_repaint_after(REST);
    }
    let rate = facts.rate.map_or_else(|| "at rest".to_owned(), |rate| format!("{rate:.0} Hz"));
    let [width, height] = facts.size;
    let mut lines = vec![
        ("Mode", snapshot.mode.to_string()),
        ("Status", snapshot.status.text().to_owned()),
        ("Time", format!("{:.3} s", snapshot.time)),
        ("Refresh Rate", rate),
        ("Resolution", format!("({width}, {height})")),
        ("Sim Speed", snapshot.pace.text()),
    ];
    if snapshot.status != Status::Paused && snapshot.pace.measured > 0.0 {
        lines.push(("Real Time", format!("{:.2}x", snapshot.pace.measured)));
    }
    if let Some(selected) = snapshot.selected.filter(|selected| selected.active) {
        let norm = |part: &[f64]| part.iter().map(|number| number * number).sum::<f64>().sqrt();
        lines.push(("Pull", format!("{:.1} N, {:.1} N m", norm(&selected.force[..3]), norm(&selected.force[3..]))));
    }
    lines.extend([("Frame", format!("{:?}", options.frame)), ("Label", format!("{:?}", options.label))]);
    Grid::new("info").num_columns(2).spacing([14.0, 2.0]).show(ui, |ui| {
        for (name, value) in lines {
            line(ui, name, &value);
        }
        for info in &snapshot.info {
            line(ui, info.name, &info.value);
        }
    });
    let command = Modifiers::COMMAND;
    ui.label(RichText::new(format!("F1 help   {command}1 {command}2 panels")).small().color(style::FAINT));
}

fn line(ui: &mut Ui, name: &str, value: &str) {
    ui.label(RichText::new(name).color(style::FAINT));
    // Digits of one width: the panel does not tremble while they run.
    ui.monospace(value);
    ui.end_row();
}
