//! State vectors.

use std::ops::Range;

use bitflags::bitflags;

use super::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::model::Model;

bitflags! {
    /// Parts of a simulation that a state vector contains, concatenated in the order of the flags.
    /// Meaning, order and values are the same as in `mjtState` of MuJoCo 3.0, except for the active
    /// equality constraints, which 2.2.2 keeps in the model and which only a reset changes here,
    /// and for [`PLASTIC`](Self::PLASTIC) and [`HISTORY`](Self::HISTORY). Newer versions of MuJoCo
    /// number them differently.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub struct StateSpec: u32 {
        /// `time` (1)
        const TIME = 1;
        /// `qpos` (nq)
        const QPOS = 1 << 1;
        /// `qvel` (nv)
        const QVEL = 1 << 2;
        /// `act` (na)
        const ACT = 1 << 3;
        /// `qacc_warmstart` (nv)
        const WARMSTART = 1 << 4;
        /// `ctrl` (nu)
        const CTRL = 1 << 5;
        /// `qfrc_applied` (nv)
        const QFRC_APPLIED = 1 << 6;
        /// `xfrc_applied` (6 nbody)
        const XFRC_APPLIED = 1 << 7;
        /// `mocap_pos` (3 nmocap)
        const MOCAP_POS = 1 << 9;
        /// `mocap_quat` (4 nmocap)
        const MOCAP_QUAT = 1 << 10;
        /// `userdata` (nuserdata)
        const USERDATA = 1 << 11;
        /// State of engine plugins (npluginstate, with engines from 2.3)
        const PLUGIN = 1 << 12;
        /// Plastic deformation of flexes (nplastic, with engines from 4.0)
        const PLASTIC = 1 << 13;
        /// Buffers of the delays of actuators and sensors (nhistory, with engines from 3.5)
        const HISTORY = 1 << 14;

        /// Positions, velocities and activations: the state of most control problems.
        const PHYSICS = Self::QPOS.bits() | Self::QVEL.bits() | Self::ACT.bits();
        /// The physics state, time, the states of plugins and flexes, and the buffers of delays.
        const FULL_PHYSICS = Self::PHYSICS.bits() | Self::TIME.bits() | Self::PLUGIN.bits() | Self::PLASTIC.bits()
            | Self::HISTORY.bits();
        /// Inputs of the user: controls, applied forces, mocap poses and user data.
        const USER = Self::CTRL.bits() | Self::QFRC_APPLIED.bits() | Self::XFRC_APPLIED.bits()
            | Self::MOCAP_POS.bits() | Self::MOCAP_QUAT.bits() | Self::USERDATA.bits();
        /// All inputs of the next step: a simulation that is set to this state continues bit for
        /// bit. (A state does not contain which bodies sleep: all are awake in a simulation that is
        /// set to it. Neither does it contain which equalities are active, since engine 3.0, nor
        /// the `act_dot` with which earlier engines advance activations while actuation is
        /// disabled, nor the readings that engines since 3.5 put into the buffers of delays while
        /// sensors are disabled.)
        const INTEGRATION = Self::FULL_PHYSICS.bits() | Self::USER.bits() | Self::WARMSTART.bits();
    }
}

/// Repeats a block for each component that is set in `$spec`, with `$part` as a constant, so that
/// each copy of the block is compiled for one component.
macro_rules! for_each_component {
    ($spec:expr, $part:ident => $body:block) => {
        for_each_component!($spec, $part => $body; TIME QPOS QVEL ACT WARMSTART CTRL QFRC_APPLIED XFRC_APPLIED
            MOCAP_POS MOCAP_QUAT USERDATA PLUGIN PLASTIC HISTORY)
    };
    ($spec:expr, $part:ident => $body:block; $($component:ident)*) => {
        $(if $spec.contains(StateSpec::$component) {
            const $part: StateSpec = StateSpec::$component;
            $body
        })*
    };
}

/// A component that the macro lacks would be absent from all state vectors.
const _: () = {
    let mut rest = StateSpec::all();
    for_each_component!(StateSpec::all(), PART => { rest = rest.difference(PART) });
    assert!(rest.is_empty());
};

