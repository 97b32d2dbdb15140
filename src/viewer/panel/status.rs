//! Panels on the state of the viewer: info panel, messages and help.

use std::time::{Duration, Instant};

use egui::{Align2, Area, Context, Grid, Id, Order, RichText, ScrollArea, Sense, Ui};

use super::layout::GAP;
use super::visual::camera_name;
use super::{PanelContext, layout, style};
use crate::viewer::input::{HelpSection, Modifiers, help_sections};
use crate::viewer::link::Status;

/// Minimum height of a row of the info panel and of the help, points.
const ROW_HEIGHT: f32 = 15.0;

/// Time without a frame after which the refresh rate is shown as idle.
const IDLE_TIME: Duration = Duration::from_millis(600);

/// Shows a line with the state of the simulation, or its details.
pub(super) fn show_info(ui: &mut Ui, cx: &PanelContext<'_>) {
    let (snapshot, status) = (cx.snapshot, cx.status);
    let is_moving = snapshot.status != Status::Paused;
    if status.rate.is_some() && (cx.view.details || is_moving) {
        // One more frame after the last change updates the rate.
        ui.ctx().request_repaint_after(IDLE_TIME);
    }
    if cx.view.details {
        show_details(ui, cx);
        return;
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        ui.label(match snapshot.status {
            Status::Paused => "Paused",
            Status::Running => "Running",
            Status::Reversed => "Reversed",
            Status::Program => "Program",
        });
        // A monospace font keeps the width of the panel constant while digits change.
        ui.monospace(format!("{:.2} s", snapshot.time));
        if is_moving && snapshot.speed.measured > 0.0 {
            ui.monospace(format!("{:.2}x", snapshot.speed.measured));
        }
        if let Some(rate) = status.rate.filter(|_| is_moving) {
            ui.monospace(rate_text(rate));
        }
        if !is_moving {
            ui.label(RichText::new("F1 help   F2 details").small().weak());
        }
    });
}

/// Returns a refresh rate.
fn rate_text(rate: f64) -> String {
    if rate >= 9.5 { format!("{rate:.0} Hz") } else { format!("{rate:.1} Hz") }
}

fn show_details(ui: &mut Ui, cx: &PanelContext<'_>) {
    let (snapshot, options, status) = (cx.snapshot, &cx.view.options, cx.status);
    let rate = match (status.rate, snapshot.status) {
        (Some(rate), _) => rate_text(rate),
        // The window is idle between two changes of the state.
        (None, Status::Running | Status::Reversed) => "below 2 Hz".to_owned(),
        (None, Status::Paused | Status::Program) => "idle".to_owned(),
    };
    let [width, height] = status.size;
    let mut lines = vec![
        ("Mode", snapshot.mode.to_string()),
        ("Status", snapshot.status.text().to_owned()),
        ("Time", format!("{:.3} s", snapshot.time)),
        ("Refresh Rate", rate),
        ("Resolution", format!("({width}, {height})")),
        ("Target Speed", snapshot.speed.text()),
    ];
    if snapshot.status != Status::Paused && snapshot.speed.measured > 0.0 {
        lines.push(("Actual Speed", format!("{:.2}x", snapshot.speed.measured)));
    }
    if let Some(selected) = snapshot.selected.filter(|selected| selected.active) {
        let norm = |part: &[f64]| part.iter().map(|number| number * number).sum::<f64>().sqrt();
        lines.push(("Pull", format!("{:.1} N, {:.1} N m", norm(&selected.force[..3]), norm(&selected.force[3..]))));
    }
    lines.push(("Camera", camera_name(&cx.view.camera, &snapshot.model)));
    lines.extend([("Frame", format!("{:?}", options.frame)), ("Label", format!("{:?}", options.label))]);
    Grid::new("info").num_columns(2).spacing([14.0, 1.0]).min_row_height(ROW_HEIGHT).show(ui, |ui| {
        for (name, value) in lines {
            show_line(ui, name, &value);
        }
        for info in &snapshot.info {
            show_line(ui, info.name, &info.value);
        }
    });
    let text = format!("F1 help   Tab {}Tab panels   {}Q quit", Modifiers::SHIFT, Modifiers::COMMAND);
    ui.label(RichText::new(text).small().weak());
}

