//! Keys and mouse, without a window: what is pressed, and what it means.
//!
//! | file | what is in it |
//! |---|---|
//! | `key.rs` | keys, modifiers, mouse buttons |
//! | `action.rs` | what a key can do |
//! | `binding.rs` | the table: which key does what, in which mode |
//! | `help.rs` | the table as a text |
//! | `mouse.rs` | gestures |

mod action;
mod binding;
mod help;
mod key;
mod mouse;

pub(crate) use self::action::{Action, Panel, PlotKind, WindowAction};
pub(crate) use self::binding::{BINDINGS, Section, action};
pub(crate) use self::help::{HelpSection, help, help_text};
pub(crate) use self::key::MouseButton;
pub use self::key::{Key, KeyPress, Modifiers};
pub(crate) use self::mouse::{Gesture, Moment, Mouse};