/// # State vectors
impl Model {
    /// Returns the length of a state vector.
    ///
    /// ```
    /// use mujoco_safe::{StateSpec, sample};
    ///
    /// let model = sample::humanoid();
    /// assert_eq!(model.state_size(StateSpec::PHYSICS), model.nq() + model.nv() + model.na());
    /// ```
    #[doc(alias = "mj_stateSize")]
    pub fn state_size(&self, spec: StateSpec) -> usize {
        let mut size = 0;
        for_each_component!(spec, PART => { size += self.part_size(PART) });
        size
    }

    /// Returns the indices of `part` in a state vector of `spec`.
    ///
    /// # Panics
    ///
    /// If `spec` does not contain `part`, or contains other components between the components of
    /// `part`.
    ///
    /// ```
    /// use mujoco_safe::{StateSpec, sample};
    ///
    /// let model = sample::cartpole();
    /// assert_eq!(model.state_range(StateSpec::PHYSICS, StateSpec::QVEL), 2..4); // [qpos; qvel]
    /// assert_eq!(model.state_range(StateSpec::INTEGRATION, StateSpec::PHYSICS), 1..5); // after the time
    /// ```
    pub fn state_range(&self, spec: StateSpec, part: StateSpec) -> Range<usize> {
        let is_other = |component: &StateSpec| !part.contains(*component);
        let start = spec.iter().take_while(is_other).map(|component| self.part_size(component)).sum();
        let found =
            spec.iter().skip_while(is_other).take_while(|component| !is_other(component)).collect::<StateSpec>();
        assert!(found == part, "{part:?} is not a contiguous part of {spec:?}");
        start..start + self.state_size(part)
    }

    /// Returns a part of a state vector of `spec`: the components in `part`, in the order of the
    /// flags.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the state vector has another length than
    /// [`state_size`](Self::state_size) of `spec`, and [`Error::Invalid`] if `spec` does not
    /// contain `part`.
    ///
    /// ```
    /// use mujoco_safe::{Data, StateSpec, sample};
    ///
    /// let data = Data::new(sample::humanoid())?;
    /// let saved = data.state(StateSpec::INTEGRATION);
    /// let part = StateSpec::TIME | StateSpec::CTRL;
    /// assert_eq!(data.model().extract_state(&saved, StateSpec::INTEGRATION, part)?, data.state(part));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_extractState")]
    pub fn extract_state(&self, state: &[f64], spec: StateSpec, part: StateSpec) -> Result<Vec<f64>> {
        Error::check_length("state", state.len(), self.state_size(spec))?;
        if !spec.contains(part) {
            return Err(Error::out_of_range(
                "the part of the state",
                format_args!("{part:?}"),
                format!("within {spec:?}"),
            ));
        }
        let mut values = Vec::with_capacity(self.state_size(part));
        let mut rest = state;
        for_each_component!(spec, PART => {
            let (component, after) = rest.split_at(self.part_size(PART));
            if part.contains(PART) {
                values.extend_from_slice(component);
            }
            rest = after;
        });
        debug_assert!(rest.is_empty(), "Bug: a state has the length of its components");
        Ok(values)
    }

    #[allow(clippy::inline_always, reason = "the constant component selects one arm")]
    #[inline(always)]
    fn part_size(&self, part: StateSpec) -> usize {
        match part {
            StateSpec::TIME => 1,
            StateSpec::QPOS => self.nq(),
            StateSpec::QVEL | StateSpec::WARMSTART | StateSpec::QFRC_APPLIED => self.nv(),
            StateSpec::ACT => self.na(),
            StateSpec::CTRL => self.nu(),
            StateSpec::XFRC_APPLIED => 6 * self.nbody(),
            StateSpec::MOCAP_POS => 3 * self.nmocap(),
            StateSpec::MOCAP_QUAT => 4 * self.nmocap(),
            StateSpec::USERDATA => self.nuserdata(),
            StateSpec::PLUGIN => self.plugin_state_len(),
            StateSpec::PLASTIC => self.plastic_len(),
            StateSpec::HISTORY => self.history_len(),
            // Undefined bits, which `from_bits_retain` can set.
            _ => 0,
        }
    }
}

/// # State vectors
impl Data {
    /// Returns positions, velocities and activations, `[qpos; qvel; act]`.
    #[doc(alias = "get_physics_state")]
    pub fn physics_state(&self) -> Vec<f64> {
        self.state(StateSpec::PHYSICS)
    }

