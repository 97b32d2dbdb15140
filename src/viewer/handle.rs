//! For programs that have a loop of their own.

use std::fmt;
use std::time::{Duration, Instant};

use super::bridge::{Bridge, Outcome};
use super::clock::Meter;
use super::event::{Asset, Event};
use super::input::KeyPress;
use super::link::{Back, Look};
use super::mode::Mode;
use super::request::Request;
use super::snapshot::{Pace, Snapshot, Status};
use crate::data::Data;
use crate::error::Result;
use crate::id::{BodyId, HeightFieldId, MeshId, TextureId};
use crate::scene::{Camera, NewGeom, Scene, SceneOptions};

/// A window that a program shows its simulation in, from a loop of its own.
///
/// The program owns the [`Data`] and steps it. [`sync`](Self::sync) shows how it stands and does to it what the user has asked
/// for in the window: pulling bodies, setting controls and joints, resetting it to the state in which the window saw it first.
/// Pausing and the keys that the viewer has no use for are told to the program, which may make of them what it likes.
///
/// The handle may go to another thread; it is no longer of use when the window is closed, and does no harm then.
pub struct Handle {
    /// Until the first look at a simulation there is only the link.
    back: Option<Back>,
    bridge: Option<Bridge>,
    geoms: Vec<NewGeom>,
    /// What was changed since the last look.
    assets: Vec<Asset>,
    paused: bool,
    /// What the program has set before the first look at a simulation.
    look: Option<Look>,
    epoch: Instant,
    meter: Meter,
    /// The simulated time at the last look.
    time: f64,
}

impl Handle {
    pub(crate) fn new(back: Back) -> Self {
        Self {
            back: Some(back),
            bridge: None,
            geoms: Vec::new(),
            assets: Vec::new(),
            paused: false,
            look: None,
            epoch: Instant::now(),
            meter: Meter::default(),
            time: 0.0,
        }
    }

    /// Whether the window is open. `false` once the user has closed it, or [`close`](Self::close) was called.
    pub fn is_running(&self) -> bool {
        !self.link().is_closed()
    }

    /// Closes the window.
    pub fn close(&mut self) {
        self.link().close();
    }

    /// Shows the simulation as it stands, and does to it what was asked for in the window. Call it once for each picture, or after
    /// each step: it takes some microseconds.
    ///
    /// While a body is pulled, the force is among its [`xfrc_applied`](Data::xfrc_applied) until the next call, added to what the
    /// program applies. A simulation in which nothing was computed yet is brought up to date with [`Data::forward`], and so is one
    /// whose state was changed from the window. One that has failed is shown as it was before; the user can reset it.
    ///
    /// It may be another simulation than at the last call, of another model too.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) for a geom of the program's that cannot be shown,
    /// [`Error::Engine`](crate::Error::Engine) or [`Error::OutOfMemory`](crate::Error::OutOfMemory) if there is no memory for the
    /// picture. What the user asked for and cannot be done is told to the user, and is no error here.
    ///
    /// # Panics
    ///
    /// If a mesh, a height field or a texture of a geom of the program's belongs to another model.
    pub fn sync(&mut self, data: &mut Data) -> Result<()> {
        let mut bridge = match (self.bridge.take(), self.back.take()) {
            (Some(bridge), _) => bridge,
            (None, Some(back)) => Bridge::new(back, data),
            (None, None) => unreachable!("Bug: a handle without a link"),
        };
        bridge.adopt(data);
        if let Some(look) = self.look.take() {
            bridge.set_look(look);
        }
        if bridge.back.is_closed() {
            // Nobody pulls any more, and nobody could let it go on.
            bridge.stop_perturbation(data);
            self.paused = false;
            self.bridge = Some(bridge);
            return Ok(());
        }
        let mut changed = false;
        // The program sees what one request begins before the next one ends it: requests of the second kind wait in the queue.
        let (was_paused, mut pulled) = (self.paused, false);
        while let Some(request) = bridge.back.next_if(|next| {
            let unseen_pause = self.paused != was_paused && next.changes_pause();
            !(unseen_pause || (pulled && next.ends_pull()))
        }) {
            if changed && request.reads_poses() {
                changed = bridge.refresh(data).is_err();
            }
            pulled |= matches!(request, Request::MovePerturbation(..)) && !self.paused && bridge.is_pulling();
            changed |= self.execute(request, &mut bridge, data);
        }
        let told = if data.check_usable().is_ok() { self.pull(&mut bridge, data, changed) } else { Ok(()) };

        let now = self.epoch.elapsed();
        self.meter.add((data.time() - self.time).max(0.0), now);
        self.time = data.time();
        let problem = data.check_usable().err().or(told.err()).map(|error| error.to_string());
        let status = if self.paused { Status::Paused } else { Status::Program };
        let pace = Pace { factor: 1.0, by_factor: false, measured: self.meter.measured(), dropped: 0.0 };
        let geoms = &self.geoms;
        let add = |scene: &mut Scene, _: &SceneOptions| geoms.iter().try_for_each(|geom| scene.push(geom).map(|_| ()));
        let published = bridge.publish(data, add, |snapshot: &mut Snapshot| {
            (snapshot.status, snapshot.pace) = (status, pace);
            snapshot.problem.clear();
            snapshot.problem.push_str(problem.as_deref().unwrap_or_default());
            snapshot.modes.clear();
            snapshot.mode = Mode::Passive;
            snapshot.info.clear();
        });
        // The snapshot that has the changed model is there.
        for asset in self.assets.drain(..) {
            bridge.back.tell(Event::Asset(asset));
        }
        self.bridge = Some(bridge);
        published
    }

