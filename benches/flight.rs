//! Cost of the flight recorder: [`FlightRecorder::step`] against [`Data::step`] from the same state
//! under the same random controls, for the standing humanoid.
//!
//! ```text
//! cargo bench --bench flight
//! ```

mod common;

use mujoco_safe::flight::FlightRecorder;
use mujoco_safe::{Controller, Data, RandomController, Result, StateSpec, sample};

struct Episode {
    data: Data,
    recorder: FlightRecorder,
    start: Vec<f64>,
    controls: Vec<Vec<f64>>,
}

impl Episode {
    fn run(&mut self, step: impl Fn(&mut FlightRecorder, &mut Data) -> Result<()>) {
        let Self { data, recorder, start, controls } = self;
        data.set_state(StateSpec::INTEGRATION, start).expect("the state has the right length");
        for controls in controls {
            data.ctrl_mut().copy_from_slice(controls);
            step(recorder, data).expect("the simulation is stable");
        }
    }
}

fn main() -> Result<()> {
    let mut data = Data::new(sample::humanoid())?;
    data.reset_to_key("stand")?;
    let start = data.state(StateSpec::INTEGRATION);
    let mut random = RandomController::new(1);
    let mut control = || {
        random.control(&mut data)?;
        Ok(data.ctrl().iter().map(|ctrl| 0.1 * ctrl).collect())
    };
    let controls: Vec<Vec<f64>> = (0..50).map(|_| control()).collect::<Result<_>>()?;
    let steps = controls.len() as u32;
    let recorder = FlightRecorder::new(&data)?;
    let mut episode = Episode { data, recorder, start, controls };
    let recorded = |episode: &mut Episode| episode.run(|recorder, data| recorder.step(data));
    let plain = |episode: &mut Episode| episode.run(|_, data| data.step());
    common::compare("flight/humanoid", &mut episode, steps, &[("recorded", &recorded), ("Data::step", &plain)]);
    Ok(())
}
