//! Velocities and accelerations of coordinate frames, forces on bodies, and points in body frames.

use std::ffi::c_int;

use mujoco_sys::{self as sys, guard, mjData, mjModel, mjOBJ_BODY, mjOBJ_CAMERA, mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_XBODY};

use crate::data::{Data, PipelineFlags, Stage};
use crate::error::{Error, Result};
use crate::id::{BodyId, CameraId, GeomId, Id, IntoId, SiteId};
use crate::kind::{self, ElementKind};
use crate::model::Model;

/// Identifier of a coordinate frame that is attached to a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FrameId {
    /// Inertial frame of a body, at its centre of mass.
    #[doc(alias = "mjOBJ_BODY")]
    BodyInertia(BodyId),
    /// Frame of a body, relative to which its joints are defined.
    #[doc(alias = "mjOBJ_XBODY")]
    Body(BodyId),
    /// Frame of a geom.
    #[doc(alias = "mjOBJ_GEOM")]
    Geom(GeomId),
    /// Frame of a site.
    #[doc(alias = "mjOBJ_SITE")]
    Site(SiteId),
    /// Frame of a camera.
    #[doc(alias = "mjOBJ_CAMERA")]
    Camera(CameraId),
}

/// Axes of the components of a velocity or an acceleration. The reference point is the origin of
/// the object in both cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axes {
    /// Axes of the world.
    World,
    /// Axes of the object.
    Local,
}

/// Spatial velocity or acceleration of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SpatialVector {
    /// Angular part, rad/s or rad/s².
    pub angular: [f64; 3],
    /// Linear part, m/s or m/s².
    pub linear: [f64; 3],
}

/// # Velocities, forces and positions of frames
impl Data {
    /// Computes the velocity of a frame.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before velocities were computed.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::data::{Axes, FrameId};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qvel_mut()[0] = 2.0;
    /// data.forward()?;
    /// let cart = FrameId::Body(data.model().body("cart")?.id());
    /// assert_eq!(data.object_velocity(cart, Axes::World)?.linear, [2.0, 0.0, 0.0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_objectVelocity")]
    pub fn object_velocity(&self, object: FrameId, axes: Axes) -> Result<SpatialVector> {
        let (object_type, index) = self.object(object);
        self.check_computed("object_velocity", Stage::Velocity)?;
        self.motion("mj_objectVelocity", |m, d, result| {
            // SAFETY: an object of this model, of a type with a frame, and a result of six
            // elements.
            unsafe { guard::mj_object_velocity(m, d, object_type, index, result, (axes == Axes::Local).into()) }
        })
    }

    /// Computes the acceleration of a frame as an accelerometer measures it, gravity included: a
    /// frame at rest accelerates upwards.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before [`rne_post_constraint`](Self::rne_post_constraint), which
    /// computes the accelerations of bodies.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::data::{Axes, FrameId};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?; // in the air
    /// data.forward()?;
    /// data.rne_post_constraint()?;
    /// let torso = FrameId::BodyInertia(data.model().body("torso")?.id());
    /// let acceleration = data.object_acceleration(torso, Axes::World)?;
    /// assert!(acceleration.linear[2].abs() < 9.81);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_objectAcceleration")]
    pub fn object_acceleration(&self, object: FrameId, axes: Axes) -> Result<SpatialVector> {
        let (object_type, index) = self.object(object);
        self.check_parts("object_acceleration", PipelineFlags::POST_CONSTRAINT)?;
        self.motion("mj_objectAcceleration", |m, d, result| {
            // SAFETY: as for the velocity; the accelerations of bodies have been computed.
            unsafe { guard::mj_object_acceleration(m, d, object_type, index, result, (axes == Axes::Local).into()) }
        })
    }

