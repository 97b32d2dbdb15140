//! The camera: where a scene is seen from.

use std::ffi::c_int;

use mujoco_sys::{self as sys, guard, mjvCamera};

use super::Scene;
use crate::data::{Data, Stage};
use crate::enums::engine_enum;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, CameraId, Id};
use crate::model::Model;

/// What a camera does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[doc(alias = "mjtCamera")]
pub enum CameraView {
    /// It looks at a point that the user moves.
    Free,
    /// It looks at the centre of mass of a body and all below it, which it follows.
    #[doc(alias = "trackbodyid")]
    Tracking(BodyId),
    /// It is a camera of the model's.
    #[doc(alias = "fixedcamid")]
    Fixed(CameraId),
    /// It is what [`Scene::set_viewpoints`] says.
    User,
}

engine_enum! {
    /// What the motion of a mouse does.
    #[doc(alias = "mjtMouse")]
    MouseAction {
        /// It rotates, in a vertical plane.
        RotateV = mjMOUSE_ROTATE_V,
        /// It rotates, in a horizontal plane.
        RotateH = mjMOUSE_ROTATE_H,
        /// It moves, in a vertical plane.
        MoveV = mjMOUSE_MOVE_V,
        /// It moves, in a horizontal plane.
        MoveH = mjMOUSE_MOVE_H,
        /// It zooms.
        Zoom = mjMOUSE_ZOOM,
    }
}

/// A camera. The numbers are those of the free and of the tracking view.
///
/// ```
/// use mujoco_safe::scene::{Camera, CameraView};
/// use mujoco_safe::sample;
///
/// let model = sample::humanoid();
/// let mut camera = Camera::free(&model);
/// camera.azimuth += 90.0;
/// camera.view = CameraView::Tracking(model.body("torso")?.id());
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "mjvCamera")]
pub struct Camera {
    /// What it does.
    pub view: CameraView,
    /// The point that it looks at, m, world frame. A tracking camera moves it a fifth of the way to the body at each update.
    pub lookat: [f64; 3],
    /// Its distance from that point, m.
    pub distance: f64,
    /// The direction that it looks in, about z from x, degrees.
    pub azimuth: f64,
    /// Its direction above the horizontal, degrees: negative looks down.
    pub elevation: f64,
}

impl Default for Camera {
    /// As in the engine: free, 2 m from the zero point, looking along y and 45° down.
    #[doc(alias = "mjv_defaultCamera")]
    fn default() -> Self {
        Self { view: CameraView::Free, lookat: [0.0; 3], distance: 2.0, azimuth: 90.0, elevation: -45.0 }
    }
}

impl Camera {
    /// The free camera that shows the whole model, from the direction of its visual settings.
    #[doc(alias = "mjv_defaultFreeCamera")]
    pub fn free(model: &Model) -> Self {
        let global = &model.raw().vis.global;
        let mut camera = Self { azimuth: global.azimuth.into(), elevation: global.elevation.into(), ..Self::default() };
        camera.align(model);
        camera
    }

    /// As [`free`](Self::free), following a body.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[track_caller]
    pub fn tracking(model: &Model, body: BodyId) -> Self {
        model.check_id(body);
        Self { view: CameraView::Tracking(body), ..Self::free(model) }
    }

    /// A camera of the model's.
    pub fn fixed(camera: CameraId) -> Self {
        Self { view: CameraView::Fixed(camera), ..Self::default() }
    }

    /// Makes it free, with the middle of the model before it, from the direction that it has.
    pub fn align(&mut self, model: &Model) {
        let stat = &model.raw().stat;
        self.view = CameraView::Free;
        self.lookat = stat.center;
        self.distance = 1.5 * stat.extent;
    }

