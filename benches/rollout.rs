//! What do rollouts cost, and what does a second thread bring? [`Rollout::run_into`] against a sequential loop of `mj_step` over
//! the same initial states and controls, recording the same states: 64 humanoids that stand, and 64 cart-poles. The ratio of one
//! thread is the price of the rollouts' own work; that of two is at best a half.
//!
//! ```text
//! cargo bench --bench rollout
//! ```

mod common;

use std::sync::Arc;

use criterion::Criterion;
use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder};
use mujoco_safe::rollout::{Rollout, RolloutBuffers, Workers};
use mujoco_safe::{Controller, Data, Model, RandomController, Result, StateSpec, sample, sys};

const ROLLOUTS: usize = 64;

/// What all ways share: the inputs, the simulations that are there already, and the buffer that they write to.
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
    /// From a keyframe, with controls of up to `strength` of their range.
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

    /// In a pool, or in this thread.
    fn rollout(&mut self, pool: Option<&ThreadPool>) {
        let rollout = Rollout::on(&self.workers, ROLLOUTS, self.steps)
            .initial_state(StateSpec::INTEGRATION, &self.start)
            .controls(&self.controls);
        let buffers = RolloutBuffers { states: Some(&mut self.states), ..Default::default() };
        let outcomes = match pool {
            Some(pool) => pool.install(|| rollout.run_into(buffers)),
            None => rollout.chunk(ROLLOUTS).run_into(buffers),
        };
        assert!(outcomes.expect("the sizes are right").iter().all(Result::is_ok), "a stable simulation");
    }

    /// The same by the engine alone.
    fn raw(&mut self) {
        let (width, nu) = (self.width, self.workers.model().nu());
        for (rollout, states) in self.states.chunks_exact_mut((self.steps + 1) * width).enumerate() {
            let (data, model) = (&mut self.data, self.workers.model());
            // The whole of what a step depends on. A reset would be needed for no more, and takes as long as many steps.
            data.set_state(StateSpec::INTEGRATION, &self.start).expect("the start has the right length");
            for (step, row) in states.chunks_exact_mut(width).enumerate() {
                data.physics_state_into(row).expect("a row of a state");
                if step < self.steps {
                    data.ctrl_mut().copy_from_slice(&self.controls[(rollout * self.steps + step) * nu..][..nu]);
                    // SAFETY: a data and its own model; no engine error can come from a state that the other ways stepped from.
                    unsafe { sys::mj_step(model.as_ptr(), data.as_mut_ptr()) };
                }
            }
        }
    }
}

fn compare(criterion: &mut Criterion, name: &str, mut runs: Runs) {
    let pool = ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be started");
    // The ways give the same, bit for bit.
    runs.raw();
    let expected = runs.states.clone();
    runs.rollout(None);
    assert!(runs.states == expected, "one thread gives other states");
    runs.rollout(Some(&pool));
    assert!(runs.states == expected, "two threads give other states");

    let steps = (ROLLOUTS * runs.steps) as u32;
    let two = |runs: &mut Runs| runs.rollout(Some(&pool));
    let one = |runs: &mut Runs| runs.rollout(None);
    let raw = |runs: &mut Runs| runs.raw();
    let ways: [common::Way<'_, Runs>; 3] = [("two threads", &two), ("one thread", &one), ("a loop of mj_step", &raw)];
    common::compare(criterion, name, &mut runs, steps, &ways);
}

fn main() -> Result<()> {
    let mut criterion = common::criterion();
    compare(&mut criterion, "rollout/humanoid", Runs::new(sample::humanoid(), "stand", 0.1, 10)?);
    compare(&mut criterion, "rollout/cartpole", Runs::new(sample::cartpole(), "hanging_down", 0.1, 50)?);
    criterion.final_summary();
    Ok(())
}
