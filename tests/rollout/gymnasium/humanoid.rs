//! A humanoid walks: rewards and observations depend on centres of mass, inertias, velocities of
//! bodies, forces of actuators and forces of contacts.

use mujoco_safe::environment::{Evaluation, Task, Transition};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Model, Result, sample};

use super::{add_uniform, assert_random, compare, squares, write};

struct Humanoid;

/// Returns the position of the centre of mass along x, m.
fn centre_of_mass(data: &Data) -> f64 {
    let masses = data.model().body_mass();
    let sum: f64 = masses.iter().zip(data.xipos()).map(|(mass, position)| mass * position[0]).sum();
    sum / masses.iter().sum::<f64>()
}

impl Task for Humanoid {
    fn observation_size(&self, model: &Model) -> usize {
        model.nq() - 2 + model.nv() + (10 + 6 + 6) * (model.nbody() - 1) + model.nv() - 6
    }

    fn frame_skip(&self) -> usize {
        5
    }

    fn time_limit(&self) -> Option<u64> {
        Some(1000)
    }

    fn body_forces(&self) -> bool {
        true
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        add_uniform(random, 0.01, data.qpos_mut());
        add_uniform(random, 0.01, data.qvel_mut());
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        let parts = [
            &data.qpos()[2..],
            data.qvel(),
            data.cinert()[1..].as_flattened(),
            data.cvel()[1..].as_flattened(),
            &data.qfrc_actuator()[6..],
            data.cfrc_ext()[1..].as_flattened(),
        ];
        write(observation, &parts);
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let data = transition.data;
        let velocity = (centre_of_mass(data) - transition.memory[0]) / transition.duration;
        let is_healthy = 1.0 < data.qpos()[2] && data.qpos()[2] < 2.0;
        let healthy = if is_healthy { 5.0 } else { 0.0 };
        let contacts = (5e-7 * squares(data.cfrc_ext().as_flattened())).min(10.0);
        let reward = 1.25 * velocity + healthy - 0.1 * squares(transition.action) - contacts;
        Ok(Evaluation { reward, terminated: !is_healthy })
    }

    fn memory_size(&self, _: &Model) -> usize {
        1
    }

    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        memory[0] = centre_of_mass(data);
        Ok(())
    }
}

#[test]
fn humanoid_equals_gymnasium() {
    let model = sample::humanoid();
    // Gymnasium's reset does not compute the forces of contacts.
    let forces = 6 * (model.nbody() - 1);
    assert_eq!(compare("Humanoid-v5", model, Humanoid, forces), [1, 0]);
}

#[test]
fn humanoid_starts_are_random_and_reproducible() {
    assert_random(sample::humanoid, |_| Humanoid);
}
