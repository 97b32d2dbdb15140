//! View of a window: camera, scene options, rendering effects and open panels.

use mujoco_sys::{mjNFRAME, mjNLABEL};

use super::input::{Panel, PlotKind, ViewAction, WindowAction};
use super::link::{Event, SceneView, Snapshot};
use crate::error::Result;
use crate::id::CameraId;
use crate::model::Model;
use crate::scene::{Camera, CameraView, FrameMode, LabelMode, MouseAction, RenderFlags, SceneOptions};

/// Width of a side panel that the user has not resized, points.
pub(crate) const SIDE_WIDTH: f32 = 286.0;

/// Image of a camera of the model over the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Pane {
    pub camera: CameraId,
    pub kind: PaneKind,
}

/// Kind of image in a pane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum PaneKind {
    Colour,
    Depth,
    Segmentation,
}

/// View of a window: camera, scene options, rendering effects and open panels.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "one flag for each panel")]
pub(crate) struct View {
    pub camera: Camera,
    pub options: SceneOptions,
    /// The free and the tracking camera are orthographic.
    pub orthographic: bool,
    pub render: RenderFlags,
    pub help: bool,
    /// Panel that opens a model file.
    pub files: bool,
    /// The info panel shows details instead of a line.
    pub details: bool,
    /// Open camera panes.
    pub panes: Vec<Pane>,
    /// Timeline at the bottom of the window.
    pub timeline: bool,
    pub left_panel: bool,
    pub right_panel: bool,
    /// Widths of the left and right side panels in a window with place for them, points.
    pub side_widths: [f32; 2],
    /// Plots of the solver, the computing times and the energy.
    pub profile: bool,
    /// Plot of the sensors.
    pub sensors: bool,
    /// Plots and sliders of a controller or program, if it has any.
    pub instruments: bool,
}

impl View {
    /// Creates the initial view: the free camera on the whole model, the engine's default options,
    /// and closed panels.
    pub fn new(model: &Model) -> Self {
        Self {
            camera: Camera::free(model),
            options: SceneOptions::default(),
            orthographic: false,
            render: RenderFlags::SHADOW
                | RenderFlags::REFLECTION
                | RenderFlags::SKYBOX
                | RenderFlags::HAZE
                | RenderFlags::CULL_FACE,
            help: false,
            files: false,
            details: false,
            panes: Vec::new(),
            timeline: true,
            left_panel: false,
            right_panel: false,
            side_widths: [SIDE_WIDTH; 2],
            profile: false,
            sensors: false,
            instruments: true,
        }
    }

    /// Returns the part of the view that the physics needs.
    pub fn scene_view(&self) -> SceneView {
        let panes = self.panes.iter().map(|pane| pane.camera).collect();
        let (camera, options) = (Some(self.camera), self.options.clone());
        SceneView { camera, options, orthographic: self.orthographic, panes }
    }

    /// Applies the effect of an event on the view.
    pub fn handle_event(&mut self, event: &Event) {
        match event {
            Event::LookAt(point) => {
                if matches!(self.camera.view, CameraView::Tracking(_)) {
                    self.camera.view = CameraView::Free;
                }
                // Without effect on a fixed camera.
                self.camera.lookat = *point;
            }
            Event::Track(body) => self.camera.view = CameraView::Tracking(*body),
            Event::View(view) => {
                self.camera = view.camera.unwrap_or(self.camera);
                self.options = view.options.clone();
            }
            Event::Copied(_) | Event::Asset(_) | Event::Notice(_) => {}
        }
    }

    /// Applies an action to the view. Returns an action that the window must perform in addition.
    pub fn apply(&mut self, action: ViewAction, model: &Model) -> Option<WindowAction> {
        let toggle = |flag: &mut bool| *flag = !*flag;
        match action {
            ViewAction::Help => {
                toggle(&mut self.help);
                return self.help.then_some(WindowAction::PrintHelp);
            }
            ViewAction::Files => toggle(&mut self.files),
            ViewAction::Details => toggle(&mut self.details),
            ViewAction::Timeline => toggle(&mut self.timeline),
            ViewAction::Panel(Panel::Left) => toggle(&mut self.left_panel),
            ViewAction::Panel(Panel::Right) => toggle(&mut self.right_panel),
            ViewAction::Plot(PlotKind::Profile) => toggle(&mut self.profile),
            ViewAction::Plot(PlotKind::Sensors) => toggle(&mut self.sensors),
            ViewAction::Plot(PlotKind::Instruments) => toggle(&mut self.instruments),
            ViewAction::Align => self.camera.align(model),
            // The free camera continues at the point that the tracking camera looks at.
            ViewAction::FreeCamera => self.camera.view = CameraView::Free,
            ViewAction::Camera(step) => self.cycle_camera(model, step),
            ViewAction::Label(step) => {
                let label = (self.options.label.raw() + step).rem_euclid(mjNLABEL as i32);
                self.options.label = LabelMode::from_raw(label).unwrap_or(LabelMode::None);
            }
            ViewAction::Frame(step) => {
                let frame = (self.options.frame.raw() + step).rem_euclid(mjNFRAME as i32);
                self.options.frame = FrameMode::from_raw(frame).unwrap_or(FrameMode::None);
            }
            ViewAction::Visual(flag) => self.options.flags.toggle(flag),
            ViewAction::Render(flag) => self.render.toggle(flag),
            ViewAction::GeomGroup(group) => toggle(&mut self.options.geomgroup[group]),
            ViewAction::SiteGroup(group) => toggle(&mut self.options.sitegroup[group]),
        }
        None
    }

