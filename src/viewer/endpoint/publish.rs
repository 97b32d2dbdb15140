//! Publication of snapshots.

use super::SimulationEndpoint;
use crate::data::{Data, Warning};
use crate::element::Object;
use crate::error::{Error, Result};
use crate::id::{BodyId, GeomId};
use crate::model::Model;
use crate::scene::{Camera, CameraView, Categories, Scene, SceneOptions};
use crate::viewer::instruments::Instruments;
use crate::viewer::link::{Event, PaneView, SceneView, SelectedBody, Snapshot};

impl SimulationEndpoint {
    /// Publishes a snapshot of the simulation. `add` adds geoms to the scene; `fill` sets the
    /// fields that differ between the viewer's and a program's simulation, such as status, mode and
    /// speed. If the data is unusable, the snapshot has its values and the previous scene.
    ///
    /// # Errors
    ///
    /// If there is no memory for a scene, or if `add` or the instruments add an invalid geom. The
    /// snapshot is published in the second case.
    pub fn publish(
        &mut self,
        data: &mut Data,
        add: impl FnOnce(&mut Scene, &SceneOptions) -> Result<()>,
        fill: impl FnOnce(&mut Snapshot),
    ) -> Result<()> {
        self.adopt(data);
        self.update_view();
        let mut snapshot = self.take_spare()?;
        let usable = data.check_usable().is_ok() && self.refresh_if_needed(data).is_ok();
        let updated = if usable {
            self.update_scene(&mut snapshot, data, add).and(self.update_panes(&mut snapshot, data))
        } else {
            Ok(())
        };

        self.report_warnings(data);

        snapshot.copy_values(data);
        self.sample(data);
        snapshot.signals.copy_from(&self.signals);
        self.signals.clear_ranges();
        self.instruments.values().clone_into(&mut snapshot.plotted);
        self.instruments.clear_ranges();
        self.instruments.parameters().clone_into(&mut snapshot.parameters);
        snapshot.model = self.model.clone();
        snapshot.captured = self.captured.clone();
        self.number += 1;
        snapshot.executed = self.link.executed();
        (snapshot.generation, snapshot.number, snapshot.camera) = (self.generation, self.number, self.camera);
        snapshot.selected = self.selected(data);
        fill(&mut snapshot);
        self.spare = self.link.publish(snapshot);
        updated
    }

    /// Returns `true` if a tracking camera has not reached its body yet.
    pub fn camera_lags(&self, data: &Data) -> bool {
        let CameraView::Tracking(body) = self.camera.view else { return false };
        if data.check_usable().is_err() {
            return false;
        }
        let target = data.subtree_com()[body.index()];
        let off = (0..3).map(|axis| (target[axis] - self.camera.lookat[axis]).powi(2)).sum::<f64>().sqrt();
        off > 1e-3 * self.camera.distance.abs()
    }

    fn update_scene(
        &mut self,
        snapshot: &mut Snapshot,
        data: &mut Data,
        add: impl FnOnce(&mut Scene, &SceneOptions) -> Result<()>,
    ) -> Result<()> {
        let (scene, options) = (&mut snapshot.scene, &self.view.options);
        let updated = scene.update(data, options, Some(&self.perturbation), &mut self.camera, Categories::all());
        let updated = updated.and_then(|()| make_orthographic(scene, &self.view, &self.camera));
        let instruments = &self.instruments;
        if let Some(body) = self.perturbation.select.filter(|body| body.index() > 0) {
            highlight(scene, &self.model, body);
        }
        match updated.and_then(|()| add(scene, options)).and_then(|()| add_instruments(scene, instruments)) {
            Err(error @ Error::SceneFull { .. }) => {
                // Reported once until the scene fits again.
                if !std::mem::replace(&mut self.scene_full_reported, true) {
                    self.link.send(Event::Notice(error.to_string()));
                }
                Ok(())
            }
            other => {
                self.scene_full_reported = false;
                other
            }
        }
    }

