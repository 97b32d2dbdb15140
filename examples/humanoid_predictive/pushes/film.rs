//! Film of some pushes that topple the regulator: the regulator on the left, the planner on the
//! right.

use std::error::Error;
use std::path::Path;

use mujoco_safe::Data;
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::scene::Camera;

use super::Outcome;
use super::scenario::Scenario;

/// Number of pushes.
const PUSHES: usize = 3;
/// Size of each half, pixels.
const SIZE: [usize; 2] = [320, 320];

pub fn record(path: &Path, scenario: &Scenario, outcomes: &[Outcome]) -> Result<(), Box<dyn Error>> {
    let shown = || outcomes.iter().filter(|outcome| !outcome.regulated.upright()).take(PUSHES);
    if shown().next().is_none() {
        return Ok(());
    }
    let mut recorder = Recorder::create(path, RecorderOptions::default().with_frames_per_second(20.0))?;
    let [width, height] = SIZE;
    let mut renderer = Renderer::new(&scenario.model, width, height)?;
    let mut camera = Camera { distance: 3.2, azimuth: 215.0, elevation: -12.0, ..Camera::free(&scenario.model) };
    camera.lookat = [0.0, 0.0, 0.75];
    let mut data = Data::new(scenario.model.clone())?;
    let (mut both, mut half) = (RgbImage::new(2 * width, height), RgbImage::default());
    // Time in the film of the start of a push.
    let mut start = 0.0;
    for outcome in shown() {
        let times = outcome.planned.trajectory.times();
        for (record, &time) in times.iter().enumerate() {
            if !recorder.is_due(start + time) {
                continue;
            }
            for (index, run) in [&outcome.regulated, &outcome.planned].into_iter().enumerate() {
                // A run ends with a fall; the film holds its last pose.
                run.trajectory.apply(record.min(run.trajectory.len() - 1), &mut data)?;
                data.forward()?;
                renderer.snapshot(&mut data, &mut camera)?.rgb_into(&mut half)?;
                let halves = both.as_bytes_mut().chunks_exact_mut(3 * width).skip(index).step_by(2);
                halves.zip(half.as_bytes().chunks_exact(3 * width)).for_each(|(to, from)| to.copy_from_slice(from));
            }
            recorder.push(&both, start + time)?;
        }
        start += times.last().copied().unwrap_or(0.0) + scenario.model.timestep();
    }
    let recorded = recorder.finish()?;
    println!("wrote {}: {} frames, {:.2} s", recorded.path.display(), recorded.frames, recorded.seconds);
    Ok(())
}