fn show_line(ui: &mut Ui, name: &str, value: &str) {
    ui.label(RichText::new(name).weak());
    // A monospace font keeps the width of the panel constant while digits change.
    ui.monospace(value);
    ui.end_row();
}

/// Display time of a notice.
const NOTICE_TIME: Duration = Duration::from_secs(4);
/// Display time of an announcement.
const ANNOUNCEMENT_TIME: Duration = Duration::from_secs(2);
/// Display time of a problem.
const PROBLEM_TIME: Duration = Duration::from_secs(12);
/// Maximum number of messages shown at the same time.
const MAX_MESSAGES: usize = 4;

/// Kind of a message.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Notice,
    Problem,
    /// State after a key press, such as the camera. Replaces the previous one.
    Announcement,
}

struct Message {
    text: String,
    kind: Kind,
    /// Display time.
    time: Duration,
    /// End of the display time, which starts when the message is first shown: a frame may take
    /// longer.
    until: Option<Instant>,
}

/// Notices and problems at the top of the window.
#[derive(Default)]
pub(super) struct Messages {
    messages: Vec<Message>,
}

impl Messages {
    pub fn notice(&mut self, text: String) {
        self.add(text, Kind::Notice, NOTICE_TIME);
    }

    pub fn warn(&mut self, text: String) {
        self.add(text, Kind::Problem, PROBLEM_TIME);
    }

    pub fn announce(&mut self, text: String) {
        self.messages.retain(|message| message.kind != Kind::Announcement);
        self.add(text, Kind::Announcement, ANNOUNCEMENT_TIME);
    }

    #[cfg(feature = "_test-hooks")]
    pub fn texts(&self) -> Vec<String> {
        self.messages.iter().map(|message| message.text.clone()).collect()
    }

    fn add(&mut self, text: String, kind: Kind, time: Duration) {
        if text.is_empty() {
            return;
        }
        self.messages.retain(|message| message.text != text);
        if self.messages.len() == MAX_MESSAGES {
            self.messages.remove(0);
        }
        self.messages.push(Message { text, kind, time, until: None });
    }

    /// Starts the display time of new messages and removes those whose time is over. Returns the
    /// time until the next removal.
    fn update(&mut self, now: Instant) -> Option<Duration> {
        let time_left =
            |message: &mut Message| message.until.get_or_insert(now + message.time).saturating_duration_since(now);
        self.messages.retain_mut(|message| !time_left(message).is_zero());
        self.messages.iter_mut().map(time_left).min()
    }

    /// Shows the messages over the image between side panels of these widths.
    pub fn show(&mut self, context: &Context, cx: &PanelContext<'_>, [left, right]: [f32; 2]) {
        if let Some(next) = self.update(Instant::now()) {
            context.request_repaint_after(next);
        }
        let problem = cx.snapshot.problem.as_str();
        let recording = cx.status.recording;
        let loading = cx.status.loading.as_deref();
        if self.messages.is_empty() && problem.is_empty() && recording.is_none() && loading.is_none() {
            return;
        }
        let shift = (left - right) / 2.0;
        let width = (context.content_rect().width() - left - right - 4.0 * GAP).clamp(120.0, 560.0);
        Area::new(Id::unique("messages"))
            .anchor(Align2::CENTER_TOP, [shift, GAP])
            .order(Order::Foreground)
            .interactable(false)
            .show(context, |ui| {
                layout::frame(context).show(ui, |ui| {
                    ui.set_max_width(width);
                    if let Some(frames) = recording {
                        show_recording(ui, frames);
                    }
                    if let Some(path) = loading {
                        ui.label(RichText::new(format!("loading {path}…")).color(style::accent(ui)));
                    }
                    if !problem.is_empty() {
                        ui.label(RichText::new(problem).color(style::failure(ui)));
                    }
                    for message in &self.messages {
                        let text = RichText::new(&message.text);
                        ui.label(if message.kind == Kind::Problem { text.color(style::warning(ui)) } else { text });
                    }
                });
            });
    }
}

