//! Gestures of the mouse.

use std::time::Duration;

use super::{Modifiers, MouseButton};
use crate::scene::{MouseAction, PerturbationFlags};
use crate::viewer::mode::Mode;
use crate::viewer::request::Place;

/// How soon a second click makes a double-click.
const DOUBLE_CLICK: Duration = Duration::from_millis(250);

/// A pointer that has moved farther than this while a button is held, in pixels, has dragged and not clicked.
const JITTER: f64 = 5.0;

/// By how much a notch of the wheel zooms, in heights of the window: as in the engine's programs, away from the user is away
/// from the scene.
const NOTCH: f64 = -0.05;

/// What a motion of the mouse means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gesture {
    /// Nothing.
    None,
    /// Moves the camera, in heights of the window.
    Camera(MouseAction, [f64; 2]),
    /// Begins to turn or pull the selected body.
    StartPerturbation(PerturbationFlags),
    /// Moves where it is pulled to, in heights of the window.
    Perturbation(MouseAction, [f64; 2]),
    /// Lets it go.
    StopPerturbation,
    /// Selects what is there.
    Select(Place),
    /// Looks at what is there.
    LookAt(Place),
    /// Follows what is there.
    Track(Place),
    /// So many notches more other moments of the trajectory.
    BurstFactor(f64),
    /// So many notches slower fading of them.
    BurstGamma(f64),
}

/// The time of an event by any clock, as far as it is known: an event that waits in a queue while a frame is drawn has no time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    pub earliest: Duration,
    pub latest: Duration,
}

impl From<Duration> for Moment {
    fn from(time: Duration) -> Self {
        Self { earliest: time, latest: time }
    }
}

/// Makes gestures of what the mouse does. Positions are in pixels, from the upper left corner of the picture.
#[derive(Debug)]
pub(crate) struct Mouse {
    at: [f64; 2],
    size: [f64; 2],
    /// The button that is held, and whether it pulls a body.
    held: Option<(MouseButton, bool)>,
    /// The last press, unless it began a drag.
    last_press: Option<(MouseButton, Duration)>,
    /// The place of the last press.
    pressed_at: [f64; 2],
}

impl Default for Mouse {
    fn default() -> Self {
        Self { at: [0.0; 2], size: [1.0; 2], held: None, last_press: None, pressed_at: [0.0; 2] }
    }
}

impl Mouse {
    /// The size of the picture, pixels.
    pub fn resize(&mut self, size: [f64; 2]) {
        self.size = size.map(|pixels| pixels.max(1.0));
    }

    /// Where it is.
    pub fn place(&self) -> Place {
        let ([x, y], [width, height]) = (self.at, self.size);
        Place { aspectratio: width / height, at: [x / width, 1.0 - y / height] }
    }

    /// Handles the press of a button. `selected` says whether there is a body to pull. Two presses are a double-click if they may
    /// have come close enough after one another.
    pub fn press(
        &mut self,
        button: MouseButton,
        modifiers: Modifiers,
        moment: impl Into<Moment>,
        selected: bool,
    ) -> Gesture {
        let moment = moment.into();
        if matches!(self.held, Some((_, true))) {
            // One hand pulls already.
            return Gesture::None;
        }
        let double = self
            .last_press
            .take()
            .is_some_and(|(last, then)| last == button && moment.earliest.saturating_sub(then) < DOUBLE_CLICK);
        let pulls = modifiers.contains(Modifiers::COMMAND) && selected && button != MouseButton::Middle && !double;
        (self.held, self.pressed_at) = (Some((button, pulls)), self.at);
        if double {
            return match (button, modifiers) {
                (MouseButton::Left, Modifiers::NONE) => Gesture::Select(self.place()),
                (MouseButton::Right, Modifiers::NONE) => Gesture::LookAt(self.place()),
                (MouseButton::Right, Modifiers::COMMAND) => Gesture::Track(self.place()),
                _ => Gesture::None,
            };
        }
        self.last_press = Some((button, moment.latest));
        match button {
            MouseButton::Left if pulls => Gesture::StartPerturbation(PerturbationFlags::ROTATE),
            MouseButton::Right if pulls => Gesture::StartPerturbation(PerturbationFlags::TRANSLATE),
            _ => Gesture::None,
        }
    }

    /// The mouse has come to a place.
    pub fn moved(&mut self, at: [f64; 2], modifiers: Modifiers) -> Gesture {
        let before = std::mem::replace(&mut self.at, at);
        let Some((button, pulls)) = self.held else { return Gesture::None };
        if (0..2).any(|axis| (at[axis] - self.pressed_at[axis]).abs() > JITTER) {
            self.last_press = None;
        }
        // By the height in both directions, so that a picture that is wide does not turn faster.
        let motion = [0, 1].map(|axis| (at[axis] - before[axis]) / self.size[1]);
        if motion == [0.0; 2] {
            return Gesture::None;
        }
        let action = match (button, modifiers.contains(Modifiers::SHIFT)) {
            (MouseButton::Left, false) => MouseAction::RotateV,
            (MouseButton::Left, true) => MouseAction::RotateH,
            (MouseButton::Right, false) => MouseAction::MoveV,
            (MouseButton::Right, true) => MouseAction::MoveH,
            (MouseButton::Middle, _) => MouseAction::Zoom,
        };
        if pulls { Gesture::Perturbation(action, motion) } else { Gesture::Camera(action, motion) }
    }

    /// A button is released.
    pub fn release(&mut self, button: MouseButton) -> Gesture {
        match self.held {
            Some((held, pulls)) if held == button => {
                self.held = None;
                if pulls { Gesture::StopPerturbation } else { Gesture::None }
            }
            _ => Gesture::None,
        }
    }

    /// The window has lost the mouse: whatever is held is released.
    pub fn leave(&mut self) -> Gesture {
        self.last_press = None;
        self.held.map_or(Gesture::None, |(button, _)| self.release(button))
    }

    /// The wheel has turned by so many notches, away from the user; touchpads turn by fractions.
    pub fn scroll(&self, notches: f64, modifiers: Modifiers, mode: Mode) -> Gesture {
        // Whoever drags with the wheel turns it by mistake.
        let dragged = matches!(self.held, Some((MouseButton::Middle, _)));
        if !notches.is_finite() || notches == 0.0 || dragged {
            return Gesture::None;
        }
        match (modifiers, mode) {
            (Modifiers::NONE, _) => Gesture::Camera(MouseAction::Zoom, [0.0, NOTCH * notches]),
            (Modifiers::COMMAND, Mode::Trajectory) => Gesture::BurstFactor(notches),
            (Modifiers::SHIFT, Mode::Trajectory) => Gesture::BurstGamma(notches),
            _ => Gesture::None,
        }
    }
}
