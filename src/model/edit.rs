//! Checked changes of a compiled model.

use std::ops::Deref;
use std::ptr;

use mujoco_sys::{self as sys, guard, mjMINVAL, mjModel};

use super::{EnableFlags, Model, Options};
use crate::data::silence_warnings;
use crate::error::{Error, Result};
use crate::ffi;
use crate::kind::Kind;

/// Mutable access to a model: from [`Model::edit`] before it is shared, from
/// [`Data::edit_model`](crate::Data::edit_model) afterwards. It dereferences to [`Model`].
///
/// The floating-point arrays of 2.2.2 are writable (`body_mass_mut`, `dof_damping_mut`, …), because
/// no value in them makes the engine access memory out of bounds. The exceptions are `wrap_prm`,
/// `hfield_size` and `mesh_vert`, which determine the addresses that the engine reads. Arrays that
/// only newer engines have are read-only. Sizes, addresses, ids and types are read-only too.
/// Switches and masks are set through [named access](crate::element):
/// `joint_mut(name)?.set_limited(true)`, `geom_mut(name)?.set_contype(2)`.
///
/// Newer engines compute addresses from some values in writable arrays. These are `eq_data` of
/// strain constraints, and for PID controllers and DC motors those parameters in `actuator_dynprm`
/// and `actuator_gainprm` that add an activation if they are positive. They are checked when the
/// edit of a simulation ends, by [`update_constants`](Self::update_constants), and by
/// [`Data::new`](crate::Data::new).
///
/// The compiler derived other quantities from these values: each accessor lists them. Bounds for
/// collision detection are updated automatically, and masks of geoms take effect at once. All
/// others need a call of [`update_constants`](Self::update_constants) after changes of masses,
/// inertias, positions or gears, and of sizes of geoms that tendons wrap around.
///
/// The access is exclusive:
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
/// Sizes, addresses, ids and types are read-only:
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

/// # Options, masses and derived constants
impl<'m> ModelMut<'m> {
    pub(crate) fn new(model: &'m mut Model) -> Self {
        model.advance_revision();
        Self { model }
    }

    /// Changes the physics options. Rejects the change if an option is out of range.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the option, its value and the valid values,
    /// [`Error::Unsupported`](crate::Error::Unsupported) for [`EnableFlags::MULTICCD`] in a binary
    /// model in which a polygon of a mesh has more than 8 vertices, and with some engines for more
    /// than 170 iterations of the convex collider in a model with sensors of distances. The model
    /// is then unchanged.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::cartpole();
    /// let error = model.edit().edit_options(|options| options.timestep = -1.0).unwrap_err();
    /// assert!(matches!(error, Error::Invalid { .. }));
    /// assert_eq!(model.timestep(), 0.01);
    /// ```
    #[doc(alias = "mjOption")]
    pub fn edit_options(&mut self, change: impl FnOnce(&mut Options)) -> Result<()> {
        let mut options = self.model.options();
        change(&mut options);
        options.check()?;
        if self.model.has_unsafe_polygons && options.enable.contains(EnableFlags::MULTICCD) {
            let what = "the option multiccd of a binary model with polygons of more than 8 vertices; load the XML";
            return Err(Error::Unsupported(what.to_owned()));
        }
        self.model.check_distances(options.mpr_iterations).map_err(Error::Unsupported)?;
        options.write(&mut self.model.raw_mut().opt);
        self.model.disable_unsafe_islands();
        self.avoid_wrong_jacobian();
        #[cfg(engine_since = "2.3.3")]
        self.model.disable_unsafe_midphase();
        Ok(())
    }

    /// Sets the duration of a step in seconds.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) unless it is positive and finite.
    pub fn set_timestep(&mut self, timestep: f64) -> Result<()> {
        self.edit_options(|options| options.timestep = timestep)
    }

