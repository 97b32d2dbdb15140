//! Handle of a window for programs that step their simulation themselves.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::endpoint::SimulationEndpoint;
use super::input::KeyPress;
use super::instruments::Instruments;
use super::link::{Asset, Event, Mode, PhysicsEnd, Request, SimulationSpeed, Snapshot, Status};
use super::simulation::SpeedMeter;
use crate::data::Data;
use crate::error::Result;
use crate::id::{BodyId, HeightFieldId, MeshId, TextureId};
use crate::scene::{Camera, NewGeom, Scene, SceneOptions};

/// Handle of a window for a program that steps its simulation itself.
///
/// The program owns the [`Data`]. [`sync`](Self::sync) shows its current state and executes the
/// user's requests on it: pulling bodies, setting controls and joints, resetting it to the state of
/// the first call. The program decides how to react to a pause and to keys that the viewer does not
/// use.
///
/// The handle can move to another thread. After the window was closed, its methods have no effect.
pub struct ViewerHandle {
    link: Arc<PhysicsEnd>,
    /// `None` before the first call of `sync`, which brings the model.
    endpoint: Option<SimulationEndpoint>,
    geoms: Vec<NewGeom>,
    instruments: Instruments,
    /// Assets that were modified since the last call of `sync`.
    assets: Vec<Asset>,
    paused: bool,
    /// Camera and options that the program has set since the last call of `sync`.
    camera: Option<Camera>,
    options: Option<SceneOptions>,
    epoch: Instant,
    meter: SpeedMeter,
    /// Simulated time of the last call of `sync`.
    time: f64,
}

impl ViewerHandle {
    pub(crate) fn new(link: PhysicsEnd) -> Self {
        Self {
            link: Arc::new(link),
            endpoint: None,
            geoms: Vec::new(),
            instruments: Instruments::default(),
            assets: Vec::new(),
            paused: false,
            camera: None,
            options: None,
            epoch: Instant::now(),
            meter: SpeedMeter::default(),
            time: 0.0,
        }
    }

    /// Returns `true` while the window is open: until the user closes it or the program calls
    /// [`close`](Self::close).
    pub fn is_running(&self) -> bool {
        !self.link.is_closed()
    }

    /// Closes the window.
    pub fn close(&mut self) {
        self.link.close();
    }

    /// Shows the current state of the simulation, and executes the user's requests on it. Call it
    /// once per frame or after each step; a call takes a few microseconds.
    ///
    /// While the user pulls a body, [`xfrc_applied`](Data::xfrc_applied) contains the force until
    /// the next call, added to the program's own forces. [`Data::forward`] is called if the poses
    /// have not been computed or if a request has changed the state. If the data is unusable, the
    /// scene does not change; the user can reset the data.
    ///
    /// The data may differ from the data of the last call and may belong to another model.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) for an invalid geom of the program,
    /// [`Error::Engine`](crate::Error::Engine) or [`Error::OutOfMemory`](crate::Error::OutOfMemory)
    /// if there is no memory for the scene, and [`Error::OtherModel`](crate::Error::OtherModel) if
    /// the camera that the program has set, or the body that it tracks, belongs to another model.
    /// The window keeps its camera then, and shows the simulation. Failed requests of the user are
    /// not errors; the window reports them.
    ///
    /// # Panics
    ///
    /// If a mesh, a height field or a texture of a geom of the program belongs to another model.
    pub fn sync(&mut self, data: &mut Data) -> Result<()> {
        let endpoint = self.endpoint.get_or_insert_with(|| {
            let mut endpoint = SimulationEndpoint::new(self.link.clone(), data);
            endpoint.instruments = std::mem::take(&mut self.instruments);
            endpoint
        });
        endpoint.adopt(data);
        if endpoint.link.is_closed() {
            // The user can no longer end a pull or a pause.
            endpoint.stop_perturbation(data);
            self.paused = false;
            return Ok(());
        }
        let viewed = endpoint.set_view(self.camera.take(), self.options.take());
        let mut changed = false;
        // A request that ends a pause or a pull stays in the queue until the program has seen the
        // pause or the pull.
        let (was_paused, mut pulled) = (self.paused, false);
        while let Some(request) = endpoint.link.next_if(|next| {
            let unseen_pause = self.paused != was_paused && next.changes_pause();
            !(unseen_pause || (pulled && next.ends_perturbation()))
        }) {
            if changed && request.reads_poses() {
                changed = endpoint.refresh(data).is_err();
            }
            pulled |= request.moves_perturbation() && !self.paused && endpoint.is_perturbing();
            changed |= execute(request, &mut self.paused, endpoint, data);
        }
        let perturbed =
            if data.check_usable().is_ok() { perturb(self.paused, endpoint, data, changed) } else { Ok(()) };

        let now = self.epoch.elapsed();
        self.meter.add((data.time() - self.time).max(0.0), now);
        self.time = data.time();
        let problem = data.check_usable().err().or(perturbed.err()).map(|error| error.to_string());
        let status = if self.paused { Status::Paused } else { Status::Program };
        let speed = SimulationSpeed { factor: 1.0, by_factor: false, measured: self.meter.measured(), dropped: 0.0 };
        let geoms = &self.geoms;
        let add =
            |scene: &mut Scene, _: &SceneOptions| geoms.iter().try_for_each(|geom| scene.add_geom(geom).map(|_| ()));
        let published = endpoint.publish(data, add, |snapshot: &mut Snapshot| {
            (snapshot.status, snapshot.speed) = (status, speed);
            snapshot.problem.clear();
            snapshot.problem.push_str(problem.as_deref().unwrap_or_default());
            snapshot.modes.clear();
            snapshot.mode = Mode::Passive;
            snapshot.info.clear();
        });
        // The window needs the snapshot with the modified model before these events.
        for asset in self.assets.drain(..) {
            endpoint.link.send(Event::Asset(asset));
        }
        published.and(viewed)
    }

