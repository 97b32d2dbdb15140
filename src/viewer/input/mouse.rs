//! Recognition of mouse gestures.

use std::time::Duration;

use super::{Modifiers, MouseButton};
use crate::scene::{MouseAction, PerturbationFlags};
use crate::viewer::link::{EndpointRequest, Mode, PlaybackRequest, Request, ViewportPoint};

/// Maximum time between the presses of a double-click.
const DOUBLE_CLICK: Duration = Duration::from_millis(250);

/// Motion of the pointer, in pixels, beyond which a click becomes a drag.
const JITTER: f64 = 5.0;

/// Zoom by a notch of the wheel, in units of the image's height. As in the engine's programs,
/// turning the wheel away from the user moves the camera away from the scene.
const NOTCH: f64 = -0.05;

/// Meaning of a mouse event.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Gesture {
    None,
    /// Moves the camera, in units of the image's height.
    Camera(MouseAction, [f64; 2]),
    /// Sends a request to the physics.
    Send(Request),
}

impl From<EndpointRequest> for Gesture {
    fn from(request: EndpointRequest) -> Self {
        Self::Send(request.into())
    }
}

impl From<PlaybackRequest> for Gesture {
    fn from(request: PlaybackRequest) -> Self {
        Self::Send(request.into())
    }
}

/// Bounds of the time of an event, on any monotonic clock. The exact time is unknown, because an
/// event may have waited in the queue while a frame was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EventTime {
    pub earliest: Duration,
    pub latest: Duration,
}

impl From<Duration> for EventTime {
    fn from(time: Duration) -> Self {
        Self { earliest: time, latest: time }
    }
}

/// Recogniser of mouse gestures. Positions are in pixels from the upper left corner of the window.
#[derive(Debug)]
pub(crate) struct Mouse {
    position: [f64; 2],
    /// Upper left corner of the image.
    origin: [f64; 2],
    /// Size of the image.
    size: [f64; 2],
    /// Held button, and `true` if it perturbs a body.
    held: Option<(MouseButton, bool)>,
    /// Last press, unless it started a drag.
    last_press: Option<(MouseButton, Duration)>,
    /// Position of the last press.
    pressed_at: [f64; 2],
}

impl Default for Mouse {
    fn default() -> Self {
        Self {
            position: [0.0; 2],
            origin: [0.0; 2],
            size: [1.0; 2],
            held: None,
            last_press: None,
            pressed_at: [0.0; 2],
        }
    }
}

impl Mouse {
    /// Sets the area of the window that shows the scene: the upper left corner and the size,
    /// pixels.
    pub fn set_area(&mut self, origin: [f64; 2], size: [f64; 2]) {
        self.origin = origin;
        self.size = size.map(|pixels| pixels.max(1.0));
    }

    /// Returns the position of the pointer in the image.
    fn point(&self) -> ViewportPoint {
        let [x, y] = [0, 1].map(|axis| self.position[axis] - self.origin[axis]);
        let [width, height] = self.size;
        ViewportPoint { aspectratio: width / height, position: [x / width, 1.0 - y / height] }
    }

    /// Handles the press of a button. `selected` is `true` if there is a body to perturb. Two
    /// presses are a double-click if the bounds of their times allow it.
    pub fn press(
        &mut self,
        button: MouseButton,
        modifiers: Modifiers,
        time: impl Into<EventTime>,
        selected: bool,
    ) -> Gesture {
        let time = time.into();
        if matches!(self.held, Some((_, true))) {
            // A perturbation is in progress.
            return Gesture::None;
        }
        let double = self
            .last_press
            .take()
            .is_some_and(|(last, then)| last == button && time.earliest.saturating_sub(then) < DOUBLE_CLICK);
        let perturbs = modifiers.contains(Modifiers::COMMAND) && selected && button != MouseButton::Middle && !double;
        (self.held, self.pressed_at) = (Some((button, perturbs)), self.position);
        if double {
            return match (button, modifiers) {
                (MouseButton::Left, Modifiers::NONE) => EndpointRequest::Select(self.point()).into(),
                (MouseButton::Right, Modifiers::NONE) => EndpointRequest::LookAt(self.point()).into(),
                (MouseButton::Right, Modifiers::COMMAND) => EndpointRequest::Track(self.point()).into(),
                _ => Gesture::None,
            };
        }
        self.last_press = Some((button, time.latest));
        match button {
            MouseButton::Left if perturbs => EndpointRequest::StartPerturbation(PerturbationFlags::ROTATE).into(),
            MouseButton::Right if perturbs => EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE).into(),
            _ => Gesture::None,
        }
    }

    /// Handles a motion of the pointer to a position.
    pub fn moved(&mut self, position: [f64; 2], modifiers: Modifiers) -> Gesture {
        let before = std::mem::replace(&mut self.position, position);
        let Some((button, perturbs)) = self.held else { return Gesture::None };
        if (0..2).any(|axis| (position[axis] - self.pressed_at[axis]).abs() > JITTER) {
            self.last_press = None;
        }
        // Relative to the height in both directions, so that the speed does not depend on the
        // aspect ratio.
        let motion = [0, 1].map(|axis| (position[axis] - before[axis]) / self.size[1]);
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
        if perturbs {
            EndpointRequest::MovePerturbation(action, motion).into()
        } else {
            Gesture::Camera(action, motion)
        }
    }

    /// Handles the release of a button.
    pub fn release(&mut self, button: MouseButton) -> Gesture {
        match self.held {
            Some((held, perturbs)) if held == button => {
                self.held = None;
                if perturbs { EndpointRequest::StopPerturbation.into() } else { Gesture::None }
            }
            _ => Gesture::None,
        }
    }

    /// Releases the held button after the window has lost the focus.
    pub fn leave(&mut self) -> Gesture {
        self.last_press = None;
        self.held.map_or(Gesture::None, |(button, _)| self.release(button))
    }

    /// Handles a turn of the wheel, in notches away from the user. Touchpads produce fractions.
    pub fn scroll(&self, notches: f64, modifiers: Modifiers, mode: Mode) -> Gesture {
        // The wheel may turn by accident while it is the pressed middle button.
        let dragged = matches!(self.held, Some((MouseButton::Middle, _)));
        if !notches.is_finite() || notches == 0.0 || dragged {
            return Gesture::None;
        }
        match (modifiers, mode) {
            (Modifiers::NONE, _) => Gesture::Camera(MouseAction::Zoom, [0.0, NOTCH * notches]),
            (Modifiers::COMMAND, Mode::Trajectory) => PlaybackRequest::ChangeBurstFactor(notches).into(),
            (Modifiers::SHIFT, Mode::Trajectory) => PlaybackRequest::ChangeBurstGamma(notches).into(),
            _ => Gesture::None,
        }
    }
}
