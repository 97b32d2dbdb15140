//! Requests of the window to the physics, nested by receiver, and events of the physics for the
//! window.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Appearance, ControlNoise, Mode, SceneView};
use crate::id::{ActuatorId, BodyId, EqualityId, HeightFieldId, JointId, KeyframeId, MeshId, TextureId};
use crate::model::{Model, Options, Relation};
use crate::scene::{MouseAction, PerturbationFlags};
use crate::viewer::endpoint::Watch;
use crate::viewer::input::KeyPress;

/// Request of the window to the physics. Ids of a model that was replaced in the meantime are
/// ignored.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Request {
    /// Pauses (`true`) or resumes (`false`) the simulation.
    Pause(bool),
    TogglePause,
    /// Restores the start state; in the trajectory mode, shows the first record.
    Reset,
    /// For the viewer's own simulation. A program that steps its simulation itself rejects it.
    Simulation(SimulationRequest),
    /// For the playback of trajectories.
    Playback(PlaybackRequest),
    /// For any simulation.
    Endpoint(EndpointRequest),
}

/// Request to the simulation that the viewer steps itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SimulationRequest {
    /// Takes this number of steps, backwards if negative. Ignored unless paused.
    Step(i32),
    /// Switches between real time and the speed factor.
    ToggleSpeed,
    /// Doubles the speed factor and applies it.
    Faster,
    /// Halves the speed factor and applies it.
    Slower,
    /// Sets the speed factor and applies it.
    SetSpeed(f64),
    /// Advances by this number of modes, cyclically.
    CycleMode(i32),
    /// Switches to a mode. Ignored if the mode is not available.
    SetMode(Mode),
    /// Sets the noise on the controls.
    SetNoise(ControlNoise),
    /// Pauses, and restores a state of the history: 0 is the oldest.
    Scrub(usize),
    /// Replaces the model.
    Load(SharedModel, Kept),
}

/// What a simulation keeps when its model is replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// Nothing: another file was loaded.
    Nothing,
    /// The camera and the selected body: the same file was loaded again. The simulation starts in
    /// its initial state.
    View,
    /// The view, and the state of what is in both models: the file was changed.
    State,
}

/// Request to the playback of trajectories. Ignored outside the trajectory mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PlaybackRequest {
    ToggleReverse,
    /// Advances by this number of trajectories, cyclically.
    CycleTrajectory(i32),
    SetTrajectory(usize),
    /// Shows this record of the trajectory.
    SetFrame(usize),
    ToggleBurst,
    ToggleDoppler,
    /// Adds to the number of records in a burst.
    ChangeBurstFactor(f64),
    /// Adds to the fading time constant of a burst.
    ChangeBurstGamma(f64),
}

/// Request that any simulation can execute, whether the viewer or the program steps it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum EndpointRequest {
    /// Sets the view to which the following requests refer.
    SetView(Box<SceneView>),
    /// Selects the body at a point of the window, or none if the point shows no body.
    Select(ViewportPoint),
    SelectBody(Option<BodyId>),
    /// Selects the parent of the selected body.
    SelectParent,
    /// Answered with [`Event::LookAt`].
    LookAt(ViewportPoint),
    /// Answered with [`Event::Track`].
    Track(ViewportPoint),
    /// Starts to pull or rotate the selected body.
    StartPerturbation(PerturbationFlags),
    /// Moves the target of the perturbation, in units of the image's height.
    MovePerturbation(MouseAction, [f64; 2]),
    StopPerturbation,
    /// Sets the control of an actuator with this number, counted from the actuator's first.
    SetControl(ActuatorId, usize, f64),
    /// Sets all controls to zero.
    ClearControls,
    /// Sets one element of a joint's position.
    SetPosition(JointId, usize, f64),
    /// Restores a keyframe of the model.
    LoadKey(KeyframeId),
    /// Captures the state as a keyframe. `None` generates a name.
    SaveKey(Option<String>),
    /// Restores the captured keyframe with this number.
    LoadCaptured(usize),
    /// Deletes the captured keyframe with this number.
    RemoveCaptured(usize),
    /// Answered with [`Event::Copied`].
    CopyState,
    /// Answered with [`Event::Copied`].
    CopyCamera,
    /// Enables or disables an equality constraint.
    SetEquality(EqualityId, bool),
    /// Sets the physics options.
    SetOptions(Box<Options>),
    /// Sets the appearance of the model.
    SetAppearance(Box<Appearance>),
    /// Writes a file about the model into a directory. Answered with a notice of the path.
    Save(SavedFile, PathBuf),
    /// Sets the parameter of a controller or a program with this name.
    SetParameter(Arc<str>, f64),
    /// Sets the watched values that the snapshots contain.
    Watch(Vec<Watch>),
    /// Forwards a key without a binding to the program.
    ForwardKey(KeyPress),
}

/// File that the user saves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SavedFile {
    /// The model as XML.
    Xml,
    /// The model in the engine's binary form.
    Binary,
    /// The engine's listing of the model.
    ModelText,
    /// The engine's listing of the simulation.
    DataText,
}

impl SavedFile {
    /// Returns the name of the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xml => "model.xml",
            Self::Binary => "model.mjb",
            Self::ModelText => "model.txt",
            Self::DataText => "data.txt",
        }
    }
}

