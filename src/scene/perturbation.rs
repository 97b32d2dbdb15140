//! Perturbation: a selected body pulled by a virtual spring, usually with the mouse.

use std::ffi::c_int;

use bitflags::bitflags;
use mujoco_sys::{self as sys, adapted, guard, mjvPerturb};

use super::camera::check_motion;
use super::{MouseAction, Scene, Selection};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, SkinId};
use crate::math::rot_vec_mat_t;
use crate::model::Model;

bitflags! {
    /// Active parts of a perturbation.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    pub struct PerturbationFlags: u32 {
        /// Pulls the body to a position.
        const TRANSLATE = sys::mjPERT_TRANSLATE;
        /// Rotates the body to an orientation.
        const ROTATE = sys::mjPERT_ROTATE;
    }
}

/// Force that was added to `xfrc_applied` of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Applied {
    body: BodyId,
    before: [f64; 6],
    after: [f64; 6],
}

/// Selected body, optionally pulled or rotated by a critically damped spring.
///
/// In an interactive loop, [`select`](Self::select) the clicked body. When a drag starts, call
/// [`start`](Self::start) and set `active`. Call [`move_by`](Self::move_by) for each mouse motion,
/// and [`apply_pose`](Self::apply_pose) and [`apply_force`](Self::apply_force) before each step.
/// Clear `active` when the drag ends.
///
/// ```
/// use mujoco_safe::scene::{Perturbation, PerturbationFlags};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// data.forward()?;
/// let cart = data.model().body("cart")?.id();
/// let mut perturbation = Perturbation::default();
/// perturbation.select = Some(cart);
/// perturbation.active = PerturbationFlags::TRANSLATE;
/// perturbation.refpos = data.xipos()[cart.index()];
/// perturbation.refpos[0] += 0.1; // pull to the right
/// for _ in 0..10 {
///     perturbation.apply_force(&mut data)?;
///     data.step()?;
/// }
/// perturbation.remove_force(&mut data);
/// assert!(data.qvel()[0] > 0.0);
/// assert_eq!(data.xfrc_applied()[cart.index()], [0.0; 6]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Perturbation {
    /// Selected body. The world body is never highlighted, pulled or rotated.
    pub select: Option<BodyId>,
    /// Selected skin.
    pub skinselect: Option<SkinId>,
    /// Active parts of the perturbation.
    pub active: PerturbationFlags,
    /// Active parts of a second user's perturbation of the same body.
    pub active2: PerturbationFlags,
    /// Target position of the body's centre of mass, m, world frame.
    pub refpos: [f64; 3],
    /// Target orientation of the body's inertial frame, `[w, x, y, z]`, world frame.
    pub refquat: [f64; 4],
    /// Selected point, m, body frame.
    pub localpos: [f64; 3],
    /// Displacement for a mouse motion of one window height, m. Set by [`start`](Self::start).
    pub scale: f64,
    /// With newer engines: offset of the selected point's target from `refpos`, and the inertia at
    /// the point, zero before the start.
    grip: [f64; 4],
    applied: Option<Applied>,
}

impl Default for Perturbation {
    /// Returns a perturbation without a selection.
    #[doc(alias = "mjv_defaultPerturb")]
    fn default() -> Self {
        Self {
            select: None,
            skinselect: None,
            active: PerturbationFlags::empty(),
            active2: PerturbationFlags::empty(),
            refpos: [0.0; 3],
            refquat: [1.0, 0.0, 0.0, 0.0],
            localpos: [0.0; 3],
            scale: 1.0,
            grip: [0.0; 4],
            applied: None,
        }
    }
}

/// Bodies that [`Perturbation::apply_pose`] moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MovableBodies {
    /// Mocap bodies, by their mocap pose. For a running simulation.
    Mocap,
    /// Also a body with a free joint, and the kinematic tree of a body if the root of the tree has
    /// a free joint. For a paused simulation.
    MocapAndFree,
}

impl Perturbation {
    /// Selects the body, the skin and the point of a [`Selection`], and deactivates the
    /// perturbation.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] if positions have not been computed.
    ///
    /// # Panics
    ///
    /// If the selection belongs to another model.
    pub fn select(&mut self, data: &Data, selection: &Selection) -> Result<()> {
        data.model().check_id(selection.body);
        data.check_computed("Perturbation::select", Stage::Position)?;
        let body = selection.body.index();
        let (xpos, xmat) = (data.xpos()[body], &data.xmat()[body]);
        let offset = std::array::from_fn(|axis| selection.point[axis] - xpos[axis]);
        self.localpos = rot_vec_mat_t(&offset, xmat);
        self.select = Some(selection.body);
        self.skinselect = selection.skin;
        self.grip = [0.0; 4];
        self.stop();
        Ok(())
    }

