//! The perturbation: a body that is pulled by a spring, as with a mouse.

use std::ffi::c_int;

use bitflags::bitflags;
use mujoco_sys::{self as sys, guard, mjvPerturb};

use super::camera::check_motion;
use super::{MouseAction, Scene, Selection};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::{BodyId, SkinId};
use crate::math::rot_vec_mat_t;
use crate::model::Model;

bitflags! {
    /// What a perturbation does.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[doc(alias = "mjtPertBit")]
    pub struct PerturbationFlags: u32 {
        /// It pulls the body to a position.
        const TRANSLATE = sys::mjPERT_TRANSLATE;
        /// It turns the body to an orientation.
        const ROTATE = sys::mjPERT_ROTATE;
    }
}

/// What was added to the applied forces of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Applied {
    body: BodyId,
    before: [f64; 6],
    after: [f64; 6],
}

/// A body that is selected, and maybe pulled or turned by a critically damped spring.
///
/// In a loop: [`select`](Self::select) what was clicked on, [`init`](Self::init) when the drag begins and set `active`,
/// [`move_by`](Self::move_by) as the mouse moves, [`apply_pose`](Self::apply_pose) and [`apply_force`](Self::apply_force) before
/// each step, and clear `active` when the drag ends.
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
#[doc(alias = "mjvPerturb")]
pub struct Perturbation {
    /// The selected body. Only one that is not the world is shown as selected, pulled or turned.
    pub select: Option<BodyId>,
    /// The selected skin.
    pub skinselect: Option<SkinId>,
    /// What the perturbation does.
    pub active: PerturbationFlags,
    /// What that of a second user does to the same body.
    pub active2: PerturbationFlags,
    /// The position that the body's centre of mass is pulled to, m, world frame.
    pub refpos: [f64; 3],
    /// The orientation that the body's inertial frame is turned to, `[w, x, y, z]`, world frame.
    pub refquat: [f64; 4],
    /// The selected point, m, in the body's frame.
    pub localpos: [f64; 3],
    /// By how much the position moves with the mouse, m for one height of the window. Set by [`init`](Self::init).
    pub scale: f64,
    applied: Option<Applied>,
}

impl Default for Perturbation {
    /// Nothing is selected.
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
            applied: None,
        }
    }
}

impl Perturbation {
    /// Selects what was found at a place of the window: its body, its skin and the point.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed.
    ///
    /// # Panics
    ///
    /// If the selection is of another model.
    pub fn select(&mut self, data: &Data, selection: &Selection) -> Result<()> {
        data.model().check_id(selection.body);
        data.check_computed("Perturbation::select", Stage::Position)?;
        let body = selection.body.index();
        let (xpos, xmat) = (data.xpos()[body], &data.xmat()[body]);
        let offset = std::array::from_fn(|axis| selection.point[axis] - xpos[axis]);
        self.localpos = rot_vec_mat_t(&offset, xmat);
        self.select = Some(selection.body);
        self.skinselect = selection.skin;
        self.stop();
        Ok(())
    }

    /// Selects nothing, and stops.
    pub fn unselect(&mut self) {
        (self.select, self.skinselect) = (None, None);
        self.stop();
    }

    /// Neither pulls nor turns any more. What [`apply_force`](Self::apply_force) has added stays until its next call, or until
    /// [`remove_force`](Self::remove_force).
    pub fn stop(&mut self) {
        (self.active, self.active2) = (PerturbationFlags::empty(), PerturbationFlags::empty());
    }

    /// Begins where the selected body is, at the scale of the scene's camera. Nothing if no body is selected, or the world.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for the scene of another model, [`Error::NotComputed`] before poses were computed,
    /// [`Error::Engine`] before the first update of the scene, [`Error::Invalid`] for numbers that are not finite. The data stays
    /// usable.
    ///
    /// # Panics
    ///
    /// If the selected body or skin is of another model than the data.
    #[doc(alias = "mjv_initPerturb")]
    pub fn init(&mut self, data: &Data, scene: &Scene) -> Result<()> {
        let model = data.model();
        scene.check_model(model, "the scene that a perturbation begins in")?;
        let mut raw = self.raw(model)?;
        data.check_computed("Perturbation::init", Stage::Position)?;
        data.call("mjv_initPerturb", |m, d| {
            // SAFETY: a model, a data and a scene that go together, poses that were computed, and a body of the model.
            unsafe { guard::mjv_init_perturb(m, d, scene.as_ptr(), &raw mut raw) }
        })?;
        self.take(&raw)
    }

