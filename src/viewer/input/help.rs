//! Help on keys and mouse, for the screen and for the terminal.

use super::binding::Binding;
use super::{BINDINGS, Key, Modifiers, Section};
use crate::viewer::link::Mode;

/// Section of the help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct HelpSection {
    pub title: &'static str,
    /// Keys or gesture, and their effect.
    pub lines: Vec<(String, &'static str)>,
}

/// Mouse gestures: modifiers, gesture, effect, and the mode to which the gesture is limited.
const MOUSE: &[(Modifiers, &str, &str, Option<Mode>)] = &[
    (Modifiers::NONE, "left drag", "Rotate the view", None),
    (Modifiers::SHIFT, "left drag", "Rotate the view", None),
    (Modifiers::NONE, "right drag", "Move the view vertically and sideways", None),
    (Modifiers::SHIFT, "right drag", "Move the view horizontally", None),
    (Modifiers::NONE, "middle drag, wheel", "Zoom", None),
    (Modifiers::NONE, "left double-click", "Select a body or unselect", None),
    (Modifiers::NONE, "right double-click", "Look at a point", None),
    (Modifiers::COMMAND, "right double-click", "Track a body", None),
    (Modifiers::COMMAND, "left drag", "Rotate the selected body", None),
    (Modifiers::COMMAND, "right drag", "Pull the selected body; while paused, move it", None),
    (Modifiers::COMMAND, "wheel", "Burst: more or fewer records", Some(Mode::Trajectory)),
    (Modifiers::SHIFT, "wheel", "Burst: slower or faster fading", Some(Mode::Trajectory)),
];

/// Returns the help for a mode, without the bindings of released keys.
pub(crate) fn help_sections(mode: Mode, released: &[Key]) -> Vec<HelpSection> {
    let here = |only: Option<Mode>| only.is_none_or(|only| only == mode);
    let mouse = MOUSE.iter().filter(|(.., only)| here(*only));
    let mouse = mouse.map(|&(modifiers, gesture, help, _)| (format!("{modifiers}{gesture}"), help));
    let mut sections = vec![HelpSection { title: "Mouse", lines: merged(mouse) }];
    for section in Section::ALL {
        let is_shown =
            |binding: &&Binding| binding.section == section && here(binding.mode) && !binding.is_released(released);
        let bindings = BINDINGS.iter().filter(is_shown);
        let lines = merged(bindings.map(|binding| (binding.press().to_string(), binding.help)));
        if !lines.is_empty() {
            sections.push(HelpSection { title: section.title(), lines });
        }
    }
    sections
}

/// Merges adjacent lines with the same effect.
fn merged(lines: impl Iterator<Item = (String, &'static str)>) -> Vec<(String, &'static str)> {
    let mut merged: Vec<(String, &'static str)> = Vec::new();
    for (keys, help) in lines {
        match merged.last_mut() {
            Some((other, same)) if *same == help => {
                other.push_str(", ");
                other.push_str(&keys);
            }
            _ => merged.push((keys, help)),
        }
    }
    merged
}

/// Formats the help as text. Lines have at most this number of columns, except for longer words.
pub(crate) fn help_text(mode: Mode, released: &[Key], columns: usize) -> String {
    let sections = help_sections(mode, released);
    let widest = sections.iter().flat_map(|section| &section.lines).map(|(keys, _)| keys.chars().count()).max();
    let left = widest.unwrap_or(0).min(columns / 2);
    let right = columns.saturating_sub(left + 3).max(10);
    let mut text = String::new();
    for section in &sections {
        text.push_str(section.title);
        text.push('\n');
        for (keys, help) in &section.lines {
            let (keys, help) = (wrapped(keys, left), wrapped(help, right));
            for row in 0..keys.len().max(help.len()) {
                let cell = |cells: &[String]| cells.get(row).cloned().unwrap_or_default();
                let line = format!("  {:left$} {}", cell(&keys), cell(&help));
                text.push_str(line.trim_end());
                text.push('\n');
            }
        }
        text.push('\n');
    }
    text
}

/// Wraps a text at spaces. A word that is longer than the width gets a separate line.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