    /// Returns `true` if the user has paused the simulation, and `false` after the window was
    /// closed. The program may ignore the pause:
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::ViewerHandle, data: &mut mujoco_safe::Data) -> mujoco_safe::Result<()> {
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

    /// Pauses or resumes the simulation on behalf of the user.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// Blocks until the user makes a request, changes the view or closes the window, or the timeout
    /// passes.
    pub fn wait(&self, timeout: Duration) {
        self.link.wait(Instant::now().checked_add(timeout));
    }

    /// Returns the camera of the window. `None` before the first [`sync`](Self::sync), unless the
    /// program has set it.
    pub fn camera(&self) -> Option<Camera> {
        self.camera.or_else(|| self.endpoint.as_ref().map(SimulationEndpoint::camera))
    }

    /// Sets the camera of the window from the next [`sync`](Self::sync) on, which returns
    /// [`Error::OtherModel`](crate::Error::OtherModel) if the camera belongs to another model. The
    /// user may move it afterwards.
    pub fn set_camera(&mut self, camera: Camera) {
        self.camera = Some(camera);
    }

    /// Returns the scene options of the window.
    pub fn options(&self) -> SceneOptions {
        let present = || self.endpoint.as_ref().map(|endpoint| endpoint.options().clone());
        self.options.clone().or_else(present).unwrap_or_default()
    }

    /// Sets the scene options of the window from the next [`sync`](Self::sync) on. The user may
    /// change them afterwards.
    pub fn set_options(&mut self, options: SceneOptions) {
        self.options = Some(options);
    }

    /// Returns the program's geoms, which the window shows in addition to the model from the next
    /// [`sync`](Self::sync) on, such as goals, paths and arrows. They stay until the program
    /// removes them.
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::ViewerHandle) -> mujoco_safe::Result<()> {
    /// use mujoco_safe::scene::NewGeom;
    ///
    /// handle.geoms_mut().clear();
    /// handle.geoms_mut().push(NewGeom::sphere(0.05).with_pos([1.0, 0.0, 0.5]).with_label("goal")?);
    /// # Ok(())
    /// # }
    /// ```
    #[doc(alias = "user_scn")]
    pub fn geoms_mut(&mut self) -> &mut Vec<NewGeom> {
        &mut self.geoms
    }

    /// Replaces the instruments in the window by those that a closure declares: plotted values,
    /// parameters with sliders, and geoms. They appear with the next [`sync`](Self::sync) and stay
    /// until the next call. A parameter receives the user's changes that arrived with the last
    /// `sync`.
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::ViewerHandle, data: &mut mujoco_safe::Data) -> mujoco_safe::Result<()> {
    /// let mut force = 0.1;
    /// while handle.is_running() {
    ///     handle.instruments(|instruments| {
    ///         instruments.parameter("force", &mut force, -1.0..=1.0);
    ///         instruments.value("speed, m/s", "cart", data.qvel()[0]);
    ///     });
    ///     data.ctrl_mut()[0] = force;
    ///     data.step()?;
    ///     handle.sync(data)?;
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub fn instruments<R>(&mut self, declare: impl FnOnce(&mut Instruments) -> R) -> R {
        let instruments = match &mut self.endpoint {
            Some(endpoint) => &mut endpoint.instruments,
            None => &mut self.instruments,
        };
        instruments.declare(declare)
    }

    /// Removes and returns the presses of keys for which the viewer has no binding, and of
    /// [released](crate::viewer::ViewerOptions::released_keys) keys. They arrive with
    /// [`sync`](Self::sync).
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::ViewerHandle, data: &mut mujoco_safe::Data) {
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
        self.endpoint.as_mut().map(SimulationEndpoint::take_keys).unwrap_or_default()
    }

    /// Uploads a modified texture of the model again, with the next [`sync`](Self::sync). A texture
    /// of another model is ignored.
    ///
    /// ```no_run
    /// # fn show(handle: &mut mujoco_safe::viewer::ViewerHandle, data: &mut mujoco_safe::Data) -> mujoco_safe::Result<()> {
    /// data.edit_model(|model| model.hfield_data_mut()[0] += 0.1)?;
    /// handle.update_height_field(data.model().height_field("ground")?);
    /// handle.sync(data)?;
    /// # Ok(())
    /// # }
    /// ```
    pub fn update_texture(&mut self, texture: impl Into<TextureId>) {
        self.assets.push(Asset::Texture(texture.into()));
    }

    /// Uploads a modified mesh of the model again, like [`update_texture`](Self::update_texture).
    pub fn update_mesh(&mut self, mesh: impl Into<MeshId>) {
        self.assets.push(Asset::Mesh(mesh.into()));
    }

    /// Uploads a modified height field of the model again, like
    /// [`update_texture`](Self::update_texture).
    pub fn update_height_field(&mut self, height_field: impl Into<HeightFieldId>) {
        self.assets.push(Asset::HeightField(height_field.into()));
    }

    /// Returns the body that the user has selected.
    pub fn selected(&self) -> Option<BodyId> {
        self.endpoint.as_ref().and_then(SimulationEndpoint::selected_body)
    }
}

