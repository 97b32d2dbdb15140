//! Side-by-side comparison of two recorded trajectories: a humanoid on one leg without control and
//! under LQR.
//!
//! ```text
//! cargo run --release --features renderer --example trajectories -- --out trajectories.gif
//! ```
//!
//! The simulations run first; the frames are rendered from the recorded trajectories. The program
//! prints the number of frames and the duration of the recording. `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Parser;
use common::{balance, command_line, window};
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::scene::Camera;
use mujoco_safe::{Controller, Data, Trajectory, ZeroController};

/// Simulated time, s.
const SECONDS: f64 = 2.0;
/// Width and height of each half, pixels.
const SIZE: [usize; 2] = [320, 360];

/// Renders two trajectories of a humanoid side by side: without control and under LQR.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Output file; the example `record` lists the formats
    #[arg(long, value_name = "PATH", default_value = "trajectories.gif")]
    out: PathBuf,
    /// Play the trajectories in a window instead, forwards and backwards (requires
    /// `--features viewer`)
    #[arg(long)]
    view: bool,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let (mut data, set_point, mut lqr) = balance::humanoid()?;
    let steps = (SECONDS / data.model().timestep()).round() as usize;

    // Both start from the same state, with a small lateral velocity.
    let controllers: [&mut dyn Controller; 2] = [&mut ZeroController, &mut lqr];
    let mut trajectories = Vec::new();
    for controller in controllers {
        set_point.apply(&mut data)?;
        data.qvel_mut()[1] = -0.15;
        let mut trajectory = Trajectory::with_capacity(data.model(), steps);
        trajectory.record(&mut data, controller, steps)?;
        trajectories.push(trajectory);
    }

    if arguments.view {
        return window::replay("Passive and LQR", data, trajectories);
    }
    draw(&mut data, &trajectories, &arguments.out)
}

/// Renders trajectories side by side.
fn draw(data: &mut Data, trajectories: &[Trajectory], out: &Path) -> Result<(), Box<dyn Error>> {
    let mut recorder = Recorder::create(out, RecorderOptions::default().with_frames_per_second(25.0))?;
    let [width, height] = SIZE;
    let mut renderer = Renderer::new(data.model(), width, height)?;
    let mut camera = Camera { distance: 3.2, azimuth: 200.0, elevation: -12.0, ..Camera::free(data.model()) };
    camera.lookat = [0.0, 0.0, 0.75];

    let mut both = RgbImage::new(width * trajectories.len(), height);
    let mut half = RgbImage::default();
    let bar = command_line::progress_bar(SECONDS)?;
    for (record, &time) in trajectories[0].times().iter().enumerate() {
        if !recorder.is_due(time) {
            continue;
        }
        for (index, trajectory) in trajectories.iter().enumerate() {
            trajectory.apply(record, data)?;
            data.forward()?;
            renderer.snapshot(data, &mut camera)?.rgb_into(&mut half)?;
            let halves = both.as_bytes_mut().chunks_exact_mut(3 * width).skip(index).step_by(trajectories.len());
            halves.zip(half.as_bytes().chunks_exact(3 * width)).for_each(|(to, from)| to.copy_from_slice(from));
        }
        recorder.push(&both, time)?;
        bar.set_position(command_line::milliseconds(time));
    }
    bar.finish_and_clear();
    let recorded = recorder.finish()?;
    println!("wrote {}: {} frames, {:.2} s", recorded.path.display(), recorded.frames, recorded.seconds);
    Ok(())
}