/// Model that is compared by identity.
#[derive(Clone, Debug)]
pub(crate) struct SharedModel(pub Arc<Model>);

impl PartialEq for SharedModel {
    fn eq(&self, other: &Self) -> bool {
        self.0.relation(&other.0) == Relation::Same
    }
}

/// Point of the image: from 0 to 1, from the left and from the bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ViewportPoint {
    /// Width of the image divided by its height.
    pub aspectratio: f64,
    pub position: [f64; 2],
}

impl From<SimulationRequest> for Request {
    fn from(request: SimulationRequest) -> Self {
        Self::Simulation(request)
    }
}

impl From<PlaybackRequest> for Request {
    fn from(request: PlaybackRequest) -> Self {
        Self::Playback(request)
    }
}

impl From<EndpointRequest> for Request {
    fn from(request: EndpointRequest) -> Self {
        Self::Endpoint(request)
    }
}

impl Request {
    /// Returns `true` if this request can pause a running simulation of the viewer.
    pub fn pauses(&self) -> bool {
        matches!(self, Self::Pause(true) | Self::TogglePause | Self::Simulation(SimulationRequest::Scrub(_)))
    }

    /// Returns `true` if this request can pause or resume a program's simulation.
    pub fn changes_pause(&self) -> bool {
        matches!(self, Self::Pause(_) | Self::TogglePause)
    }

    /// Returns `true` if this request ends the perturbation of the selected body.
    pub fn ends_perturbation(&self) -> bool {
        use EndpointRequest::{Select, SelectBody, SelectParent, StartPerturbation, StopPerturbation};
        matches!(
            self,
            Self::Endpoint(StartPerturbation(_) | StopPerturbation | Select(_) | SelectBody(_) | SelectParent)
        )
    }

    /// Returns `true` if this request moves the target of the perturbation.
    pub fn moves_perturbation(&self) -> bool {
        matches!(self, Self::Endpoint(EndpointRequest::MovePerturbation(..)))
    }

    /// Returns `true` if the effect of this request depends on the poses that are computed from the
    /// state.
    pub fn reads_poses(&self) -> bool {
        use EndpointRequest::{CopyCamera, LookAt, MovePerturbation, Track};
        self.ends_perturbation()
            || matches!(self, Self::Endpoint(LookAt(_) | Track(_) | MovePerturbation(..) | CopyCamera))
    }

    /// Merges the next request into this request if a single request is equivalent to both, so that
    /// a slow loop executes fewer requests. Returns `false` if the two requests cannot be merged.
    pub fn merge(&mut self, next: &Self) -> bool {
        use EndpointRequest::{MovePerturbation, SetControl, SetParameter, SetPosition};
        match (self, next) {
            (Self::Endpoint(request), Self::Endpoint(next)) => match (request, next) {
                (MovePerturbation(action, [x, y]), MovePerturbation(next, [dx, dy])) if action == next => {
                    (*x, *y) = (*x + dx, *y + dy);
                    true
                }
                (SetControl(id, number, value), SetControl(next, next_number, newer))
                    if (*id, *number) == (*next, *next_number) =>
                {
                    *value = *newer;
                    true
                }
                (SetParameter(name, value), SetParameter(next, newer)) if name == next => {
                    *value = *newer;
                    true
                }
                (SetPosition(id, part, value), SetPosition(next, next_part, newer))
                    if (*id, *part) == (*next, *next_part) =>
                {
                    *value = *newer;
                    true
                }
                _ => false,
            },
            (Self::Simulation(SimulationRequest::Scrub(index)), Self::Simulation(SimulationRequest::Scrub(newer)))
            | (Self::Playback(PlaybackRequest::SetFrame(index)), Self::Playback(PlaybackRequest::SetFrame(newer))) => {
                *index = *newer;
                true
            }
            _ => false,
        }
    }
}

/// Single message of the physics to the window. Continuous state is in the
/// [`Snapshot`](super::Snapshot).
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Event {
    /// Text for the clipboard.
    Copied(String),
    /// The camera must look at this point.
    LookAt([f64; 3]),
    /// The camera must track this body.
    Track(BodyId),
    /// The program has modified an asset of the model.
    Asset(Asset),
    /// Text to be shown for a few seconds.
    Notice(String),
    /// The program has set the camera and the scene options.
    View(Box<SceneView>),
}

impl Event {
    /// Returns `true` if the event does not refer to another model.
    pub(super) fn fits(&self, model: &Model) -> bool {
        let lineage = match self {
            Self::Track(body) => body.lineage(),
            Self::Asset(Asset::Texture(texture)) => texture.lineage(),
            Self::Asset(Asset::Mesh(mesh)) => mesh.lineage(),
            Self::Asset(Asset::HeightField(height_field)) => height_field.lineage(),
            Self::Copied(_) | Self::LookAt(_) | Self::Notice(_) | Self::View(_) => return true,
        };
        lineage == model.lineage()
    }
}

/// Part of a model of which the renderer keeps a copy on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asset {
    Texture(TextureId),
    Mesh(MeshId),
    HeightField(HeightFieldId),
}
