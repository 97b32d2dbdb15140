//! A new model for a simulation, which keeps the state of the elements that both models have.

use super::Data;
use crate::error::Result;
#[cfg(engine_since = "3.0.0")]
use crate::ffi;
use crate::kind::Kind;
use crate::model::{Adoption, IntoModel, Survivors, kept_parts};

/// # Another model
impl Data {
    /// Gives the simulation another model, typically an edited version of its own, and keeps the
    /// state of the elements that are in both: it continues where it is. The model comes from a
    /// [`Spec`](crate::spec::Spec) that has changed since it was compiled for this simulation, or
    /// from a file that has been edited.
    ///
    /// Returns the elements that are only in one of the models.
    ///
    /// ```
    /// use mujoco_safe::Data;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::from_xml_str(
    ///     "<mujoco>
    ///        <worldbody>
    ///          <body name='left'><freejoint/><geom size='.1'/></body>
    ///          <body name='right' pos='1 0 0'><freejoint/><geom size='.1'/></body>
    ///        </worldbody>
    ///      </mujoco>",
    /// )?;
    /// let mut data = Data::new(spec.compile()?)?;
    /// data.step_n(100)?;
    /// let falling = data.qvel()[8];
    ///
    /// let left = spec.body("left")?.id();
    /// spec.remove(left)?;
    /// let added = spec.add_body(spec.world()).set_name("added").set_pos([0.0, 1.0, 0.0]).id();
    /// spec.add_freejoint(added);
    /// spec.add_geom(added).set_size(&[0.2]);
    /// let adoption = data.adopt(spec.compile()?)?;
    ///
    /// assert_eq!(adoption.lost[0].to_string(), "body 'left'");
    /// assert_eq!(adoption.new[0].to_string(), "body 'added'");
    /// assert!((data.time() - 0.2).abs() < 1e-9);
    /// assert_eq!(data.qvel()[2], falling);                // the right body falls on
    /// assert_eq!(data.qpos()[7..10], [0.0, 1.0, 0.0]);    // the added one starts
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # State
    ///
    /// | of | is kept |
    /// |---|---|
    /// | bodies | applied forces, and poses of mocap bodies |
    /// | joints | positions, velocities, applied forces, warm starts of the solver, plastic deformation |
    /// | actuators | controls, activations, samples of delays |
    /// | equality constraints | whether they are active |
    /// | sensors | samples of delays |
    /// | tendons and flexes | plastic deformation |
    /// | instances of plugins | `plugin_state`; the memory of the plugin itself is new |
    /// | the simulation | time, `userdata` by its indices, [callbacks](Self::set_callbacks), an error that has poisoned it |
    ///
    /// New elements have the values that they have in a new simulation of the model, and so have a
    /// joint whose type has changed and those values of an actuator, sensor, flex or plugin whose
    /// number has changed ([`Adoption::reset`]). A new sensor with an `interval` takes a sample in
    /// each step until its own time, which starts at zero, is that of the simulation. Other values
    /// stay as they are, also those that are outside of a new range. A change of the pose of a free
    /// body in the model does not move it, because its position is that of its joint.
    ///
    /// Everything else is that of the new model: parameters, options, keyframes, also where the old
    /// one was changed by [`edit_model`](Self::edit_model) or
    /// [`weld_at_present_pose`](Self::weld_at_present_pose). An equality constraint stays active or
    /// not whatever the new model says; with 2.2.2, where this is a part of the model, a shared
    /// model is copied if they differ. All results count as not computed, all bodies are awake, and
    /// the counters of warnings and timers start at zero.
    ///
    /// After an edit that no step reads, such as a new camera, later steps are the same bit for bit
    /// unless a body sleeps. If the models are equal in all values, all results, counters and
    /// sleeping bodies stay as they are, too.
    ///
    /// # Elements that are in both models
    ///
    /// An element of a [`Spec`](crate::spec::Spec) stays the same until it is removed, also if it
    /// is renamed, and is never another element, also if that has its name. This holds for the
    /// models of a spec and of its clones. The copies of a `replicate` are the same if their
    /// numbers are.
    ///
    /// Other elements are the same if their names are: those of models from files or of unrelated
    /// specs, and those that `composite`, `flexcomp` and `attach` create. Those without names are
    /// the same only if both models have as many of them, in bodies that are the same (joints and
    /// bodies) or in the whole model (others), and they agree one by one: joints in their types,
    /// bodies in the types of their joints and in being mocap bodies, actuators, equality
    /// constraints and sensors in their types and the elements to which they refer, tendons in
    /// their paths. An instance of a plugin without a name is the
    /// same if the body, actuator or sensor to which it belongs is. By this rule, two alike
    /// elements without names that change places in a file take each other's state: name them.
    ///
    /// The compiler does not say which elements of a spec are those of the model, so some count as
    /// new although they are not:
    ///
    /// - bodies and joints without names of a spec with `fusestatic`, or in a body with elements
    ///   that create others (`attach`, `composite`, `flexcomp`);
    /// - actuators, equality constraints, sensors and tendons without names, if there are elements
    ///   that create others (also `replicate`) and another one of their kind without a name is
    ///   added or removed;
    /// - those that refer to copies of a `replicate`, if they are renamed.
    ///
    /// # Differences from `mj_recompile`
    ///
    /// The C function recompiles one `mjSpec`, and its elements are the same until they are
    /// removed, also in these cases. Otherwise that of 4.0.1 keeps the same values as this one.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new). The simulation is unchanged then.
    #[doc(alias = "mj_recompile")]
    pub fn adopt(&mut self, model: impl IntoModel) -> Result<Adoption> {
        let model = model.into_model();
        let old_model = self.model.clone();
        let survivors = Survivors::of(&old_model, &model);
        let adoption = Adoption::of(&survivors, &old_model, &model);
        if survivors.are_all() && old_model.has_same_bits(&model) {
            self.model = model;
            return Ok(adoption);
        }
        let mut new = Self::new(&model)?;
        new.keep_state(self, &survivors)?;
        new.failure = self.failure.take();
        std::mem::swap(&mut new.callbacks, &mut self.callbacks);
        *self = new;
        Ok(adoption)
    }

