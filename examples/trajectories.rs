//! Side-by-side comparison of two recorded trajectories: a humanoid on one leg without control and under LQR.
//!
//! ```text
//! cargo run --release --features renderer --example trajectories -- --out trajectories.gif
//! ```
//!
//! The simulations run first; the frames are rendered from the recorded trajectories. Options:
//!
//! - `--out PATH`: output file (trajectories.gif); for the formats see the example `record`
//! - `--seconds S`: simulated time (2)
//! - `--size WxH`: image size of each half in pixels (320x360)
//! - `--view`: plays the trajectories in a window instead, forwards and backwards (requires `--features viewer`)

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use common::{balance, command_line, window};
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::scene::Camera;
use mujoco_safe::{Controller, Data, Trajectory, ZeroController};

const HELP: &str = "trajectories [--out PATH] [--seconds S] [--size WxH] [--view]";

struct Arguments {
    out: PathBuf,
    seconds: f64,
    size: [u32; 2],
    view: bool,
}

fn arguments() -> Result<Arguments, String> {
    let arguments = Arguments { out: "trajectories.gif".into(), seconds: 2.0, size: [320, 360], view: false };
    command_line::read(HELP, arguments, |arguments, option| {
        match option.name() {
            "--out" => arguments.out = option.path()?,
            "--seconds" => arguments.seconds = option.number()?,
            "--size" => arguments.size = option.size()?,
            "--view" => arguments.view = true,
            _ => return option.unknown(),
        }
        Ok(())
    })
}

fn main() -> std::process::ExitCode {
    common::command_line::exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    let (mut data, set_point, mut lqr) = balance::humanoid()?;
    let steps = (arguments.seconds / data.model().timestep()).round() as usize;

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
    draw(&mut data, &trajectories, &arguments)
}

/// Renders trajectories side by side.
fn draw(data: &mut Data, trajectories: &[Trajectory], arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let [width, height] = arguments.size;
    let mut recorder = Recorder::create(&arguments.out, RecorderOptions::default().with_frames_per_second(25.0))?;
    let mut renderer = Renderer::new(data.model(), width, height)?;
    let mut camera = Camera { distance: 3.2, azimuth: 200.0, elevation: -12.0, ..Camera::free(data.model()) };
    camera.lookat = [0.0, 0.0, 0.75];

    let (width, height) = (width as usize, height as usize);
    let mut both = RgbImage::new(width * trajectories.len(), height);
    let mut half = RgbImage::default();
    let bar = command_line::progress_bar(arguments.seconds)?;
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