    /// Writes `[qpos; qvel; act]` to `state`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn physics_state_into(&self, state: &mut [f64]) -> Result<()> {
        self.state_into(StateSpec::PHYSICS, state)
    }

    /// Sets positions, velocities and activations from `[qpos; qvel; act]`. Call
    /// [`forward`](Self::forward) to update the quantities that depend on them;
    /// [`step`](Self::step) needs no such call.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    #[doc(alias = "set_physics_state!")]
    pub fn set_physics_state(&mut self, state: &[f64]) -> Result<()> {
        self.set_state(StateSpec::PHYSICS, state)
    }

    /// Returns the parts of the state that are set in `spec`, concatenated.
    ///
    /// ```
    /// use mujoco_safe::{Data, StateSpec, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// let saved = data.state(StateSpec::INTEGRATION);
    /// data.step()?;
    /// let once = data.physics_state();
    /// data.set_state(StateSpec::INTEGRATION, &saved)?;
    /// data.step()?;
    /// assert_eq!(data.physics_state(), once); // bit for bit
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_getState")]
    pub fn state(&self, spec: StateSpec) -> Vec<f64> {
        let mut state = vec![0.0; self.model().state_size(spec)];
        self.read_state(spec, &mut state);
        state
    }

    /// Writes the parts of the state that are set in `spec` to `state`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    #[doc(alias = "mj_getState")]
    pub fn state_into(&self, spec: StateSpec, state: &mut [f64]) -> Result<()> {
        Error::check_length("state", state.len(), self.model().state_size(spec))?;
        self.read_state(spec, state);
        Ok(())
    }

    /// Sets the parts of the state that are set in `spec`.
    ///
    /// In a model with the option `sleep`, positions or velocities in `spec` wake all bodies, and
    /// results that were computed while one slept count as not computed.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, and [`Error::Invalid`] for a
    /// [`HISTORY`](StateSpec::HISTORY) with the index of a sample that does not exist; the state is
    /// unchanged then. If another value is out of range, the next step returns an error.
    #[doc(alias = "mj_setState")]
    pub fn set_state(&mut self, spec: StateSpec, state: &[f64]) -> Result<()> {
        Error::check_length("state", state.len(), self.model().state_size(spec))?;
        if spec.contains(StateSpec::HISTORY) && self.model().history_len() > 0 {
            let range = self.model().state_range(spec, StateSpec::HISTORY);
            self.model().check_history(&state[range])?;
        }
        self.write_state(spec, state);
        if spec.intersects(StateSpec::QPOS | StateSpec::QVEL) {
            self.wake();
        }
        Ok(())
    }

    /// Copies the parts of the state that are set in `spec` from another simulation, without
    /// allocation. Otherwise as [`set_state`](Self::set_state) with the [`state`](Self::state) of
    /// the other simulation. Edits of its model, such as
    /// [`weld_at_present_pose`](Self::weld_at_present_pose), are not copied.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if the model of the other simulation was loaded separately.
    ///
    /// ```
    /// use mujoco_safe::{Data, StateSpec, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.step_n(10)?;
    /// let mut twin = Data::new(data.model().clone())?;
    /// twin.copy_state(&data, StateSpec::INTEGRATION)?;
    /// data.step()?;
    /// twin.step()?;
    /// assert_eq!(twin.physics_state(), data.physics_state()); // bit for bit
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_copyState")]
    pub fn copy_state(&mut self, other: &Self, spec: StateSpec) -> Result<()> {
        self.model().relation(other.model()).check("the data to copy the state from")?;
        for_each_component!(spec, PART => { self.part_mut(PART).copy_from_slice(other.part(PART)) });
        if spec.intersects(StateSpec::QPOS | StateSpec::QVEL) {
            self.wake();
        }
        Ok(())
    }

    /// Computes all quantities for the present state, without an effect on later steps. `saved` is
    /// memory for the state.
    ///
    /// [`forward`](Self::forward) overwrites the initial guess of the constraint solver and
    /// normalises the quaternions in `qpos`. The state is restored because a step that starts from
    /// other values differs in the last bits. Bodies that sleep continue to do so.
    pub(crate) fn forward_between_steps(&mut self, saved: &mut Vec<f64>) -> Result<()> {
        saved.resize(self.model().state_size(StateSpec::INTEGRATION), 0.0);
        self.read_state(StateSpec::INTEGRATION, saved);
        let result = self.forward();
        self.write_state(StateSpec::INTEGRATION, saved);
        result
    }

    fn write_state(&mut self, spec: StateSpec, state: &[f64]) {
        let mut rest = state;
        for_each_component!(spec, PART => {
            let target = self.part_mut(PART);
            let (values, after) = rest.split_at(target.len());
            target.copy_from_slice(values);
            rest = after;
        });
        debug_assert!(rest.is_empty(), "Bug: a state has the length of its components");
    }

    /// Integrates the velocity `qvel` (`nv`) over the time `dt` in seconds and adds the result to
    /// `qpos`. The velocity of the simulation is unchanged. Call [`forward`](Self::forward) to
    /// update the quantities that depend on the position.
    ///
    /// [`Model::integrate_pos`] integrates any other position.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] if `dt` is not finite. The position
    /// is then unchanged.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.integrate_pos(&[0.1, 0.5], 2.0)?;
    /// assert_eq!(data.qpos(), [0.2, 1.0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_integratePos")]
    pub fn integrate_pos(&mut self, qvel: &[f64], dt: f64) -> Result<()> {
        // SAFETY: the engine allocated `qpos` with this length, and the data is borrowed
        // exclusively.
        let qpos = unsafe { ffi::array_mut(self.raw_mut().qpos, self.model.nq()) };
        self.model.integrate_pos(qpos, qvel, dt)
    }

    fn read_state(&self, spec: StateSpec, state: &mut [f64]) {
        let mut rest = state;
        self.for_each_part(spec, |_, source| {
            let (target, after) = std::mem::take(&mut rest).split_at_mut(source.len());
            target.copy_from_slice(source);
            rest = after;
        });
        debug_assert!(rest.is_empty(), "Bug: a state has the length of its components");
    }

    /// Calls `each` with each component of a state and its values, in their order.
    #[inline]
    pub(crate) fn for_each_part(&self, spec: StateSpec, mut each: impl FnMut(StateSpec, &[f64])) {
        for_each_component!(spec, PART => { each(PART, self.part(PART)) });
    }

    #[allow(clippy::inline_always, reason = "the constant component selects one arm")]
    #[inline(always)]
    fn part(&self, part: StateSpec) -> &[f64] {
        match part {
            StateSpec::TIME => std::slice::from_ref(&self.raw().time),
            StateSpec::QPOS => self.qpos(),
            StateSpec::QVEL => self.qvel(),
            StateSpec::ACT => self.act(),
            StateSpec::WARMSTART => self.qacc_warmstart(),
            StateSpec::CTRL => self.ctrl(),
            StateSpec::QFRC_APPLIED => self.qfrc_applied(),
            StateSpec::XFRC_APPLIED => self.xfrc_applied().as_flattened(),
            StateSpec::MOCAP_POS => self.mocap_pos().as_flattened(),
            StateSpec::MOCAP_QUAT => self.mocap_quat().as_flattened(),
            StateSpec::USERDATA => self.userdata(),
            StateSpec::PLUGIN => self.plugin_state_values(),
            StateSpec::PLASTIC => self.plastic_values(),
            StateSpec::HISTORY => self.history_values(),
            _ => &[],
        }
    }

    #[allow(clippy::inline_always, reason = "the constant component selects one arm")]
    #[inline(always)]
    fn part_mut(&mut self, part: StateSpec) -> &mut [f64] {
        match part {
            StateSpec::TIME => std::slice::from_mut(&mut self.raw_mut().time),
            StateSpec::QPOS => self.qpos_mut(),
            StateSpec::QVEL => self.qvel_mut(),
            StateSpec::ACT => self.act_mut(),
            StateSpec::WARMSTART => self.qacc_warmstart_mut(),
            StateSpec::CTRL => self.ctrl_mut(),
            StateSpec::QFRC_APPLIED => self.qfrc_applied_mut(),
            StateSpec::XFRC_APPLIED => self.xfrc_applied_mut().as_flattened_mut(),
            StateSpec::MOCAP_POS => self.mocap_pos_mut().as_flattened_mut(),
            StateSpec::MOCAP_QUAT => self.mocap_quat_mut().as_flattened_mut(),
            StateSpec::USERDATA => self.userdata_mut(),
            StateSpec::PLUGIN => self.plugin_state_values_mut(),
            StateSpec::PLASTIC => self.plastic_values_mut(),
            StateSpec::HISTORY => self.history_values_mut(),
            _ => &mut [],
        }
    }
}
