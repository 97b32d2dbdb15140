//! Overhead of the safe step: [`Data::step`] against `mj_step` from the same state under the same
//! random controls, for the standing humanoid, the cart-pole, and 22 humanoids if the engine's
//! sample models are installed (`apt-get install libmujoco-samples`). Restoring the initial state,
//! which both variants do, takes less than a thousandth of a run.
//!
//! The ratio includes the guard, the check of the state for invalid numbers (in place of the
//! engine's own), the warning counters, and the check of each pair of geoms before the engine's
//! collision functions. Loading the first model installs the latter check in the engine's table of
//! collision functions, so a raw run restores the original table. Since 3.3 that table has the
//! checks for pairs of boxes and of other convex shapes, which these models do not have.
//!
//! ```text
//! cargo bench --bench step
//! ```

mod common;

use mujoco_safe::{Controller, Data, Model, RandomController, Result, StateSpec, sample, sys};

type Collisions = [[sys::mjfCollision; sys::mjNGEOMTYPES as usize]; sys::mjNGEOMTYPES as usize];

/// Replaces the table of collision functions and returns the previous one.
fn exchange(collisions: &Collisions) -> Collisions {
    // SAFETY: no other thread uses the engine, and the table contains the engine's functions, with
    // or without checks.
    unsafe { std::ptr::replace(&raw mut sys::mjCOLLISIONFUNC, *collisions) }
}

/// Simulation with its initial state and its controls.
struct Episode {
    data: Data,
    start: Vec<f64>,
    controls: Vec<Vec<f64>>,
}

impl Episode {
    /// Prepares an episode from a keyframe, or from the default positions, with controls up to a
    /// tenth of their range.
    fn new(model: Model, key: Option<&str>, steps: u32) -> Result<Self> {
        let mut data = Data::new(model)?;
        if let Some(key) = key {
            data.reset_to_key(key)?;
        }
        let start = data.state(StateSpec::INTEGRATION);
        let mut random = RandomController::new(1);
        let controls = (0..steps)
            .map(|_| {
                random.control(&mut data)?;
                Ok(data.ctrl().iter().map(|ctrl| 0.1 * ctrl).collect())
            })
            .collect::<Result<_>>()?;
        Ok(Self { data, start, controls })
    }

    fn run(&mut self, step: impl Fn(&mut Data)) {
        self.data.set_state(StateSpec::INTEGRATION, &self.start).expect("the state has the right length");
        for controls in &self.controls {
            self.data.ctrl_mut().copy_from_slice(controls);
            step(&mut self.data);
        }
    }
}

fn compare(engines_own: &Collisions, name: &str, mut episode: Episode) {
    let steps = episode.controls.len() as u32;
    let safe = |episode: &mut Episode| episode.run(|data| data.step().expect("the simulation is stable"));
    let raw = |episode: &mut Episode| {
        let checked = exchange(engines_own);
        episode.run(|data| {
            // SAFETY: the data and its own model. The other variant made the same steps without an
            // engine error.
            unsafe { sys::mj_step(data.model().as_ptr(), data.as_mut_ptr()) }
        });
        exchange(&checked);
    };
    common::compare(name, &mut episode, steps, &[("Data::step", &safe), ("mj_step", &raw)]);
}

fn main() -> Result<()> {
    // SAFETY: no model has been loaded, and no other thread uses the engine.
    let engines_own = unsafe { sys::mjCOLLISIONFUNC };
    compare(&engines_own, "step/humanoid", Episode::new(sample::humanoid(), Some("stand"), 50)?);
    compare(&engines_own, "step/cartpole", Episode::new(sample::cartpole(), Some("hanging_down"), 200)?);
    if let Some(path) = common::models::many_humanoids() {
        let episode = Episode::new(Model::from_xml_path(path)?, None, 10)?;
        compare(&engines_own, "step/22 humanoids", episode);
    }
    Ok(())
}
