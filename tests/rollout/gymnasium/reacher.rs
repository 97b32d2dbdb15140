//! An arm moves its fingertip to a target: rewards and observations depend on poses.

use mujoco_safe::environment::{Evaluation, Task, Transition};
use mujoco_safe::id::BodyId;
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Model, Result};

use super::{add_uniform, assert_random, compare, squares, write};

struct Reacher {
    fingertip: BodyId,
    target: BodyId,
}

impl Reacher {
    fn model() -> Model {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/gymnasium/reacher.xml");
        Model::from_xml_path(file).unwrap()
    }

    fn new(model: &Model) -> Self {
        let body = |name: &str| model.body(name).unwrap().id();
        Self { fingertip: body("fingertip"), target: body("target") }
    }

    /// Returns the position of the fingertip relative to the target, m.
    fn offset(&self, data: &Data) -> [f64; 3] {
        let (fingertip, target) = (data.body(self.fingertip).xpos(), data.body(self.target).xpos());
        std::array::from_fn(|axis| fingertip[axis] - target[axis])
    }
}

impl Task for Reacher {
    fn observation_size(&self, _: &Model) -> usize {
        10
    }

    fn frame_skip(&self) -> usize {
        2
    }

    fn time_limit(&self) -> Option<u64> {
        Some(50)
    }

    /// The last two positions are those of the target, drawn from a disc.
    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        add_uniform(random, 0.1, &mut data.qpos_mut()[..2]);
        add_uniform(random, 0.005, &mut data.qvel_mut()[..2]);
        loop {
            let goal = [random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)];
            if squares(&goal) < 0.04 {
                data.qpos_mut()[2..].copy_from_slice(&goal);
                return Ok(());
            }
        }
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        let (qpos, qvel) = (data.qpos(), data.qvel());
        let (cosines, sines) = ([qpos[0].cos(), qpos[1].cos()], [qpos[0].sin(), qpos[1].sin()]);
        write(observation, &[&cosines, &sines, &qpos[2..], &qvel[..2], &self.offset(data)[..2]]);
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let distance = squares(&self.offset(transition.data)).sqrt();
        Ok(Evaluation { reward: -distance - squares(transition.action), terminated: false })
    }
}

#[test]
fn reacher_equals_gymnasium() {
    let model = Reacher::model();
    let task = Reacher::new(&model);
    assert_eq!(compare("Reacher-v5", model, task, 0), [0, 1]);
}

#[test]
fn reacher_starts_are_random_and_reproducible() {
    assert_random(Reacher::model, Reacher::new);
}
