//! What is selected, pulled, looked at.

use super::Bridge;
use super::request::Outcome;
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::scene::{Categories, MouseAction, PerturbationFlags, Scene, Selection};
use crate::viewer::capture::camera_xml;
use crate::viewer::event::Event;
use crate::viewer::request::Place;

impl Bridge {
    pub(super) fn select(&mut self, place: Place, data: &mut Data) -> Result<Outcome> {
        self.stop_perturbation(data);
        match self.find(place, data)? {
            Some(found) => {
                self.perturbation.select(data, &found)?;
                self.clicked = Some(found);
            }
            None => self.unselect(),
        }
        Ok(Outcome::Done)
    }

    pub(super) fn select_body(&mut self, body: Option<BodyId>, data: &mut Data) -> Result<Outcome> {
        self.stop_perturbation(data);
        match body {
            Some(body) if self.is_stale(body) => {}
            Some(body) => {
                self.refresh_if_needed(data)?;
                let point = data.xpos()[body.index()];
                let found = Selection { body, geom: None, skin: None, point };
                self.perturbation.select(data, &found)?;
                self.clicked = Some(found);
            }
            None => self.unselect(),
        }
        Ok(Outcome::Done)
    }

    pub(super) fn select_parent(&mut self, data: &mut Data) -> Result<Outcome> {
        let Some(body) = self.perturbation.select else { return Ok(Outcome::Done) };
        let parent = data.model().body(body).parent();
        self.select_body(Some(parent), data)
    }

    fn unselect(&mut self) {
        self.perturbation.unselect();
        self.clicked = None;
    }

    pub(super) fn look_at(&mut self, place: Place, data: &mut Data) -> Result<Outcome> {
        if let Some(found) = self.find(place, data)? {
            self.back.tell(Event::LookAt(found.point));
        }
        Ok(Outcome::Done)
    }

    /// The world does not move, so nothing follows it.
    pub(super) fn track(&mut self, place: Place, data: &mut Data) -> Result<Outcome> {
        if let Some(found) = self.find(place, data)?.filter(|found| found.body.index() > 0) {
            self.back.tell(Event::Track(found.body));
        }
        Ok(Outcome::Done)
    }

    pub(super) fn start_perturbation(&mut self, flags: PerturbationFlags, data: &mut Data) -> Result<Outcome> {
        if self.perturbation.select.is_none_or(|body| body.index() == 0) {
            return Ok(Outcome::Done);
        }
        let mut perturbation = self.perturbation.clone();
        self.with_scene(data, |scene, data| perturbation.init(data, scene))?;
        perturbation.active = flags;
        self.perturbation = perturbation;
        self.dragged = false;
        Ok(Outcome::Done)
    }

    pub(super) fn move_perturbation(
        &mut self,
        action: MouseAction,
        motion: [f64; 2],
        data: &mut Data,
    ) -> Result<Outcome> {
        if self.perturbation.active.is_empty() {
            return Ok(Outcome::Done);
        }
        let mut perturbation = self.perturbation.clone();
        self.with_scene(data, |scene, data| perturbation.move_by(data, scene, action, motion))?;
        self.perturbation = perturbation;
        self.dragged = true;
        Ok(Outcome::Done)
    }

    /// Whether the selected body is pulled or turned.
    pub fn is_pulling(&self) -> bool {
        !self.perturbation.active.is_empty()
    }

    pub fn stop_perturbation(&mut self, data: &mut Data) {
        self.perturbation.stop();
        self.perturbation.remove_force(data);
    }

    /// Before a step: puts a mocap body where it is dragged to, and pulls any other.
    pub fn apply_perturbation(&mut self, data: &mut Data) -> Result<()> {
        if self.perturbation.active.is_empty() {
            return Ok(());
        }
        if data.stage() < Stage::Velocity {
            self.refresh(data)?;
        }
        self.perturbation.apply_pose(data, false)?;
        self.perturbation.apply_force(data)
    }

    /// After it.
    pub fn remove_perturbation(&mut self, data: &mut Data) {
        self.perturbation.remove_force(data);
    }

    /// While paused: puts the body where it is dragged to. Whether there was anything to do is returned.
    pub fn drag(&mut self, data: &mut Data) -> Result<bool> {
        if self.perturbation.active.is_empty() || !std::mem::take(&mut self.dragged) {
            return Ok(false);
        }
        self.refresh_if_needed(data)?;
        self.perturbation.apply_pose(data, true)?;
        Ok(true)
    }

    pub(super) fn copy_camera(&mut self, data: &mut Data) -> Result<Outcome> {
        let head = self.with_scene(data, |scene, _| scene.camera_in_model())?;
        self.back.tell(Event::Copied(camera_xml(&head)));
        Ok(Outcome::Done)
    }

    /// What is seen at a place.
    fn find(&mut self, place: Place, data: &mut Data) -> Result<Option<Selection>> {
        let options = self.look.options.clone();
        self.with_scene(data, |scene, data| scene.select(data, &options, place.aspectratio, place.at))
    }

    /// Lends a scene that shows the simulation as it is, from where the window looks.
    fn with_scene<R>(&mut self, data: &mut Data, with: impl FnOnce(&Scene, &Data) -> Result<R>) -> Result<R> {
        self.refresh_if_needed(data)?;
        let mut snapshot = self.take_spare()?;
        // A camera that follows comes nearer with each picture, and this is none.
        let mut camera = self.camera;
        let options = &self.look.options;
        let updated = snapshot.scene.update(data, options, Some(&self.perturbation), &mut camera, Categories::all());
        let result = match updated {
            // What there is no room for is not drawn, but there all the same.
            Ok(()) | Err(Error::SceneFull { .. }) => with(&snapshot.scene, data),
            Err(error) => Err(error),
        };
        self.spare = Some(snapshot);
        result
    }
}
