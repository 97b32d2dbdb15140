//! Moving frames: the bodies, and the cameras and lights that do not move with a body.

use crate::data::Data;
use crate::math::{mat2quat, quat_z2vec};
use crate::model::Model;

/// A moving frame, by the index of its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    Body(usize),
    /// Camera that tracks a body or points at one.
    Camera(usize),
    /// Light that tracks a body or points at one. The direction of the light is the z-axis.
    Light(usize),
}

/// The value of `mjCAMLIGHT_FIXED`, for the modes of cameras and lights.
const FIXED: i32 = mujoco_sys::mjCAMLIGHT_FIXED as i32;

/// Returns the frames of a model: first all bodies.
pub(crate) fn all(model: &Model) -> Vec<Frame> {
    let moving = |modes: &[i32]| -> Vec<usize> { (0..modes.len()).filter(|&index| modes[index] != FIXED).collect() };
    let cameras = moving(model.cam_mode()).into_iter().map(Frame::Camera);
    let lights = moving(model.light_mode()).into_iter().map(Frame::Light);
    (0..model.nbody()).map(Frame::Body).chain(cameras).chain(lights).collect()
}

/// Position, m, and orientation in the world frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(crate) pos: [f64; 3],
    pub(crate) quat: [f64; 4],
}

impl Pose {
    /// Selects the sign of the quaternion that is nearer to the one before, so that a motion has no
    /// jumps.
    pub(crate) fn near(self, before: Option<[f64; 4]>) -> Self {
        let product: f64 = before.iter().flatten().zip(self.quat).map(|(a, b)| a * b).sum();
        if product < 0.0 { Self { quat: self.quat.map(|part| -part), ..self } } else { self }
    }
}

/// Returns the pose of a frame, of which the positions have been computed.
pub(crate) fn pose(data: &Data, frame: Frame) -> Pose {
    match frame {
        Frame::Body(index) => Pose { pos: data.xpos()[index], quat: data.xquat()[index] },
        Frame::Camera(index) => Pose { pos: data.cam_xpos()[index], quat: mat2quat(&data.cam_xmat()[index]) },
        Frame::Light(index) => Pose { pos: data.light_xpos()[index], quat: quat_z2vec(&data.light_xdir()[index]) },
    }
}