    /// Scales all masses and inertias so that the total mass has the given value, kg. Call
    /// [`update_constants`](Self::update_constants) afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) unless the mass is positive and finite.
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
            return Err(crate::error::Error::out_of_range("the total mass", mass, "positive and finite"));
        }
        self.clear_simple_body_flags();
        // SAFETY: a model that is borrowed exclusively; the function scales its masses and
        // inertias.
        unsafe { sys::mj_setTotalmass(self.model.raw.as_ptr(), mass) };
        Ok(())
    }

    /// Recomputes the quantities that the compiler derived from masses, inertias, positions and
    /// `qpos0`: subtree masses, inverse weights, reference lengths, statistics and all fields with
    /// a `0` in their names. Also recomputes the flags of coinciding frames (`body_sameframe` and
    /// the like), and with 2.2.2 the flags of bodies that move independently (`body_simple`), which
    /// speed up the engine. With engines from 2.3 to 3.10 an edit clears the flags of frames for
    /// good, which is correct and a little slower. Since 3.17 the engine leaves the statistics to
    /// the compiler. With these engines the call recomputes `meanmass` and `meaninertia`, except
    /// values of the user, and `meaninertia` of a model with armature of tendons. `meansize`,
    /// `extent` and `center` keep their values. Trees that an edited stiffness or damping of a
    /// tendon couples do not sleep afterwards, unless the user has set their policy.
    ///
    /// Computes the bounds by which the engine skips pairs of geoms in collision detection, for
    /// spheres, capsules, cylinders, ellipsoids and boxes: bounding spheres and boxes, and with
    /// newer engines the hierarchies of boxes, margins and masks of bodies. Until this call the
    /// bounds of an edited model contain everything, which finds all contacts, but slowly. A
    /// simulation's own model gets its bounds at the end of
    /// [`Data::edit_model`](crate::Data::edit_model).
    ///
    /// Quantities that only the compiler computes keep their values: masses of bodies from geoms,
    /// `qpos0` of free joints from the poses of their bodies, the virtual masses in `geom_fluid`
    /// (newer engines, from 3.17, compute them from the sizes, also if they were edited),
    /// `actuator_lengthrange` (see [`set_length_range`](crate::ModelMut::set_length_range)),
    /// relative poses of welds, lengths of springs of tendons without a `springlength`, and
    /// parameters of actuators with a damping ratio.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) for a body that has joints, but a mass or a moment
    /// of inertia that is not at least 10⁻¹⁵ (`mjMINVAL`), unless a child without joints has both;
    /// since engine 3.3 also a child of such a child. This is the rule of the XML compiler; the
    /// engine itself accepts such a body and does not accelerate it. The model is then unchanged.
    /// Also for values from which the engine would compute addresses outside of the model's arrays;
    /// see [`ModelMut`].
    ///
    /// [`Error::Unsupported`](crate::Error::Unsupported) with engines since 2.3 for a body with
    /// several degrees of freedom whose part of the inertia matrix was diagonal when it was
    /// compiled (`body_simple`), but is not any more, because its centre of mass, its axes of
    /// inertia or its joints have moved. The matrix has no space for the other elements. The model
    /// is then unchanged.
    ///
    /// [`Error::Engine`](crate::Error::Engine) or [`Error::OutOfMemory`](crate::Error::OutOfMemory)
    /// if the memory for a scratch simulation is exhausted, or its stack is too small. The derived
    /// quantities may then be partly updated.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::cartpole();
    /// let mut edit = model.edit();
    /// edit.body_mut("pole")?.set_mass(0.0);
    /// let error = edit.update_constants().unwrap_err();
    /// assert!(matches!(&error, Error::Invalid { what, .. } if what == "the mass of body 'pole'"), "{error}");
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mj_setConst")]
    pub fn update_constants(&mut self) -> Result<()> {
        self.check_moving_bodies()?;
        self.check_addresses()?;
        #[cfg(engine_since = "2.3.0")]
        {
            self.check_simple_bodies()?;
            self.clear_flags_of_fixed_bodies();
        }
        #[cfg(engine_since = "3.17.0")]
        let means = self.means();
        let mut scratch = ptr::null_mut();
        // SAFETY: a valid model, and a pointer for the result.
        ffi::check_without_data("mj_makeData", unsafe { guard::mj_make_data(self.model.as_ptr(), &raw mut scratch) })?;
        if scratch.is_null() {
            return Err(crate::error::Error::OutOfMemory { function: "mj_makeData" });
        }
        // SAFETY: created above, and nothing else owns it. A counter above zero prevents the engine
        // from formatting a warning in a buffer that all threads share. No warning is lost: every
        // step with the model repeats it, for example the warning about a singular inertia matrix.
        silence_warnings(unsafe { &mut *scratch });
        self.compute_flags();
        self.update_bounds();
        let modes = (self.cam_mode().to_vec(), self.light_mode().to_vec());
        let biases = self.actuator_biasprm().to_vec();
        #[cfg(engine_since = "3.17.0")]
        let welds = self.eq_data().to_vec();
        #[cfg(engine_since = "3.0.0")]
        let masks = self.model.hide_geoms_without_box();
        // SAFETY: a model that is borrowed exclusively, and a data that was created for it.
        let result =
            ffi::check_without_data("mj_setConst", unsafe { guard::mj_set_const(self.model.raw.as_ptr(), scratch) });
        #[cfg(engine_since = "3.0.0")]
        if !masks.is_empty() {
            self.model.set_masks(&masks);
            self.update_bounds();
        }
        // Since 3.1.6, and not in 3.17, the engine takes a positive factor of the velocity for a
        // damping ratio and replaces it.
        self.actuator_biasprm_mut().copy_from_slice(&biases);
        #[cfg(engine_since = "3.17.0")]
        self.restore_welds(&welds);
        if result.is_err() {
            // The inertias of simple bodies may not have been computed.
            self.clear_simple_body_flags();
            // The engine sets cameras and lights to the fixed mode for the duration of the call.
            self.set_tracking_modes(&modes.0, &modes.1);
        }
        // SAFETY: created above, and not used any more.
        unsafe { sys::mj_deleteData(scratch) };
        #[cfg(engine_since = "3.17.0")]
        self.update_means(means);
        #[cfg(engine_since = "3.5.0")]
        self.keep_coupled_trees_awake();
        result
    }

    /// Restores the relative poses of welds that the engine has computed from `qpos0`, because the
    /// text gives none. A pose that differs from the computed one is marked as given, as in a text,
    /// because the engine does not save it otherwise.
    #[cfg(engine_since = "3.17.0")]
    fn restore_welds(&mut self, before: &[[f64; sys::mjNEQDATA as usize]]) {
        /// Place of the flag of computed poses.
        const COMPUTED: usize = 11;
        for equality in (0..self.neq()).filter(|&equality| before[equality][COMPUTED] != 0.0) {
            if self.eq_type()[equality] as u32 == sys::mjEQ_WELD && self.eq_data()[equality] != before[equality] {
                self.eq_data_mut()[equality] = before[equality];
                self.eq_data_mut()[equality][COMPUTED] = 0.0;
            }
        }
    }

    /// Keeps trees awake that a tendon with stiffness or damping connects, as the compiler does if
    /// the user sets no policy. The compiler does not let the trees of a tendon along more than two
    /// trees sleep in any case.
    #[cfg(engine_since = "3.5.0")]
    fn keep_coupled_trees_awake(&mut self) {
        let acts = |tendon: &usize| self.tendon_stiffness()[*tendon] != 0.0 || self.tendon_damping()[*tendon] != 0.0;
        let pairs = (0..self.ntendon()).filter(|&tendon| self.tendon_treenum()[tendon] == 2);
        let trees: Vec<i32> = pairs.filter(acts).flat_map(|tendon| self.tendon_treeid()[tendon]).collect();
        let (length, policies) = (self.ntree(), self.raw_mut().tree_sleep_policy);
        // SAFETY: the engine allocated the array with this length, and the model is borrowed
        // exclusively.
        let policies = unsafe { ffi::array_mut(policies, length) };
        for tree in trees {
            let policy = &mut policies[ffi::size(tree)];
            if *policy == sys::mjSLEEP_AUTO_ALLOWED as i32 {
                *policy = sys::mjSLEEP_AUTO_NEVER as i32;
            }
        }
    }

    /// Returns the means of masses and inertias that the last computation of constants left, if
    /// there are bodies and degrees of freedom.
    #[cfg(engine_since = "3.17.0")]
    fn means(&self) -> [Option<f64>; 2] {
        let mean = |sum: f64, count: usize| (count > 0).then(|| sum / count as f64);
        [mean(self.body_subtreemass()[0], self.nbody() - 1), mean(self.dof_M0().iter().sum(), self.nv())]
    }

    /// Recomputes the means of masses and inertias, because newer engines leave the statistics to
    /// the compiler. A statistic that was not the mean before was set by the user, or contains the
    /// armature of tendons, and stays.
    #[cfg(engine_since = "3.17.0")]
    fn update_means(&mut self, before: [Option<f64>; 2]) {
        let new = |old: f64, [before, mean]: [Option<f64>; 2]| match (before, mean) {
            (Some(before), Some(mean)) if (old - before).abs() <= 1e-9 * before.abs() => mean,
            _ => old,
        };
        let [mass, inertia] = self.means();
        let statistics = &mut self.raw_mut().stat;
        statistics.meanmass = new(statistics.meanmass, [before[0], mass]);
        statistics.meaninertia = new(statistics.meaninertia, [before[1], inertia]);
    }

    /// Rejects bodies that move and have no mass or no inertia, by the rule of the XML compiler.
    fn check_moving_bodies(&self) -> Result<()> {
        let is_zero = |value: f64| value.is_nan() || value < mjMINVAL;
        let is_massless = |body: usize| is_zero(self.body_mass()[body]);
        let zero_moment = |body: usize| self.body_inertia()[body].iter().find(|&&moment| is_zero(moment));
        for body in (1..self.nbody()).filter(|&body| self.body_jntnum()[body] > 0) {
            let (quantity, value) = match (is_massless(body), zero_moment(body)) {
                (true, _) => ("mass", self.body_mass()[body]),
                (false, Some(&moment)) => ("moment of inertia", moment),
                (false, None) => continue,
            };
            // A body follows its parent in the order of bodies. Since 3.3 a descendant suffices.
            let mut carried = vec![false; self.nbody()];
            carried[body] = true;
            let is_valid = (body + 1..self.nbody()).any(|child| {
                let parent = ffi::size(self.body_parentid()[child]);
                carried[child] = self.body_jntnum()[child] == 0
                    && carried[parent]
                    && (parent == body || cfg!(engine_since = "3.3.0"));
                carried[child] && !is_massless(child) && zero_moment(child).is_none()
            });
            if !is_valid {
                let name = self.name_at(Kind::Body, body).map_or(body.to_string(), |name| format!("'{name}'"));
                let what = format!("the {quantity} of body {name}");
                return Err(crate::error::Error::out_of_range(
                    what,
                    value,
                    "at least 1e-15, because the body has joints",
                ));
            }
        }
        Ok(())
    }

    /// Sets the tracking modes of all cameras and lights.
    fn set_tracking_modes(&mut self, cameras: &[i32], lights: &[i32]) {
        let raw = self.raw_mut();
        // SAFETY: the engine allocated both arrays with these lengths, and the model is borrowed
        // exclusively.
        unsafe {
            ffi::array_mut(raw.cam_mode, cameras.len()).copy_from_slice(cameras);
            ffi::array_mut(raw.light_mode, lights.len()).copy_from_slice(lights);
        }
    }

    #[inline]
    pub(crate) fn raw_mut(&mut self) -> &mut mjModel {
        self.model.raw_mut()
    }

    pub(super) fn inner(&mut self) -> &mut Model {
        self.model
    }
}