    /// Sets the state of all elements that survive from another simulation.
    pub(crate) fn keep_state(&mut self, old: &Self, survivors: &Survivors<'_>) -> Result<()> {
        let (to, from) = (self.model.clone(), old.model.clone());
        self.raw_mut().time = old.time();
        let userdata = to.nuserdata().min(from.nuserdata());
        keep(&mut self.userdata_mut()[..userdata], &old.userdata()[..userdata]);
        for (new, origin) in survivors.pairs(Kind::Body) {
            self.xfrc_applied_mut()[new] = old.xfrc_applied()[origin];
            let mocap = [to.body_mocapid()[new], from.body_mocapid()[origin]].map(usize::try_from);
            if let [Ok(new), Ok(origin)] = mocap {
                self.mocap_pos_mut()[new] = old.mocap_pos()[origin];
                self.mocap_quat_mut()[new] = old.mocap_quat()[origin];
            }
        }
        for (new, origin) in survivors.pairs(Kind::Joint) {
            let [new_joint, old_joint] = [to.joint(to.id(new)?), from.joint(from.id(origin)?)];
            let (new, origin) = (new_joint.qpos_range(), old_joint.qpos_range());
            self.qpos_mut()[new].copy_from_slice(&old.qpos()[origin]);
            let (new, origin) = (new_joint.dofs(), old_joint.dofs());
            self.qvel_mut()[new.clone()].copy_from_slice(&old.qvel()[origin.clone()]);
            self.qacc_warmstart_mut()[new.clone()].copy_from_slice(&old.qacc_warmstart()[origin.clone()]);
            self.qfrc_applied_mut()[new].copy_from_slice(&old.qfrc_applied()[origin]);
        }
        for (new, origin) in survivors.pairs(Kind::Actuator) {
            keep(&mut self.ctrl_mut()[to.controls_of(new)], &old.ctrl()[from.controls_of(origin)]);
            keep(&mut self.act_mut()[to.activations_of(new)], &old.act()[from.activations_of(origin)]);
        }
        let kept = |new, old: &_| kept_parts(survivors, new, old);
        for (place, origin) in kept(to.history_parts(), &from.history_parts()) {
            self.history_values_mut()[place].copy_from_slice(&old.history_values()[origin]);
        }
        for (place, origin) in kept(to.plastic_parts(), &from.plastic_parts()) {
            self.plastic_values_mut()[place].copy_from_slice(&old.plastic_values()[origin]);
        }
        for (place, origin) in kept(to.plugin_parts(), &from.plugin_parts()) {
            self.plugin_state_values_mut()[place].copy_from_slice(&old.plugin_state_values()[origin]);
        }
        self.keep_equalities(old, survivors)
    }

    /// Sets whether the equality constraints are active.
    #[cfg_attr(engine_since = "3.0.0", allow(clippy::unnecessary_wraps, reason = "2.2.2 may copy the model"))]
    fn keep_equalities(&mut self, old: &Self, survivors: &Survivors<'_>) -> Result<()> {
        let active = old.active_equalities();
        #[cfg(engine_since = "3.0.0")]
        {
            let length = self.model().neq();
            // SAFETY: the engine allocated the array with this length, and `self` is borrowed
            // exclusively.
            let present = unsafe { ffi::array_mut(self.raw_mut().eq_active, length) };
            survivors.pairs(Kind::Equality).for_each(|(new, origin)| present[new] = active[origin]);
        }
        #[cfg(not(engine_since = "3.0.0"))]
        for (new, origin) in survivors.pairs(Kind::Equality) {
            if self.active_equalities()[new] != active[origin] {
                self.set_equality_active(new, active[origin] != 0)?;
            }
        }
        Ok(())
    }
}

/// Copies values, unless their number has changed.
fn keep(to: &mut [f64], from: &[f64]) {
    if to.len() == from.len() {
        to.copy_from_slice(from);
    }
}
