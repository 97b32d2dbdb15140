//! Camera of a scene: free, tracking a body, or fixed in the model.

use std::ffi::c_int;

use mujoco_sys::{self as sys, adapted, guard, mjvCamera};

use super::Scene;
use super::needs::check_poses;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, CameraId, Id, IntoId};
use crate::kind;
use crate::macros::engine_enum;
use crate::model::Model;

/// Mode of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CameraView {
    /// The camera points at [`Camera::lookat`], which the user moves.
    Free,
    /// The camera points at the centre of mass of a body's subtree, and follows it.
    #[doc(alias = "trackbodyid")]
    Tracking(BodyId),
    /// A camera that the model defines.
    #[doc(alias = "fixedcamid")]
    Fixed(CameraId),
    /// The viewpoints set by [`Scene::set_viewpoints`].
    User,
}

engine_enum! {
    /// Effect of a mouse motion.
    MouseAction {
        /// Rotates in a vertical plane.
        RotateV = mjMOUSE_ROTATE_V,
        /// Rotates in a horizontal plane.
        RotateH = mjMOUSE_ROTATE_H,
        /// Moves in a vertical plane.
        MoveV = mjMOUSE_MOVE_V,
        /// Moves in a horizontal plane.
        MoveH = mjMOUSE_MOVE_H,
        /// Zooms.
        Zoom = mjMOUSE_ZOOM,
    }
}

/// Abstract camera. The numeric fields apply to the free and the tracking mode, whose field of view
/// and projection are the model's: `fovy` and, with engines from 3.2, `orthographic` of
/// `visual/global` in MJCF.
///
/// ```
/// use mujoco_safe::sample;
/// use mujoco_safe::scene::{Camera, CameraView};
///
/// let model = sample::humanoid();
/// let torso = model.body("torso")?.id();
/// let mut camera = Camera::tracking(&model, "torso")?; // an unknown name is an error
/// assert_eq!(camera, Camera::tracking(&model, torso)); // an id is always found
/// camera.azimuth += 90.0;
///
/// let side = Camera::fixed(&model, "side")?;
/// assert_eq!(side.view, CameraView::Fixed(model.camera("side")?.id()));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Mode.
    pub view: CameraView,
    /// Point at the centre of the view, m, world frame. Each update moves the `lookat` of a
    /// tracking camera a fifth of the way to the body.
    pub lookat: [f64; 3],
    /// Distance from the camera to `lookat`, m.
    pub distance: f64,
    /// Horizontal viewing direction, degrees about z, measured from x.
    pub azimuth: f64,
    /// Elevation of the viewing direction above the horizontal, degrees. Negative values look down.
    pub elevation: f64,
}

impl Default for Camera {
    /// Returns the engine's default: free, 2 m from the origin, looking along y and 45° down.
    #[doc(alias = "mjv_defaultCamera")]
    fn default() -> Self {
        Self { view: CameraView::Free, lookat: [0.0; 3], distance: 2.0, azimuth: 90.0, elevation: -45.0 }
    }
}

impl Camera {
    /// Creates a free camera that shows the complete model, in the direction given by the model's
    /// visual settings.
    #[doc(alias = "mjv_defaultFreeCamera")]
    pub fn free(model: &Model) -> Self {
        let global = &model.raw().vis.global;
        let mut camera = Self { azimuth: global.azimuth.into(), elevation: global.elevation.into(), ..Self::default() };
        camera.align(model);
        camera
    }

    /// Creates a camera as [`free`](Self::free) does, and lets it follow a body. An id or a view
    /// yields the camera itself; a name or an index yields a [`Result`].
    ///
    /// # Panics
    ///
    /// If the id or the view belongs to another model.
    #[track_caller]
    pub fn tracking<Q: IntoId<kind::Body>>(model: &Model, body: Q) -> Q::Found<Self> {
        body.find(model, |body| Self { view: CameraView::Tracking(body), ..Self::free(model) })
    }

    /// Creates a camera that reproduces a camera of the model. An id or a view yields the camera
    /// itself; a name or an index yields a [`Result`].
    ///
    /// # Panics
    ///
    /// If the id or the view belongs to another model.
    #[track_caller]
    pub fn fixed<Q: IntoId<kind::Camera>>(model: &Model, camera: Q) -> Q::Found<Self> {
        camera.find(model, |camera| Self { view: CameraView::Fixed(camera), ..Self::default() })
    }

    /// Switches to the free mode and centres the model, without a change of direction.
    pub fn align(&mut self, model: &Model) {
        let stat = &model.raw().stat;
        self.view = CameraView::Free;
        self.lookat = stat.center;
        self.distance = 1.5 * stat.extent;
    }

