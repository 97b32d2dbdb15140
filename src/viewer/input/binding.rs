//! The table: which key does what, in which mode.

use super::{Action, Key, KeyPress, Modifiers};
use crate::viewer::mode::Mode;

/// Under which heading of the help something stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Section {
    Standard,
    Window,
    Camera,
    Visual,
    Groups,
    Trajectory,
}

/// A line of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Binding {
    pub key: Key,
    /// Exactly these.
    pub modifiers: Modifiers,
    /// Whether it is done again while the key is held.
    pub repeats: bool,
    /// In which mode only.
    pub mode: Option<Mode>,
    pub action: Action,
    pub section: Section,
    pub help: &'static str,
}

pub(crate) static BINDINGS: &[Binding] = &[];

/// What a key does in a mode.
pub(crate) fn action(press: KeyPress, mode: Mode) -> Option<Action> {
    BINDINGS
        .iter()
        .find(|binding| {
            binding.key == press.key
                && binding.modifiers == press.modifiers
                && (binding.repeats || !press.repeat)
                && binding.mode.is_none_or(|only| only == mode)
        })
        .map(|binding| binding.action)
}
