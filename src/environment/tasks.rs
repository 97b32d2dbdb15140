//! Ready tasks, with the observations, rewards and ends of episodes of Gymnasium's documentation.

use super::{Evaluation, Task, Transition};
use crate::data::Data;
use crate::error::Result;
use crate::model::Model;
use crate::rollout::Random;
use crate::sample;

/// Number of steps of an episode.
const TIME_LIMIT: Option<u64> = Some(1000);

/// Task of
/// [`InvertedPendulum-v5`](https://gymnasium.farama.org/environments/mujoco/inverted_pendulum/): a
/// cart balances a pole.
///
/// - Model: [`sample::cartpole`]; an action is a force on the cart, with 0.04 s per step.
/// - Observation `(4)`: position of the cart, m, angle of the pole, rad, and their velocities.
/// - Reward: 1 for each step that does not terminate.
/// - Terminated: the angle exceeds 0.2 rad, or the state is not finite. Truncated after 1000 steps.
/// - Initial state: upright, with a uniform deviation of up to 0.01 in all positions and
///   velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InvertedPendulum;

impl InvertedPendulum {
    /// Loads the model.
    pub fn model() -> Model {
        sample::cartpole()
    }
}

impl Task for InvertedPendulum {
    fn observation_size(&self, model: &Model) -> usize {
        model.nq() + model.nv()
    }

    fn frame_skip(&self) -> usize {
        4
    }

    fn time_limit(&self) -> Option<u64> {
        TIME_LIMIT
    }

    fn forward_after_start(&self) -> bool {
        false
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        add_uniform(random, 0.01, data.qpos_mut());
        add_uniform(random, 0.01, data.qvel_mut());
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        let (positions, velocities) = observation.split_at_mut(data.qpos().len());
        positions.copy_from_slice(data.qpos());
        velocities.copy_from_slice(data.qvel());
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let (qpos, qvel) = (transition.data.qpos(), transition.data.qvel());
        let is_finite = qpos.iter().chain(qvel).all(|value| value.is_finite());
        let terminated = !is_finite || qpos[1].abs() > 0.2;
        Ok(Evaluation { reward: if terminated { 0.0 } else { 1.0 }, terminated })
    }
}

/// Task of [`Hopper-v5`](https://gymnasium.farama.org/environments/mujoco/hopper/): a leg with a
/// torso hops forward in a plane.
///
/// - Model: [`Hopper::model`]; the actions are torques at hip, knee and ankle, in ±1, with 0.008 s
///   per step.
/// - Observation `(11)`: positions without that along the path, and velocities, limited to ±10.
/// - Reward: the mean velocity along the path during the step, m/s, plus 1 if the state is healthy,
///   minus 0.001 × the sum of the squares of the actions.
/// - Terminated: the state is not healthy, which means a height of the torso above 0.7 m, a pitch
///   of the torso within ±0.2 rad, and the pitch, the joint angles and all velocities within ±100.
///   Truncated after 1000 steps.
/// - Initial state: standing, with a uniform deviation of up to 0.005 in all positions and
///   velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hopper;

impl Hopper {
    /// Loads the model: a torso, a thigh, a shin and a foot. The positions are x and z of the
    /// torso, m, its pitch, and the angles of hip, knee and ankle, rad.
    pub fn model() -> Model {
        sample::hopper()
    }
}

impl Task for Hopper {
    fn observation_size(&self, model: &Model) -> usize {
        model.nq() - 1 + model.nv()
    }

    fn frame_skip(&self) -> usize {
        4
    }

    fn time_limit(&self) -> Option<u64> {
        TIME_LIMIT
    }

    fn forward_after_start(&self) -> bool {
        false
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        add_uniform(random, 0.005, data.qpos_mut());
        add_uniform(random, 0.005, data.qvel_mut());
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        observe_without_x(data, observation);
        for velocity in &mut observation[data.qpos().len() - 1..] {
            *velocity = velocity.clamp(-10.0, 10.0);
        }
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let (qpos, qvel) = (transition.data.qpos(), transition.data.qvel());
        let is_moderate = qpos[2..].iter().chain(qvel).all(|value| value.abs() < 100.0);
        let is_healthy = is_moderate && qpos[1] > 0.7 && qpos[2].abs() < 0.2;
        let healthy = if is_healthy { 1.0 } else { 0.0 };
        Ok(Evaluation { reward: velocity(transition) + healthy - 1e-3 * effort(transition), terminated: !is_healthy })
    }
}

/// Task of [`HalfCheetah-v5`](https://gymnasium.farama.org/environments/mujoco/half_cheetah/): two
/// legs with a torso run forward in a plane.
///
/// - Model: [`HalfCheetah::model`]; the actions are torques at the hip, knee and ankle of the hind
///   leg, then of the fore leg, in ±1, with 0.05 s per step.
/// - Observation `(17)`: positions without that along the path, and velocities.
/// - Reward: the mean velocity along the path during the step, m/s, minus 0.1 × the sum of the
///   squares of the actions.
/// - Terminated: never. Truncated after 1000 steps.
/// - Initial state: standing, with a uniform deviation of up to 0.1 in all positions, and a normal
///   one of 0.1 in all velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HalfCheetah;

impl HalfCheetah {
    /// Loads the model: a torso, and a hind leg and a fore leg of thigh, shin and foot. The
    /// positions are x and z of the torso relative to standing, m, its pitch, and the angles of
    /// hip, knee and ankle of the hind leg, then of the fore leg, rad.
    pub fn model() -> Model {
        sample::half_cheetah()
    }
}

impl Task for HalfCheetah {
    fn observation_size(&self, model: &Model) -> usize {
        model.nq() - 1 + model.nv()
    }

    fn frame_skip(&self) -> usize {
        5
    }

    fn time_limit(&self) -> Option<u64> {
        TIME_LIMIT
    }

    fn forward_after_start(&self) -> bool {
        false
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        add_uniform(random, 0.1, data.qpos_mut());
        for velocity in data.qvel_mut() {
            *velocity += 0.1 * random.normal();
        }
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        observe_without_x(data, observation);
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        Ok(Evaluation { reward: velocity(transition) - 0.1 * effort(transition), terminated: false })
    }
}

/// Adds a number from a uniform distribution within ±`deviation` to each value.
fn add_uniform(random: &mut Random, deviation: f64, values: &mut [f64]) {
    for value in values {
        *value += random.uniform(-deviation, deviation);
    }
}

/// Writes the positions without the first, which is that along the path, and the velocities.
fn observe_without_x(data: &Data, observation: &mut [f64]) {
    let (positions, velocities) = observation.split_at_mut(data.qpos().len() - 1);
    positions.copy_from_slice(&data.qpos()[1..]);
    velocities.copy_from_slice(data.qvel());
}

/// Returns the mean velocity along the path, m/s.
fn velocity(transition: &Transition<'_>) -> f64 {
    (transition.data.qpos()[0] - transition.before.qpos[0]) / transition.duration
}

/// Returns the sum of the squares of the actions.
fn effort(transition: &Transition<'_>) -> f64 {
    transition.action.iter().map(|action| action * action).sum()
}
