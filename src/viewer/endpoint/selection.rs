//! Selection and perturbation of bodies with the mouse.

use super::SimulationEndpoint;
use super::keyframe::camera_xml;
use super::publish::make_orthographic;
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::scene::{Categories, MouseAction, MovableBodies, PerturbationFlags, Scene, Selection};
use crate::viewer::link::{Event, ViewportPoint};

impl SimulationEndpoint {
    pub(super) fn select(&mut self, point: ViewportPoint, data: &mut Data) -> Result<()> {
        self.stop_perturbation(data);
        match self.pick(point, data)? {
            Some(found) => {
                self.perturbation.select(data, &found)?;
                self.clicked = Some(found);
            }
            None => self.unselect(),
        }
        Ok(())
    }

    pub(super) fn select_body(&mut self, body: Option<BodyId>, data: &mut Data) -> Result<()> {
        self.stop_perturbation(data);
        match body {
            Some(body) if self.is_stale(body) => {}
            Some(body) => {
                self.refresh_if_needed(data)?;
                let point = data.xpos()[body.index()];
                let found = Selection { body, geom: None, skin: None, flex: None, point };
                self.perturbation.select(data, &found)?;
                self.clicked = Some(found);
            }
            None => self.unselect(),
        }
        Ok(())
    }

    pub(super) fn select_parent(&mut self, data: &mut Data) -> Result<()> {
        let Some(body) = self.perturbation.select else { return Ok(()) };
        let parent = data.model().body(body).parent();
        self.select_body(Some(parent), data)
    }

    fn unselect(&mut self) {
        self.perturbation.unselect();
        self.clicked = None;
    }

    pub(super) fn look_at(&mut self, point: ViewportPoint, data: &mut Data) -> Result<()> {
        if let Some(found) = self.pick(point, data)? {
            self.link.send(Event::LookAt(found.point));
        }
        Ok(())
    }

    /// Makes the window track the body at a point. The world is not tracked, because it does not
    /// move.
    pub(super) fn track(&mut self, point: ViewportPoint, data: &mut Data) -> Result<()> {
        if let Some(found) = self.pick(point, data)?.filter(|found| found.body.index() > 0) {
            self.link.send(Event::Track(found.body));
        }
        Ok(())
    }

    pub(super) fn start_perturbation(&mut self, flags: PerturbationFlags, data: &mut Data) -> Result<()> {
        if self.perturbation.select.is_none_or(|body| body.index() == 0) {
            return Ok(());
        }
        let mut perturbation = self.perturbation.clone();
        self.with_scene(data, |scene, data| perturbation.start(data, scene))?;
        perturbation.active = flags;
        self.perturbation = perturbation;
        self.dragged = false;
        Ok(())
    }

    pub(super) fn move_perturbation(&mut self, action: MouseAction, motion: [f64; 2], data: &mut Data) -> Result<()> {
        if self.perturbation.active.is_empty() {
            return Ok(());
        }
        let mut perturbation = self.perturbation.clone();
        self.with_scene(data, |scene, data| perturbation.move_by(data, action, motion, scene))?;
        self.perturbation = perturbation;
        self.dragged = true;
        Ok(())
    }

    /// Returns `true` while the selected body is pulled or rotated.
    pub fn is_perturbing(&self) -> bool {
        !self.perturbation.active.is_empty()
    }

    pub fn stop_perturbation(&mut self, data: &mut Data) {
        self.perturbation.stop();
        self.perturbation.remove_force(data);
    }

    /// Applies the perturbation before a step: sets the pose of a mocap body, and adds a force to
    /// any other body.
    pub fn apply_perturbation(&mut self, data: &mut Data) -> Result<()> {
        if self.perturbation.active.is_empty() {
            return Ok(());
        }
        if data.stage() < Stage::Velocity {
            self.refresh(data)?;
        }
        self.perturbation.apply_pose(data, MovableBodies::Mocap)?;
        self.perturbation.apply_force(data)
    }

    /// Removes the force of the perturbation after a step.
    pub fn remove_perturbation(&mut self, data: &mut Data) {
        self.perturbation.remove_force(data);
    }

    /// Sets the pose of the dragged body while paused. Returns `true` if the pose has changed.
    pub fn drag(&mut self, data: &mut Data) -> Result<bool> {
        if self.perturbation.active.is_empty() || !std::mem::take(&mut self.dragged) {
            return Ok(false);
        }
        self.refresh_if_needed(data)?;
        self.perturbation.apply_pose(data, MovableBodies::MocapAndFree)?;
        Ok(true)
    }

    pub(super) fn copy_camera(&mut self, data: &mut Data) -> Result<()> {
        let head = self.with_scene(data, |scene, _| scene.camera_in_model())?;
        self.link.send(Event::Copied(camera_xml(&head)));
        Ok(())
    }

    /// Returns the body, geom or skin at a point of the window.
    fn pick(&mut self, point: ViewportPoint, data: &mut Data) -> Result<Option<Selection>> {
        let options = self.view.options.clone();
        let (view, camera) = (self.view.clone(), self.camera);
        self.with_scene(data, |scene, data| {
            make_orthographic(scene, &view, &camera)?;
            scene.select(data, &options, point.aspectratio, point.position)
        })
    }

    /// Calls a closure with a scene of the current state and view.
    fn with_scene<R>(&mut self, data: &mut Data, with: impl FnOnce(&mut Scene, &mut Data) -> Result<R>) -> Result<R> {
        self.refresh_if_needed(data)?;
        let mut snapshot = self.take_spare()?;
        // `update` moves a tracking camera, which only a published frame may do.
        let mut camera = self.camera;
        let options = &self.view.options;
        let updated = snapshot.scene.update(data, options, Some(&self.perturbation), &mut camera, Categories::all());
        let result = match updated {
            // A full scene lacks geoms, but its cameras are valid.
            Ok(()) | Err(Error::SceneFull { .. }) => with(&mut snapshot.scene, data),
            Err(error) => Err(error),
        };
        self.spare = Some(snapshot);
        result
    }
}
