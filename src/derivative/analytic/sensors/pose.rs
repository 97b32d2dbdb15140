//! Poses and velocities of the objects that sensors are attached to.

use mujoco_sys::{mjCAMLIGHT_FIXED, mjOBJ_BODY, mjOBJ_CAMERA, mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_XBODY};

use super::Point;
use crate::data::Data;
use crate::ffi;
use crate::math;
use crate::model::Model;
use crate::numerics::spatial::{Spatial, Vec3, angular, cross, linear, spatial, sub, velocity_at};

/// Frame of an object, in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) body: usize,
    pub(super) position: Vec3,
    /// Row-major; its columns are the axes of the frame.
    rotation: [f64; 9],
    pub(super) quaternion: [f64; 4],
    /// Position relative to the reference point of the tree.
    arm: Vec3,
}

impl Pose {
    /// Returns `true` if the object of a sensor has a pose that is fixed to a body.
    pub(super) fn is_known(model: &Model, sensor: usize) -> bool {
        is_fixed(model, model.sensor_objtype()[sensor], model.sensor_objid()[sensor])
    }

    /// Returns `true` if a sensor has no reference frame, or one that is fixed to a body.
    pub(super) fn has_known_reference(model: &Model, sensor: usize) -> bool {
        let reference = model.sensor_refid()[sensor];
        reference < 0 || is_fixed(model, model.sensor_reftype()[sensor], reference)
    }

    /// Returns the pose of the object of a sensor, which [is known](Self::is_known).
    pub(super) fn of_object(data: &Data, sensor: usize) -> Self {
        let model = data.model();
        Self::new(data, model.sensor_objtype()[sensor], model.sensor_objid()[sensor])
    }

    /// Returns the pose of the reference frame of a sensor, if it has one.
    pub(super) fn of_reference(data: &Data, sensor: usize) -> Option<Self> {
        let model = data.model();
        let reference = model.sensor_refid()[sensor];
        (reference >= 0).then(|| Self::new(data, model.sensor_reftype()[sensor], reference))
    }

    fn new(data: &Data, kind: i32, object: i32) -> Self {
        const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 0.0];
        let (model, object) = (data.model(), ffi::size(object));
        #[expect(non_upper_case_globals, reason = "the engine's constants")]
        let (body, position, rotation, offset) = match kind as u32 {
            mjOBJ_BODY => (object, data.xipos()[object], data.ximat()[object], model.body_iquat()[object]),
            mjOBJ_XBODY => (object, data.xpos()[object], data.xmat()[object], IDENTITY),
            mjOBJ_GEOM => {
                let body = ffi::size(model.geom_bodyid()[object]);
                (body, data.geom_xpos()[object], data.geom_xmat()[object], model.geom_quat()[object])
            }
            mjOBJ_SITE => {
                let body = ffi::size(model.site_bodyid()[object]);
                (body, data.site_xpos()[object], data.site_xmat()[object], model.site_quat()[object])
            }
            mjOBJ_CAMERA => {
                let body = ffi::size(model.cam_bodyid()[object]);
                (body, data.cam_xpos()[object], data.cam_xmat()[object], model.cam_quat()[object])
            }
            _ => unreachable!("Bug: a sensor of an object without a pose"),
        };
        let arm = sub(&position, &data.subtree_com()[ffi::size(model.body_rootid()[body])]);
        Self { body, position, rotation, quaternion: math::mul_quat(&data.xquat()[body], &offset), arm }
    }

    /// Returns a vector of the world in the axes of the frame.
    pub(super) fn to_local(self, vector: &Vec3) -> Vec3 {
        std::array::from_fn(|axis| (0..3).map(|i| self.rotation[3 * i + axis] * vector[i]).sum())
    }

    /// Returns an axis of the frame.
    pub(super) fn axis(&self, axis: usize) -> Vec3 {
        std::array::from_fn(|i| self.rotation[3 * i + axis])
    }

    /// Returns a motion vector about the reference point of the tree as one about the origin of the
    /// frame.
    pub(super) fn at_origin(&self, motion: &Spatial) -> Spatial {
        spatial(&angular(motion), &velocity_at(motion, &self.arm))
    }

    /// Returns the torque, about the origin of the frame, of a force vector about the reference
    /// point of the tree.
    pub(super) fn torque(&self, force: &Spatial) -> Vec3 {
        sub(&angular(force), &cross(&self.arm, &linear(force)))
    }

    /// Returns the velocity of the frame, about its origin, in the world's axes.
    pub(super) fn velocity(&self, data: &Data) -> Spatial {
        self.at_origin(&data.cvel()[self.body])
    }

    /// Returns the degrees of freedom that move the frame.
    pub(super) fn dofs<'a>(&self, point: Point<'a>) -> impl Iterator<Item = usize> + use<'a> {
        point.tree.chain(point.tree.last[self.body])
    }
}

/// Returns `true` if the pose of an object is fixed to a body.
fn is_fixed(model: &Model, kind: i32, object: i32) -> bool {
    let kind = kind as u32;
    // Other cameras follow or face a body.
    let is_camera = || kind == mjOBJ_CAMERA && model.cam_mode()[ffi::size(object)] as u32 == mjCAMLIGHT_FIXED;
    [mjOBJ_BODY, mjOBJ_XBODY, mjOBJ_GEOM, mjOBJ_SITE].contains(&kind) || is_camera()
}
