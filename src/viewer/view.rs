//! The window's side: from where and at what it looks, and which panels there are.

use mujoco_sys::{mjNFRAME, mjNLABEL};

use super::event::Event;
use super::input::{Action, Gesture, Panel, PlotKind, WindowAction};
use super::link::Look;
use super::request::Request;
use super::snapshot::Snapshot;
use crate::error::Result;
use crate::model::Model;
use crate::scene::{Camera, CameraView, FrameMode, LabelMode, RenderFlags, SceneOptions};

/// What is left to be done for an action.
#[derive(Debug)]
pub(crate) enum Effect {
    /// Nothing: the view has changed.
    Done,
    /// To be asked of the physics.
    Ask(Request),
    /// To be done by the window.
    Window(WindowAction),
}

/// From where and at what the window looks, and which panels there are.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "each panel is there or not")]
pub(crate) struct View {
    pub camera: Camera,
    pub options: SceneOptions,
    pub render: RenderFlags,
    /// The help.
    pub help: bool,
    /// The info panel.
    pub info: bool,
    pub left_panel: bool,
    pub right_panel: bool,
    /// The plot of the solver and the timers.
    pub profile: bool,
    /// The plot of the sensors.
    pub sensors: bool,
}

impl View {
    /// As a viewer begins: the free camera on the whole model, the engine's defaults, the info panel.
    pub fn new(model: &Model) -> Self {
        Self {
            camera: Camera::free(model),
            options: SceneOptions::default(),
            render: RenderFlags::SHADOW
                | RenderFlags::REFLECTION
                | RenderFlags::SKYBOX
                | RenderFlags::HAZE
                | RenderFlags::CULL_FACE,
            help: false,
            info: true,
            left_panel: false,
            right_panel: false,
            profile: false,
            sensors: false,
        }
    }

    /// What the physics has to know of it.
    pub fn look(&self) -> Look {
        Look { camera: Some(self.camera), options: self.options.clone() }
    }

    /// The model was replaced by another: a camera of the old one is of no use.
    pub fn model_replaced(&mut self, model: &Model) {
        self.camera = Camera::free(model);
    }

    /// Does what the physics answers, as far as it is the view's.
    pub fn take(&mut self, event: &Event) {
        match event {
            Event::LookAt(point) => {
                // A camera of the model's looks where it does.
                if matches!(self.camera.view, CameraView::Tracking(_)) {
                    self.camera.view = CameraView::Free;
                }
                self.camera.lookat = *point;
            }
            Event::Track(body) => self.camera.view = CameraView::Tracking(*body),
            Event::View(look) => {
                self.camera = look.camera.unwrap_or(self.camera);
                self.options = look.options.clone();
            }
            Event::Copied(_) | Event::Asset(_) | Event::Notice(_) => {}
        }
    }