    /// Moves the camera in response to a mouse motion `[dx, dy]`, right and down, as fractions of
    /// the window height. Has no effect on a camera of the model. A tracking camera cannot be moved
    /// off its body.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a scene of another model, [`Error::Invalid`] if a value is not
    /// finite or would not be finite after the motion, [`Error::Engine`] for a translation in a
    /// scene that was never updated, with engines before 3.11.
    ///
    /// # Panics
    ///
    /// If the body or the camera in [`view`](Self::view) belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::scene::{Camera, MouseAction, Scene};
    /// use mujoco_safe::sample;
    ///
    /// let model = sample::humanoid();
    /// let scene = Scene::new(&model, 100)?;
    /// let mut camera = Camera::free(&model);
    /// let before = camera.distance;
    /// camera.move_by(&model, MouseAction::Zoom, [0.0, 0.05], &scene)?;
    /// assert!(camera.distance < before);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjv_moveCamera")]
    pub fn move_by(&mut self, model: &Model, action: MouseAction, [dx, dy]: [f64; 2], scene: &Scene) -> Result<()> {
        scene.check_model(model, "the scene that a camera is moved in")?;
        let mut raw = self.raw(model)?;
        check_motion([dx, dy])?;
        // SAFETY: a valid action, and a model that the scene belongs to.
        let status =
            unsafe { guard::mjv_move_camera(model.as_ptr(), action.raw(), dx, dy, scene.as_ptr(), &raw mut raw) };
        ffi::check_without_data("mjv_moveCamera", status)?;
        let mut moved = *self;
        moved.take(&raw);
        moved.check()?;
        *self = moved;
        Ok(())
    }

    /// Converts the camera to the engine's structure.
    #[track_caller]
    pub(super) fn raw(&self, model: &Model) -> Result<mjvCamera> {
        let (view, fixedcamid, trackbodyid) = match self.view {
            CameraView::Free => (sys::mjCAMERA_FREE, -1, -1),
            CameraView::Tracking(body) => (sys::mjCAMERA_TRACKING, -1, checked(model, body)),
            CameraView::Fixed(camera) => (sys::mjCAMERA_FIXED, checked(model, camera), -1),
            CameraView::User => (sys::mjCAMERA_USER, -1, -1),
        };
        self.check()?;
        let &Self { lookat, distance, azimuth, elevation, .. } = self;
        // SAFETY: the function sets all fields of the structure, including those that only newer
        // engines have.
        let mut raw: mjvCamera = unsafe { ffi::made_by(|raw| sys::mjv_defaultCamera(raw)) };
        if matches!(self.view, CameraView::Free | CameraView::Tracking(_)) {
            // SAFETY: a valid camera and a valid model.
            unsafe { adapted::set_free_projection(&raw mut raw, model.as_ptr()) };
        }
        (raw.type_, raw.fixedcamid, raw.trackbodyid) = (view as c_int, fixedcamid, trackbodyid);
        (raw.lookat, raw.distance, raw.azimuth, raw.elevation) = (lookat, distance, azimuth, elevation);
        Ok(raw)
    }

    /// Copies the fields that the engine changes.
    pub(super) fn take(&mut self, raw: &mjvCamera) {
        self.lookat = raw.lookat;
        (self.distance, self.azimuth, self.elevation) = (raw.distance, raw.azimuth, raw.elevation);
    }

    fn check(&self) -> Result<()> {
        let numbers = [self.distance, self.azimuth, self.elevation];
        // The scene stores single precision.
        if numbers.iter().chain(&self.lookat).all(|&number| (number as f32).is_finite()) {
            return Ok(());
        }
        Err(Error::out_of_range("a number of the camera", format!("{self:?}"), "finite in single precision"))
    }
}

#[track_caller]
fn checked<K: kind::ElementKind>(model: &Model, id: Id<K>) -> c_int {
    model.check_id(id);
    id.index() as c_int
}

/// Returns an error unless both components are finite.
pub(super) fn check_motion(motion: [f64; 2]) -> Result<()> {
    if motion.iter().all(|number| number.is_finite()) {
        return Ok(());
    }
    Err(Error::not_finite("the motion of the mouse", format!("{motion:?}")))
}

impl Scene {
    /// Moves the viewpoints to a camera without a simulation. A tracking camera keeps its `lookat`.
    /// Has no effect for the other modes, whose poses depend on a simulation.
    #[cfg(feature = "viewer")]
    pub(crate) fn look(&mut self, model: &Model, camera: &Camera) -> Result<()> {
        self.check_model(model, "the model to show")?;
        if !matches!(camera.view, CameraView::Free | CameraView::Tracking(_)) {
            return Ok(());
        }
        let mut raw = Camera { view: CameraView::Free, ..*camera }.raw(model)?;
        let (model, scene) = (model.as_ptr(), self.raw_mut());
        // SAFETY: a model that the scene belongs to. For a free camera the function does not
        // dereference the data.
        let status = unsafe { guard::mjv_update_camera(model, std::ptr::null_mut(), &raw mut raw, scene) };
        ffi::check_without_data("mjv_updateCamera", status)
    }

    /// Updates only the viewpoints.
    ///
    /// [`update`](Self::update) centres an infinite plane near the viewpoints of the previous
    /// update. Call this function first if there was no previous update, for example to render a
    /// single image.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] if positions have not been computed, [`Error::OtherModel`] for data
    /// of another model, [`Error::Invalid`] if the camera contains a value that is not finite.
    ///
    /// # Panics
    ///
    /// If the body or the camera in [`Camera::view`] belongs to another model.
    #[doc(alias = "mjv_updateCamera")]
    pub fn update_camera(&mut self, data: &Data, camera: &mut Camera) -> Result<()> {
        self.check_model(data.model(), "the data to show")?;
        check_poses("Scene::update_camera", data)?;
        let mut raw = camera.raw(data.model())?;
        let scene = self.raw_mut();
        data.call("mjv_updateCamera", |m, d| {
            // SAFETY: the model and the data belong together, the positions were computed, and the
            // ids are valid. The function only reads the data although its pointer is not const.
            unsafe { guard::mjv_update_camera(m, d.cast_mut(), &raw mut raw, scene) }
        })?;
        camera.take(&raw);
        Ok(())
    }
}
