//! Viewpoints of a scene, and the transform between model space and room space.

use std::ffi::c_int;

use mujoco_sys::adapted::{self, SceneProjection};
use mujoco_sys::{self as sys, guard, mjvGLCamera};

use super::camera::check_motion;
use super::{MouseAction, Scene};
use crate::error::{Error, Result};
use crate::ffi;
use crate::model::Model;

/// Viewpoint of one eye: pose and frustum, in single precision.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Viewpoint {
    /// Position, m.
    pub pos: [f32; 3],
    /// Viewing direction.
    pub forward: [f32; 3],
    /// Upward direction of the image.
    pub up: [f32; 3],
    /// Centre of the near plane, m to the right of `forward`.
    pub frustum_center: f32,
    /// Half the width of the near plane, m. Zero if the width follows from the height and the
    /// aspect ratio of the image, as it always does with engines before 3.0.
    pub frustum_width: f32,
    /// Lower edge of the near plane, m.
    pub frustum_bottom: f32,
    /// Upper edge of the near plane, m.
    pub frustum_top: f32,
    /// Distance of the near plane, m.
    pub frustum_near: f32,
    /// Distance of the far plane, m.
    pub frustum_far: f32,
    /// Marks an orthographic projection, in which the edges of the near plane are the edges of the
    /// image at every depth. With engines from 3.2.
    pub orthographic: bool,
}

impl Viewpoint {
    fn new(raw: &mjvGLCamera) -> Self {
        let &mjvGLCamera { pos, forward, up, .. } = raw;
        let &mjvGLCamera { frustum_center, frustum_bottom, frustum_top, frustum_near, frustum_far, .. } = raw;
        // SAFETY: a valid structure, of which the function reads numbers.
        let projection = unsafe { adapted::scene_projection(raw) };
        Self {
            pos,
            forward,
            up,
            frustum_center,
            frustum_width: projection.half_width,
            frustum_bottom,
            frustum_top,
            frustum_near,
            frustum_far,
            orthographic: projection.orthographic != 0,
        }
    }

    /// Converts the viewpoint to the engine's structure.
    fn raw(&self) -> Result<mjvGLCamera> {
        let &Self { pos, forward, up, .. } = self;
        let &Self { frustum_center, frustum_bottom, frustum_top, frustum_near, frustum_far, .. } = self;
        // SAFETY: all-zero bytes are a valid structure of numbers.
        let mut raw: mjvGLCamera = unsafe { std::mem::zeroed() };
        (raw.pos, raw.forward, raw.up) = (pos, forward, up);
        (raw.frustum_center, raw.frustum_bottom, raw.frustum_top) = (frustum_center, frustum_bottom, frustum_top);
        (raw.frustum_near, raw.frustum_far) = (frustum_near, frustum_far);
        let projection =
            SceneProjection { half_width: self.frustum_width, orthographic: c_int::from(self.orthographic) };
        // SAFETY: two valid structures.
        if unsafe { adapted::set_scene_projection(&raw mut raw, &raw const projection) } == 0 {
            return Err(Error::Unsupported(
                "the width of a frustum with engines before 3.0, or an orthographic viewpoint with engines before 3.2"
                    .to_owned(),
            ));
        }
        Ok(raw)
    }

    /// Returns half the width of the near plane for images with this ratio of width to height, m.
    #[cfg(feature = "renderer")]
    pub(crate) fn half_width(&self, aspect: f64) -> f64 {
        if self.frustum_width > 0.0 {
            self.frustum_width.into()
        } else {
            0.5 * aspect * (f64::from(self.frustum_top) - f64::from(self.frustum_bottom))
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        let frustum = [
            self.frustum_center,
            self.frustum_width,
            self.frustum_bottom,
            self.frustum_top,
            self.frustum_near,
            self.frustum_far,
        ];
        self.pos.iter().chain(&self.forward).chain(&self.up).chain(&frustum).all(|number| number.is_finite())
    }
}

/// Pose of the head midway between the two eyes, in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// Position, m.
    pub pos: [f64; 3],
    /// Viewing direction.
    pub forward: [f64; 3],
    /// Upward direction.
    pub up: [f64; 3],
}

