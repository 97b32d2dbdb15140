//! Visual servoing: a rover drives to a ball with the depth and segmentation images of its camera,
//! ten images per second.
//!
//! ```text
//! cargo run --release --features renderer --example camera_sensor -- --out out
//! ```
//!
//! The program prints the position of the ball in every tenth image if it writes images, and the
//! final distance. `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use common::command_line;
use mujoco_safe::element::Object;
use mujoco_safe::id::GeomId;
use mujoco_safe::render::{DepthImage, Renderer, SegmentationImage};
use mujoco_safe::{Data, Model};

/// Simulated time, s.
const SECONDS: f64 = 6.0;
/// Simulated time between two images, s.
const IMAGE_INTERVAL: f64 = 0.1;
/// Distance from the ball at which the rover stops, m.
const STOP_DISTANCE: f64 = 0.5;

/// Drives a rover to a ball with the depth and segmentation images of its camera.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Folder for every tenth image; without it, no images are written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(Arguments { out }: &Arguments) -> Result<(), Box<dyn Error>> {
    let mut data = Data::new(Model::from_xml_str(include_str!("../models/rover.xml"))?)?;
    let model = data.model().clone();
    let (ball, mast) = (model.geom("ball")?.id(), model.geom("head")?.id());
    let eye = model.camera("eye")?.id();
    let mut renderer = Renderer::new(&model, 320, 240)?;
    let (mut depth, mut segmentation) = (DepthImage::default(), SegmentationImage::default());
    if let Some(out) = out {
        std::fs::create_dir_all(out)?;
    }

    let bar = command_line::progress_bar(SECONDS)?;
    let mut images = 0;
    let mut detection = None;
    data.forward()?;
    while data.time() < SECONDS {
        if data.time() >= f64::from(images) * IMAGE_INTERVAL {
            // Render the present view of the camera.
            let mut snapshot = renderer.snapshot(&mut data, eye)?;
            snapshot.depth_into(&mut depth)?;
            snapshot.segmentation_into(&mut segmentation)?;
            detection = Detection::find(ball, &depth, &segmentation);

            // Drive towards the ball and slow down near it. Without a detection, turn on the spot.
            let [forward, turn] = match detection {
                Some(detection) => [8.0 * (detection.distance - STOP_DISTANCE).clamp(0.0, 1.0), 3.0 * detection.left],
                None => [0.0, 2.0],
            };
            data.ctrl_mut().copy_from_slice(&[forward - turn, forward + turn]);

            if let Some(out) = out.as_ref().filter(|_| images % 10 == 0) {
                let name = |kind: &str| out.join(format!("rover_{images:03}_{kind}.png"));
                snapshot.rgb()?.save_png(name("rgb"))?;
                depth.to_rgb([0.0, 5.0]).save_png(name("depth"))?;
                segmentation.save_png(name("segmentation"))?;
                bar.suspend(|| println!("{}", describe(&data, detection)));
            }
            images += 1;
        }
        data.step()?;
        bar.set_position(command_line::milliseconds(data.time()));
    }
    bar.finish_and_clear();
    println!("{}", describe(&data, detection));

    let [from, to] = [mast, ball].map(|geom| *data.geom(geom).xpos());
    let gap = (from[0] - to[0]).hypot(from[1] - to[1]);
    println!("{images} images rendered; the ball is {gap:.2} m from the mast");
    if let Some(out) = out {
        println!("wrote images to {}", out.display());
    }
    Ok(())
}

/// Position of an object relative to the camera.
#[derive(Clone, Copy, Debug)]
struct Detection {
    /// Horizontal offset from the image centre to the left; 1 is the edge of the image.
    left: f64,
    /// Distance to the nearest visible point along the optical axis, m.
    distance: f64,
}

impl Detection {
    fn find(object: GeomId, depth: &DepthImage, segmentation: &SegmentationImage) -> Option<Self> {
        let (mut pixels, mut columns, mut distance) = (0.0, 0.0, f64::INFINITY);
        for (index, segment) in segmentation.pixels().enumerate() {
            if segment.is_some_and(|segment| segment.object == Some(Object::Geom(object))) {
                pixels += 1.0;
                columns += (index % segmentation.width()) as f64 + 0.5;
                distance = distance.min(f64::from(depth.as_slice()[index]));
            }
        }
        (pixels > 0.0).then(|| Self { left: 1.0 - 2.0 * columns / pixels / segmentation.width() as f64, distance })
    }
}

fn describe(data: &Data, detection: Option<Detection>) -> String {
    match detection {
        Some(Detection { left, distance }) => {
            format!("{:.1} s: ball detected at {distance:.2} m, offset {left:+.2} to the left", data.time())
        }
        None => format!("{:.1} s: no ball detected", data.time()),
    }
}
