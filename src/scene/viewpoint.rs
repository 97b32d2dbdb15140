//! The eyes of a scene, and the room that it stands in.

use mujoco_sys::{self as sys, guard, mjvGLCamera};

use super::camera::check_motion;
use super::{MouseAction, Scene};
use crate::error::{Error, Result};
use crate::ffi;
use crate::model::Model;

/// One eye: a pose and a frustum, in single precision.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[doc(alias = "mjvGLCamera")]
pub struct Viewpoint {
    /// Position, m.
    pub pos: [f32; 3],
    /// The direction in which it looks.
    pub forward: [f32; 3],
    /// The direction that is up in the picture.
    pub up: [f32; 3],
    /// The middle of the frustum's near side, right of `forward`, m. Its width follows from its height and the window.
    pub frustum_center: f32,
    /// The lower edge of the near side, m.
    pub frustum_bottom: f32,
    /// Its upper edge, m.
    pub frustum_top: f32,
    /// The distance of the near side, m.
    pub frustum_near: f32,
    /// The distance of the far side, m.
    pub frustum_far: f32,
}

impl Viewpoint {
    fn new(raw: &mjvGLCamera) -> Self {
        let &mjvGLCamera { pos, forward, up, .. } = raw;
        let &mjvGLCamera { frustum_center, frustum_bottom, frustum_top, frustum_near, frustum_far, .. } = raw;
        Self { pos, forward, up, frustum_center, frustum_bottom, frustum_top, frustum_near, frustum_far }
    }

    fn raw(&self) -> mjvGLCamera {
        let &Self { pos, forward, up, .. } = self;
        let &Self { frustum_center, frustum_bottom, frustum_top, frustum_near, frustum_far, .. } = self;
        mjvGLCamera { pos, forward, up, frustum_center, frustum_bottom, frustum_top, frustum_near, frustum_far }
    }

    pub(super) fn is_finite(&self) -> bool {
        let frustum = [self.frustum_center, self.frustum_bottom, self.frustum_top, self.frustum_near, self.frustum_far];
        self.pos.iter().chain(&self.forward).chain(&self.up).chain(&frustum).all(|number| number.is_finite())
    }
}

/// The head that has the two eyes, in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// Position, m.
    pub pos: [f64; 3],
    /// The direction in which it looks.
    pub forward: [f64; 3],
    /// The direction that is up.
    pub up: [f64; 3],
}

/// How a model stands in the room of the viewer: for virtual reality. First it is turned, then shifted, then scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The shift, m.
    pub translate: [f32; 3],
    /// The turn, `[w, x, y, z]`.
    pub rotate: [f32; 4],
    /// The scale.
    pub scale: f32,
}

impl Scene {
    /// The left and the right eye. They are the same for a camera whose distance of the eyes is zero, and zero before the first
    /// update.
    pub fn viewpoints(&self) -> [Viewpoint; 2] {
        [0, 1].map(|eye| Viewpoint::new(&self.raw().camera[eye]))
    }

    /// The middle between the eyes: what a picture with one eye is drawn from.
    #[doc(alias = "mjv_averageCamera")]
    pub fn viewpoint(&self) -> Viewpoint {
        let [left, right] = &self.raw().camera;
        // SAFETY: two valid structures, of which it makes a third.
        Viewpoint::new(&unsafe { sys::mjv_averageCamera(left, right) })
    }

    /// Sets the eyes, which an update with [`CameraView::User`](super::CameraView::User) leaves as they are.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the numbers are finite, the near side is before the eye and the far side behind it.
    pub fn set_viewpoints(&mut self, viewpoints: [Viewpoint; 2]) -> Result<()> {
        for viewpoint in &viewpoints {
            let ordered = viewpoint.frustum_near > 0.0 && viewpoint.frustum_far > viewpoint.frustum_near;
            if !(viewpoint.is_finite() && ordered && viewpoint.frustum_top > viewpoint.frustum_bottom) {
                return Err(Error::invalid(
                    "a viewpoint",
                    format!("{viewpoint:?}"),
                    "finite, with a frustum of 0 < near < far and bottom < top",
                ));
            }
        }
        self.raw_mut().camera = viewpoints.map(|viewpoint| viewpoint.raw());
        Ok(())
    }

    /// The height of the frustum at a distance of 1, the mean over the eyes.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] before the first update.
    #[doc(alias = "mjv_frustumHeight")]
    pub fn frustum_height(&self) -> Result<f64> {
        let mut height = 0.0;
        // SAFETY: a scene, and a place for the result.
        let status = unsafe { guard::mjv_frustum_height(self.as_ptr(), &raw mut height) };
        ffi::check_without_data("mjv_frustumHeight", status)?;
        Ok(height)
    }

    /// The middle between the eyes in the model's frame.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] before the first update.
    #[doc(alias = "mjv_cameraInModel")]
    pub fn camera_in_model(&self) -> Result<Head> {
        self.head("mjv_cameraInModel", guard::mjv_camera_in_model)
    }

