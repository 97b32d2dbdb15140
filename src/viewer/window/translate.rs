//! The windowing library's keys and buttons as the viewer's.

use winit::event::{KeyEvent, MouseButton as WinitButton, MouseScrollDelta};
use winit::keyboard::{Key as WinitKey, ModifiersState, NamedKey};
use winit::platform::modifier_supplement::KeyEventExtModifierSupplement;

use crate::viewer::input::{Key, Modifiers, MouseButton};

/// Pixels that a touchpad scrolls for one notch of a wheel.
const PIXELS_PER_NOTCH: f64 = 50.0;

/// The key, by what it gives without modifiers. `None` for those that the viewer does not know.
pub(super) fn key(event: &KeyEvent) -> Option<Key> {
    let named = match event.key_without_modifiers() {
        WinitKey::Named(named) => named,
        WinitKey::Character(text) => return character(&text),
        _ => return None,
    };
    Some(match named {
        NamedKey::Escape => Key::Escape,
        NamedKey::Enter => Key::Enter,
        NamedKey::Space => Key::Space,
        NamedKey::Tab => Key::Tab,
        NamedKey::Backspace => Key::Backspace,
        NamedKey::Delete => Key::Delete,
        NamedKey::Insert => Key::Insert,
        NamedKey::Home => Key::Home,
        NamedKey::End => Key::End,
        NamedKey::PageUp => Key::PageUp,
        NamedKey::PageDown => Key::PageDown,
        NamedKey::ArrowUp => Key::Up,
        NamedKey::ArrowDown => Key::Down,
        NamedKey::ArrowLeft => Key::Left,
        NamedKey::ArrowRight => Key::Right,
        function => Key::Function(FUNCTIONS.iter().position(|key| *key == function)? as u8 + 1),
    })
}

const FUNCTIONS: [NamedKey; 12] = [
    NamedKey::F1,
    NamedKey::F2,
    NamedKey::F3,
    NamedKey::F4,
    NamedKey::F5,
    NamedKey::F6,
    NamedKey::F7,
    NamedKey::F8,
    NamedKey::F9,
    NamedKey::F10,
    NamedKey::F11,
    NamedKey::F12,
];

fn character(text: &str) -> Option<Key> {
    let mut characters = text.chars().flat_map(char::to_lowercase);
    let first = characters.next()?;
    match (first, characters.next()) {
        (' ', None) => Some(Key::Space),
        (character, None) => Some(Key::Character(character)),
        _ => None,
    }
}

pub(super) fn modifiers(state: ModifiersState) -> Modifiers {
    Modifiers::held(state.shift_key(), state.control_key(), state.alt_key(), state.super_key())
}

pub(super) fn button(button: WinitButton) -> Option<MouseButton> {
    match button {
        WinitButton::Left => Some(MouseButton::Left),
        WinitButton::Middle => Some(MouseButton::Middle),
        WinitButton::Right => Some(MouseButton::Right),
        _ => None,
    }
}

/// How far it was scrolled, in notches of a wheel, up.
pub(super) fn notches(delta: MouseScrollDelta) -> f64 {
    match delta {
        MouseScrollDelta::LineDelta(_, lines) => lines.into(),
        MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_NOTCH,
    }
}
