//! A quadruped runs: rewards and observations depend on the forces of contacts, and rewards on the
//! pose before the step.

use mujoco_safe::environment::{Evaluation, Task, Transition};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Model, Result};

use super::{add_uniform, assert_random, compare, squares};

/// Body whose velocity is rewarded.
const TORSO: usize = 1;

struct Ant;

impl Ant {
    fn model() -> Model {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/gymnasium/quadruped.xml");
        Model::from_xml_path(file).unwrap()
    }
}

/// Returns the forces of contacts on all bodies, limited to ±1.
fn contact_forces(data: &Data) -> impl Iterator<Item = f64> {
    data.cfrc_ext().as_flattened().iter().map(|force| force.clamp(-1.0, 1.0))
}

impl Task for Ant {
    fn observation_size(&self, model: &Model) -> usize {
        model.nq() - 2 + model.nv() + 6 * (model.nbody() - 1)
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
        add_uniform(random, 0.1, data.qpos_mut());
        for velocity in data.qvel_mut() {
            *velocity += 0.1 * random.normal();
        }
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        let state = data.qpos()[2..].iter().chain(data.qvel()).copied();
        let parts = state.chain(contact_forces(data).skip(6));
        observation.iter_mut().zip(parts).for_each(|(to, value)| *to = value);
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let data = transition.data;
        let velocity = (data.xpos()[TORSO][0] - transition.memory[0]) / transition.duration;
        let is_finite = data.qpos().iter().chain(data.qvel()).all(|value| value.is_finite());
        let is_healthy = is_finite && (0.2..=1.0).contains(&data.qpos()[2]);
        let healthy = if is_healthy { 1.0 } else { 0.0 };
        let contacts: f64 = contact_forces(data).map(|force| force * force).sum();
        let costs = 0.5 * squares(transition.action) + 5e-4 * contacts;
        Ok(Evaluation { reward: velocity + healthy - costs, terminated: !is_healthy })
    }

    fn memory_size(&self, _: &Model) -> usize {
        1
    }

    /// Remembers the position of the torso along x.
    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        memory[0] = data.xpos()[TORSO][0];
        Ok(())
    }
}

#[test]
fn ant_equals_gymnasium() {
    assert_eq!(compare("Ant-v5", Ant::model(), Ant, 0), [1, 0]);
}

#[test]
fn ant_starts_are_random_and_reproducible() {
    assert_random(Ant::model, |_| Ant);
}
