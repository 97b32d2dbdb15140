//! The [`Controller`] trait, and controllers that need no solver.
//!
//! A controller sets `ctrl` before each step. Rollouts, recordings, the viewer and the trajectory
//! optimiser all accept a controller. Regulators that solve for a gain are in
//! [`control`](crate::control).

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::data::Data;
pub use crate::error::Outcome;
use crate::error::{Error, Result};
use crate::id::{ActuatorId, Lineage};
use crate::model::Model;

/// Sets the controls of a simulation, once before every step.
///
/// A closure is a controller. It returns nothing or a [`Result`]:
///
/// ```
/// use mujoco_safe::{Controller, Data, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.1;
/// for _ in 0..10 {
///     push.control(&mut data)?;
///     data.step()?;
/// }
/// assert!(data.qpos()[0] > 0.0);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// The closure must declare the type of its argument, `|data: &mut Data|`, because the compiler
/// does not infer it from this trait.
///
/// `Box<dyn Controller>` and `&mut dyn Controller` are controllers too, also with `Send` and
/// `Sync`, so a program can choose a controller at run time. A `Box<C>` or `&mut C` of another
/// controller `C` must be converted to one of them.
///
/// ```
/// use mujoco_safe::{Controller, Data, PdController, RandomController, Trajectory, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// for name in ["pd", "random"] {
///     let mut controller: Box<dyn Controller> = match name {
///         "pd" => Box::new(PdController::new(data.model(), 0.02, 0.005)),
///         _ => Box::new(RandomController::new(1)),
///     };
///     Trajectory::new(data.model()).record(&mut data, &mut controller, 10)?;
/// }
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a controller",
    label = "not a controller",
    note = "a closure is a controller if it declares the type of its argument, `|data: &mut Data| …`, and returns `()` or `Result<()>`",
    note = "other types implement `Controller`; a `&mut C` converts to a `&mut dyn Controller`, which is one"
)]
pub trait Controller {
    /// Sets the controls for the present state.
    ///
    /// # Errors
    ///
    /// Any error of the controller. The caller then does not take the step.
    fn control(&mut self, data: &mut Data) -> Result<()>;
}

impl<F, O> Controller for F
where
    F: FnMut(&mut Data) -> O,
    O: Outcome<Value = ()>,
{
    fn control(&mut self, data: &mut Data) -> Result<()> {
        self(data).into_result()
    }
}

/// Implements [`Controller`] for pointers to trait objects. A generic `Box<C>` would overlap with
/// closures, because a box of a closure is a closure.
macro_rules! forward_to_trait_object {
    ($($pointer:ty),*) => {
        $(
            impl Controller for $pointer {
                fn control(&mut self, data: &mut Data) -> Result<()> {
                    (**self).control(data)
                }
            }
        )*
    };
}
forward_to_trait_object!(
    Box<dyn Controller + '_>,
    Box<dyn Controller + Send + '_>,
    Box<dyn Controller + Send + Sync + '_>,
    &mut (dyn Controller + '_),
    &mut (dyn Controller + Send + '_),
    &mut (dyn Controller + Send + Sync + '_)
);

/// Controller that sets all controls to zero, which leaves the passive dynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ZeroController;

impl Controller for ZeroController {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        data.ctrl_mut().fill(0.0);
        Ok(())
    }
}

/// Controller that draws each control from a uniform distribution: over the control's range if it
/// is limited, else over ±1. The same seed yields the same controls on every machine.
///
/// ```
/// use mujoco_safe::{Controller, Data, RandomController, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// let mut random = RandomController::new(1);
/// random.control(&mut data)?;
/// assert!(data.ctrl().iter().all(|ctrl| ctrl.abs() <= 1.0));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "random_controller!")]
#[derive(Clone, Debug)]
pub struct RandomController {
    random: Xoshiro256PlusPlus,
}

impl RandomController {
    /// Creates a controller whose random numbers are determined by the seed.
    pub fn new(seed: u64) -> Self {
        Self { random: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }
}

impl Controller for RandomController {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        for index in 0..data.model().nu() {
            let model = data.model();
            let [low, high] =
                if model.actuator_ctrllimited()[index] == 0 { [-1.0, 1.0] } else { model.actuator_ctrlrange()[index] };
            let fraction: f64 = self.random.random();
            data.ctrl_mut()[index] = low + fraction * (high - low);
        }
        Ok(())
    }
}

/// PD controller that drives each actuator's length to a target:
/// `ctrl = kp (target − length) − kd velocity`.
///
/// The length of an actuator on a joint is the joint position times the gear, so this is the usual
/// PD controller of a robot with motors on its joints; it works the same way for tendons. It uses
/// the lengths and velocities of the present state.
///
/// ```
/// use mujoco_safe::{Controller, Data, PdController, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let mut pd = PdController::new(data.model(), 0.02, 0.005);
/// pd.set_target(data.model().actuator("slide")?, 0.2 * 50.0); // 0.2 m, times the gear
/// for _ in 0..2000 {
///     pd.control(&mut data)?;
///     data.step()?;
/// }
/// assert!((data.joint("slider")?.qpos()[0] - 0.2).abs() < 0.05);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// Stiffer legs than arms, and the pose of a keyframe as the target:
///
/// ```
/// use mujoco_safe::{Data, PdController, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// let mut pd = PdController::new(data.model(), 2.0, 0.1);
/// for actuator in data.model().actuators() {
///     if actuator.name().is_some_and(|name| name.ends_with("knee")) {
///         pd.set_gains(actuator, 10.0, 0.5);
///     }
/// }
/// data.reset_to_key("squat")?;
/// pd.hold(&mut data)?;
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "pid")]
#[derive(Clone, Debug)]
pub struct PdController {
    /// Gains of position and velocity.
    gains: Vec<[f64; 2]>,
    target: Vec<f64>,
    lineage: Lineage,
}

