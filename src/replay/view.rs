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
        let mut lights: Vec<Self> =
            head.into_iter().map(|light| Self::new(light, None, None, [0.0; 3], [0.0, 0.0, -1.0])).collect();
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
                Self::new(light, Some(index), own, [0.0; 3], [0.0, 0.0, 1.0])
            } else {
                let body = model.light_bodyid()[index] as usize;
                Self::new(light, Some(index), Some(body), model.light_pos()[index], model.light_dir()[index])
            });
        }
        lights
    }

    fn new(light: SceneLight, index: Option<usize>, frame: Option<usize>, pos: [f64; 3], dir: [f64; 3]) -> Self {
        let SceneLight { directional, castshadow, cutoff, exponent, ambient, diffuse, specular, .. } = light;
        Self { index, frame, pos, dir, directional, castshadow, cutoff, exponent, ambient, diffuse, specular }
    }
}

/// Frustum of a camera: see [`Viewpoint`].
#[derive(Debug, Serialize)]
pub(crate) struct Frustum {
    pub(crate) center: f32,
    pub(crate) width: f32,
    pub(crate) bottom: f32,
    pub(crate) top: f32,
    pub(crate) near: f32,
    pub(crate) far: f32,
    pub(crate) orthographic: bool,
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
pub(crate) struct FixedCamera {
    pub(crate) name: Option<String>,
    pub(crate) frame: usize,
    /// Position, m, and orientation in the frame. The camera looks along the negative z-axis.
    pub(crate) pos: [f64; 3],
    pub(crate) quat: [f64; 4],
    pub(crate) frustum: Frustum,
}

impl FixedCamera {
    /// Returns all cameras. Leaves the scene at the viewpoint of the last one.
    pub(crate) fn all(data: &Data, frames: &[Frame], scene: &mut Scene) -> Result<Vec<Self>> {
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
pub(crate) struct FreeCamera {
    /// Position, m.
    pub(crate) pos: [f32; 3],
    /// Point at the centre of the view, m.
    pub(crate) lookat: [f64; 3],
    pub(crate) frustum: Frustum,
}

impl FreeCamera {
    pub(crate) fn new(viewpoint: &Viewpoint, lookat: [f64; 3]) -> Self {
        Self { pos: viewpoint.pos, lookat, frustum: Frustum::new(viewpoint) }
    }
}
