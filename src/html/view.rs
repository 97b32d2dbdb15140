//! Lights and cameras.

use std::collections::BTreeSet;

use serde::Serialize;

use super::frame::Frame;
use crate::data::Data;
use crate::element;
use crate::error::Result;
use crate::model::Model;
use crate::scene::{Camera, Scene, SceneLight, Viewpoint};

/// Light.
#[derive(Debug, Serialize)]
pub(super) struct Light {
    /// Index of the frame; `None` for the headlight.
    frame: Option<usize>,
    /// Position, m, and direction in the frame.
    pos: [f64; 3],
    dir: [f64; 3],
    directional: bool,
    castshadow: bool,
    cutoff: f32,
    exponent: f32,
    ambient: [f32; 3],
    diffuse: [f32; 3],
    specular: [f32; 3],
}

impl Light {
    /// Returns the active lights, and describes those that the engine's renderer does not draw.
    pub(super) fn all(model: &Model, frames: &[Frame], scene: &Scene, left_out: &mut BTreeSet<String>) -> Vec<Self> {
        let active = (0..model.nlight()).filter(|&index| model.light_active()[index] != 0);
        let (head, others): (Vec<_>, Vec<_>) = scene.lights().partition(|light| light.headlight);
        let mut lights: Vec<Self> =
            head.into_iter().map(|light| Self::new(light, None, [0.0; 3], [0.0, 0.0, -1.0])).collect();
        for (light, index) in others.into_iter().zip(active) {
            if !light.drawn {
                left_out.insert(format!(
                    "light {}: its type",
                    model.lights().nth(index).and_then(|light| light.name()).unwrap_or("without a name")
                ));
                continue;
            }
            let own = frames.iter().position(|frame| *frame == Frame::Light(index));
            lights.push(if own.is_some() {
                Self::new(light, own, [0.0; 3], [0.0, 0.0, 1.0])
            } else {
                let body = model.light_bodyid()[index] as usize;
                Self::new(light, Some(body), model.light_pos()[index], model.light_dir()[index])
            });
        }
        lights
    }

    fn new(light: SceneLight, frame: Option<usize>, pos: [f64; 3], dir: [f64; 3]) -> Self {
        let SceneLight { directional, castshadow, cutoff, exponent, ambient, diffuse, specular, .. } = light;
        Self { frame, pos, dir, directional, castshadow, cutoff, exponent, ambient, diffuse, specular }
    }
}

/// Frustum of a camera: see [`Viewpoint`].
#[derive(Debug, Serialize)]
struct Frustum {
    center: f32,
    width: f32,
    bottom: f32,
    top: f32,
    near: f32,
    far: f32,
    orthographic: bool,
}

impl Frustum {
    fn new(viewpoint: &Viewpoint) -> Self {
        Self {
            center: viewpoint.frustum_center,
            width: viewpoint.frustum_width,
            bottom: viewpoint.frustum_bottom,
            top: viewpoint.frustum_top,
            near: viewpoint.frustum_near,
            far: viewpoint.frustum_far,
            orthographic: viewpoint.orthographic,
        }
    }
}

/// Camera of the model.
#[derive(Debug, Serialize)]
pub(super) struct FixedCamera {
    name: Option<String>,
    frame: usize,
    /// Position, m, and orientation in the frame. The camera looks along the negative z-axis.
    pos: [f64; 3],
    quat: [f64; 4],
    frustum: Frustum,
}

impl FixedCamera {
    /// Returns all cameras. Leaves the scene at the viewpoint of the last one.
    pub(super) fn all(data: &Data, frames: &[Frame], scene: &mut Scene) -> Result<Vec<Self>> {
        let model = data.model();
        let mut camera = |index: usize, view: element::Camera<'_>| {
            scene.update_camera(data, &mut Camera::fixed(model, view.id()))?;
            let (frame, pos, quat) = match frames.iter().position(|frame| *frame == Frame::Camera(index)) {
                Some(frame) => (frame, [0.0; 3], [1.0, 0.0, 0.0, 0.0]),
                None => (model.cam_bodyid()[index] as usize, model.cam_pos()[index], model.cam_quat()[index]),
            };
            let (name, frustum) = (view.name().map(str::to_owned), Frustum::new(&scene.viewpoint()));
            Ok(Self { name, frame, pos, quat, frustum })
        };
        model.cameras().enumerate().map(|(index, view)| camera(index, view)).collect()
    }
}

/// Free camera at the start.
#[derive(Debug, Serialize)]
pub(super) struct FreeCamera {
    /// Position, m.
    pos: [f32; 3],
    /// Point at the centre of the view, m.
    lookat: [f64; 3],
    frustum: Frustum,
}

impl FreeCamera {
    pub(super) fn new(viewpoint: &Viewpoint, lookat: [f64; 3]) -> Self {
        Self { pos: viewpoint.pos, lookat, frustum: Frustum::new(viewpoint) }
    }
}