/// Transform from model space to room space, for virtual reality. The model is rotated, then
/// translated, then scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Translation, m.
    pub translate: [f32; 3],
    /// Rotation, `[w, x, y, z]`.
    pub rotate: [f32; 4],
    /// Scale factor.
    pub scale: f32,
}

impl Scene {
    /// Replaces perspective viewpoints by orthographic ones, whose images show the same height at a
    /// distance, m. Requires an engine from 3.2.
    #[cfg(feature = "viewer")]
    pub(crate) fn make_orthographic(&mut self, distance: f64) -> Result<()> {
        let viewpoints = self.viewpoints().map(|viewpoint| {
            if viewpoint.orthographic {
                return viewpoint;
            }
            let ratio = (distance / f64::from(viewpoint.frustum_near)) as f32;
            Viewpoint {
                frustum_center: ratio * viewpoint.frustum_center,
                frustum_width: ratio * viewpoint.frustum_width,
                frustum_bottom: ratio * viewpoint.frustum_bottom,
                frustum_top: ratio * viewpoint.frustum_top,
                orthographic: true,
                ..viewpoint
            }
        });
        self.set_viewpoints(viewpoints)
    }

    /// Returns the viewpoints of the left and the right eye. They are equal if the camera has no
    /// interpupillary distance, and zero before the first update.
    pub fn viewpoints(&self) -> [Viewpoint; 2] {
        [0, 1].map(|eye| Viewpoint::new(&self.raw().camera[eye]))
    }

    /// Returns the average of both viewpoints, from which a monoscopic image is rendered.
    #[doc(alias = "mjv_averageCamera")]
    pub fn viewpoint(&self) -> Viewpoint {
        let [left, right] = &self.raw().camera;
        // SAFETY: two valid structures; the function returns their average by value.
        Viewpoint::new(&unsafe { sys::mjv_averageCamera(left, right) })
    }

    /// Sets the viewpoints. An update with [`CameraView::User`](super::CameraView::User) keeps
    /// them.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless all values are finite, 0 < near < far, bottom < top, and the width
    /// is not negative; [`Error::Unsupported`] for a projection that the engine lacks.
    pub fn set_viewpoints(&mut self, viewpoints: [Viewpoint; 2]) -> Result<()> {
        for viewpoint in &viewpoints {
            let ordered = viewpoint.frustum_near > 0.0 && viewpoint.frustum_far > viewpoint.frustum_near;
            let is_open = viewpoint.frustum_top > viewpoint.frustum_bottom && viewpoint.frustum_width >= 0.0;
            if !(viewpoint.is_finite() && ordered && is_open) {
                return Err(Error::out_of_range(
                    "a viewpoint",
                    format!("{viewpoint:?}"),
                    "finite, with a frustum of 0 < near < far and bottom < top, whose width is not negative",
                ));
            }
        }
        let [left, right] = &viewpoints;
        self.raw_mut().camera = [left.raw()?, right.raw()?];
        Ok(())
    }

    /// Returns the height of the frustum at unit distance, averaged over the eyes.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] before the first update.
    #[doc(alias = "mjv_frustumHeight")]
    pub fn frustum_height(&self) -> Result<f64> {
        let mut height = 0.0;
        // SAFETY: a valid scene, and a valid place for the result.
        let status = unsafe { guard::mjv_frustum_height(self.as_ptr(), &raw mut height) };
        ffi::check_without_data("mjv_frustumHeight", status)?;
        Ok(height)
    }

    /// Returns the pose of the head in model space.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] before the first update.
    #[doc(alias = "mjv_cameraInModel")]
    pub fn camera_in_model(&self) -> Result<Head> {
        self.head("mjv_cameraInModel", guard::mjv_camera_in_model)
    }