    /// Does an action, as far as it is the view's.
    pub fn act(&mut self, action: Action, model: &Model) -> Effect {
        let toggle = |shown: &mut bool| {
            *shown = !*shown;
            Effect::Done
        };
        match action {
            Action::Help => {
                self.help = !self.help;
                if self.help { Effect::Window(WindowAction::PrintHelp) } else { Effect::Done }
            }
            Action::Info => toggle(&mut self.info),
            Action::Panel(Panel::Left) => toggle(&mut self.left_panel),
            Action::Panel(Panel::Right) => toggle(&mut self.right_panel),
            Action::Plot(PlotKind::Profile) => toggle(&mut self.profile),
            Action::Plot(PlotKind::Sensors) => toggle(&mut self.sensors),
            Action::Window(action) => Effect::Window(action),
            Action::Align => {
                self.camera.align(model);
                Effect::Done
            }
            Action::Camera(step) => {
                self.cycle_camera(model, step);
                Effect::Done
            }
            Action::Label(step) => {
                let label = (self.options.label.raw() + step).rem_euclid(mjNLABEL as i32);
                self.options.label = LabelMode::from_raw(label).unwrap_or(LabelMode::None);
                Effect::Done
            }
            Action::Frame(step) => {
                let frame = (self.options.frame.raw() + step).rem_euclid(mjNFRAME as i32);
                self.options.frame = FrameMode::from_raw(frame).unwrap_or(FrameMode::None);
                Effect::Done
            }
            Action::Visual(flag) => {
                self.options.flags.toggle(flag);
                Effect::Done
            }
            Action::Render(flag) => {
                self.render.toggle(flag);
                Effect::Done
            }
            Action::GeomGroup(group) => toggle(&mut self.options.geomgroup[group]),
            Action::SiteGroup(group) => toggle(&mut self.options.sitegroup[group]),
            Action::Reset => Effect::Ask(Request::Reset),
            Action::Pause => Effect::Ask(Request::TogglePause),
            Action::Step(steps) => Effect::Ask(Request::Step(steps)),
            Action::Speed => Effect::Ask(Request::ToggleSpeed),
            Action::Faster => Effect::Ask(Request::Faster),
            Action::Slower => Effect::Ask(Request::Slower),
            Action::Mode(step) => Effect::Ask(Request::CycleMode(step)),
            Action::SelectParent => Effect::Ask(Request::SelectParent),
            Action::ClearControls => Effect::Ask(Request::ClearControls),
            Action::SaveKey => Effect::Ask(Request::SaveKey(None)),
            Action::CopyState => Effect::Ask(Request::CopyState),
            Action::CopyCamera => Effect::Ask(Request::CopyCamera),
            Action::Reverse => Effect::Ask(Request::Reverse),
            Action::Trajectory(step) => Effect::Ask(Request::CycleTrajectory(step)),
            Action::Burst => Effect::Ask(Request::Burst),
            Action::Doppler => Effect::Ask(Request::Doppler),
        }
    }

    /// Does a gesture of the mouse, as far as it is the view's.
    ///
    /// # Errors
    ///
    /// If the camera cannot be moved in the snapshot's scene, which then shows nothing yet, or so far.
    pub fn gesture(&mut self, gesture: Gesture, snapshot: &Snapshot) -> Result<Effect> {
        self.fit(&snapshot.model);
        Ok(Effect::Ask(match gesture {
            Gesture::None => return Ok(Effect::Done),
            Gesture::Camera(action, motion) => {
                self.camera.move_by(&snapshot.model, &snapshot.scene, action, motion)?;
                return Ok(Effect::Done);
            }
            Gesture::StartPerturbation(flags) => Request::StartPerturbation(flags),
            Gesture::Perturbation(action, motion) => Request::MovePerturbation(action, motion),
            Gesture::StopPerturbation => Request::StopPerturbation,
            Gesture::Select(place) => Request::Select(place),
            Gesture::LookAt(place) => Request::LookAt(place),
            Gesture::Track(place) => Request::Track(place),
            Gesture::BurstFactor(notches) => Request::BurstFactor(notches),
            Gesture::BurstGamma(notches) => Request::BurstGamma(notches),
        }))
    }

    /// Puts the eyes of a snapshot where the camera is now, and its effects to what they are now: for a picture that follows the
    /// mouse though the physics is slow. A tracking camera follows its body as the snapshot says.
    ///
    /// # Errors
    ///
    /// If the camera's numbers are of no use.
    pub fn prepare(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        self.fit(&snapshot.model);
        snapshot.scene.set_render_flags(self.render);
        if self.camera.view == snapshot.camera.view {
            if matches!(self.camera.view, CameraView::Tracking(_)) {
                self.camera.lookat = snapshot.camera.lookat;
            }
            snapshot.scene.look(&snapshot.model, &self.camera)?;
        }
        Ok(())
    }

    /// A camera of a model that was replaced is none any more.
    fn fit(&mut self, model: &Model) {
        let fits = match self.camera.view {
            CameraView::Tracking(id) => id.lineage() == model.lineage(),
            CameraView::Fixed(id) => id.lineage() == model.lineage(),
            CameraView::Free | CameraView::User => true,
        };
        if !fits {
            self.camera = Camera::free(model);
        }
    }

    /// Free, then those of the model, and round again.
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
