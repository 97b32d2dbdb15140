//! Keys, modifiers, mouse buttons.

use std::fmt;

/// A key, by what it gives without modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs, reason = "what is printed on the keys")]
pub enum Key {
    /// A letter in lower case, a digit or a punctuation mark: what the key gives without modifiers.
    Character(char),
    /// A function key: 1 for F1.
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
    /// As help texts name it.
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

/// Which modifier keys are held.
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
    /// None.
    pub const NONE: Self = Self(0);
    /// Shift.
    pub const SHIFT: Self = Self(1);
    /// That of the platform's commands: Ctrl, or Cmd on macOS.
    pub const COMMAND: Self = Self(1 << 1);
    /// Alt, or Option on macOS.
    pub const ALT: Self = Self(1 << 2);
    /// The one that is left: Super (the Windows key), or Ctrl on macOS. The viewer has no use for it.
    pub const OTHER: Self = Self(1 << 3);

    /// From the keys that are held. Which of Ctrl and Super is [`COMMAND`](Self::COMMAND) depends on the platform.
    #[allow(clippy::fn_params_excessive_bools, reason = "a key each")]
    pub(crate) fn held(shift: bool, control: bool, alt: bool, system: bool) -> Self {
        let (command, other) = if cfg!(target_os = "macos") { (system, control) } else { (control, system) };
        let parts = [(shift, Self::SHIFT), (command, Self::COMMAND), (alt, Self::ALT), (other, Self::OTHER)];
        parts.into_iter().filter(|(held, _)| *held).fold(Self::NONE, |all, (_, part)| all | part)
    }

    /// Whether all of these are held.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Both.
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
    /// As help texts name them, with a plus behind each: `Ctrl+Shift+`.
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

/// A key that was pressed, or repeats because it is held.
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
    /// The key.
    pub key: Key,
    /// The modifiers that are held.
    pub modifiers: Modifiers,
    /// Whether it repeats.
    pub repeat: bool,
}

impl fmt::Display for KeyPress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.modifiers, self.key)
    }
}

/// A button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MouseButton {
    Left,
    Middle,
    Right,
}
