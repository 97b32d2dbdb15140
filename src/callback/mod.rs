//! Closures that the engine calls during a step: controls, forces, sensor readings and collision
//! filters.
//!
//! ```
//! use mujoco_safe::callback::Callbacks;
//! use mujoco_safe::{Data, sample};
//!
//! // A spring of 20 N/m between the cart and the origin.
//! let mut data = Data::new(sample::cartpole())?;
//! data.qpos_mut()[0] = 0.5;
//! let spring = Callbacks::new().with_passive(|passive| {
//!     let x = passive.qpos()[0];
//!     passive.qfrc_passive_mut()[0] -= 20.0 * x;
//! });
//! data.with_callbacks(spring, |data| data.forward())?;
//! assert_eq!(data.qfrc_passive()[0], -10.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! | closure | called | valid results | sets |
//! |---|---|---|---|
//! | [`with_control`](Callbacks::with_control) | before actuator forces are computed | positions, velocities | controls, applied forces |
//! | [`with_passive`](Callbacks::with_passive) | after passive forces were computed | positions | passive forces |
//! | [`with_sensor`](Callbacks::with_sensor) | after the evaluation of the sensors of a stage, if `user` sensors are among them | the stage | readings |
//! | [`with_contact_filter`](Callbacks::with_contact_filter) | for each pair of geoms in the broad phase | positions (frames only) | collision of the pair |
//! | [`with_actuator_dynamics`](Callbacks::with_actuator_dynamics), [`with_actuator_gain`](Callbacks::with_actuator_gain), [`with_actuator_bias`](Callbacks::with_actuator_bias) | for each actuator whose `dyntype`, `gaintype` or `biastype` is `user` | positions, velocities | the derivative, gain or bias |
//!
//! # Safety and cost
//!
//! In the engine, each callback is one function pointer for the process. In this crate, a callback
//! is a closure for one simulation, either within a scope ([`Data::with_callbacks`]) or until it is
//! replaced ([`Data::set_callbacks`]). It is not called for other simulations, clones, or the
//! compilation of models, in this thread or another. A closure reads the simulation during the
//! step, so access to results that are not computed yet returns
//! [`Error::NotComputed`](crate::Error::NotComputed). It can change only fields that the engine
//! reads afterwards. If a closure panics, the call that ran it returns
//! [`Error::Callback`](crate::Error::Callback), and the simulation must be reset.
//!
//! The function pointer of a kind of callback is installed at its first use in the process. Before
//! that, a step has no additional cost. Afterwards, each step of a simulation without callbacks
//! spends a few nanoseconds in a function that returns at once.

mod context;
mod install;
mod trampoline;

use std::ffi::c_int;
use std::fmt;

use mujoco_sys::callback;

pub use self::context::{ControlContext, PassiveContext, SensorContext};
use self::trampoline::callback_name;
use crate::data::Data;
use crate::id::{ActuatorId, GeomId};

type Control<'c> = Box<dyn FnMut(&mut ControlContext<'_>) + Send + 'c>;
type Passive<'c> = Box<dyn FnMut(&mut PassiveContext<'_>) + Send + 'c>;
type Sensor<'c> = Box<dyn FnMut(&mut SensorContext<'_>) + Send + 'c>;
type ContactFilter<'c> = Box<dyn FnMut(&Data, [GeomId; 2], bool) -> bool + Send + 'c>;
type Actuator<'c> = Box<dyn FnMut(&Data, ActuatorId) -> f64 + Send + 'c>;

