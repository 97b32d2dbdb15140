//! Steps of vector environments do not allocate.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use mujoco_safe::environment::{Evaluation, Task, Transition, VectorEnvironment};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Model, Result, sample};

use crate::allocations::allocates_nothing;
use crate::lock_process;

/// A task that reads contacts and forces on bodies, and starts a new episode every other step.
struct Contacts;

impl Task for Contacts {
    fn observation_size(&self, model: &Model) -> usize {
        6 * model.nbody()
    }

    fn time_limit(&self) -> Option<u64> {
        Some(2)
    }

    fn forward_after_step(&self) -> bool {
        true
    }

    fn body_forces(&self) -> bool {
        true
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        data.qpos_mut()[2] += random.uniform(-0.01, 0.01);
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        observation.copy_from_slice(data.cfrc_ext().as_flattened());
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let force: f64 = transition.data.contacts().map(|contact| contact.force().unwrap().force[0]).sum();
        Ok(Evaluation { reward: force + transition.memory[0], terminated: false })
    }

    fn memory_size(&self, _: &Model) -> usize {
        1
    }

    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        memory[0] = data.time();
        Ok(())
    }
}

#[test]
fn steps_and_new_episodes_of_an_environment_do_not_allocate() {
    let _lock = lock_process();
    let model = sample::humanoid();
    let actions = vec![0.1; model.nu()];
    let mut environment = VectorEnvironment::new(model, Contacts, 1, 0).unwrap();
    let start = environment.batch().episode(0);
    allocates_nothing("VectorEnvironment::step", || environment.step(&actions).unwrap());
    assert!(environment.batch().episode(0) > start + 1);
}
