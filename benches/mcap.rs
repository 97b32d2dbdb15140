//! Cost of a log: a step that a [`Log`] makes and writes to a file against [`Data::step`], from the
//! same state under the same random controls, for the standing humanoid with a time step of 1 ms.
//! The file is in the directory for temporary files.
//!
//! ```text
//! cargo bench --features mcap --bench mcap
//! ```

mod common;

use common::episode::Episode;
use mujoco_safe::mcap::Log;
use mujoco_safe::{Data, Result, sample};

const STEPS: u32 = 100;

fn main() -> Result<()> {
    let mut model = sample::humanoid();
    model.edit().set_timestep(0.001)?;
    let path = std::env::temp_dir().join(format!("mujoco_safe_bench_{}.mcap", std::process::id()));
    let mut episode = Episode::new(Data::new(model)?, STEPS, |data| Log::create(&path, data.model()))?;
    let logged = |episode: &mut Episode<_>| episode.run(Log::step);
    let plain = |episode: &mut Episode<_>| episode.run(|_, data| data.step());
    common::compare("mcap/humanoid", &mut episode, STEPS, &[("logged", &logged), ("Data::step", &plain)]);
    let size = std::fs::metadata(&path).map_or(0, |file| file.len());
    println!("the file has {} MB", size / 1_000_000);
    std::fs::remove_file(path).ok();
    Ok(())
}
