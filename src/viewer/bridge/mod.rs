//! The physics' side of the link: what any simulation can do for the window, whoever steps it.
//!
//! | file | what is in it |
//! |---|---|
//! | `request.rs` | requests done |
//! | `selection.rs` | what is selected, pulled, looked at |
//! | `publish.rs` | snapshots made |

mod publish;
mod request;
mod selection;

use std::sync::Arc;

pub(crate) use self::request::Outcome;
use super::capture::CapturedKey;
use super::event::Event;
use super::input::KeyPress;
use super::link::{Back, Look};
use super::snapshot::Snapshot;
use super::watch::Watch;
use crate::data::{Data, Stage, StateSpec, Warning};
use crate::error::Result;
use crate::id::BodyId;
use crate::model::Model;
use crate::scene::{Camera, CameraView, Perturbation, Selection};

/// The physics' side of the link.
pub(crate) struct Bridge {
    pub back: Back,
    /// The model that all this is for.
    model: Arc<Model>,
    generation: u64,
    number: u64,
    /// The state that a reset returns to.
    start: Vec<f64>,
    look: Look,
    camera: Camera,
    perturbation: Perturbation,
    /// Whether the mouse has moved a pose since it was last set.
    dragged: bool,
    clicked: Option<Selection>,
    spare: Option<Box<Snapshot>>,
    captured: Arc<Vec<CapturedKey>>,
    /// How many states were ever kept.
    kept: usize,
    watches: Vec<Watch>,
    keys: Vec<KeyPress>,
    /// Whether it was told that there are more geoms than there is room for.
    told_full: bool,
    /// Which of the engine's warnings were told.
    warned: [bool; Warning::ALL.len()],
    /// Memory for [`refresh`](Self::refresh).
    state: Vec<f64>,
}

impl Bridge {
    /// For a simulation in the state that a reset is to return to.
    pub fn new(back: Back, data: &Data) -> Self {
        let model = data.model().clone();
        Self {
            back,
            camera: Camera::free(&model),
            generation: 0,
            number: 0,
            start: data.state(StateSpec::INTEGRATION),
            look: Look::default(),
            perturbation: Perturbation::default(),
            dragged: false,
            clicked: None,
            spare: None,
            captured: Arc::default(),
            kept: 0,
            watches: Vec::new(),
            keys: Vec::new(),
            told_full: false,
            warned: [false; Warning::ALL.len()],
            state: Vec::new(),
            model,
        }
    }

    /// Whether a simulation is of the model that all this is for.
    pub fn is_for(&self, data: &Data) -> bool {
        self.model.is_same_structure(data.model())
    }

    /// Takes over a simulation of another model, or of one that was edited.
    pub fn adopt(&mut self, data: &Data) {
        let model = data.model();
        if !self.is_for(data) {
            self.generation += 1;
            self.start = data.state(StateSpec::INTEGRATION);
            self.camera = Camera::free(model);
            self.look.camera = None;
            self.perturbation = Perturbation::default();
            (self.clicked, self.dragged, self.told_full) = (None, false, false);
            // Its scene is of the other model.
            self.spare = None;
            self.captured = Arc::default();
        }
        if !Arc::ptr_eq(&self.model, model) {
            self.model = model.clone();
        }
    }

    /// Sets the simulation to the state that it started from.
    pub fn reset(&mut self, data: &mut Data) -> Result<()> {
        data.reset()?;
        data.set_state(StateSpec::INTEGRATION, &self.start)?;
        self.refresh(data)
    }

    /// Takes the controls away, and what was applied since the start.
    pub fn clear_inputs(&mut self, data: &mut Data) -> Result<()> {
        const APPLIED: StateSpec = StateSpec::QFRC_APPLIED.union(StateSpec::XFRC_APPLIED);
        self.perturbation.remove_force(data);
        let model = data.model().clone();
        let before = model.state_size(
            StateSpec::TIME
                | StateSpec::QPOS
                | StateSpec::QVEL
                | StateSpec::ACT
                | StateSpec::WARMSTART
                | StateSpec::CTRL,
        );
        data.ctrl_mut().fill(0.0);
        data.set_state(APPLIED, &self.start[before..before + model.state_size(APPLIED)])
    }

    /// Brings what depends on the state up to date, and leaves the state itself as it is, bit for bit: forward dynamics would
    /// change what the solver starts from, and the last bits of quaternions.
    pub fn refresh(&mut self, data: &mut Data) -> Result<()> {
        self.state.resize(data.model().state_size(StateSpec::INTEGRATION), 0.0);
        data.state_into(StateSpec::INTEGRATION, &mut self.state)?;
        let result = data.forward();
        data.set_state(StateSpec::INTEGRATION, &self.state)?;
        result
    }

    /// The same, where what is shown has not been computed at all.
    pub fn refresh_if_needed(&mut self, data: &mut Data) -> Result<()> {
        let needs = if self.look.options.shows_contacts() { Stage::Acceleration } else { Stage::Position };
        if data.stage() < needs { self.refresh(data) } else { Ok(()) }
    }

    /// Takes over the newest view of the window. Returns whether it has changed.
    pub fn take_look(&mut self) -> bool {
        let Some(look) = self.back.look() else { return false };
        self.set_window_look(look);
        true
    }

    /// Takes over a view of the window.
    fn set_window_look(&mut self, look: Look) {
        self.look = look;
        let Some(camera) = self.look.camera else { return };
        if self.knows(&camera) {
            // A camera that follows a body has come further than the window knows.
            let follows = matches!(camera.view, CameraView::Tracking(_)) && camera.view == self.camera.view;
            let lookat = if follows { self.camera.lookat } else { camera.lookat };
            self.camera = Camera { lookat, ..camera };
        }
    }

    /// From where and at what is looked.
    pub fn present_look(&self) -> Look {
        Look { camera: Some(self.camera), options: self.look.options.clone() }
    }

    /// Sets from where and at what is looked, in the window too.
    ///
    /// # Panics
    ///
    /// If the camera is of another model.
    pub fn set_look(&mut self, look: Look) {
        if let Some(camera) = look.camera {
            assert!(self.knows(&camera), "the camera of the viewer is one of another model than the simulation");
            self.camera = camera;
        }
        // What the window has said meanwhile comes too late.
        let _ = self.back.look();
        self.look = look;
        self.back.tell(Event::View(Box::new(self.present_look())));
    }

    /// Whether a camera is none of another model.
    fn knows(&self, camera: &Camera) -> bool {
        match camera.view {
            CameraView::Fixed(id) => !self.is_stale(id),
            CameraView::Tracking(id) => !self.is_stale(id),
            CameraView::Free | CameraView::User => true,
        }
    }

    /// The body that is selected.
    pub fn selected_body(&self) -> Option<BodyId> {
        self.perturbation.select
    }

    /// The keys that the viewer has no use for.
    pub fn take_keys(&mut self) -> Vec<KeyPress> {
        std::mem::take(&mut self.keys)
    }
}