    /// The middle between the eyes in the frame of the room, which is the model's unless there is a
    /// [`transform`](Self::transform).
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] before the first update.
    #[doc(alias = "mjv_cameraInRoom")]
    pub fn camera_in_room(&self) -> Result<Head> {
        self.head("mjv_cameraInRoom", guard::mjv_camera_in_room)
    }

    fn head(
        &self,
        function: &'static str,
        call: unsafe extern "C" fn(*mut f64, *mut f64, *mut f64, *const sys::mjvScene) -> i32,
    ) -> Result<Head> {
        let mut head = Head { pos: [0.0; 3], forward: [0.0; 3], up: [0.0; 3] };
        let (pos, forward, up) = (head.pos.as_mut_ptr(), head.forward.as_mut_ptr(), head.up.as_mut_ptr());
        // SAFETY: one of the two functions above, with three places for three numbers.
        ffi::check_without_data(function, unsafe { call(pos, forward, up, self.as_ptr()) })?;
        Ok(head)
    }

    /// How the model stands in the room; `None` for as it is.
    pub fn transform(&self) -> Option<Transform> {
        let &sys::mjvScene { enabletransform, translate, rotate, scale, .. } = self.raw();
        (enabletransform != 0).then_some(Transform { translate, rotate, scale })
    }

    /// Sets how the model stands in the room. An update takes it away, unless its camera is
    /// [`CameraView::User`](super::CameraView::User).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the numbers are finite, the quaternion is not zero and the scale is from 0.01 to 100.
    #[doc(alias = "enabletransform")]
    pub fn set_transform(&mut self, transform: Option<Transform>) -> Result<()> {
        let Some(Transform { translate, rotate, scale }) = transform else {
            self.raw_mut().enabletransform = 0;
            return Ok(());
        };
        let finite = translate.iter().chain(&rotate).all(|number| number.is_finite());
        if !(finite && rotate != [0.0; 4] && (0.01..=100.0).contains(&scale)) {
            return Err(Error::invalid(
                "a transform",
                format!("{transform:?}"),
                "finite, with a quaternion that is not zero and a scale from 0.01 to 100",
            ));
        }
        let raw = self.raw_mut();
        (raw.enabletransform, raw.translate, raw.rotate, raw.scale) = (1, translate, rotate, scale);
        Ok(())
    }

    /// Moves the model in the room as a mouse does: by `[dx, dy]`, in heights of the window. Nothing without a
    /// [`transform`](Self::transform). `roomup` is what is up in the room.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for another model, [`Error::Invalid`] for numbers that are not finite or would make the transform
    /// so, [`Error::Engine`] for a scene with a transform before its first update.
    #[doc(alias = "mjv_moveModel")]
    pub fn move_model(
        &mut self,
        model: &Model,
        action: MouseAction,
        [dx, dy]: [f64; 2],
        roomup: [f64; 3],
    ) -> Result<()> {
        self.check_model(model, "the model to move")?;
        check_motion([dx, dy])?;
        let before = self.transform();
        // SAFETY: an action that there is, three numbers, a scene of the model's lineage.
        let status =
            unsafe { guard::mjv_move_model(model.as_ptr(), action.raw(), dx, dy, roomup.as_ptr(), self.raw_mut()) };
        ffi::check_without_data("mjv_moveModel", status)?;
        let moved = self.transform();
        if let Err(error) = self.set_transform(moved) {
            self.set_transform(before)?;
            return Err(error);
        }
        Ok(())
    }

    /// A pose of the room in the model's frame: position, and orientation `[w, x, y, z]`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the scale is too small, which [`set_transform`](Self::set_transform) rules out.
    #[doc(alias = "mjv_room2model")]
    pub fn room_to_model(&self, pos: [f64; 3], quat: [f64; 4]) -> Result<([f64; 3], [f64; 4])> {
        self.convert("mjv_room2model", guard::mjv_room2model, pos, quat)
    }

    /// A pose of the model in the frame of the room: position, and orientation `[w, x, y, z]`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the scale is too small, which [`set_transform`](Self::set_transform) rules out.
    #[doc(alias = "mjv_model2room")]
    pub fn model_to_room(&self, pos: [f64; 3], quat: [f64; 4]) -> Result<([f64; 3], [f64; 4])> {
        self.convert("mjv_model2room", guard::mjv_model2room, pos, quat)
    }

    fn convert(
        &self,
        function: &'static str,
        call: unsafe extern "C" fn(*mut f64, *mut f64, *const f64, *const f64, *const sys::mjvScene) -> i32,
        pos: [f64; 3],
        quat: [f64; 4],
    ) -> Result<([f64; 3], [f64; 4])> {
        let (mut to_pos, mut to_quat) = ([0.0; 3], [0.0; 4]);
        let (from, to) = ((pos.as_ptr(), quat.as_ptr()), (to_pos.as_mut_ptr(), to_quat.as_mut_ptr()));
        // SAFETY: one of the two functions above, with three and four numbers, and as many places.
        ffi::check_without_data(function, unsafe { call(to.0, to.1, from.0, from.1, self.as_ptr()) })?;
        Ok((to_pos, to_quat))
    }
}

/// A vector turned about z by the angle between y and the horizontal part of `forward`: what is ahead of a mouse in what is ahead
/// of a camera.
///
/// ```
/// use mujoco_safe::scene::align_to_camera;
///
/// let ahead = align_to_camera([0.0, 1.0, 0.0], [1.0, 0.0, -0.5]);
/// assert_eq!(ahead, [1.0, 0.0, 0.0]);
/// ```
#[doc(alias = "mjv_alignToCamera")]
pub fn align_to_camera(vec: [f64; 3], forward: [f64; 3]) -> [f64; 3] {
    let mut res = [0.0; 3];
    // SAFETY: three numbers each; the function cannot fail.
    unsafe { sys::mjv_alignToCamera(res.as_mut_ptr(), vec.as_ptr(), forward.as_ptr()) };
    res
}