    /// Clears the selection and deactivates the perturbation.
    pub fn unselect(&mut self) {
        (self.select, self.skinselect) = (None, None);
        self.stop();
    }

    /// Deactivates the perturbation. A force added by [`apply_force`](Self::apply_force) persists
    /// until its next call, or until [`remove_force`](Self::remove_force).
    pub fn stop(&mut self) {
        (self.active, self.active2) = (PerturbationFlags::empty(), PerturbationFlags::empty());
    }

    /// Sets the target to the pose of the selected body, and the scale from the scene's camera. Has
    /// no effect without a selection, or for the world body.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a scene of another model, [`Error::NotComputed`] if positions have
    /// not been computed, [`Error::Engine`] before the first update of the scene,
    /// [`Error::Invalid`] if a value is not finite. The data stays usable.
    ///
    /// # Panics
    ///
    /// If the selected body or skin belongs to another model than the data.
    #[doc(alias = "mjv_initPerturb")]
    pub fn start(&mut self, data: &mut Data, scene: &Scene) -> Result<()> {
        let model = data.model();
        scene.check_model(model, "the scene of a perturbation")?;
        let mut raw = self.raw(model)?;
        data.check_computed("Perturbation::start", Stage::Position)?;
        data.call_on_stack("mjv_initPerturb", |m, d| {
            // SAFETY: the model, the data and the scene belong together, the positions were
            // computed, and the body is valid. Newer engines use the stack of the data, which is
            // borrowed exclusively.
            unsafe { guard::mjv_init_perturb(m, d, scene.as_ptr(), &raw mut raw) }
        })?;
        self.take(&raw)
    }

    /// Moves the target in response to a mouse motion `[dx, dy]`, as fractions of the window
    /// height. The target orientation stays within 90° of the body's. [`Zoom`](MouseAction::Zoom)
    /// has no effect.
    ///
    /// # Errors
    ///
    /// As for [`start`](Self::start).
    ///
    /// # Panics
    ///
    /// As for [`start`](Self::start).
    #[doc(alias = "mjv_movePerturb")]
    pub fn move_by(&mut self, data: &Data, action: MouseAction, [dx, dy]: [f64; 2], scene: &Scene) -> Result<()> {
        let model = data.model();
        scene.check_model(model, "the scene of a perturbation")?;
        let mut raw = self.raw(model)?;
        data.check_computed("Perturbation::move_by", Stage::Position)?;
        check_motion([dx, dy])?;
        if action == MouseAction::Zoom {
            // For this action the engine would rotate an uninitialised vector.
            return Ok(());
        }
        data.call("mjv_movePerturb", |m, d| {
            // SAFETY: as in `start`, with a valid action; without a selection the engine reads the
            // world body.
            unsafe { guard::mjv_move_perturb(m, d, action.raw(), dx, dy, scene.as_ptr(), &raw mut raw) }
        })?;
        self.take(&raw)
    }

    /// Moves the selected body to the target pose. Has no effect on a body that is not one of
    /// `bodies`, or if [`active`](Self::active) is empty. Call [`Data::forward`] afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] if positions have not been computed, [`Error::Invalid`] if a value is
    /// not finite.
    ///
    /// # Panics
    ///
    /// If the selected body or skin belongs to another model.
    #[doc(alias = "mjv_applyPerturbPose")]
    pub fn apply_pose(&self, data: &mut Data, bodies: MovableBodies) -> Result<()> {
        let raw = self.raw(data.model())?;
        let paused = (bodies == MovableBodies::MocapAndFree).into();
        data.check_computed("Perturbation::apply_pose", Stage::Position)?;
        data.call_mut("mjv_applyPerturbPose", |m, d| {
            // SAFETY: the model and the data belong together, the positions were computed, and the
            // body is valid.
            unsafe { guard::mjv_apply_perturb_pose(m, d, &raw const raw, paused) }
        })
    }