    /// Makes a call that writes the motion of a frame to six elements.
    fn motion(
        &self,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *const mjData, *mut f64) -> c_int,
    ) -> Result<SpatialVector> {
        let mut result = [0.0; 6];
        self.call(function, |m, d| call(m, d, result.as_mut_ptr()))?;
        Ok(SpatialVector::from_engine(result))
    }

    /// Converts a force (N) and a torque (N·m) on a body to generalised forces, and adds them to
    /// `qfrc_target` (nv). The force acts at `point` (m). All three vectors are in the world frame.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong length,
    /// [`Error::Engine`] if the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.forward()?;
    /// let mut force = vec![0.0; data.model().nv()];
    /// let point = *data.body("cart")?.xpos();
    /// data.apply_ft([3.0, 0.0, 0.0], [0.0; 3], point, "cart", &mut force)?;
    /// assert_eq!(force, [3.0, 0.0]);
    /// data.qfrc_applied_mut().copy_from_slice(&force);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_applyFT")]
    pub fn apply_ft(
        &mut self,
        force: [f64; 3],
        torque: [f64; 3],
        point: [f64; 3],
        body: impl IntoId<kind::Body>,
        qfrc_target: &mut [f64],
    ) -> Result<()> {
        let body = body.id_in(&**self.model())?;
        self.check_computed("apply_ft", Stage::Position)?;
        Error::check_length("qfrc_target of apply_ft", qfrc_target.len(), self.model().nv())?;
        let (body, target) = (body.index() as c_int, qfrc_target.as_mut_ptr());
        self.call_mut("mj_applyFT", |m, d| {
            // SAFETY: a body of this model, three vectors of three elements, and a target of nv
            // elements.
            unsafe { guard::mj_apply_ft(m, d, force.as_ptr(), torque.as_ptr(), point.as_ptr(), body, target) }
        })
    }

    /// Transforms a position (m) and an orientation `[w, x, y, z]` from the frame of a body to the
    /// world frame. Returns the position and the rotation matrix.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let (pos, _) = data.local_to_global([0.0; 3], [1.0, 0.0, 0.0, 0.0], "foot_left")?;
    /// assert_eq!(&pos, data.body("foot_left")?.xpos());
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_local2Global")]
    pub fn local_to_global(
        &self,
        pos: [f64; 3],
        quat: [f64; 4],
        body: impl IntoId<kind::Body>,
    ) -> Result<([f64; 3], [f64; 9])> {
        let body = body.id_in(&**self.model())?;
        self.check_computed("local_to_global", Stage::Position)?;
        let (mut xpos, mut xmat) = ([0.0; 3], [0.0; 9]);
        // SAFETY: a body of this model, and arrays of 3, 9, 3 and 4 elements. The function only
        // reads the data.
        unsafe {
            sys::mj_local2Global(
                self.as_ptr().cast_mut(),
                xpos.as_mut_ptr(),
                xmat.as_mut_ptr(),
                pos.as_ptr(),
                quat.as_ptr(),
                body.index() as c_int,
                0,
            );
        }
        Ok((xpos, xmat))
    }

    /// Returns `true` if a point, in metres and in the world frame, is inside a site: in a sphere,
    /// capsule, cylinder, ellipsoid or box, or in the convex hull of a mesh.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`kinematics`](Self::kinematics), and [`Error::Unsupported`] with engines before
    /// 3.13.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_insideSite")]
    pub fn inside_site(&self, site: impl IntoId<kind::Site>, point: [f64; 3]) -> Result<bool> {
        let site = site.id_in(&**self.model())?.index() as c_int;
        self.check_parts("inside_site", PipelineFlags::KINEMATICS)?;
        // SAFETY: a site of this model, whose pose was computed, and a vector of three elements.
        match unsafe { sys::adapted::inside_site(self.model().as_ptr(), self.as_ptr(), site, point.as_ptr()) } {
            -1 => Err(Error::lacks("mj_insideSite", "3.13.0 and later")),
            inside => Ok(inside != 0),
        }
    }

    /// Returns the engine's type and index of an object.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    fn object(&self, object: FrameId) -> (c_int, c_int) {
        let model = self.model();
        let (object_type, index) = match object {
            FrameId::BodyInertia(id) => (mjOBJ_BODY, model.checked_index(id)),
            FrameId::Body(id) => (mjOBJ_XBODY, model.checked_index(id)),
            FrameId::Geom(id) => (mjOBJ_GEOM, model.checked_index(id)),
            FrameId::Site(id) => (mjOBJ_SITE, model.checked_index(id)),
            FrameId::Camera(id) => (mjOBJ_CAMERA, model.checked_index(id)),
        };
        (object_type as c_int, index)
    }
}

impl Model {
    fn checked_index<K: ElementKind>(&self, id: Id<K>) -> c_int {
        self.check_id(id);
        id.index() as c_int
    }
}

impl SpatialVector {
    /// Splits a spatial vector of the engine, whose angular part comes first.
    fn from_engine([rx, ry, rz, tx, ty, tz]: [f64; 6]) -> Self {
        Self { angular: [rx, ry, rz], linear: [tx, ty, tz] }
    }
}