    /// Moves where it pulls or turns to, as a mouse does: by `[dx, dy]`, in heights of the window. An orientation stays within a
    /// quarter turn of the body's. [`Zoom`](MouseAction::Zoom) does nothing.
    ///
    /// # Errors
    ///
    /// As for [`init`](Self::init).
    ///
    /// # Panics
    ///
    /// As for [`init`](Self::init).
    #[doc(alias = "mjv_movePerturb")]
    pub fn move_by(&mut self, data: &Data, scene: &Scene, action: MouseAction, [dx, dy]: [f64; 2]) -> Result<()> {
        let model = data.model();
        scene.check_model(model, "the scene that a perturbation moves in")?;
        let mut raw = self.raw(model)?;
        data.check_computed("Perturbation::move_by", Stage::Position)?;
        check_motion([dx, dy])?;
        if action == MouseAction::Zoom {
            // The engine would turn a vector that it has not set.
            return Ok(());
        }
        data.call("mjv_movePerturb", |m, d| {
            // SAFETY: as in `init`, and an action of the engine's; without a selection the engine reads the world body.
            unsafe { guard::mjv_move_perturb(m, d, action.raw(), dx, dy, scene.as_ptr(), &raw mut raw) }
        })?;
        self.take(&raw)
    }

    /// Puts the selected body where the perturbation is: the mocap pose of a mocap body at any time, and where `paused` the
    /// position of a body that floats freely, or of the tree that it belongs to if its root does. Nothing for others, or if
    /// nothing is [`active`](Self::active). Call [`Data::forward`] afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed, [`Error::Invalid`] for numbers that are not finite.
    ///
    /// # Panics
    ///
    /// If the selected body or skin is of another model.
    #[doc(alias = "mjv_applyPerturbPose")]
    pub fn apply_pose(&self, data: &mut Data, paused: bool) -> Result<()> {
        let raw = self.raw(data.model())?;
        data.check_computed("Perturbation::apply_pose", Stage::Position)?;
        data.call_mut("mjv_applyPerturbPose", |m, d| {
            // SAFETY: a model and a data that go together, poses that were computed, a body of the model.
            unsafe { guard::mjv_apply_perturb_pose(m, d, &raw const raw, paused.into()) }
        })
    }

    /// The force and torque with which it pulls and turns the selected body, as in
    /// [`xfrc_applied`](Data::xfrc_applied): N and N m, world frame, at the body's centre of mass. Zero if nothing is
    /// [`active`](Self::active), no body is selected, or the world.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before velocities were computed, [`Error::Invalid`] for numbers that are not finite.
    ///
    /// # Panics
    ///
    /// If the selected body or skin is of another model.
    pub fn force(&self, data: &mut Data) -> Result<[f64; 6]> {
        let raw = self.raw(data.model())?;
        data.check_computed("Perturbation::force", Stage::Velocity)?;
        let Some(body) = self.select.map(BodyId::index).filter(|&body| body > 0) else { return Ok([0.0; 6]) };
        if (self.active | self.active2).is_empty() {
            return Ok([0.0; 6]);
        }
        // The engine writes over what was applied.
        let before = data.xfrc_applied()[body];
        let result = data.call_mut("mjv_applyPerturbForce", |m, d| {
            // SAFETY: a model and a data that go together, velocities that were computed, a body of the model.
            unsafe { guard::mjv_apply_perturb_force(m, d, &raw const raw) }
        });
        let force = std::mem::replace(&mut data.xfrc_applied_mut()[body], before);
        result.map(|()| force)
    }

    /// Adds its [`force`](Self::force) to the applied forces of the selected body. What an earlier call added is taken away
    /// before, so it may be called before each step, and forces that the program applies stay what they are. (The engine would
    /// write over them.)
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
        let Some(body) = self.select.filter(|_| force != [0.0; 6]) else { return Ok(()) };
        let applied = &mut data.xfrc_applied_mut()[body.index()];
        let before = *applied;
        *applied = std::array::from_fn(|i| before[i] + force[i]);
        self.applied = Some(Applied { body, before, after: *applied });
        Ok(())
    }

    /// Takes away what [`apply_force`](Self::apply_force) has added, unless the program has set the applied force of that body
    /// since.
    pub fn remove_force(&mut self, data: &mut Data) {
        let Some(Applied { body, before, after }) = self.applied.take() else { return };
        if body.lineage() == data.model().lineage() {
            let present = &mut data.xfrc_applied_mut()[body.index()];
            if *present == after {
                *present = before;
            }
        }
    }

    /// As the engine keeps it.
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
        Ok(mjvPerturb { select, skinselect, active, active2, refpos, refquat, localpos, scale })
    }

    /// Takes over what the engine changed, if it can be used.
    fn take(&mut self, raw: &mjvPerturb) -> Result<()> {
        let &mjvPerturb { refpos, refquat, scale, .. } = raw;
        let moved = Self { refpos, refquat, scale, ..self.clone() };
        moved.check()?;
        *self = moved;
        Ok(())
    }

    fn check(&self) -> Result<()> {
        let numbers = self.refpos.iter().chain(&self.refquat).chain(&self.localpos).chain([&self.scale]);
        if numbers.clone().all(|number| number.is_finite()) {
            return Ok(());
        }
        Err(Error::invalid("a number of the perturbation", format!("{self:?}"), "finite"))
    }
}
