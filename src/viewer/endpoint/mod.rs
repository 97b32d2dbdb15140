//! Physics' side of the link: execution of the requests that any simulation supports, and
//! publication of snapshots.

mod keyframe;
mod publish;
mod request;
mod selection;
mod watch;

use std::sync::Arc;

pub(crate) use self::keyframe::CapturedKey;
pub(crate) use self::watch::Watch;
use super::input::KeyPress;
use super::instruments::Instruments;
use super::link::{Event, PhysicsEnd, SceneView, Snapshot};
use super::signal::Signals;
use crate::data::{Data, Stage, StateSpec, Warning};
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::model::Model;
use crate::scene::{Camera, CameraView, Perturbation, SceneOptions, Selection};

/// Connection of a simulation to its window.
pub(crate) struct SimulationEndpoint {
    pub link: Arc<PhysicsEnd>,
    pub instruments: Instruments,
    /// Model to which the other fields refer.
    model: Arc<Model>,
    generation: u64,
    number: u64,
    /// State that a reset restores.
    start: Vec<f64>,
    view: SceneView,
    camera: Camera,
    perturbation: Perturbation,
    /// The mouse has moved the target of the perturbation since the pose was last applied.
    dragged: bool,
    clicked: Option<Selection>,
    spare: Option<Box<Snapshot>>,
    captured: Arc<Vec<CapturedKey>>,
    /// Number of keyframes captured so far, including deleted keyframes.
    captures: usize,
    /// Signals since the last snapshot.
    signals: Signals,
    keys: Vec<KeyPress>,
    /// The user has been notified that the scene is full.
    scene_full_reported: bool,
    /// Engine warnings of which the user has been notified.
    warned: [bool; Warning::ALL.len()],
    /// Buffer of [`refresh`](Self::refresh).
    state: Vec<f64>,
}

impl SimulationEndpoint {
    /// Creates an endpoint for a simulation. A reset restores its current state.
    pub fn new(link: Arc<PhysicsEnd>, data: &Data) -> Self {
        let model = data.model().clone();
        Self {
            link,
            instruments: Instruments::default(),
            camera: Camera::free(&model),
            generation: 0,
            number: 0,
            start: data.state(StateSpec::INTEGRATION),
            view: SceneView::default(),
            perturbation: Perturbation::default(),
            dragged: false,
            clicked: None,
            spare: None,
            captured: Arc::default(),
            captures: 0,
            signals: Signals::default(),
            keys: Vec::new(),
            scene_full_reported: false,
            warned: [false; Warning::ALL.len()],
            state: Vec::new(),
            model,
        }
    }

    /// Returns `true` if the model of the simulation has the structure of the endpoint's model.
    pub fn is_for(&self, data: &Data) -> bool {
        self.model.is_same_structure(data.model())
    }

    /// Adopts the model of a simulation after it was edited or replaced.
    pub fn adopt(&mut self, data: &Data) {
        let model = data.model();
        if !self.is_for(data) {
            self.generation += 1;
            self.start = data.state(StateSpec::INTEGRATION);
            self.camera = Camera::free(model);
            self.view.camera = None;
            self.perturbation = Perturbation::default();
            (self.clicked, self.dragged, self.scene_full_reported) = (None, false, false);
            // The spare snapshot has a scene of the old model.
            self.spare = None;
            self.captured = Arc::default();
            self.signals.adopt(model);
        }
        self.model = model.clone();
    }

    /// Adopts the model of a simulation after its file was loaded again. Keeps the camera, and the
    /// selected body if there is still one with its name. A reset restores the state of `initial`.
    pub fn adopt_edited(&mut self, data: &Data, initial: &Data) {
        let (old, camera) = (self.model.clone(), self.camera);
        let (select, localpos, clicked) = (self.perturbation.select, self.perturbation.localpos, self.clicked);
        self.adopt(data);
        let new = data.model();
        let same_body = |id: BodyId| Some(new.body(old.name(id)?).ok()?.id());
        let view = match camera.view {
            CameraView::Fixed(id) => {
                old.name(id).and_then(|name| new.camera(name).ok()).map(|camera| CameraView::Fixed(camera.id()))
            }
            CameraView::Tracking(id) => same_body(id).map(CameraView::Tracking),
            CameraView::Free | CameraView::User => Some(camera.view),
        };
        self.camera = Camera { view: view.unwrap_or(CameraView::Free), ..camera };
        if let Some(body) = select.and_then(same_body) {
            self.perturbation = Perturbation::default();
            (self.perturbation.select, self.perturbation.localpos) = (Some(body), localpos);
            self.clicked = clicked.map(|clicked| Selection {
                body,
                geom: clicked.geom.and_then(|geom| Some(new.geom(old.name(geom)?).ok()?.id())),
                skin: None,
                flex: None,
                point: clicked.point,
            });
        }
        self.start = initial.state(StateSpec::INTEGRATION);
    }

