//! Gestures of the mouse.

use std::time::Duration;

use super::{Modifiers, MouseButton};
use crate::scene::{MouseAction, PerturbationFlags};
use crate::viewer::mode::Mode;

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
    /// Selects what is there: 0 to 1, from the left and from below.
    Select([f64; 2]),
    /// Looks at what is there.
    LookAt([f64; 2]),
    /// Follows what is there.
    Track([f64; 2]),
    /// So many notches more other moments of the trajectory.
    BurstFactor(f64),
    /// So many notches slower fading of them.
    BurstGamma(f64),
}

/// Makes gestures of what the mouse does. Positions are in pixels from the upper left corner.
#[derive(Debug, Default)]
pub(crate) struct Mouse {
    at: [f64; 2],
    size: [f64; 2],
    /// The button that is held, and whether it pulls a body.
    held: Option<(MouseButton, bool)>,
    last_press: Option<(MouseButton, Duration)>,
}

impl Mouse {
    /// The size of the picture, pixels.
    pub fn resize(&mut self, size: [f64; 2]) {
        self.size = size;
    }

    /// A button is pressed. `now` is any clock's, `selected` whether a body is that can be moved.
    pub fn press(&mut self, button: MouseButton, modifiers: Modifiers, now: Duration, selected: bool) -> Gesture {
        let _ = (button, modifiers, now, selected);
        Gesture::None
    }

    /// The mouse has come to a place.
    pub fn moved(&mut self, at: [f64; 2], modifiers: Modifiers) -> Gesture {
        let _ = (at, modifiers);
        Gesture::None
    }

    /// A button is released.
    pub fn release(&mut self, button: MouseButton) -> Gesture {
        let _ = button;
        Gesture::None
    }

    /// The wheel has turned by so many notches, away from the user.
    pub fn scroll(&self, notches: f64, modifiers: Modifiers, mode: Mode) -> Gesture {
        let _ = (notches, modifiers, mode);
        Gesture::None
    }
}