    /// Moves it as a mouse does: by `[dx, dy]`, in heights of the window, right and down. Does nothing to a camera of the model's.
    /// A tracking camera does not let itself be pushed off its body.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for the scene of another model, [`Error::Invalid`] for numbers that are not finite or would make the
    /// camera so, [`Error::Engine`] if it is to be pushed in a scene that was not updated.
    ///
    /// # Panics
    ///
    /// If the body or camera that it views is of another model.
    ///
    /// ```
    /// use mujoco_safe::scene::{Camera, MouseAction, Scene};
    /// use mujoco_safe::sample;
    ///
    /// let model = sample::humanoid();
    /// let scene = Scene::new(&model, 100)?;
    /// let mut camera = Camera::free(&model);
    /// let before = camera.distance;
    /// camera.move_by(&model, &scene, MouseAction::Zoom, [0.0, 0.05])?;
    /// assert!(camera.distance < before);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjv_moveCamera")]
    pub fn move_by(&mut self, model: &Model, scene: &Scene, action: MouseAction, [dx, dy]: [f64; 2]) -> Result<()> {
        scene.check_model(model, "the scene that a camera is moved in")?;
        let mut raw = self.raw(model)?;
        check_motion([dx, dy])?;
        // SAFETY: an action that there is, and a model of the scene's lineage.
        let status =
            unsafe { guard::mjv_move_camera(model.as_ptr(), action.raw(), dx, dy, scene.as_ptr(), &raw mut raw) };
        ffi::check_without_data("mjv_moveCamera", status)?;
        let mut moved = *self;
        moved.take(&raw);
        moved.check()?;
        *self = moved;
        Ok(())
    }

    /// As the engine keeps it.
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
        Ok(mjvCamera { type_: view as c_int, fixedcamid, trackbodyid, lookat, distance, azimuth, elevation })
    }

    /// Takes over what the engine changed.
    pub(super) fn take(&mut self, raw: &mjvCamera) {
        self.lookat = raw.lookat;
        (self.distance, self.azimuth, self.elevation) = (raw.distance, raw.azimuth, raw.elevation);
    }

    fn check(&self) -> Result<()> {
        let numbers = [self.distance, self.azimuth, self.elevation];
        // A scene has single precision.
        if numbers.iter().chain(&self.lookat).all(|&number| (number as f32).is_finite()) {
            return Ok(());
        }
        Err(Error::invalid("a number of the camera", format!("{self:?}"), "finite in single precision"))
    }
}

#[track_caller]
fn checked<K: crate::id::ElementKind>(model: &Model, id: Id<K>) -> c_int {
    model.check_id(id);
    id.index() as c_int
}

/// Refuses a motion that is none.
pub(super) fn check_motion(motion: [f64; 2]) -> Result<()> {
    if motion.iter().all(|number| number.is_finite()) {
        return Ok(());
    }
    Err(Error::invalid("the motion of the mouse", format!("{motion:?}"), "finite"))
}

impl Scene {
    /// Puts the eyes where a free camera is, or a tracking one that does not move along: for a picture from elsewhere than the last
    /// update, without a simulation. Nothing for others, whose poses a simulation has.
    #[cfg(feature = "viewer")]
    pub(crate) fn look(&mut self, model: &Model, camera: &Camera) -> Result<()> {
        self.check_model(model, "the model to look at")?;
        if !matches!(camera.view, CameraView::Free | CameraView::Tracking(_)) {
            return Ok(());
        }
        let mut raw = Camera { view: CameraView::Free, ..*camera }.raw(model)?;
        let (model, scene) = (model.as_ptr(), self.raw_mut());
        // SAFETY: a model of the scene's lineage. For a free camera the function reads no simulation.
        let status = unsafe { guard::mjv_update_camera(model, std::ptr::null_mut(), &raw mut raw, scene) };
        ffi::check_without_data("mjv_updateCamera", status)
    }

    /// Brings only the viewpoints up to date. An [`update`](Self::update) puts the middle of an infinite plane near the viewpoints
    /// of the update before; call this first where there was none, for a single picture say.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::OtherModel`] for the data of another model,
    /// [`Error::Invalid`] for numbers of the camera that are not finite.
    ///
    /// # Panics
    ///
    /// If the body or camera that the camera views is of another model.
    #[doc(alias = "mjv_updateCamera")]
    pub fn update_camera(&mut self, data: &Data, camera: &mut Camera) -> Result<()> {
        self.check_model(data.model(), "the data to show")?;
        data.check_computed("Scene::update_camera", Stage::Position)?;
        let mut raw = camera.raw(data.model())?;
        let scene = self.raw_mut();
        data.call("mjv_updateCamera", |m, d| {
            // SAFETY: a model and a data that go together, whose poses were computed, and which the function only reads although
            // its pointer is not const; ids of the model.
            unsafe { guard::mjv_update_camera(m, d.cast_mut(), &raw mut raw, scene) }
        })?;
        camera.take(&raw);
        Ok(())
    }
}