    /// Computes the viewpoints of the panes.
    fn update_panes(&self, snapshot: &mut Snapshot, data: &Data) -> Result<()> {
        snapshot.panes.clear();
        let cameras = self.view.panes.iter().filter(|&&camera| !self.is_stale(camera));
        let before = snapshot.scene.viewpoints();
        for &camera in cameras {
            snapshot.scene.update_camera(data, &mut Camera::fixed(&self.model, camera))?;
            snapshot.panes.push(PaneView { camera, viewpoints: snapshot.scene.viewpoints() });
        }
        if snapshot.panes.is_empty() { Ok(()) } else { snapshot.scene.set_viewpoints(before) }
    }

    /// Reports the first engine warning of each kind. `SceneFull` is reported separately.
    fn report_warnings(&mut self, data: &Data) {
        for (reported, warning) in self.warned.iter_mut().zip(Warning::ALL) {
            let count = data.warning(warning);
            if count.number > 0 && !*reported && warning != Warning::VisualGeomFull {
                self.link.send(Event::Notice(warning.message(count.lastinfo, data)));
            }
            *reported = count.number > 0;
        }
    }

    fn selected(&mut self, data: &mut Data) -> Option<SelectedBody> {
        let body = self.perturbation.select?;
        let clicked = self.clicked.filter(|clicked| clicked.body == body);
        Some(SelectedBody {
            body,
            geom: clicked.and_then(|clicked| clicked.geom),
            localpos: self.perturbation.localpos,
            active: !self.perturbation.active.is_empty(),
            force: self.perturbation.force(data).unwrap_or_default(),
        })
    }

    /// Returns a snapshot of the current model that may be overwritten.
    pub(super) fn take_spare(&mut self) -> Result<Box<Snapshot>> {
        match self.spare.take() {
            Some(spare) if spare.model.is_same_structure(&self.model) => Ok(spare),
            _ => Ok(Box::new(Snapshot::new(&self.model)?)),
        }
    }
}

/// Makes the viewpoints of a free or tracking camera orthographic if the user wants it.
pub(super) fn make_orthographic(scene: &mut Scene, view: &SceneView, camera: &Camera) -> Result<()> {
    let is_movable = matches!(camera.view, CameraView::Free | CameraView::Tracking(_));
    if view.orthographic && is_movable { scene.make_orthographic(camera.distance) } else { Ok(()) }
}

/// Colour that is added to the geoms of the selected body, its weight, and their smallest emission.
/// The engine brightens them only in proportion to their colour, which is invisible in dark ones.
const HIGHLIGHT: [f32; 3] = [1.0, 0.75, 0.2];
const HIGHLIGHT_WEIGHT: f32 = 0.4;
const HIGHLIGHT_EMISSION: f32 = 0.4;

/// Makes the geoms of a body visible as selected.
fn highlight(scene: &mut Scene, model: &Model, body: BodyId) {
    let is_of_body = |geom: GeomId| model.geom(geom).body() == body;
    for mut geom in scene.geoms_mut() {
        let view = geom.view();
        let is_selected = matches!(view.object(), Some(Object::Geom(id)) if is_of_body(id));
        if !is_selected || view.category() == Categories::DECOR {
            continue;
        }
        let (rgba, emission) = (view.rgba(), view.emission());
        let mixed = |part: usize| rgba[part] + HIGHLIGHT_WEIGHT * (HIGHLIGHT[part] - rgba[part]);
        geom.set_rgba([mixed(0), mixed(1), mixed(2), rgba[3]]);
        geom.set_emission(emission.max(HIGHLIGHT_EMISSION));
    }
}

/// Adds the geoms of the instruments to a scene. The controller may have created them for a model
/// that the user has replaced.
fn add_instruments(scene: &mut Scene, instruments: &Instruments) -> Result<()> {
    for geom in instruments.geoms() {
        if !geom.fits(scene) {
            return Err(Error::OtherModel { what: "a mesh, height field or texture of the instruments" });
        }
        scene.add_geom(geom)?;
    }
    Ok(())
}
