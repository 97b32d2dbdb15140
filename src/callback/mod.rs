//! Closures that the engine calls in the middle of a step: controls, forces, readings and filters of one's own.
//!
//! ```
//! use mujoco_safe::{Callbacks, Data, sample};
//!
//! // A spring of 20 N/m between the cart and the origin.
//! let mut data = Data::new(sample::cartpole())?;
//! data.qpos_mut()[0] = 0.5;
//! let spring = Callbacks::new().passive(|passive| {
//!     let x = passive.qpos()[0];
//!     passive.qfrc_passive_mut()[0] -= 20.0 * x;
//! });
//! data.with_callbacks(spring, |data| data.forward())?;
//! assert_eq!(data.qfrc_passive()[0], -10.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! | closure | called | reads what is computed from | sets |
//! |---|---|---|---|
//! | [`control`](Callbacks::control) | before actuator forces are computed | positions, velocities | controls, applied forces |
//! | [`passive`](Callbacks::passive) | after passive forces were computed | positions | passive forces |
//! | [`sensor`](Callbacks::sensor) | after the sensors of a stage were read, if some of them are `user` sensors | the stage | readings |
//! | [`contact_filter`](Callbacks::contact_filter) | for each pair of geoms that may be near | positions (frames only) | whether they collide |
//! | [`actuator_dynamics`](Callbacks::actuator_dynamics), [`actuator_gain`](Callbacks::actuator_gain), [`actuator_bias`](Callbacks::actuator_bias) | for each actuator whose `dyntype`, `gaintype` or `biastype` is `user` | positions, velocities | a number |
//!
//! # How it is kept safe
//!
//! To the engine a callback is one function pointer for the whole process. Here it is a closure for one simulation, in one
//! scope ([`Data::with_callbacks`]): another simulation, a clone of this one, or a model that is being compiled, in this thread
//! or another, is not called for. A closure sees the simulation as it is at that moment, so what is not computed yet is
//! [`Error::NotComputed`](crate::Error::NotComputed), and it can change only what the engine reads afterwards. If it panics,
//! the call that ran it returns [`Error::Callback`](crate::Error::Callback), and the simulation is to be reset.
//!
//! In a process that never uses a kind of callback, the engine has none of that kind: a step costs nothing more. Once a kind
//! was used, the engine keeps a pointer to a function that finds out, in a few nanoseconds, that there is nothing to do.

mod moment;
mod scope;
mod trampoline;

use std::fmt;

pub use self::moment::{ControlMoment, PassiveMoment, SensorMoment};
pub(crate) use self::scope::Slot;
pub(crate) use self::trampoline::computing;
use crate::data::Data;
use crate::id::{ActuatorId, GeomId};

type Control<'c> = Box<dyn FnMut(&mut ControlMoment<'_>) + Send + 'c>;
type Passive<'c> = Box<dyn FnMut(&mut PassiveMoment<'_>) + Send + 'c>;
type Sensor<'c> = Box<dyn FnMut(&mut SensorMoment<'_>) + Send + 'c>;
type ContactFilter<'c> = Box<dyn FnMut(&Data, [GeomId; 2], bool) -> bool + Send + 'c>;
type Actuator<'c> = Box<dyn FnMut(&Data, ActuatorId) -> f64 + Send + 'c>;

/// Closures for [`Data::with_callbacks`]. They may borrow what outlives that call.
///
/// ```compile_fail,E0597
/// # use mujoco_safe::{Callbacks, Data, sample};
/// let mut data = Data::new(sample::cartpole()).unwrap();
/// let callbacks = {
///     let mut calls = 0;
///     Callbacks::new().control(|_| calls += 1) // `calls` does not live long enough
/// };
/// data.with_callbacks(callbacks, |data| data.step()).unwrap();
/// ```
///
/// A simulation may be stepped in any thread, so they must be able to go there:
///
/// ```compile_fail,E0277
/// # use mujoco_safe::Callbacks;
/// let calls = std::rc::Rc::new(std::cell::Cell::new(0));
/// let callbacks = Callbacks::new().control(|_| calls.set(calls.get() + 1)); // `Rc` cannot be sent between threads
/// ```
#[derive(Default)]
#[must_use = "they are called within Data::with_callbacks"]
pub struct Callbacks<'c> {
    control: Option<Control<'c>>,
    passive: Option<Passive<'c>>,
    sensor: Option<Sensor<'c>>,
    contact_filter: Option<ContactFilter<'c>>,
    actuator_dynamics: Option<Actuator<'c>>,
    actuator_gain: Option<Actuator<'c>>,
    actuator_bias: Option<Actuator<'c>>,
}