/// Shows a red dot and the number of frames of a recording.
fn show_recording(ui: &mut Ui, frames: u64) {
    ui.horizontal(|ui| {
        let side = ui.spacing().interact_size.y;
        let (place, _) = ui.allocate_exact_size(egui::vec2(0.6 * side, side), Sense::hover());
        ui.painter().circle_filled(place.center(), 0.25 * side, style::failure(ui));
        ui.label(RichText::new(format!("recording, {frames} frames")).color(style::failure(ui)));
    });
}

/// Maximum number of columns of tables in the help.
const MAX_COLUMNS: usize = 3;
/// Widths of the keys and of their description in the help, points.
const WIDTHS: [f32; 2] = [138.0, 236.0];

pub(super) fn show_help(context: &Context, cx: &PanelContext<'_>) {
    let sections = help_sections(cx.snapshot.mode, cx.released_keys);
    let room = context.content_rect().size() - egui::vec2(40.0, 64.0);
    let columns = ((room.x / (WIDTHS[0] + WIDTHS[1] + 24.0)) as usize).clamp(1, MAX_COLUMNS);
    layout::center(context, "help", |ui| {
        ui.horizontal(|ui| {
            ui.heading("Keys and mouse");
            ui.label(RichText::new("F1 closes the help").small().weak());
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

/// Distributes sections over columns: the longest first, each into the shortest column. Keeps their
/// order within and between columns.
fn split(sections: &[HelpSection], columns: usize) -> Vec<Vec<&HelpSection>> {
    let length = |section: usize| sections[section].lines.len() + 2;
    let mut order: Vec<usize> = (0..sections.len()).collect();
    order.sort_by_key(|&section| std::cmp::Reverse(length(section)));
    let mut parts = vec![Vec::new(); columns];
    for section in order {
        let shortest = parts
            .iter_mut()
            .min_by_key(|part: &&mut Vec<usize>| part.iter().map(|&other| length(other)).sum::<usize>());
        shortest.expect("Bug: help without columns").push(section);
    }
    for part in &mut parts {
        part.sort_unstable();
    }
    parts.sort_by_key(|part| part.first().copied());
    parts.into_iter().map(|part| part.into_iter().map(|section| &sections[section]).collect()).collect()
}

fn table(ui: &mut Ui, section: &HelpSection) {
    ui.label(RichText::new(section.title).strong().color(style::accent(ui)));
    Grid::new(section.title).num_columns(2).spacing([8.0, 1.0]).min_row_height(ROW_HEIGHT).show(ui, |ui| {
        for (keys, description) in &section.lines {
            cell(ui, WIDTHS[0], RichText::new(keys).monospace().size(11.0));
            cell(ui, WIDTHS[1], RichText::new(*description).size(12.0));
            ui.end_row();
        }
    });
    ui.add_space(6.0);
}

/// Shows a text that is wrapped to a fixed width.
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
    fn display_time_of_a_message_starts_when_it_is_first_shown() {
        let mut messages = Messages::default();
        messages.notice("saved".to_owned());
        let first = Instant::now() + 10 * NOTICE_TIME;
        assert_eq!(messages.update(first), Some(NOTICE_TIME));
        messages.warn("no clipboard".to_owned());
        assert_eq!(messages.update(first + NOTICE_TIME / 2), Some(NOTICE_TIME / 2));
        assert_eq!(messages.messages.len(), 2);
        assert!(messages.update(first + NOTICE_TIME).is_some());
        assert_eq!(messages.messages.len(), 1);
        assert_eq!(messages.update(first + NOTICE_TIME / 2 + PROBLEM_TIME), None);
    }

    #[test]
    fn sections_are_distributed_over_columns_in_order() {
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
