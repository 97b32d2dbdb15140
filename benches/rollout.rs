//! Overhead and scaling of rollouts: [`Rollout::run_into`] against a sequential loop of `mj_step`
//! from the same initial states with the same controls, recording the same states, for 64 standing
//! humanoids and 64 cart-poles. The ratio for one thread is the overhead; the ratio for two threads
//! is at best one half.
//!
//! ```text
//! cargo bench --bench rollout
//! ```

mod common;

use std::sync::Arc;

use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder};
use mujoco_safe::rollout::{Rollout, RolloutBuffers, Workers};
use mujoco_safe::{Controller, Data, Model, RandomController, Result, StateSpec, sample, sys};

const ROLLOUTS: usize = 64;

/// Shared state of the variants: inputs, existing workers, and the output buffer.
struct Runs {
    workers: Workers,
    data: Data,
    steps: usize,
    start: Vec<f64>,
    width: usize,
    controls: Vec<f64>,
    states: Vec<f64>,
}

impl Runs {
    /// Prepares rollouts from a keyframe, with random controls up to the fraction `strength` of
    /// their range.
    fn new(model: Model, key: &str, strength: f64, steps: usize) -> Result<Self> {
        let model = Arc::new(model);
        let mut data = Data::new(model.clone())?;
        data.reset_to_key(key)?;
        let (start, width) = (data.state(StateSpec::INTEGRATION), data.physics_state().len());
        let mut random = RandomController::new(1);
        let mut controls = Vec::new();
        for _ in 0..ROLLOUTS * steps {
            random.control(&mut data)?;
            controls.extend(data.ctrl().iter().map(|ctrl| strength * ctrl));
        }
        let states = vec![0.0; ROLLOUTS * (steps + 1) * width];
        Ok(Self { workers: Workers::new(model), data, steps, start, width, controls, states })
    }

    /// Runs the rollouts in a pool, or in this thread.
    fn rollout(&mut self, pool: Option<&ThreadPool>) {
        let rollout = Rollout::on(&self.workers, ROLLOUTS, self.steps)
            .with_initial_state(StateSpec::INTEGRATION, &self.start)
            .with_controls(&self.controls);
        let buffers = RolloutBuffers { states: Some(&mut self.states), ..Default::default() };
        let outcomes = match pool {
            Some(pool) => pool.install(|| rollout.run_into(buffers)),
            None => rollout.with_chunk(ROLLOUTS).run_into(buffers),
        };
        assert!(outcomes.expect("the sizes match").iter().all(Result::is_ok), "the simulation is stable");
    }

    /// Runs the same rollouts with the engine alone.
    fn raw(&mut self) {
        let (width, nu) = (self.width, self.workers.model().nu());
        for (rollout, states) in self.states.chunks_exact_mut((self.steps + 1) * width).enumerate() {
            let (data, model) = (&mut self.data, self.workers.model());
            // The integration state contains everything that a step depends on. A reset would take
            // as long as many steps.
            data.set_state(StateSpec::INTEGRATION, &self.start).expect("the state has the right length");
            for (step, row) in states.chunks_exact_mut(width).enumerate() {
                data.physics_state_into(row).expect("the row has the length of a state");
                if step < self.steps {
                    data.ctrl_mut().copy_from_slice(&self.controls[(rollout * self.steps + step) * nu..][..nu]);
                    // SAFETY: the data and its own model. The other variants made the same steps
                    // without an engine error.
                    unsafe { sys::mj_step(model.as_ptr(), data.as_mut_ptr()) };
                }
            }
        }
    }
}

fn compare(name: &str, mut runs: Runs) {
    let pool = ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be created");
    // All variants compute bitwise equal states.
    runs.raw();
    let expected = runs.states.clone();
    runs.rollout(None);
    assert!(runs.states == expected, "one thread computes different states");
    runs.rollout(Some(&pool));
    assert!(runs.states == expected, "two threads compute different states");

    let steps = (ROLLOUTS * runs.steps) as u32;
    let two = |runs: &mut Runs| runs.rollout(Some(&pool));
    let one = |runs: &mut Runs| runs.rollout(None);
    let raw = |runs: &mut Runs| runs.raw();
    let variants: [common::Variant<'_, Runs>; 3] =
        [("two threads", &two), ("one thread", &one), ("a loop of mj_step", &raw)];
    common::compare(name, &mut runs, steps, &variants);
}

fn main() -> Result<()> {
    compare("rollout/humanoid", Runs::new(sample::humanoid(), "stand", 0.1, 10)?);
    compare("rollout/cartpole", Runs::new(sample::cartpole(), "hanging_down", 0.1, 50)?);
    Ok(())
}
