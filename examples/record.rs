//! Offscreen recording: a humanoid balances on one leg and recovers from a push.
//!
//! ```text
//! cargo run --release --features renderer --example record -- --out humanoid.gif
//! ```
//!
//! During the push the film runs at a sixth of real time, and an arrow shows the force. The program
//! prints the number of frames and the duration of the recording. `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use common::{balance, command_line};
use mujoco_safe::Controller;
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::scene::{Camera, Connector, NewGeom};

/// Horizontal force on the torso during the push, N.
const PUSH: [f64; 2] = [40.0, 25.0];
/// Start and duration of the push, s.
const PUSH_AT: f64 = 1.0;
const PUSH_DURATION: f64 = 0.1;
/// Factor of the slow motion during the push.
const SLOW_MOTION: f64 = 6.0;
/// Length of the arrow, and distance of its tip from the centre of the torso, m.
const ARROW: f64 = 0.5;
const GAP: f64 = 0.14;

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
    /// Width and height of the frames in pixels
    #[arg(long, value_name = "WxH", default_value = "560x420", value_parser = command_line::size)]
    size: [usize; 2],
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(&Arguments { ref out, seconds, size: [width, height] }: &Arguments) -> Result<(), Box<dyn Error>> {
    let mut recorder = Recorder::create(out, RecorderOptions::default().with_frames_per_second(25.0))?;
    let (mut data, _, mut lqr) = balance::humanoid()?;
    let model = data.model().clone();
    let torso = model.body("torso")?.id();

    // The camera looks at a right angle to the push, which is towards the right of the image.
    let newtons = PUSH[0].hypot(PUSH[1]);
    let direction = PUSH.map(|component| component / newtons);
    let azimuth = 90.0 + direction[1].atan2(direction[0]).to_degrees();
    let mut camera = Camera { distance: 2.6, azimuth, elevation: -8.0, ..Camera::free(&model) };
    camera.lookat = [0.0, 0.0, 0.8];
    let mut renderer = Renderer::new(&model, width, height)?;
    let mut picture = RgbImage::default();

    let bar = command_line::progress_bar(seconds)?;
    // Time in the film, s.
    let mut film_time = 0.0;
    while data.time() < seconds {
        let pushing = (PUSH_AT..PUSH_AT + PUSH_DURATION).contains(&data.time());
        let [x, y] = if pushing { PUSH } else { [0.0, 0.0] };
        *data.body_mut(torso).xfrc_applied_mut() = [x, y, 0.0, 0.0, 0.0, 0.0];
        // Rendering takes longer than a step, so render only when a frame is due.
        if recorder.is_due(film_time) {
            let point = *data.body(torso).xipos();
            let mut snapshot = renderer.snapshot(&mut data, &mut camera)?;
            if pushing {
                let label = format!("{newtons:.0} N");
                for geom in arrow(point, direction, &label)? {
                    snapshot.scene_mut().add_geom(&geom)?;
                }
            }
            snapshot.rgb_into(&mut picture)?;
            recorder.push(&picture, film_time)?;
        }
        lqr.control(&mut data)?;
        data.step()?;
        film_time += model.timestep() * if pushing { SLOW_MOTION } else { 1.0 };
        bar.set_position(command_line::milliseconds(data.time()));
    }
    bar.finish_and_clear();
    let recorded = recorder.finish()?;
    println!("wrote {}: {} frames, {:.2} s", recorded.path.display(), recorded.frames, recorded.seconds);
    Ok(())
}

/// Returns an arrow in a horizontal direction, whose tip is near the surface of the torso, and its
/// label above it.
fn arrow([x, y, z]: [f64; 3], direction: [f64; 2], label: &str) -> mujoco_safe::Result<[NewGeom; 2]> {
    let at = |distance: f64, height: f64| [x - distance * direction[0], y - distance * direction[1], z + height];
    // An arrow is drawn at half the length of the connector.
    let arrow = NewGeom::connector(Connector::Arrow, 0.025, at(GAP + ARROW, 0.0), at(GAP - ARROW, 0.0));
    let label = NewGeom::text(label)?.with_pos(at(GAP + ARROW, 0.07));
    Ok([arrow.with_rgba([0.84, 0.37, 0.0, 1.0]), label])
}