    /// Computes the force and torque of the spring on the selected body, as in
    /// [`xfrc_applied`](Data::xfrc_applied): N and N·m, world frame, at the body's centre of mass.
    /// Zero if [`active`](Self::active) is empty, without a selection, or for the world body.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] if velocities have not been computed, [`Error::Invalid`] if a value
    /// is not finite.
    ///
    /// # Panics
    ///
    /// If the selected body or skin belongs to another model.
    #[doc(alias = "mjv_applyPerturbForce")]
    pub fn force(&self, data: &mut Data) -> Result<[f64; 6]> {
        let raw = self.raw(data.model())?;
        data.check_computed("Perturbation::force", Stage::Velocity)?;
        let Some(body) = self.select.map(BodyId::index).filter(|&body| body > 0) else { return Ok([0.0; 6]) };
        if (self.active | self.active2).is_empty() {
            return Ok([0.0; 6]);
        }
        // The engine overwrites the applied force.
        let before = data.xfrc_applied()[body];
        let result = data.call_mut("mjv_applyPerturbForce", |m, d| {
            // SAFETY: the model and the data belong together, the velocities were computed, and the
            // body is valid.
            unsafe { guard::mjv_apply_perturb_force(m, d, &raw const raw) }
        });
        let force = std::mem::replace(&mut data.xfrc_applied_mut()[body], before);
        result.map(|()| force)
    }

    /// Adds the [`force`](Self::force) to the applied force of the selected body, after removing
    /// the force that an earlier call added. It can therefore be called before each step, and
    /// preserves forces that the program applies. (The engine's function overwrites them.) A body
    /// without degrees of freedom, such as a mocap body, gets no force: the engine's, up to 3·10¹⁶
    /// N with MuJoCo 2.2.2, would only be seen by force sensors.
    ///
    /// # Errors
    ///
    /// As for [`force`](Self::force).
    ///
    /// # Panics
    ///
    /// As for [`force`](Self::force).
    #[doc(alias = "mjv_applyPerturbForce")]
    pub fn apply_force(&mut self, data: &mut Data) -> Result<()> {
        let force = self.force(data)?;
        self.remove_force(data);
        // A body moves with the first of its ancestors that is not welded to its parent.
        let (weld, dofs) = (data.model().body_weldid(), data.model().body_dofnum());
        let movable = self.select.filter(|body| dofs[weld[body.index()] as usize] > 0);
        let Some(body) = movable.filter(|_| force != [0.0; 6]) else { return Ok(()) };
        let applied = &mut data.xfrc_applied_mut()[body.index()];
        let before = *applied;
        *applied = std::array::from_fn(|i| before[i] + force[i]);
        self.applied = Some(Applied { body, before, after: *applied });
        Ok(())
    }

    /// Removes the force that [`apply_force`](Self::apply_force) added, unless the program has
    /// since set the applied force of that body.
    pub fn remove_force(&mut self, data: &mut Data) {
        let Some(Applied { body, before, after }) = self.applied.take() else { return };
        if body.lineage() == data.model().lineage() {
            let present = &mut data.xfrc_applied_mut()[body.index()];
            if *present == after {
                *present = before;
            }
        }
    }

    /// Converts the perturbation to the engine's structure.
    #[track_caller]
    pub(super) fn raw(&self, model: &Model) -> Result<mjvPerturb> {
        let select = self.select.map_or(0, |body| {
            model.check_id(body);
            body.index() as c_int
        });
        let skinselect = self.skinselect.map_or(-1, |skin| {
            model.check_id(skin);
            skin.index() as c_int
        });
        self.check()?;
        let &Self { active, active2, refpos, refquat, localpos, scale, .. } = self;
        let (active, active2) = (active.bits() as c_int, active2.bits() as c_int);
        // SAFETY: the function sets all fields of the structure, including those that only newer
        // engines have.
        let mut raw: mjvPerturb = unsafe { ffi::made_by(|raw| sys::mjv_defaultPerturb(raw)) };
        (raw.select, raw.skinselect, raw.active, raw.active2) = (select, skinselect, active, active2);
        (raw.refpos, raw.refquat, raw.localpos, raw.scale) = (refpos, refquat, localpos, scale);
        // SAFETY: a valid structure and four numbers.
        unsafe { adapted::set_grip(&raw mut raw, self.grip.as_ptr()) };
        Ok(raw)
    }

    /// Copies the fields that the engine changed, if they are finite.
    fn take(&mut self, raw: &mjvPerturb) -> Result<()> {
        let &mjvPerturb { refpos, refquat, scale, .. } = raw;
        let mut grip = self.grip;
        // SAFETY: as in `raw`.
        unsafe { adapted::get_grip(raw, grip.as_mut_ptr()) };
        let moved = Self { refpos, refquat, scale, grip, ..self.clone() };
        moved.check()?;
        *self = moved;
        Ok(())
    }

    fn check(&self) -> Result<()> {
        let numbers =
            self.refpos.iter().chain(&self.refquat).chain(&self.localpos).chain(&self.grip).chain([&self.scale]);
        if numbers.clone().all(|number| number.is_finite()) {
            return Ok(());
        }
        Err(Error::not_finite("a number of the perturbation", format!("{self:?}")))
    }
}
