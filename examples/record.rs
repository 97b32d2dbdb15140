//! Offscreen recording: a humanoid balances on one leg and recovers from a push.
//!
//! ```text
//! cargo run --release --features renderer --example record -- --out humanoid.gif
//! ```
//!
//! Options:
//!
//! - `--out PATH`: output file (humanoid.gif); .gif, .png, .mp4 (requires the program `ffmpeg`), or a folder for numbered images
//! - `--seconds S`: simulated time (4)
//! - `--slow N`: slow-motion factor (1)
//! - `--fps N`: frames per second (25)
//! - `--size WxH`: image size in pixels (480x360)

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use common::{balance, command_line};
use mujoco_safe::Controller;
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::scene::{Camera, SceneOptions, VisualFlags};

const HELP: &str = "record [--out PATH] [--seconds S] [--slow N] [--fps N] [--size WxH]";

/// Horizontal force on the torso during the push, N. The push lasts 0.1 s.
const PUSH: [f64; 2] = [40.0, 25.0];
/// Start of the push, s.
const PUSH_AT: f64 = 1.0;

struct Arguments {
    out: PathBuf,
    seconds: f64,
    slow: f64,
    frames_per_second: f64,
    size: [u32; 2],
}

fn arguments() -> Result<Arguments, String> {
    let arguments =
        Arguments { out: "humanoid.gif".into(), seconds: 4.0, slow: 1.0, frames_per_second: 25.0, size: [480, 360] };
    command_line::read(HELP, arguments, |arguments, option| {
        match option.name() {
            "--out" => arguments.out = option.path()?,
            "--seconds" => arguments.seconds = option.number()?,
            "--slow" => arguments.slow = option.number()?,
            "--fps" => arguments.frames_per_second = option.number()?,
            "--size" => arguments.size = option.size()?,
            _ => return option.unknown(),
        }
        Ok(())
    })
}

fn main() -> std::process::ExitCode {
    common::command_line::exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let Arguments { out, seconds, slow, frames_per_second, size: [width, height] } = arguments()?;
    let options = RecorderOptions::default().with_frames_per_second(frames_per_second).with_speed(1.0 / slow);
    let mut recorder = Recorder::create(&out, options)?;
    let (mut data, _, mut lqr) = balance::humanoid()?;
    let model = data.model().clone();
    let torso = model.body("torso")?.id();

    // Configure the images.
    let mut shown = SceneOptions::default();
    shown.flags |= VisualFlags::PERTFORCE;
    let mut camera = Camera { distance: 2.9, azimuth: 215.0, elevation: -12.0, ..Camera::free(&model) };
    camera.lookat = [0.0, 0.0, 0.85];
    let mut renderer = Renderer::new(&model, width, height)?;
    let mut picture = RgbImage::default();

    let bar = command_line::progress_bar(seconds)?;
    while data.time() < seconds {
        let pushing = (PUSH_AT..PUSH_AT + 0.1).contains(&data.time());
        let [x, y] = if pushing { PUSH } else { [0.0, 0.0] };
        *data.body_mut(torso).xfrc_applied_mut() = [x, y, 0.0, 0.0, 0.0, 0.0];
        // Rendering takes longer than a step, so render only when a frame is due.
        if recorder.is_due(data.time()) {
            renderer.snapshot_with(&mut data, &mut camera, &shown)?.rgb_into(&mut picture)?;
            recorder.push(&picture, data.time())?;
        }
        lqr.control(&mut data)?;
        data.step()?;
        bar.set_position(command_line::milliseconds(data.time()));
    }
    bar.finish_and_clear();
    let recorded = recorder.finish()?;
    println!("wrote {}: {} frames, {:.2} s", recorded.path.display(), recorded.frames, recorded.seconds);
    Ok(())
}