/// Closures for [`Data::with_callbacks`] and [`Data::set_callbacks`]. Closures for `with_callbacks`
/// may borrow values that outlive that call.
///
/// ```compile_fail,E0597
/// # use mujoco_safe::callback::Callbacks;
/// # use mujoco_safe::{Data, sample};
/// let mut data = Data::new(sample::cartpole()).unwrap();
/// let callbacks = {
///     let mut calls = 0;
///     Callbacks::new().with_control(|_| calls += 1) // `calls` does not live long enough
/// };
/// data.with_callbacks(callbacks, |data| data.step()).unwrap();
/// ```
///
/// They must be `Send`, because a simulation may be stepped in any thread:
///
/// ```compile_fail,E0277
/// # use mujoco_safe::callback::Callbacks;
/// let calls = std::rc::Rc::new(std::cell::Cell::new(0));
/// let callbacks = Callbacks::new().with_control(|_| calls.set(calls.get() + 1)); // `Rc` cannot be sent between threads
/// ```
#[derive(Default)]
#[must_use = "closures are called after Data::set_callbacks or within Data::with_callbacks"]
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
    /// Creates an empty set of callbacks.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets controls and applied forces during a step, from the results of the position and
    /// velocity stages, including their sensor readings. The Runge–Kutta integrator calls the
    /// closure in each of its four substeps, with the sensor readings of the first substep;
    /// [`Data::transition_fd`] calls it at each perturbed state, so that a feedback law is part of
    /// the linearisation. If a control is NaN or beyond ±10¹⁰, the call returns
    /// [`Error::Unstable`](crate::Error::Unstable) and the data is poisoned.
    #[doc(alias = "mjcb_control")]
    pub fn with_control(mut self, control: impl FnMut(&mut ControlContext<'_>) + Send + 'c) -> Self {
        self.control = Some(Box::new(control));
        self
    }

    /// Adds to the engine's passive forces of springs, dampers and the medium.
    #[doc(alias = "mjcb_passive")]
    pub fn with_passive(mut self, passive: impl FnMut(&mut PassiveContext<'_>) + Send + 'c) -> Self {
        self.passive = Some(Box::new(passive));
        self
    }

    /// Sets the readings of `user` sensors.
    ///
    /// ```
    /// use mujoco_safe::callback::Callbacks;
    /// use mujoco_safe::{Data, Model};
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
    /// let callbacks = Callbacks::new().with_sensor(|context| {
    ///     let momentum = [0, 1, 2].map(|axis| 2.0 * context.qvel()[axis]);
    ///     context.data_mut(sensor).copy_from_slice(&momentum);
    /// });
    /// data.with_callbacks(callbacks, |data| data.forward())?;
    /// assert_eq!(data.sensor(sensor).data()?, [0.0, 0.0, 3.0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjcb_sensor")]
    pub fn with_sensor(mut self, sensor: impl FnMut(&mut SensorContext<'_>) + Send + 'c) -> Self {
        self.sensor = Some(Box::new(sensor));
        self
    }

    /// Selects the pairs of geoms that may collide. The last argument of the closure is the result
    /// of the engine's rule (masks, and no collisions within a body or between parent and child).
    /// The return value replaces it. The closure is not called for pairs that the model lists
    /// explicitly, nor for pairs that the broad phase excludes.
    ///
    /// ```
    /// use mujoco_safe::callback::Callbacks;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("stand")?;
    /// let floor = data.model().geom("floor")?.id();
    /// let ghost = Callbacks::new().with_contact_filter(|_, geoms, collide| collide && !geoms.contains(&floor));
    /// data.with_callbacks(ghost, |data| data.forward())?;
    /// assert!(data.contacts().filter_map(|contact| contact.geoms()).all(|geoms| !geoms.contains(&floor)));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjcb_contactfilter")]
    pub fn with_contact_filter(mut self, filter: impl FnMut(&Data, [GeomId; 2], bool) -> bool + Send + 'c) -> Self {
        self.contact_filter = Some(Box::new(filter));
        self
    }

    /// Computes the time derivative of the activation of an actuator whose `dyntype` is `user`. The
    /// default is 0. For an actuator with several activations (`actdim`, with newer engines), a
    /// step returns [`Error::Unsupported`](crate::Error::Unsupported).
    #[doc(alias = "mjcb_act_dyn")]
    pub fn with_actuator_dynamics(mut self, derivative: impl FnMut(&Data, ActuatorId) -> f64 + Send + 'c) -> Self {
        self.actuator_dynamics = Some(Box::new(derivative));
        self
    }

    /// Computes the gain of an actuator whose `gaintype` is `user`: the force per unit of control
    /// or activation. The default is 1.
    #[doc(alias = "mjcb_act_gain")]
    pub fn with_actuator_gain(mut self, gain: impl FnMut(&Data, ActuatorId) -> f64 + Send + 'c) -> Self {
        self.actuator_gain = Some(Box::new(gain));
        self
    }

    /// Computes the bias of an actuator whose `biastype` is `user`: an additional force. The
    /// default is 0.
    #[doc(alias = "mjcb_act_bias")]
    pub fn with_actuator_bias(mut self, bias: impl FnMut(&Data, ActuatorId) -> f64 + Send + 'c) -> Self {
        self.actuator_bias = Some(Box::new(bias));
        self
    }

    /// Returns the engine's numbers of the callbacks that are set.
    fn present(&self) -> impl Iterator<Item = c_int> {
        let callbacks = [
            (callback::CONTROL, self.control.is_some()),
            (callback::PASSIVE, self.passive.is_some()),
            (callback::SENSOR, self.sensor.is_some()),
            (callback::CONTACT_FILTER, self.contact_filter.is_some()),
            (callback::ACTUATOR_DYNAMICS, self.actuator_dynamics.is_some()),
            (callback::ACTUATOR_GAIN, self.actuator_gain.is_some()),
            (callback::ACTUATOR_BIAS, self.actuator_bias.is_some()),
        ];
        callbacks.into_iter().filter(|(_, is_set)| *is_set).map(|(kind, _)| kind)
    }
}

impl fmt::Debug for Callbacks<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Callbacks: ")?;
        f.debug_set().entries(self.present().map(callback_name)).finish()
    }
}
