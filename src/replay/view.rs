//! Lights and cameras.

use std::collections::BTreeSet;

use serde::Serialize;

use super::motion::Frame;
use super::names::description;
use crate::data::Data;
use crate::element;
use crate::error::Result;
use crate::kind::Kind;
use crate::math::{cross, mat2quat};
use crate::model::Model;
use crate::scene::{Camera, Scene, SceneLight, Viewpoint};

/// Light.
#[derive(Debug, Serialize)]
pub(crate) struct Light {
    /// Index of the light in the model; `None` for the headlight.
    #[serde(skip)]
    pub(crate) index: Option<usize>,
    /// Index of the frame; `None` for the headlight.
    pub(crate) frame: Option<usize>,
    /// Position, m, and direction in the frame.
    pub(crate) pos: [f64; 3],
    pub(crate) dir: [f64; 3],
    pub(crate) directional: bool,
    pub(crate) castshadow: bool,
    pub(crate) cutoff: f32,
    pub(crate) exponent: f32,
    pub(crate) ambient: [f32; 3],
    pub(crate) diffuse: [f32; 3],
    pub(crate) specular: [f32; 3],
}

impl Light {
    /// Returns the active lights, and describes those that the engine's renderer does not draw.
    pub(crate) fn all(model: &Model, frames: &[Frame], scene: &Scene, left_out: &mut BTreeSet<String>) -> Vec<Self> {
        let active = (0..model.nlight()).filter(|&index| model.light_active()[index] != 0);
        let (head, others): (Vec<_>, Vec<_>) = scene.lights().partition(|light| light.headlight);
        let headlight = |light| Self::new(light, None, None, [0.0; 3], [0.0, 0.0, -1.0]);
        let mut lights: Vec<Self> = head.into_iter().map(headlight).collect();
        for (light, index) in others.into_iter().zip(active) {
            if !light.drawn {
                left_out.insert(format!("{}: its type", description(model, Kind::Light, index)));
                continue;
            }
            let fixed = (model.light_bodyid()[index] as usize, model.light_pos()[index], model.light_dir()[index]);
            let moving = frames.iter().position(|frame| *frame == Frame::Light(index));
            let (frame, pos, dir) = moving.map_or(fixed, |frame| (frame, [0.0; 3], [0.0, 0.0, 1.0]));
            lights.push(Self::new(light, Some(index), Some(frame), pos, dir));
        }
        lights
    }

    fn new(light: SceneLight, index: Option<usize>, frame: Option<usize>, pos: [f64; 3], dir: [f64; 3]) -> Self {
        let SceneLight { directional, castshadow, cutoff, exponent, ambient, diffuse, specular, .. } = light;
        Self { index, frame, pos, dir, directional, castshadow, cutoff, exponent, ambient, diffuse, specular }
    }
}

/// Part of a viewpoint that a page needs.
#[derive(Serialize)]
#[serde(remote = "Viewpoint")]
struct Projection {
    frustum_center: f32,
    frustum_width: f32,
    frustum_bottom: f32,
    frustum_top: f32,
    frustum_near: f32,
    frustum_far: f32,
    orthographic: bool,
}

/// Camera of the model, or the free camera at the start.
#[derive(Debug, Serialize)]
pub(crate) struct CameraLook {
    pub(crate) name: Option<String>,
    pub(crate) frame: usize,
    /// Position, m, and orientation in the frame. The camera looks along the negative z-axis.
    pub(crate) pos: [f64; 3],
    pub(crate) quat: [f64; 4],
    #[serde(with = "Projection")]
    pub(crate) view: Viewpoint,
}

impl CameraLook {
    /// Returns the free camera, of which the scene has the viewpoint. Its frame is the world.
    pub(crate) fn free(view: Viewpoint) -> Self {
        let [z, y] = [view.forward.map(|part| -f64::from(part)), view.up.map(f64::from)];
        let x = cross(&y, &z);
        let quat = mat2quat(&[x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]]);
        Self { name: None, frame: 0, pos: view.pos.map(f64::from), quat, view }
    }

    /// Returns all cameras of the model. Leaves the scene at the viewpoint of the last one.
    pub(crate) fn all(data: &Data, frames: &[Frame], scene: &mut Scene) -> Result<Vec<Self>> {
        let model = data.model();
        let camera = |(index, element): (usize, element::Camera<'_>)| {
            scene.update_camera(data, &mut Camera::fixed(model, element.id()))?;
            let fixed = (model.cam_bodyid()[index] as usize, model.cam_pos()[index], model.cam_quat()[index]);
            let moving = frames.iter().position(|frame| *frame == Frame::Camera(index));
            let (frame, pos, quat) = moving.map_or(fixed, |frame| (frame, [0.0; 3], [1.0, 0.0, 0.0, 0.0]));
            Ok(Self { name: element.name().map(str::to_owned), frame, pos, quat, view: scene.viewpoint() })
        };
        model.cameras().enumerate().map(camera).collect()
    }
}
