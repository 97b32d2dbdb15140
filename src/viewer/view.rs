//! The window's side: from where and at what it looks, and which panels there are.

use super::input::{Action, Gesture, Panel, PlotKind, WindowAction};
use super::link::Look;
use super::request::{Place, Request};
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

    /// Does an action, as far as it is the view's.
    pub fn act(&mut self, action: Action, model: &Model) -> Effect {
        let _ = model;
        let _ = action;
        let _ = (CameraView::Free, FrameMode::None, LabelMode::None, Panel::Left, PlotKind::Profile);
        Effect::Done
    }

    /// Does a gesture of the mouse, as far as it is the view's.
    pub fn gesture(&mut self, gesture: Gesture, snapshot: &Snapshot) -> Result<Effect> {
        let _ = (gesture, snapshot, Place { aspectratio: 1.0, at: [0.0; 2] });
        Ok(Effect::Done)
    }

    /// Puts the eyes of a snapshot where the camera is now, and its effects to what they are now: for a picture that follows the
    /// mouse though the physics is slow. A tracking camera follows its body as the snapshot says.
    pub fn prepare(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        snapshot.scene.set_render_flags(self.render);
        if self.camera.view == snapshot.camera.view {
            if matches!(self.camera.view, CameraView::Tracking(_)) {
                self.camera.lookat = snapshot.camera.lookat;
            }
            snapshot.scene.look(&snapshot.model, &self.camera)?;
        }
        Ok(())
    }
}