    /// Whether the user wants the simulation to stand still, which a user who has closed the window does not. The program does not
    /// have to care:
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::Handle, data: &mut mujoco_safe::Data) -> mujoco_safe::Result<()> {
    /// use std::time::Duration;
    ///
    /// while handle.is_running() {
    ///     if handle.is_paused() {
    ///         handle.wait(Duration::from_millis(50));
    ///     } else {
    ///         data.step()?;
    ///     }
    ///     handle.sync(data)?;
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Says that the simulation stands still, or goes on, as if the user had.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// Waits until the user asks for something, moves the view or closes the window, but no longer than this.
    pub fn wait(&self, timeout: Duration) {
        self.link().wait(Instant::now().checked_add(timeout));
    }

    /// From where the window looks. `None` before the first [`sync`](Self::sync).
    pub fn camera(&self) -> Option<Camera> {
        self.bridge.as_ref().and_then(|bridge| bridge.present_look().camera)
    }

    /// Sets from where the window looks. The user may look elsewhere from there.
    ///
    /// # Panics
    ///
    /// At the next [`sync`](Self::sync), if the camera is one of another model, or follows a body of another one.
    pub fn set_camera(&mut self, camera: Camera) {
        let look = Look { camera: Some(camera), ..self.look() };
        self.set_look(look);
    }

    /// What the window shows.
    pub fn options(&self) -> SceneOptions {
        self.look().options
    }

    /// Sets what the window shows. The user may change it from there.
    pub fn set_options(&mut self, options: SceneOptions) {
        let look = Look { options, ..self.look() };
        self.set_look(look);
    }

    /// Geoms of the program's, which are shown with those of the model from the next [`sync`](Self::sync) on: goals, paths,
    /// arrows. They stay until they are taken out.
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::Handle) -> mujoco_safe::Result<()> {
    /// use mujoco_safe::scene::NewGeom;
    ///
    /// handle.geoms_mut().clear();
    /// handle.geoms_mut().push(NewGeom::sphere(0.05).pos([1.0, 0.0, 0.5]).label("goal")?);
    /// # Ok(())
    /// # }
    /// ```
    #[doc(alias = "user_scn")]
    pub fn geoms_mut(&mut self) -> &mut Vec<NewGeom> {
        &mut self.geoms
    }

    /// The keys that were pressed and that the viewer has no use for, since the last call. They arrive with
    /// [`sync`](Self::sync).
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::Handle, data: &mut mujoco_safe::Data) {
    /// use mujoco_safe::viewer::Key;
    ///
    /// for press in handle.keys() {
    ///     if press.key == Key::Home {
    ///         data.qvel_mut().fill(0.0);
    ///     }
    /// }
    /// # }
    /// ```
    #[doc(alias = "key_callback")]
    pub fn keys(&mut self) -> Vec<KeyPress> {
        self.bridge.as_mut().map(Bridge::take_keys).unwrap_or_default()
    }

    /// Says that a texture of the model was changed, so that it is drawn anew as the model has it that the next
    /// [`sync`](Self::sync) sees. One of another model is ignored.
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::Handle, data: &mut mujoco_safe::Data) -> mujoco_safe::Result<()> {
    /// let ground = data.model().height_field("ground")?.id();
    /// data.edit_model(|model| model.hfield_data_mut()[0] += 0.1)?;
    /// handle.update_height_field(ground);
    /// handle.sync(data)?;
    /// # Ok(())
    /// # }
    /// ```
    pub fn update_texture(&mut self, texture: TextureId) {
        self.assets.push(Asset::Texture(texture));
    }

    /// Says that a mesh of the model was changed, as [`update_texture`](Self::update_texture) does of a texture.
    pub fn update_mesh(&mut self, mesh: MeshId) {
        self.assets.push(Asset::Mesh(mesh));
    }

    /// Says that a height field of the model was changed, as [`update_texture`](Self::update_texture) does of a texture.
    pub fn update_height_field(&mut self, height_field: HeightFieldId) {
        self.assets.push(Asset::HeightField(height_field));
    }

    /// The body that the user has selected.
    pub fn selected(&self) -> Option<BodyId> {
        self.bridge.as_ref().and_then(Bridge::selected_body)
    }

    fn link(&self) -> &Back {
        let back = self.bridge.as_ref().map(|bridge| &bridge.back).or(self.back.as_ref());
        back.expect("Bug: a handle without a link")
    }

    fn look(&self) -> Look {
        let present = || self.bridge.as_ref().map(Bridge::present_look);
        self.look.clone().or_else(present).unwrap_or_default()
    }

    fn set_look(&mut self, look: Look) {
        match &mut self.bridge {
            Some(bridge) => bridge.set_look(look),
            None => self.look = Some(look),
        }
    }

    /// Does what was asked for. Whether the simulation has changed is returned.
    fn execute(&mut self, request: Request, bridge: &mut Bridge, data: &mut Data) -> bool {
        match request {
            Request::Pause(paused) => self.paused = paused,
            Request::TogglePause => self.paused = !self.paused,
            other => match bridge.execute(other, data) {
                Ok(Outcome::Changed) => return true,
                Ok(Outcome::Done) => return self.paused && Self::drag(bridge, data),
                Ok(Outcome::Left) => {
                    bridge.back.tell(Event::Notice("the program has the simulation in its own hands".to_owned()));
                }
                Err(error) => bridge.back.tell(Event::Notice(error.to_string())),
            },
        }
        false
    }

    /// Moves the selected body to the pose that the mouse has dragged it to. Returns whether the simulation has changed.
    fn drag(bridge: &mut Bridge, data: &mut Data) -> bool {
        bridge.drag(data).unwrap_or_else(|error| {
            bridge.back.tell(Event::Notice(error.to_string()));
            false
        })
    }

    /// Moves or pulls the body that is dragged, and brings a simulation up to date that has changed.
    fn pull(&self, bridge: &mut Bridge, data: &mut Data, changed: bool) -> Result<()> {
        if self.paused {
            bridge.remove_perturbation(data);
            let dragged = bridge.drag(data)?;
            return if dragged || changed { bridge.refresh(data) } else { Ok(()) };
        }
        if changed {
            bridge.refresh(data)?;
        }
        bridge.apply_perturbation(data)
    }
}

impl fmt::Debug for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Handle")
            .field("is_running", &self.is_running())
            .field("is_paused", &self.paused)
            .finish_non_exhaustive()
    }
}