/// # Editing
impl Model {
    /// Returns mutable access to a model that is not shared.
    ///
    /// ```
    /// use mujoco_safe::enums::Integrator;
    /// use mujoco_safe::sample;
    ///
    /// let mut model = sample::cartpole();
    /// model.edit().edit_options(|options| {
    ///     options.timestep = 0.002;
    ///     options.integrator = Integrator::Rk4;
    /// })?;
    /// model.edit().body_mass_mut()[1] = 2.0;
    /// assert_eq!(model.timestep(), 0.002);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn edit(&mut self) -> ModelMut<'_> {
        ModelMut::new(self)
    }

    /// Returns the sum of all masses, kg.
    #[doc(alias = "mj_getTotalmass")]
    pub fn total_mass(&self) -> f64 {
        // SAFETY: the function reads the masses of a valid model.
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

#[cfg(test)]
mod tests {
    use crate::{Error, Model};

    /// Sets the size of the engine's stack. Newer engines have an arena in bytes instead, which
    /// contains the stack.
    fn set_stack(model: &mut Model, numbers: i32) {
        #[cfg(not(engine_since = "2.3.0"))]
        (model.raw_mut().nstack = numbers);
        #[cfg(engine_since = "2.3.0")]
        (model.raw_mut().narena = i64::from(8 * numbers));
    }

    #[test]
    fn a_failed_update_restores_the_modes_of_cameras_and_lights() {
        let mut model = Model::from_xml_str(
            r#"<mujoco><worldbody>
                 <body name="ball"><freejoint/><geom size=".1"/>
                   <camera mode="trackcom"/><light mode="trackcom"/></body>
               </worldbody></mujoco>"#,
        )
        .unwrap();
        let modes = (model.cam_mode().to_vec(), model.light_mode().to_vec());
        let mut failures = 0;
        // With 75 numbers, 2.2.2 has stack space for the Jacobians, which it allocates first, but
        // not for the allocations after it has changed the cameras.
        for numbers in (3..1000).step_by(8) {
            set_stack(&mut model, numbers);
            if let Err(error) = model.edit().update_constants() {
                assert!(matches!(error, Error::Engine { .. }), "{error}");
                failures += 1;
            }
            assert_eq!((model.cam_mode(), model.light_mode()), (&modes.0[..], &modes.1[..]));
        }
        assert!((10..120).contains(&failures), "{failures} failures");
    }
}
