//! Gymnasium's tasks `Reacher-v5`, `Ant-v5` and `Humanoid-v5`, written as tasks of this library,
//! against episodes of Gymnasium's classes with the same models and the same version of the engine.
//!
//! `tests/oracle/gymnasium/record.py` records the episodes: the initial states, which come from
//! NumPy's random numbers, observations, rewards and ends.

mod ant;
mod humanoid;
mod reacher;

use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_safe::environment::{Evaluation, Task, Transition, VectorEnvironment};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Model, Result, engine_version};
use serde_json::Value;

use super::bits;

/// Largest deviation from a recorded number, which has 12 digits. On other platforms the last bits
/// of sines differ, and contacts amplify the differences.
const BOUND: f64 = if cfg!(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu")) { 1e-9 } else { 1e-5 };

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= BOUND * (1.0 + expected.abs()), "{what}, {index}: {found}, not {expected}");
    }
}

/// A task whose episodes start at recorded states.
struct Recorded<T> {
    task: T,
    starts: Vec<[Vec<f64>; 2]>,
    next: AtomicUsize,
}

impl<T: Task> Task for Recorded<T> {
    fn observation_size(&self, model: &Model) -> usize {
        self.task.observation_size(model)
    }

    fn frame_skip(&self) -> usize {
        self.task.frame_skip()
    }

    fn time_limit(&self) -> Option<u64> {
        self.task.time_limit()
    }

    fn forward_after_step(&self) -> bool {
        self.task.forward_after_step()
    }

    fn body_forces(&self) -> bool {
        self.task.body_forces()
    }

    fn start(&self, _: &mut Random, data: &mut Data) -> Result<()> {
        let [qpos, qvel] = &self.starts[self.next.fetch_add(1, Ordering::Relaxed) % self.starts.len()];
        data.qpos_mut().copy_from_slice(qpos);
        data.qvel_mut().copy_from_slice(qvel);
        // Gymnasium's reset changes the initial guess of the constraint solver by this call, and
        // quaternions of older engines.
        data.forward()
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        self.task.observe(data, observation)
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        self.task.evaluate(transition)
    }

    fn memory_size(&self, model: &Model) -> usize {
        self.task.memory_size(model)
    }

    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        self.task.remember(data, memory)
    }
}

/// Compares the recorded episodes of a task. Returns the numbers of episodes that were terminated
/// and truncated. Gymnasium's first observation of an episode has zeros instead of its last
/// `uncomputed` values.
fn compare<T: Task>(name: &str, model: Model, task: T, uncomputed: usize) -> [usize; 2] {
    let file = format!("{}/tests/oracle/gymnasium/{}.json", env!("CARGO_MANIFEST_DIR"), engine_version());
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}; see record.py"));
    let recorded: Value = serde_json::from_str(&text).unwrap();
    let episodes = recorded[name].as_array().unwrap();
    let starts = episodes.iter().map(|episode| [numbers(&episode["qpos"]), numbers(&episode["qvel"])]).collect();
    let nu = model.nu();
    let task = Recorded { task, starts, next: AtomicUsize::new(0) };
    let mut environment = VectorEnvironment::new(model, task, 1, 0).unwrap();
    let (mut ends, mut ended) = ([0; 2], true);
    for (number, episode) in episodes.iter().enumerate() {
        if !ended {
            environment.reset().unwrap();
        }
        let first = numbers(&episode["observation"]);
        let (computed, zeros) = first.split_at(first.len() - uncomputed);
        assert!(zeros.iter().all(|value| *value == 0.0));
        assert_near(&environment.observations().row(0)[..computed.len()], computed, &format!("start of {number}"));
        for (step, recorded) in episode["steps"].as_array().unwrap().iter().enumerate() {
            let what = format!("{name}, episode {number}, step {step}");
            environment.step(&action(nu, step, number, episode["factor"].as_f64().unwrap())).unwrap();
            assert_near(environment.rewards(), &[recorded["reward"].as_f64().unwrap()], &what);
            let flags = [environment.terminated()[0], environment.truncated()[0]];
            assert_eq!(flags, ["terminated", "truncated"].map(|flag| recorded[flag].as_bool().unwrap()), "{what}");
            if !recorded["observation"].is_null() {
                assert_near(environment.final_observations().row(0), &numbers(&recorded["observation"]), &what);
            }
            ended = flags.contains(&true);
            ends[0] += usize::from(flags[0]);
            ends[1] += usize::from(flags[1]);
        }
    }
    ends
}

/// Returns the action of a step that `record.py` takes.
fn action(nu: usize, step: usize, episode: usize, factor: f64) -> Vec<f64> {
    let multiple = |actuator: usize| ((31 * step + 17 * actuator + 7 * episode) % 41) as f64 - 20.0;
    (0..nu).map(|actuator| factor * multiple(actuator) / 20.0).collect()
}

/// Asserts that two environments with one seed have the same initial observations, and that those
/// of different simulations, episodes and seeds differ.
fn assert_random<T: Task>(model: fn() -> Model, task: fn(&Model) -> T) {
    let new = |seed: u64| {
        let model = model();
        let task = task(&model);
        VectorEnvironment::new(model, task, 3, seed).unwrap()
    };
    let (mut one, same, other) = (new(1), new(1), new(2));
    let first = one.observations().to_matrix();
    assert_eq!(bits(first.as_slice()), bits(same.observations().as_slice()));
    one.reset().unwrap();
    for index in 0..3 {
        assert_ne!(first.row(index), one.observations().row(index));
        assert_ne!(first.row(index), other.observations().row(index));
        assert_ne!(first.row(index), first.row((index + 1) % 3));
    }
}

/// Adds a number from a uniform distribution within ±`deviation` to each value.
fn add_uniform(random: &mut Random, deviation: f64, values: &mut [f64]) {
    for value in values {
        *value += random.uniform(-deviation, deviation);
    }
}

/// Writes parts of an observation one after another.
fn write(observation: &mut [f64], parts: &[&[f64]]) {
    let mut rest = observation;
    for part in parts {
        let (to, others) = rest.split_at_mut(part.len());
        to.copy_from_slice(part);
        rest = others;
    }
    assert!(rest.is_empty(), "the observation is {} values longer than its parts", rest.len());
}

fn squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
