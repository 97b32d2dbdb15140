//! Controllers that come with the crate.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Controller;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::id::{ActuatorId, Lineage};
use crate::model::Model;

/// Sets all controls to zero: the passive dynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ZeroController;

impl Controller for ZeroController {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        data.ctrl_mut().fill(0.0);
        Ok(())
    }
}

/// Sets each control to a random number: uniform over its range where it has one, and over ±1 otherwise. The same seed gives
/// the same numbers, on every machine.
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
#[derive(Clone, Debug)]
pub struct RandomController {
    random: Xoshiro256PlusPlus,
}

impl RandomController {
    /// One whose numbers follow from the seed.
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

/// Drives each actuator's length to a target by `ctrl = kp (target − length) − kd velocity`.
///
/// The length of an actuator on a joint is the joint's position times its gear, so this is the usual PD controller of a robot
/// whose motors sit on its joints, and means the same for tendons. The lengths and velocities are those of the present state.
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
#[derive(Clone, Debug)]
pub struct PdController {
    kp: f64,
    kd: f64,
    target: Vec<f64>,
    lineage: Lineage,
}

impl PdController {
    /// One with these gains for all actuators, whose targets are their lengths in the reference configuration.
    pub fn new(model: &Model, kp: f64, kd: f64) -> Self {
        Self { kp, kd, target: model.actuator_length0().to_vec(), lineage: model.lineage() }
    }

    /// Sets the target length of an actuator.
    ///
    /// # Panics
    ///
    /// If the actuator is one of another model than that which the controller was made for.
    pub fn set_target(&mut self, actuator: impl Into<ActuatorId>, length: f64) {
        let actuator = actuator.into();
        assert!(actuator.lineage() == self.lineage, "{actuator:?} belongs to another model than this controller");
        self.target[actuator.index()] = length;
    }
}

impl Controller for PdController {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        Error::check_length("the target of a PD controller", self.target.len(), data.model().nu())?;
        // The lengths of the last step belong to the state before it.
        data.forward()?;
        for (index, target) in self.target.iter().enumerate() {
            let ctrl = self.kp * (target - data.actuator_length()[index]) - self.kd * data.actuator_velocity()[index];
            data.ctrl_mut()[index] = ctrl;
        }
        Ok(())
    }
}