    /// Returns the pose of the head in room space, which equals model space without a
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
        // SAFETY: one of the two functions above, with three arrays of three numbers.
        ffi::check_without_data(function, unsafe { call(pos, forward, up, self.as_ptr()) })?;
        Ok(head)
    }

    /// Returns the transform from model space to room space, if one is set.
    pub fn transform(&self) -> Option<Transform> {
        let &sys::mjvScene { enabletransform, translate, rotate, scale, .. } = self.raw();
        (enabletransform != 0).then_some(Transform { translate, rotate, scale })
    }

    /// Sets the transform from model space to room space. An update removes it, unless its camera
    /// is [`CameraView::User`](super::CameraView::User).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless all values are finite, the quaternion is not zero and the scale is
    /// in 0.01 to 100.
    #[doc(alias = "enabletransform")]
    pub fn set_transform(&mut self, transform: Option<Transform>) -> Result<()> {
        let Some(Transform { translate, rotate, scale }) = transform else {
            self.raw_mut().enabletransform = 0;
            return Ok(());
        };
        let finite = translate.iter().chain(&rotate).all(|number| number.is_finite());
        if !(finite && rotate != [0.0; 4] && (0.01..=100.0).contains(&scale)) {
            return Err(Error::out_of_range(
                "a transform",
                format!("{transform:?}"),
                "finite, with a quaternion that is not zero and a scale from 0.01 to 100",
            ));
        }
        let raw = self.raw_mut();
        (raw.enabletransform, raw.translate, raw.rotate, raw.scale) = (1, translate, rotate, scale);
        Ok(())
    }

    /// Moves the model in room space in response to a mouse motion `[dx, dy]`, as fractions of the
    /// window height. Has no effect without a [`transform`](Self::transform). `roomup` is the
    /// upward direction of the room.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for another model, [`Error::Invalid`] if a value is not finite or the
    /// moved transform would be invalid, [`Error::Engine`] for a scene with a transform before its
    /// first update.
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
        // SAFETY: a valid action, three numbers, and a model that the scene belongs to.
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

    /// Converts a pose from room space to model space: position, m, and orientation `[w, x, y, z]`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the scale is too small, which [`set_transform`](Self::set_transform)
    /// prevents.
    #[doc(alias = "mjv_room2model")]
    pub fn room_to_model(&self, pos: [f64; 3], quat: [f64; 4]) -> Result<([f64; 3], [f64; 4])> {
        self.convert("mjv_room2model", guard::mjv_room2model, pos, quat)
    }

    /// Converts a pose from model space to room space: position, m, and orientation `[w, x, y, z]`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the scale is too small, which [`set_transform`](Self::set_transform)
    /// prevents.
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
        // SAFETY: one of the two functions above, with arrays of three and four numbers for inputs
        // and outputs.
        ffi::check_without_data(function, unsafe { call(to.0, to.1, from.0, from.1, self.as_ptr()) })?;
        Ok((to_pos, to_quat))
    }
}

/// Rotates a vector about z by the angle from y to the horizontal component of `forward`. This maps
/// the forward direction of a mouse to the forward direction of the camera.
///
/// ```
/// use mujoco_safe::scene::align_to_camera;
///
/// let ahead = align_to_camera([0.0, 1.0, 0.0], [1.0, 0.0, -0.5]);
/// assert_eq!(ahead, [1.0, 0.0, 0.0]);
/// ```
pub fn align_to_camera(vec: [f64; 3], forward: [f64; 3]) -> [f64; 3] {
    let mut res = [0.0; 3];
    // SAFETY: arrays of three numbers; the function cannot fail.
    unsafe { sys::mjv_alignToCamera(res.as_mut_ptr(), vec.as_ptr(), forward.as_ptr()) };
    res
}
