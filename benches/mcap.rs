//! Cost of a log: a step that a [`Log`] makes and writes to a file against [`Data::step`], from the
//! same state under the same random controls, for the standing humanoid with a time step of 1 ms.
//! The file is in the directory for temporary files.
//!
//! ```text
//! cargo bench --features mcap --bench mcap
//! ```

mod common;

use mujoco_safe::mcap::Log;
use mujoco_safe::{Controller, Data, RandomController, Result, StateSpec, sample};

struct Episode {
    data: Data,
    log: Log,
    start: Vec<f64>,
    controls: Vec<Vec<f64>>,
}

impl Episode {
    fn run(&mut self, step: impl Fn(&mut Log, &mut Data) -> Result<()>) {
        let Self { data, log, start, controls } = self;
        data.set_state(StateSpec::INTEGRATION, start).expect("the state has the right length");
        for controls in controls {
            data.ctrl_mut().copy_from_slice(controls);
            step(log, data).expect("the simulation is stable");
        }
    }
}

fn main() -> Result<()> {
    let mut model = sample::humanoid();
    model.edit().set_timestep(0.001)?;
    let mut data = Data::new(model)?;
    data.reset_to_key("stand")?;
    let start = data.state(StateSpec::INTEGRATION);
    let mut random = RandomController::new(1);
    let mut control = || {
        random.control(&mut data)?;
        Ok(data.ctrl().iter().map(|ctrl| 0.1 * ctrl).collect())
    };
    let controls: Vec<Vec<f64>> = (0..100).map(|_| control()).collect::<Result<_>>()?;
    let steps = controls.len() as u32;
    let path = std::env::temp_dir().join(format!("mujoco_safe_bench_{}.mcap", std::process::id()));
    let log = Log::create(&path, data.model())?;
    let mut episode = Episode { data, log, start, controls };
    let logged = |episode: &mut Episode| episode.run(|log, data| log.step(data));
    let plain = |episode: &mut Episode| episode.run(|_, data| data.step());
    common::compare("mcap/humanoid", &mut episode, steps, &[("logged", &logged), ("Data::step", &plain)]);
    let size = std::fs::metadata(&path).map_or(0, |file| file.len());
    println!("the file has {} MB", size / 1_000_000);
    std::fs::remove_file(path).ok();
    Ok(())
}
