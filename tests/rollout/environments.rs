//! Environments: the definitions of tasks agree with Gymnasium's numbers, and a vector environment
//! equals a loop over single simulations.

use mujoco_safe::environment::{
    Evaluation, HalfCheetah, Hopper, InvertedPendulum, Motion, Task, Transition, VectorEnvironment,
};
use mujoco_safe::rollout::{Distribution, Parameter, Parameters, Random};
use mujoco_safe::{Controller, Data, Model, RandomController, Result};
use serde_json::Value;

use super::{bits, pool};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{what}: {found}, but {expected}");
    }
}

/// Compares a task with recorded steps. Returns the number of steps that terminate.
fn compare(name: &str, task: &dyn Task, model: Model) -> usize {
    let recorded: Value = serde_json::from_str(include_str!("../oracle/environments.json")).unwrap();
    let mut data = Data::new(model).unwrap();
    let mut observation = vec![0.0; task.observation_size(data.model())];
    let mut terminations = 0;
    for (step, recorded) in recorded[name].as_array().unwrap().iter().enumerate() {
        let what = |of: &str| format!("{of} in step {step} of {name}");
        let motion = |key: &str| (numbers(&recorded[key][0]), numbers(&recorded[key][1]));
        let ((qpos, qvel), after, action) = (motion("before"), motion("after"), numbers(&recorded["action"]));
        data.qpos_mut().copy_from_slice(&after.0);
        data.qvel_mut().copy_from_slice(&after.1);
        let duration = recorded["duration"].as_f64().unwrap();
        let transition = Transition::new(Motion::new(&qpos, &qvel), &action, &data, &[], duration);
        let evaluation = task.evaluate(&transition).unwrap();
        assert_near(&[evaluation.reward], &[recorded["reward"].as_f64().unwrap()], &what("reward"));
        assert_eq!(evaluation.terminated, recorded["terminated"].as_bool().unwrap(), "{}", what("termination"));
        terminations += usize::from(evaluation.terminated);

        task.observe(&data, &mut observation).unwrap();
        assert_near(&observation, &numbers(&recorded["observation"]), &what("observation"));
        let steps = task.frame_skip() as f64;
        assert!((data.model().timestep() * steps - duration).abs() < 1e-12, "{}", what("duration"));
    }
    terminations
}

#[test]
fn observations_rewards_and_ends_are_those_of_gymnasium() {
    assert!(compare("InvertedPendulum-v5", &InvertedPendulum, InvertedPendulum::model()) >= 2);
    assert!(compare("Hopper-v5", &Hopper, Hopper::model()) >= 2);
    assert_eq!(compare("HalfCheetah-v5", &HalfCheetah, HalfCheetah::model()), 0);
}

/// The hopper with short episodes.
pub(crate) struct ShortHopper;

impl Task for ShortHopper {
    fn observation_size(&self, model: &Model) -> usize {
        Hopper.observation_size(model)
    }

    fn frame_skip(&self) -> usize {
        Hopper.frame_skip()
    }

    fn time_limit(&self) -> Option<u64> {
        Some(23)
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        data.qpos_mut()[2] = 0.15; // rad, so that some fall before the time limit
        Hopper.start(random, data)
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        Hopper.observe(data, observation)
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        Hopper.evaluate(transition)
    }
}

/// One simulation of the short hopper, without an environment.
pub(crate) struct Alone {
    pub(crate) data: Data,
    pub(crate) index: usize,
    pub(crate) episode: u64,
    pub(crate) steps: u64,
}

impl Alone {
    pub(crate) fn start(&mut self, seed: u64) {
        (self.episode, self.steps) = (self.episode + 1, 0);
        self.data.reset().unwrap();
        ShortHopper.start(&mut Random::new(seed, self.index, self.episode), &mut self.data).unwrap();
    }

    pub(crate) fn observation(&self) -> Vec<f64> {
        let mut observation = vec![0.0; 11];
        Hopper.observe(&self.data, &mut observation).unwrap();
        observation
    }

