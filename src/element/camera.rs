//! Cameras.

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::CameraMode;
use crate::id::{BodyId, kind};
use crate::model::{Model, ModelMut};

fields!(Camera on Model {
    /// What it does while its body moves.
    mode: {CameraMode} = |camera| CameraMode::of_field(camera.owner.cam_mode()[camera.index()]);
    /// The body that it belongs to.
    body: {BodyId} = |camera| camera.id_in(camera.owner.cam_bodyid());
    /// The body that it turns to, if its mode has one.
    #[doc(alias = "targetbodyid")]
    target: {Option<BodyId>} = |camera| camera.optional_id_in(camera.owner.cam_targetbodyid());
    /// Position in the frame of its body, m.
    pos: [f64; 3] = cam_pos, pos_mut in cam_pos_mut;
    /// Orientation in the frame of its body: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = cam_quat, quat_mut in cam_quat_mut;
    /// Position relative to the centre of mass of its subtree in the reference configuration, m.
    poscom0: [f64; 3] = cam_poscom0;
    /// Position relative to its body in the reference configuration, m, world frame.
    pos0: [f64; 3] = cam_pos0;
    /// Orientation in the reference configuration, as a row-major rotation matrix.
    mat0: [f64; 9] = cam_mat0;
    /// Vertical field of view, degrees.
    fovy: f64 = cam_fovy, set_fovy in cam_fovy_mut;
    /// Distance between the eyes, m.
    ipd: f64 = cam_ipd, set_ipd in cam_ipd_mut;
    /// The user's own numbers.
    user: [f64] = cam_user, user_mut in cam_user_mut;
});

fields!(Camera on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = cam_xpos;
    /// Orientation as a row-major rotation matrix, world frame. The camera looks along its negative z axis.
    xmat: [f64; 9] = cam_xmat;
});
