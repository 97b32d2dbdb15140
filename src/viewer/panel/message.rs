//! Notices and problems, at the top of the window.

use std::time::{Duration, Instant};

use egui::{Align2, Area, Context, Id, Order, RichText};

use super::layout::{GAP, SIDE};
use super::{Shown, style};

/// How long a notice stays.
const NOTICE: Duration = Duration::from_secs(4);
/// How long a problem stays.
const PROBLEM: Duration = Duration::from_secs(12);
/// How many are shown at most.
const MOST: usize = 4;

struct Message {
    text: String,
    is_problem: bool,
    until: Instant,
}

#[derive(Default)]
pub(super) struct Messages {
    messages: Vec<Message>,
}

impl Messages {
    pub fn notice(&mut self, text: String) {
        self.add(text, false, NOTICE);
    }

    pub fn warn(&mut self, text: String) {
        self.add(text, true, PROBLEM);
    }

    pub fn texts(&self) -> Vec<String> {
        self.messages.iter().map(|message| message.text.clone()).collect()
    }

    fn add(&mut self, text: String, is_problem: bool, stays: Duration) {
        if text.is_empty() {
            return;
        }
        self.messages.retain(|message| message.text != text);
        if self.messages.len() == MOST {
            self.messages.remove(0);
        }
        self.messages.push(Message { text, is_problem, until: Instant::now() + stays });
    }

    pub fn show(&mut self, context: &Context, shown: &Shown<'_>) {
        let now = Instant::now();
        self.messages.retain(|message| message.until > now);
        if let Some(next) = self.messages.iter().map(|message| message.until - now).min() {
            context.request_repaint_after(next);
        }
        let problem = shown.snapshot.problem.as_str();
        let recording = shown.facts.recording;
        if self.messages.is_empty() && problem.is_empty() && recording.is_none() {
            return;
        }
        // Between the panels at the sides.
        let sides = SIDE * (f32::from(u8::from(shown.view.left_panel)) + f32::from(u8::from(shown.view.right_panel)));
        let shift =
            SIDE / 2.0 * (f32::from(u8::from(shown.view.left_panel)) - f32::from(u8::from(shown.view.right_panel)));
        let width = (context.content_rect().width() - sides - 4.0 * GAP).clamp(120.0, 560.0);
        Area::new(Id::unique("messages"))
            .anchor(Align2::CENTER_TOP, [shift, GAP])
            .order(Order::Foreground)
            .interactable(false)
            .show(context, |ui| {
                style::frame().show(ui, |ui| {
                    ui.set_max_width(width);
                    if let Some(frames) = recording {
                        ui.label(RichText::new(format!("● recording, {frames} frames")).color(style::FAILURE));
                    }
                    if !problem.is_empty() {
                        ui.label(RichText::new(problem).color(style::FAILURE));
                    }
                    for message in &self.messages {
                        let text = RichText::new(&message.text);
                        ui.label(if message.is_problem { text.color(style::WARNING) } else { text });
                    }
                });
            });
    }
}