/// Executes a request. Returns `true` if the simulation has changed.
fn execute(request: Request, paused: &mut bool, endpoint: &mut SimulationEndpoint, data: &mut Data) -> bool {
    let executed = match request {
        Request::Pause(pause) => {
            *paused = pause;
            return false;
        }
        Request::TogglePause => {
            *paused = !*paused;
            return false;
        }
        Request::Simulation(_) | Request::Playback(_) => {
            endpoint.link.send(Event::Notice("the program steps this simulation itself".to_owned()));
            return false;
        }
        Request::Reset => endpoint.reset(data).map(|()| true),
        Request::Endpoint(request) => endpoint.execute(request, data),
    };
    // While paused, a drag takes effect before the next request.
    let changed = match executed {
        Ok(false) if *paused => endpoint.drag(data),
        other => other,
    };
    changed.unwrap_or_else(|error| {
        endpoint.link.send(Event::Notice(error.to_string()));
        false
    })
}

/// Applies the perturbation, and recomputes the quantities that depend on the state if it has
/// changed.
fn perturb(paused: bool, endpoint: &mut SimulationEndpoint, data: &mut Data, changed: bool) -> Result<()> {
    if paused {
        endpoint.remove_perturbation(data);
        let dragged = endpoint.drag(data)?;
        return if dragged || changed { endpoint.refresh(data) } else { Ok(()) };
    }
    if changed {
        endpoint.refresh(data)?;
    }
    endpoint.apply_perturbation(data)
}

impl fmt::Debug for ViewerHandle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ViewerHandle")
            .field("is_running", &self.is_running())
            .field("is_paused", &self.paused)
            .finish_non_exhaustive()
    }
}
