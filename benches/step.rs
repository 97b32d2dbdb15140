//! What does safety cost a simulation? [`Data::step`] against `mj_step`, from the same state through the same steps under the
//! same random controls: the humanoid, standing, the cart-pole, and 22 humanoids where the engine's sample models are installed
//! (`apt-get install libmujoco-samples`). Going back to the start, which both do, is less than a thousandth of it.
//!
//! What the ratio measures is the guard, the look at the state for numbers that the engine would reset, in place of the engine's own, the
//! warning counters, and the look at each pair of geoms before it goes to the engine's collision functions. Those last looks are in the
//! table of these functions since the first model was loaded, so a raw run gets the engine's own table back.
//!
//! ```text
//! cargo bench --bench step
//! ```

mod common;

use criterion::Criterion;
use mujoco_safe::{Controller, Data, Model, RandomController, Result, StateSpec, sample, sys};

type Collisions = [[sys::mjfCollision; 8]; 8];

/// Puts other collision functions in the place of the present ones, which it returns.
fn exchange(collisions: &Collisions) -> Collisions {
    // SAFETY: nothing else runs in this program, and the functions are the engine's, checked or not.
    unsafe { std::ptr::replace(&raw mut sys::mjCOLLISIONFUNC, *collisions) }
}

/// A simulation, where it begins, and what it does then.
struct Episode {
    data: Data,
    start: Vec<f64>,
    controls: Vec<Vec<f64>>,
}

impl Episode {
    /// From a keyframe, or the model's own positions, with controls of up to a tenth of their range.
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
        self.data.set_state(StateSpec::INTEGRATION, &self.start).expect("the start has the right length");
        for controls in &self.controls {
            self.data.ctrl_mut().copy_from_slice(controls);
            step(&mut self.data);
        }
    }
}

fn compare(criterion: &mut Criterion, engines_own: &Collisions, name: &str, mut episode: Episode) {
    let steps = episode.controls.len() as u32;
    let safe = |episode: &mut Episode| episode.run(|data| data.step().expect("a stable simulation"));
    let raw = |episode: &mut Episode| {
        let checked = exchange(engines_own);
        episode.run(|data| {
            // SAFETY: a data and its own model; no engine error can come from a state that the other way stepped from.
            unsafe { sys::mj_step(data.model().as_ptr(), data.as_mut_ptr()) }
        });
        exchange(&checked);
    };
    common::compare(criterion, name, &mut episode, steps, &[("Data::step", &safe), ("mj_step", &raw)]);
}

fn main() -> Result<()> {
    let mut criterion = common::criterion();
    // SAFETY: no model has been loaded, and nothing else runs.
    let engines_own = unsafe { sys::mjCOLLISIONFUNC };
    compare(&mut criterion, &engines_own, "step/humanoid", Episode::new(sample::humanoid(), Some("stand"), 50)?);
    compare(
        &mut criterion,
        &engines_own,
        "step/cartpole",
        Episode::new(sample::cartpole(), Some("hanging_down"), 200)?,
    );
    if let Some(path) = common::samples::many_humanoids() {
        let episode = Episode::new(Model::from_xml_path(path)?, None, 10)?;
        compare(&mut criterion, &engines_own, "step/22 humanoids", episode);
    }
    criterion.final_summary();
    Ok(())
}
