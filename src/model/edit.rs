//! What may be changed after compilation.

use std::ops::Deref;
use std::ptr;

use mujoco_sys::{self as sys, guard, mjModel};

use super::{Model, Options};
use crate::error::Result;
use crate::ffi;

/// A model that may be changed: from [`Model::edit`] before it is shared, from
/// [`Data::edit_model`](crate::Data::edit_model) afterwards. It reads like a [`Model`].
///
/// Real numbers can be written to (`body_mass_mut`, `dof_damping_mut`, …); whatever is in them, the engine stays within its
/// memory. The three arrays of reals that decide where it reads, `wrap_prm`, `hfield_size` and `mesh_vert`, cannot, and neither
/// can sizes, addresses, ids and types. Switches and masks are set through [named access](crate::element):
/// `joint_mut(name)?.set_limited(true)`, `geom_mut(name)?.set_contype(2)`.
///
/// What the compiler derived from a number does not follow when the number changes: call
/// [`update_constants`](Self::update_constants) after masses, inertias, positions or sizes.
///
/// A model that is lent is not changed by anyone else:
///
/// ```compile_fail,E0499
/// # use mujoco_safe::sample;
/// let mut model = sample::cartpole();
/// let mut edit = model.edit();
/// let masses = edit.body_mass_mut();
/// model.edit().update_constants().unwrap(); // more than once as mutable
/// masses[1] = 2.0;
/// ```
///
/// ```compile_fail,E0505
/// # use mujoco_safe::{Data, sample};
/// let mut model = sample::cartpole();
/// let mut edit = model.edit();
/// let data = Data::new(model); // move out while borrowed
/// edit.body_mass_mut()[1] = 2.0;
/// ```
///
/// Nor are sizes, addresses, ids and types:
///
/// ```compile_fail,E0599
/// # use mujoco_safe::sample;
/// let mut model = sample::cartpole();
/// model.edit().body_parentid_mut()[1] = 7; // no such method
/// ```
#[derive(Debug)]
pub struct ModelMut<'m> {
    model: &'m mut Model,
}

impl<'m> ModelMut<'m> {
    pub(crate) fn new(model: &'m mut Model) -> Self {
        Self { model }
    }

    /// Changes the physics options, after checking them: nothing is changed if one is out of range.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the option, its value and what is allowed.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::cartpole();
    /// let error = model.edit().options(|options| options.timestep = -1.0).unwrap_err();
    /// assert!(matches!(error, Error::Invalid { .. }));
    /// assert_eq!(model.timestep(), 0.01);
    /// ```
    #[doc(alias = "mjOption")]
    pub fn options(&mut self, change: impl FnOnce(&mut Options)) -> Result<()> {
        let mut options = self.model.options();
        change(&mut options);
        options.check()?;
        options.write(&mut self.model.raw_mut().opt);
        Ok(())
    }

    /// Sets the duration of a step in seconds.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) unless it is positive and finite.
    pub fn set_timestep(&mut self, timestep: f64) -> Result<()> {
        self.options(|options| options.timestep = timestep)
    }

    /// Scales all masses and inertias so that the masses have this sum, kg. Call [`update_constants`](Self::update_constants)
    /// afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) unless it is positive and finite.
    ///
    /// ```
    /// use mujoco_safe::sample;
    ///
    /// let mut model = sample::humanoid();
    /// let mut edit = model.edit();
    /// edit.set_total_mass(70.0)?;
    /// edit.update_constants()?;
    /// assert!((model.total_mass() - 70.0).abs() < 1e-9);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_setTotalmass")]
    pub fn set_total_mass(&mut self, mass: f64) -> Result<()> {
        if !(mass.is_finite() && mass > 0.0) {
            return Err(crate::Error::invalid("the total mass", mass, "positive and finite"));
        }
        self.forget_simple_bodies();
        // SAFETY: a model that is borrowed exclusively; the function scales its masses and inertias.
        unsafe { sys::mj_setTotalmass(self.model.raw.as_ptr(), mass) };
        Ok(())
    }

    /// Computes anew what the compiler derived from masses, inertias, positions and `qpos0`: subtree masses, inverse weights,
    /// reference lengths, the statistics and the rest of what has a `0` in its name; which frames coincide and which bodies move by
    /// themselves (`body_sameframe`, `body_simple` and the like), so that the engine can leave computations out again. Where a
    /// sphere, capsule, cylinder, ellipsoid or box has outgrown its `geom_rbound`, beyond which no contacts are looked for, that
    /// grows too.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`](crate::Error::Engine) if the numbers do not make a model, such as a body without mass that moves.
    #[doc(alias = "mj_setConst")]
    pub fn update_constants(&mut self) -> Result<()> {
        let mut scratch = ptr::null_mut();
        // SAFETY: a valid model, a place for the result.
        ffi::check_without_data("mj_makeData", unsafe { guard::mj_make_data(self.model.as_ptr(), &raw mut scratch) })?;
        if scratch.is_null() {
            return Err(crate::Error::OutOfMemory { function: "mj_makeData" });
        }
        // SAFETY: just made, and ours. A counter that is not zero keeps the engine from printing a warning through a buffer that
        // all threads share; what it would warn about, such as a singular inertia, every step with the model tells.
        for warning in unsafe { &mut (*scratch).warning } {
            warning.number = 1;
        }
        self.note_shortcuts();
        self.widen_bounds();
        // SAFETY: a model that is borrowed exclusively, and a data that was made for it.
        let result =
            ffi::check_without_data("mj_setConst", unsafe { guard::mj_set_const(self.model.raw.as_ptr(), scratch) });
        if result.is_err() {
            // Their inertias may not have been computed.
            self.forget_simple_bodies();
        }
        // SAFETY: made above, and used no more.
        unsafe { sys::mj_deleteData(scratch) };
        result
    }

    #[inline]
    pub(crate) fn raw_mut(&mut self) -> &mut mjModel {
        self.model.raw_mut()
    }
}

impl Model {
    /// The sum of all masses, kg.
    #[doc(alias = "mj_getTotalmass")]
    pub fn total_mass(&self) -> f64 {
        // SAFETY: reads the masses of a valid model.
        unsafe { sys::mj_getTotalmass(self.as_ptr()) }
    }
}

impl Deref for ModelMut<'_> {
    type Target = Model;

    #[inline]
    fn deref(&self) -> &Model {
        self.model
    }
}
