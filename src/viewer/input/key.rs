//! Keys, modifiers and buttons.

use std::fmt;

/// Key of the keyboard, identified by its symbol without modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the labels of the keys")]
pub enum Key {
    /// Lower-case letter, digit or punctuation mark that the key produces without modifiers.
    Character(char),
    /// Function key: 1 for F1.
    Function(u8),
    Escape,
    Enter,
    Space,
    Tab,
    Backspace,
    Delete,
    Insert,
    Home,
    End,
    PageUp,
    PageDown,
    Up,
    Down,
    Left,
    Right,
}

impl fmt::Display for Key {
    /// Formats the key as help texts name it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Character(character) => write!(f, "{}", character.to_uppercase()),
            Self::Function(number) => write!(f, "F{number}"),
            Self::Escape => f.write_str("Esc"),
            Self::PageUp => f.write_str("Page Up"),
            Self::PageDown => f.write_str("Page Down"),
            other => write!(f, "{other:?}"),
        }
    }
}

/// Set of modifier keys.
///
/// ```
/// use mujoco_safe::viewer::Modifiers;
///
/// let held = Modifiers::SHIFT | Modifiers::COMMAND;
/// assert!(held.contains(Modifiers::SHIFT));
/// assert!(!held.contains(Modifiers::ALT));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Modifiers(u8);

impl Modifiers {
    /// No modifier.
    pub const NONE: Self = Self(0);
    /// Shift key.
    pub const SHIFT: Self = Self(1);
    /// Modifier of the platform's commands: Ctrl, or Cmd on macOS.
    pub const COMMAND: Self = Self(1 << 1);
    /// Alt key, or Option on macOS.
    pub const ALT: Self = Self(1 << 2);
    /// Remaining modifier: Super (the Windows key), or Ctrl on macOS. No binding of the viewer uses
    /// it.
    pub const OTHER: Self = Self(1 << 3);

    /// Creates the set of the held keys. [`COMMAND`](Self::COMMAND) is Ctrl or Super, depending on
    /// the platform.
    #[allow(clippy::fn_params_excessive_bools, reason = "one parameter for each key")]
    pub(crate) fn held(shift: bool, control: bool, alt: bool, system: bool) -> Self {
        let (command, other) = if cfg!(target_os = "macos") { (system, control) } else { (control, system) };
        let parts = [(shift, Self::SHIFT), (command, Self::COMMAND), (alt, Self::ALT), (other, Self::OTHER)];
        parts.into_iter().filter(|(held, _)| *held).fold(Self::NONE, |all, (_, part)| all | part)
    }

    /// Returns `true` if the set contains all of these modifiers.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Returns the union of both sets.
    pub(super) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl std::ops::BitOr for Modifiers {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        self.and(other)
    }
}

impl fmt::Display for Modifiers {
    /// Formats the modifiers as help texts name them, each followed by a plus: `Ctrl+Shift+`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (command, other) = if cfg!(target_os = "macos") { ("Cmd+", "Ctrl+") } else { ("Ctrl+", "Super+") };
        for (part, name) in
            [(Self::COMMAND, command), (Self::ALT, "Alt+"), (Self::SHIFT, "Shift+"), (Self::OTHER, other)]
        {
            if self.contains(part) {
                f.write_str(name)?;
            }
        }
        Ok(())
    }
}

/// Key press, or repetition of a held key.
///
/// ```
/// use mujoco_safe::viewer::{Key, KeyPress, Modifiers};
///
/// let press = KeyPress { key: Key::Character('z'), modifiers: Modifiers::COMMAND, repeat: false };
/// # #[cfg(not(target_os = "macos"))]
/// assert_eq!(press.to_string(), "Ctrl+Z");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct KeyPress {
    /// Pressed key.
    pub key: Key,
    /// Modifiers held at the time of the press.
    pub modifiers: Modifiers,
    /// `true` for a repetition of a held key.
    pub repeat: bool,
}

impl fmt::Display for KeyPress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.modifiers, self.key)
    }
}

/// Button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MouseButton {
    Left,
    Middle,
    Right,
}
