//! Keyboard and mouse input, independent of the windowing library: keys, the table of bindings, and
//! mouse gestures.

mod binding;
mod help;
mod key;
mod mouse;

pub(crate) use self::binding::{Action, BINDINGS, Panel, PlotKind, Section, ViewAction, WindowAction, find_action};
pub(crate) use self::help::{HelpSection, help_sections, help_text};
pub(crate) use self::key::MouseButton;
pub use self::key::{Key, KeyPress, Modifiers};
pub(crate) use self::mouse::{EventTime, Gesture, Mouse};
