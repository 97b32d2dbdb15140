//! Offscreen recording: a humanoid balances on one leg and recovers from a push.
//!
//! ```text
//! cargo run --release --features renderer --example record -- --out humanoid.gif
//! ```
//!
//! The program prints the number of frames and the duration of the recording. `--help` lists the
//! options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use common::{balance, command_line};
use mujoco_safe::Controller;
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::scene::{Camera, SceneOptions, VisualFlags};

/// Horizontal force on the torso during the push, N. The push lasts 0.1 s.
const PUSH: [f64; 2] = [40.0, 25.0];
/// Start of the push, s.
const PUSH_AT: f64 = 1.0;

/// Records a humanoid that balances on one leg and recovers from a push.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Output file: .gif, .png, .mp4 (requires the program ffmpeg), or a folder for numbered images
    #[arg(long, value_name = "PATH", default_value = "humanoid.gif")]
    out: PathBuf,
    /// Simulated time, s
    #[arg(long, value_name = "S", default_value_t = 4.0)]
    seconds: f64,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(&Arguments { ref out, seconds }: &Arguments) -> Result<(), Box<dyn Error>> {
    let mut recorder = Recorder::create(out, RecorderOptions::default().with_frames_per_second(25.0))?;
    let (mut data, _, mut lqr) = balance::humanoid()?;
    let model = data.model().clone();
    let torso = model.body("torso")?.id();

    // Configure the images.
    let mut shown = SceneOptions::default();
    shown.flags |= VisualFlags::PERTFORCE;
    let mut camera = Camera { distance: 2.9, azimuth: 215.0, elevation: -12.0, ..Camera::free(&model) };
    camera.lookat = [0.0, 0.0, 0.85];
    let mut renderer = Renderer::new(&model, 480, 360)?;
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
