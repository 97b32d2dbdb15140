//! What the window asks of the physics.

use std::sync::Arc;

use super::input::KeyPress;
use super::link::Look;
use super::mode::Mode;
use super::watch::Watch;
use crate::id::{ActuatorId, BodyId, EqualityId, JointId, KeyframeId};
use crate::model::{Model, Options};
use crate::scene::{MouseAction, PerturbationFlags};

/// A place in the window: 0 to 1, from the left and from below, and the window's width divided by its height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub aspectratio: f64,
    pub at: [f64; 2],
}

/// What the window asks of the physics. Ids of a model that is no longer there are ignored: it was replaced in the meantime.
#[derive(Debug)]
pub(crate) enum Request {
    // What a simulation does, and a program with a loop of its own does not.
    /// Pauses, or goes on.
    Pause(bool),
    /// The other of the two.
    TogglePause,
    /// So many steps forward, or back where negative. Only where paused.
    Step(i32),
    /// Goes in real time, or at the factor that is set.
    ToggleSpeed,
    /// Doubles the factor, and goes by it.
    Faster,
    /// Halves the factor, and goes by it.
    Slower,
    /// Sets the factor, and goes by it.
    SetSpeed(f64),
    /// So many modes on, or back.
    CycleMode(i32),
    /// A mode; nothing if there is no such one.
    SetMode(Mode),
    /// Pauses, and goes to a moment of the history: 0 is the oldest.
    Scrub(usize),
    /// Goes on with another model.
    Reload(Arc<Model>),

    // What is done with trajectories.
    /// The other direction.
    Reverse,
    /// So many trajectories on, or back.
    CycleTrajectory(i32),
    /// A trajectory.
    SetTrajectory(usize),
    /// A moment of the trajectory.
    SetFrame(usize),
    /// Other moments, or not.
    Burst,
    /// Red and blue, or not.
    Doppler,
    /// So many notches more other moments.
    BurstFactor(f64),
    /// So many notches slower fading.
    BurstGamma(f64),

    // What can be done with any simulation.
    /// Looks from here. The requests after it refer to what is seen from here.
    Look(Box<Look>),
    /// Back to the start.
    Reset,
    /// Selects what is seen at a place; nothing there unselects.
    Select(Place),
    /// Selects a body, or none.
    SelectBody(Option<BodyId>),
    /// Selects the parent of the selected body.
    SelectParent,
    /// Answers with [`Event::LookAt`](super::event::Event::LookAt).
    LookAt(Place),
    /// Answers with [`Event::Track`](super::event::Event::Track).
    Track(Place),
    /// Begins to pull or turn the selected body.
    StartPerturbation(PerturbationFlags),
    /// Moves where it is pulled to, in heights of the window.
    MovePerturbation(MouseAction, [f64; 2]),
    /// Lets go.
    StopPerturbation,
    /// Sets a control.
    SetControl(ActuatorId, f64),
    /// Sets all controls to zero.
    ClearControls,
    /// Sets a number of a joint's position; where the simulation runs, it goes on from there.
    SetPosition(JointId, usize, f64),
    /// To a keyframe of the model's.
    LoadKey(KeyframeId),
    /// Keeps the state, under a name or a number.
    SaveKey(Option<String>),
    /// Goes to the kept state of this number.
    LoadCaptured(usize),
    /// Forgets the kept state of this number.
    RemoveCaptured(usize),
    /// Answers with [`Event::Copied`](super::event::Event::Copied).
    CopyState,
    /// Answers with [`Event::Copied`](super::event::Event::Copied).
    CopyCamera,
    /// Switches an equality constraint.
    SetEquality(EqualityId, bool),
    /// Sets the physics options.
    SetOptions(Box<Options>),
    /// Which numbers the snapshots have besides.
    Watch(Vec<Watch>),
    /// A key that the viewer has no use for.
    Key(KeyPress),
}

impl Request {
    /// Returns `true` if executing this request can pause a simulation that runs.
    pub(super) fn pauses(&self) -> bool {
        matches!(self, Self::Pause(true) | Self::TogglePause | Self::Scrub(_))
    }

    /// Returns `true` if executing this request can pause a program's simulation or let it go on.
    pub(super) fn changes_pause(&self) -> bool {
        matches!(self, Self::Pause(_) | Self::TogglePause)
    }

    /// Returns `true` if executing this request ends the pull of the selected body.
    pub(super) fn ends_pull(&self) -> bool {
        matches!(
            self,
            Self::StartPerturbation(_)
                | Self::StopPerturbation
                | Self::Select(_)
                | Self::SelectBody(_)
                | Self::SelectParent
        )
    }

    /// Returns `true` if the effect of this request depends on the poses that are computed from the state.
    pub(super) fn reads_poses(&self) -> bool {
        self.ends_pull()
            || matches!(self, Self::LookAt(_) | Self::Track(_) | Self::MovePerturbation(..) | Self::CopyCamera)
    }

    /// Merges the next request into this one if the two are equivalent to one: a slow loop then executes fewer of them.
    pub(super) fn merge(&mut self, next: &Self) -> bool {
        match (self, next) {
            (Self::MovePerturbation(action, [x, y]), Self::MovePerturbation(next, [dx, dy])) if action == next => {
                (*x, *y) = (*x + dx, *y + dy);
                true
            }
            (Self::SetControl(id, value), Self::SetControl(next, newer)) if id == next => {
                *value = *newer;
                true
            }
            (Self::SetPosition(id, part, value), Self::SetPosition(next, next_part, newer))
                if (*id, *part) == (*next, *next_part) =>
            {
                *value = *newer;
                true
            }
            (Self::Scrub(index), Self::Scrub(newer)) | (Self::SetFrame(index), Self::SetFrame(newer)) => {
                *index = *newer;
                true
            }
            _ => false,
        }
    }
}
