//! Snapshots made.

use std::sync::Arc;

use super::Bridge;
use crate::data::{Data, Warning};
use crate::error::{Error, Result};
use crate::scene::{CameraView, Categories, Scene, SceneOptions};
use crate::viewer::event::Event;
use crate::viewer::snapshot::{Selected, Snapshot};

impl Bridge {
    /// Makes a snapshot of the simulation and hands it out. `add` adds to the scene, `fill` writes the rest: status, mode, pace.
    /// Of a data that has failed the numbers are shown, and the scene of before.
    ///
    /// # Errors
    ///
    /// If there is no memory for a scene, or if what was added to it cannot be shown; the snapshot is handed out all the same.
    pub fn publish(
        &mut self,
        data: &mut Data,
        add: impl FnOnce(&mut Scene, &SceneOptions) -> Result<()>,
        fill: impl FnOnce(&mut Snapshot),
    ) -> Result<()> {
        self.adopt(data);
        self.take_look();
        let mut snapshot = self.take_spare()?;
        let usable = data.check_usable().is_ok() && self.refresh_if_needed(data).is_ok();
        let shown = if usable { self.show(&mut snapshot, data, add) } else { Ok(()) };

        self.tell_warnings(data);

        snapshot.take_numbers(data);
        snapshot.watched.clear();
        snapshot.watched.extend(self.watches.iter().map(|watch| watch.value(data)));
        if !Arc::ptr_eq(&snapshot.model, &self.model) {
            snapshot.model = self.model.clone();
        }
        if !Arc::ptr_eq(&snapshot.captured, &self.captured) {
            snapshot.captured = self.captured.clone();
        }
        self.number += 1;
        snapshot.executed = self.back.taken();
        (snapshot.generation, snapshot.number, snapshot.camera) = (self.generation, self.number, self.camera);
        snapshot.selected = self.selected(data);
        fill(&mut snapshot);
        self.spare = self.back.publish(snapshot);
        shown
    }

    /// Whether the camera follows a body, and is still on its way to it.
    pub fn camera_lags(&self, data: &Data) -> bool {
        let CameraView::Tracking(body) = self.camera.view else { return false };
        if data.check_usable().is_err() {
            return false;
        }
        let target = data.subtree_com()[body.index()];
        let off = (0..3).map(|axis| (target[axis] - self.camera.lookat[axis]).powi(2)).sum::<f64>().sqrt();
        off > 1e-3 * self.camera.distance.abs()
    }

    fn show(
        &mut self,
        snapshot: &mut Snapshot,
        data: &mut Data,
        add: impl FnOnce(&mut Scene, &SceneOptions) -> Result<()>,
    ) -> Result<()> {
        let (scene, options) = (&mut snapshot.scene, &self.look.options);
        let shown = scene.update(data, options, Some(&self.perturbation), &mut self.camera, Categories::all());
        let shown = shown.and_then(|()| add(scene, options));
        match shown {
            Err(error @ Error::SceneFull { .. }) => {
                // As long as it lasts it is told once.
                if !std::mem::replace(&mut self.told_full, true) {
                    self.back.tell(Event::Notice(error.to_string()));
                }
                Ok(())
            }
            other => {
                self.told_full = false;
                other
            }
        }
    }

    /// The first warning of each kind is told. That the picture is full is told otherwise.
    fn tell_warnings(&mut self, data: &Data) {
        for (told, warning) in self.warned.iter_mut().zip(Warning::ALL) {
            let count = data.warning(warning);
            if count.number > 0 && !*told && warning != Warning::VisualGeomFull {
                self.back.tell(Event::Notice(warning.message(count.last_info, data)));
            }
            *told = count.number > 0;
        }
    }

    fn selected(&mut self, data: &mut Data) -> Option<Selected> {
        let body = self.perturbation.select?;
        let clicked = self.clicked.filter(|clicked| clicked.body == body);
        Some(Selected {
            body,
            geom: clicked.and_then(|clicked| clicked.geom),
            skin: self.perturbation.skinselect,
            localpos: self.perturbation.localpos,
            active: !self.perturbation.active.is_empty(),
            force: self.perturbation.force(data).unwrap_or_default(),
        })
    }

    /// A snapshot of the present model to write to.
    pub(super) fn take_spare(&mut self) -> Result<Box<Snapshot>> {
        match self.spare.take() {
            Some(spare) if spare.model.is_same_structure(&self.model) => Ok(spare),
            _ => Ok(Box::new(Snapshot::new(&self.model)?)),
        }
    }
}