impl PdController {
    /// Creates a controller with the same gains for all actuators. Targets are the lengths in the
    /// reference configuration.
    pub fn new(model: &Model, kp: f64, kd: f64) -> Self {
        let target = model.actuator_length0().to_vec();
        Self { gains: vec![[kp, kd]; target.len()], target, lineage: model.lineage() }
    }

    /// Sets the gains of an actuator, given by its id or its view.
    ///
    /// # Panics
    ///
    /// If the actuator does not belong to the model that the controller was created for.
    pub fn set_gains(&mut self, actuator: impl Into<ActuatorId>, kp: f64, kd: f64) {
        let index = self.index(actuator.into());
        self.gains[index] = [kp, kd];
    }

    /// Sets the target length of an actuator, given by its id or its view: [`Model::actuator`]
    /// looks up a name.
    ///
    /// # Panics
    ///
    /// If the actuator does not belong to the model that the controller was created for.
    pub fn set_target(&mut self, actuator: impl Into<ActuatorId>, length: f64) {
        let index = self.index(actuator.into());
        self.target[index] = length;
    }

    /// Sets all targets to the lengths at the present state, for example at a
    /// [keyframe](Data::reset_to_key). Calls [`Data::forward`].
    ///
    /// # Errors
    ///
    /// The errors of [`Data::forward`], and [`Error::Shape`] if the model has another number of
    /// actuators than the model that the controller was created for.
    pub fn hold(&mut self, data: &mut Data) -> Result<()> {
        self.evaluate(data)?;
        self.target.copy_from_slice(data.actuator_length());
        Ok(())
    }

    fn index(&self, actuator: ActuatorId) -> usize {
        assert!(actuator.lineage() == self.lineage, "{actuator:?} belongs to another model than this controller");
        actuator.index()
    }

    /// Computes the lengths of the present state. After a step, they still belong to the previous
    /// state.
    fn evaluate(&self, data: &mut Data) -> Result<()> {
        if data.model().has_several_controls() {
            let message = "a PD controller for actuators with several controls or forces";
            return Err(Error::Unsupported(message.to_owned()));
        }
        Error::check_length("the targets of a PD controller", self.target.len(), data.model().nu())?;
        data.forward()
    }
}

impl Controller for PdController {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        self.evaluate(data)?;
        for (index, (&target, &[kp, kd])) in self.target.iter().zip(&self.gains).enumerate() {
            let ctrl = kp * (target - data.actuator_length()[index]) - kd * data.actuator_velocity()[index];
            data.ctrl_mut()[index] = ctrl;
        }
        Ok(())
    }
}