    /// Ends the pull at a body.
    pub fn end_perturbation(&mut self, data: &mut Data) {
        self.perturbation.remove_force(data);
    }

    /// Restores the start state.
    pub fn reset(&mut self, data: &mut Data) -> Result<()> {
        data.reset()?;
        data.set_state(StateSpec::INTEGRATION, &self.start)?;
        self.refresh(data)
    }

    /// Clears the controls, and restores the applied forces of the start state.
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

    /// Recomputes the quantities that depend on the state, and leaves the state unchanged bit for
    /// bit.
    pub fn refresh(&mut self, data: &mut Data) -> Result<()> {
        data.forward_between_steps(&mut self.state)
    }

    /// Adds the current values of the simulation to its signals.
    pub fn sample(&mut self, data: &Data) {
        self.signals.sample(data);
    }

    /// Calls [`refresh`](Self::refresh) if quantities that the scene shows have not been computed.
    pub fn refresh_if_needed(&mut self, data: &mut Data) -> Result<()> {
        let needs = if self.view.options.shows_contacts() { Stage::Acceleration } else { Stage::Position };
        if data.stage() < needs { self.refresh(data) } else { Ok(()) }
    }

    /// Adopts the newest view of the window. Returns `true` if it has changed.
    pub fn update_view(&mut self) -> bool {
        let Some(view) = self.link.take_view() else { return false };
        self.adopt_view(view);
        true
    }

    fn adopt_view(&mut self, view: SceneView) {
        self.view = view;
        let Some(camera) = self.view.camera else { return };
        if self.is_of_model(&camera) {
            // A tracking camera has moved further here than in the window's copy.
            let follows = matches!(camera.view, CameraView::Tracking(_)) && camera.view == self.camera.view;
            let lookat = if follows { self.camera.lookat } else { camera.lookat };
            self.camera = Camera { lookat, ..camera };
        }
    }

    /// Returns the current camera.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// Returns the current scene options.
    pub fn options(&self) -> &SceneOptions {
        &self.view.options
    }

    /// Sets the camera and the scene options that the program has changed, in the window too.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if the camera belongs to another model. The window keeps its camera.
    pub fn set_view(&mut self, camera: Option<Camera>, options: Option<SceneOptions>) -> Result<()> {
        let is_foreign = camera.is_some_and(|camera| !self.is_of_model(&camera));
        let camera = camera.filter(|_| !is_foreign);
        if camera.is_some() || options.is_some() {
            // The window's newest view is older.
            self.update_view();
            self.camera = camera.unwrap_or(self.camera);
            self.view.camera = Some(self.camera);
            if let Some(options) = options {
                self.view.options = options;
            }
            self.link.send(Event::View(Box::new(self.view.clone())));
        }
        if is_foreign { Err(Error::OtherModel { what: "the camera for the viewer" }) } else { Ok(()) }
    }

    /// Returns `true` if the camera does not refer to another model.
    fn is_of_model(&self, camera: &Camera) -> bool {
        match camera.view {
            CameraView::Fixed(id) => !self.is_stale(id),
            CameraView::Tracking(id) => !self.is_stale(id),
            CameraView::Free | CameraView::User => true,
        }
    }

    /// Returns the selected body.
    pub fn selected_body(&self) -> Option<BodyId> {
        self.perturbation.select
    }

    /// Removes the key presses without a binding.
    pub fn take_keys(&mut self) -> Vec<KeyPress> {
        std::mem::take(&mut self.keys)
    }
}