impl<'c> Callbacks<'c> {
    /// None.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets controls and applied forces in the middle of a step, from the results of the position and velocity stages, readings of
    /// their sensors included. With the Runge–Kutta integrator it is called at each of the four substeps, with the readings of the
    /// first; in [`Data::transition_fd`] at each perturbed state, so that a feedback law is part of the linearisation. Controls
    /// that are not finite or are huge are [`Error::Unstable`](crate::Error::Unstable) of the step, and poison the data.
    #[doc(alias = "mjcb_control")]
    pub fn control(mut self, control: impl FnMut(&mut ControlMoment<'_>) + Send + 'c) -> Self {
        self.control = Some(Box::new(control));
        self
    }

    /// Adds to the passive forces, those of springs, dampers and the medium.
    #[doc(alias = "mjcb_passive")]
    pub fn passive(mut self, passive: impl FnMut(&mut PassiveMoment<'_>) + Send + 'c) -> Self {
        self.passive = Some(Box::new(passive));
        self
    }

    /// Sets the readings of `user` sensors.
    ///
    /// ```
    /// use mujoco_safe::{Callbacks, Data, Model};
    ///
    /// let model = Model::from_xml_str(
    ///     r#"<mujoco>
    ///          <worldbody><body name="ball"><freejoint/><geom size="0.1" mass="2"/></body></worldbody>
    ///          <sensor><user name="momentum" objtype="body" objname="ball" datatype="real" dim="3" needstage="vel"/></sensor>
    ///        </mujoco>"#,
    /// )?;
    /// let sensor = model.sensor("momentum")?.id();
    /// let mut data = Data::new(model)?;
    /// data.qvel_mut()[2] = 1.5;
    /// let callbacks = Callbacks::new().sensor(|moment| {
    ///     let momentum = [0, 1, 2].map(|axis| 2.0 * moment.qvel()[axis]);
    ///     moment.data_mut(sensor).copy_from_slice(&momentum);
    /// });
    /// data.with_callbacks(callbacks, |data| data.forward())?;
    /// assert_eq!(data.sensor(sensor).data()?, [0.0, 0.0, 3.0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjcb_sensor")]
    pub fn sensor(mut self, sensor: impl FnMut(&mut SensorMoment<'_>) + Send + 'c) -> Self {
        self.sensor = Some(Box::new(sensor));
        self
    }

    /// Decides whether two geoms may collide. The last argument is what the engine's own rule says (masks, and no collisions
    /// within a body or between parent and child), which the answer replaces. It is not asked about pairs that the model
    /// names, nor about pairs that are far apart.
    ///
    /// ```
    /// use mujoco_safe::{Callbacks, Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("stand")?;
    /// let floor = data.model().geom("floor")?.id();
    /// let ghost = Callbacks::new().contact_filter(|_, geoms, collide| collide && !geoms.contains(&floor));
    /// data.with_callbacks(ghost, |data| data.forward())?;
    /// assert!(data.contacts().all(|contact| !contact.geoms().contains(&floor)));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjcb_contactfilter")]
    pub fn contact_filter(mut self, filter: impl FnMut(&Data, [GeomId; 2], bool) -> bool + Send + 'c) -> Self {
        self.contact_filter = Some(Box::new(filter));
        self
    }

    /// Gives the time derivative of the activation of an actuator whose `dyntype` is `user`. Without it that is 0.
    #[doc(alias = "mjcb_act_dyn")]
    pub fn actuator_dynamics(mut self, derivative: impl FnMut(&Data, ActuatorId) -> f64 + Send + 'c) -> Self {
        self.actuator_dynamics = Some(Box::new(derivative));
        self
    }

    /// Gives the gain of an actuator whose `gaintype` is `user`: force for each unit of control or activation. Without it that
    /// is 1.
    #[doc(alias = "mjcb_act_gain")]
    pub fn actuator_gain(mut self, gain: impl FnMut(&Data, ActuatorId) -> f64 + Send + 'c) -> Self {
        self.actuator_gain = Some(Box::new(gain));
        self
    }

    /// Gives the bias of an actuator whose `biastype` is `user`: the force that it adds. Without it that is 0.
    #[doc(alias = "mjcb_act_bias")]
    pub fn actuator_bias(mut self, bias: impl FnMut(&Data, ActuatorId) -> f64 + Send + 'c) -> Self {
        self.actuator_bias = Some(Box::new(bias));
        self
    }
}

impl fmt::Debug for Callbacks<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let set = [
            ("control", self.control.is_some()),
            ("passive", self.passive.is_some()),
            ("sensor", self.sensor.is_some()),
            ("contact_filter", self.contact_filter.is_some()),
            ("actuator_dynamics", self.actuator_dynamics.is_some()),
            ("actuator_gain", self.actuator_gain.is_some()),
            ("actuator_bias", self.actuator_bias.is_some()),
        ];
        f.write_str("Callbacks: ")?;
        f.debug_set().entries(set.iter().filter(|(_, set)| *set).map(|(name, _)| *name)).finish()
    }
}
