//! Cost of the flight recorder: [`FlightRecorder::step`] against [`Data::step`] from the same state
//! under the same random controls, for the standing humanoid.
//!
//! ```text
//! cargo bench --bench flight
//! ```

mod common;

use common::episode::Episode;
use mujoco_safe::flight::FlightRecorder;
use mujoco_safe::{Data, Result, sample};

const STEPS: u32 = 50;

fn main() -> Result<()> {
    let mut episode = Episode::new(Data::new(sample::humanoid())?, STEPS, FlightRecorder::new)?;
    let recorded = |episode: &mut Episode<_>| episode.run(FlightRecorder::step);
    let plain = |episode: &mut Episode<_>| episode.run(|_, data| data.step());
    common::compare("flight/humanoid", &mut episode, STEPS, &[("recorded", &recorded), ("Data::step", &plain)]);
    Ok(())
}
