//! Film of a policy.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use mujoco_safe::environment::{HalfCheetah, VectorEnvironment};
use mujoco_safe::record::{Recorder, RecorderOptions, Summary};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::{Data, Model};

use crate::policy::Policy;

/// Records the first seconds of an episode from the side.
pub fn record(path: &Path, model: &Arc<Model>, policy: &Policy, seconds: f64) -> Result<Summary, Box<dyn Error>> {
    let mut environment = VectorEnvironment::new(model, HalfCheetah, 1, 0)?;
    let mut recorder = Recorder::create(path, RecorderOptions::default().with_frames_per_second(20.0))?;
    let mut renderer = Renderer::new(model, 480, 240)?;
    let (mut data, mut picture) = (Data::new(model)?, RgbImage::default());
    let mut actions = vec![0.0; model.nu()];
    loop {
        environment.batch().load(0, &mut data)?;
        if data.time() > seconds {
            return Ok(recorder.finish()?);
        }
        data.forward()?;
        if recorder.is_due(data.time()) {
            renderer.snapshot(&mut data, "side")?.rgb_into(&mut picture)?;
            recorder.push(&picture, data.time())?;
        }
        policy.act(environment.observations(), &mut actions);
        environment.step(&actions)?;
    }
}