    /// Moves the camera by a motion of the mouse, in units of the window's height.
    ///
    /// # Errors
    ///
    /// If the scene of the snapshot is empty, or if the camera would leave the range of finite
    /// numbers.
    pub fn move_camera(&mut self, action: MouseAction, motion: [f64; 2], snapshot: &Snapshot) -> Result<()> {
        self.drop_stale_camera(&snapshot.model);
        let viewpoint = snapshot.scene.viewpoint();
        let factor = match action {
            MouseAction::MoveV | MouseAction::MoveH if self.orthographic && viewpoint.orthographic => {
                // The engine moves the camera by the height of a perspective frustum.
                let height = f64::from(viewpoint.frustum_top - viewpoint.frustum_bottom);
                height / (snapshot.scene.frustum_height()? * self.camera.distance)
            }
            _ => 1.0,
        };
        self.camera.move_by(&snapshot.model, action, motion.map(|part| factor * part), &snapshot.scene)
    }

    /// Updates the viewpoint and the effects of a snapshot to the current view, so that the image
    /// follows the mouse even if the physics is slow. A tracking camera adopts its look-at point
    /// from the snapshot.
    ///
    /// # Errors
    ///
    /// If the camera is invalid.
    pub fn update_snapshot(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        self.drop_stale_camera(&snapshot.model);
        snapshot.scene.set_render_flags(self.render);
        if self.camera.view == snapshot.camera.view {
            if matches!(self.camera.view, CameraView::Tracking(_)) {
                self.camera.lookat = snapshot.camera.lookat;
            }
            snapshot.scene.look(&snapshot.model, &self.camera)?;
            if self.orthographic && matches!(self.camera.view, CameraView::Free | CameraView::Tracking(_)) {
                snapshot.scene.make_orthographic(self.camera.distance)?;
            }
        }
        Ok(())
    }

    /// Keeps the panes of a model that is replaced whose cameras the new model has by name.
    pub fn adopt_panes(&mut self, previous: &Model, model: &Model) {
        self.panes.retain_mut(|pane| {
            let belongs = pane.camera.lineage() == previous.lineage();
            let name = if belongs { previous.camera(pane.camera).name() } else { None };
            let camera = name.and_then(|name| model.camera(name).ok());
            camera.map(|camera| pane.camera = camera.id()).is_some()
        });
    }

    /// Resets a camera that belongs to another model.
    fn drop_stale_camera(&mut self, model: &Model) {
        let fits = match self.camera.view {
            CameraView::Tracking(id) => id.lineage() == model.lineage(),
            CameraView::Fixed(id) => id.lineage() == model.lineage(),
            CameraView::Free | CameraView::User => true,
        };
        if !fits {
            self.camera = Camera::free(model);
        }
    }

    /// Cycles through the free camera and the cameras of the model.
    fn cycle_camera(&mut self, model: &Model, step: i32) {
        let present = match self.camera.view {
            CameraView::Fixed(camera) => camera.index() as i32 + 1,
            CameraView::Free | CameraView::Tracking(_) | CameraView::User => 0,
        };
        let next = (present + step).rem_euclid(model.ncam() as i32 + 1);
        let camera = usize::try_from(next - 1).ok().and_then(|index| model.camera(index).ok());
        self.camera.view = camera.map_or(CameraView::Free, |camera| CameraView::Fixed(camera.id()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panes_follow_the_names_of_cameras() {
        let model = |cameras: &str| {
            let world: Vec<String> = cameras.split(' ').map(|name| format!("<camera name='{name}'/>")).collect();
            Model::from_xml_str(&format!("<mujoco><worldbody><camera/>{}</worldbody></mujoco>", world.concat()))
                .unwrap()
        };
        let [old, new, other] = [model("left right"), model("right front"), model("right left")];
        let mut view = View::new(&old);
        let pane = |model: &Model, camera: usize, kind| Pane { camera: model.camera(camera).unwrap().id(), kind };
        view.panes = vec![
            pane(&old, 0, PaneKind::Colour),
            pane(&old, 1, PaneKind::Colour),
            pane(&old, 2, PaneKind::Depth),
            pane(&other, 1, PaneKind::Depth),
        ];
        view.adopt_panes(&old, &new);
        assert_eq!(view.panes, [pane(&new, 1, PaneKind::Depth)]);
    }
}