    /// Returns the reward, termination and truncation.
    pub(crate) fn step(&mut self, action: &[f64]) -> (f64, bool, bool) {
        let (qpos, qvel) = (self.data.qpos().to_vec(), self.data.qvel().to_vec());
        self.data.ctrl_mut().copy_from_slice(action);
        (0..4).for_each(|_| self.data.step().unwrap());
        self.steps += 1;
        let before = Motion::new(&qpos, &qvel);
        let evaluation = Hopper.evaluate(&Transition::new(before, action, &self.data, &[], 0.002 * 4.0)).unwrap();
        (evaluation.reward, evaluation.terminated, !evaluation.terminated && self.steps == 23)
    }
}

#[test]
fn a_vector_environment_equals_single_simulations_with_resets() {
    let (count, seed, mut ends) = (5, 3, [0; 2]);
    for threads in [1, 3] {
        let new = || VectorEnvironment::new(Hopper::model(), ShortHopper, count, seed);
        let mut environment = pool(threads).install(new).unwrap();
        let alone = |index| Alone { data: Data::new(Hopper::model()).unwrap(), index, episode: 0, steps: 0 };
        let mut alone: Vec<Alone> = (0..count).map(alone).collect();
        for alone in &mut alone {
            alone.start(seed);
        }
        let mut random = RandomController::new(1);
        let mut source = Data::new(Hopper::model()).unwrap();
        for step in 0..60 {
            let mut actions = Vec::new();
            for _ in 0..count {
                random.control(&mut source).unwrap();
                actions.extend_from_slice(source.ctrl());
            }
            pool(threads).install(|| environment.step(&actions)).unwrap();
            for (index, alone) in alone.iter_mut().enumerate() {
                let what = format!("simulation {index}, step {step}, {threads} threads");
                let (reward, terminated, truncated) = alone.step(&actions[3 * index..][..3]);
                assert_eq!(environment.rewards()[index].to_bits(), reward.to_bits(), "reward of {what}");
                let flags = (environment.terminated()[index], environment.truncated()[index]);
                assert_eq!(flags, (terminated, truncated), "{what}");
                let last = alone.observation();
                assert_eq!(bits(environment.final_observations().row(index)), bits(&last), "end of {what}");
                ends[0] += usize::from(terminated);
                ends[1] += usize::from(truncated);
                if terminated || truncated {
                    alone.start(seed);
                }
                assert_eq!(bits(environment.observations().row(index)), bits(&alone.observation()), "start of {what}");
            }
        }
    }
    assert!(ends[0] >= 4 && ends[1] >= 4, "{ends:?} episodes were terminated and truncated");
}

#[test]
fn a_failure_terminates_one_episode() {
    let mut environment = VectorEnvironment::new(HalfCheetah::model(), HalfCheetah, 3, 1).unwrap();
    let mut actions = [0.1; 18];
    actions[6] = f64::NAN;
    environment.step(&actions).unwrap();
    assert_eq!((environment.terminated(), environment.truncated()), (&[false, true, false][..], &[false; 3][..]));
    assert_eq!(environment.rewards()[1], 0.0);
    assert!(environment.final_observations().row(1).iter().all(|value| value.is_nan()));
    assert!(environment.observations().as_slice().iter().all(|value| value.is_finite()));
    assert_eq!(environment.batch().episode(1), 2);
    assert!(environment.step(&actions[..17]).unwrap_err().to_string().contains("actions"));
}

#[test]
fn parameters_change_at_the_start_of_an_episode_only() {
    let model = Hopper::model();
    let gravity = Distribution::Uniform { low: -11.0, high: -9.0 };
    let parameters = Parameters::new().with(&model, Parameter::Gravity(2), gravity).unwrap();
    let mut environment =
        VectorEnvironment::new(model, ShortHopper, 3, 1).unwrap().with_parameters(parameters).unwrap();
    let mut changes = 0;
    for _ in 0..30 {
        let before = environment.batch().parameters().to_matrix();
        environment.step(&[0.2; 9]).unwrap();
        for index in 0..3 {
            let ended = environment.terminated()[index] || environment.truncated()[index];
            assert_eq!(environment.batch().parameters().row(index) != before.row(index), ended);
            changes += usize::from(ended);
        }
    }
    assert!(changes >= 3);
    assert_eq!(
        environment.batch().data(2).unwrap().model().options().gravity[2],
        environment.batch().parameters()[(2, 0)]
    );
}
