//! A rover that goes by what it sees: the camera on its mast gives colours, depths and which thing is where, ten times a second.
//!
//! ```text
//! cargo run --release --features renderer --example camera_sensor -- --out out
//! ```
//!
//! `--seconds S` for how long (6), `--size WxH` of the pictures (320x240), `--out DIR` where some of the pictures go (none
//! are written without).

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use common::{option, progress};
use mujoco_safe::render::{DepthPicture, Renderer, SegmentationPicture};
use mujoco_safe::scene::{Camera, Categories, SceneObject, SceneOptions};
use mujoco_safe::{Data, GeomId, Model, Scene};

const HELP: &str = "camera_sensor [--seconds S] [--size WxH] [--out DIR]";

/// From one look to the next, s of the simulation.
const LOOK_EVERY: f64 = 0.1;
/// Where it stops before the ball, m.
const STOP: f64 = 0.5;

struct Arguments {
    seconds: f64,
    size: [u32; 2],
    out: Option<PathBuf>,
}

fn arguments() -> Result<Arguments, String> {
    let arguments = Arguments { seconds: 6.0, size: [320, 240], out: None };
    option::read(HELP, arguments, |arguments, option| {
        match option.name() {
            "--seconds" => arguments.seconds = option.number()?,
            "--size" => arguments.size = option.size()?,
            "--out" => arguments.out = Some(option.path()?),
            _ => return option.unknown(),
        }
        Ok(())
    })
}

fn main() -> std::process::ExitCode {
    common::finish(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let Arguments { seconds, size: [width, height], out } = arguments()?;
    let mut data = Data::new(Model::from_xml_str(include_str!("../models/rover.xml"))?)?;
    let model = data.model().clone();
    let (ball, head) = (model.geom("ball")?.id(), model.geom("head")?.id());
    let mut eye = Camera::fixed(model.camera("eye")?.id());
    let mut scene = Scene::new(&model, 1000)?;
    let mut renderer = Renderer::new(&model, width, height)?;
    let (mut depth, mut things) = (DepthPicture::default(), SegmentationPicture::default());
    if let Some(out) = &out {
        std::fs::create_dir_all(out)?;
    }

    let bar = progress::bar(seconds)?;
    let mut looks = 0;
    let mut seen = None;
    data.forward()?;
    while data.time() < seconds {
        if data.time() >= f64::from(looks) * LOOK_EVERY {
            // What the camera sees now.
            scene.update(&mut data, &SceneOptions::default(), None, &mut eye, Categories::all())?;
            renderer.depth_into(&scene, &mut depth)?;
            renderer.segmentation_into(&scene, &mut things)?;
            seen = Sight::of(ball, &depth, &things);

            // Towards the ball, slower near it; without it turn and look around.
            let [forward, turn] = match seen {
                Some(sight) => [8.0 * (sight.distance - STOP).clamp(0.0, 1.0), 3.0 * sight.left],
                None => [0.0, 2.0],
            };
            data.ctrl_mut().copy_from_slice(&[forward - turn, forward + turn]);

            if let Some(out) = out.as_ref().filter(|_| looks % 10 == 0) {
                let name = |kind: &str| out.join(format!("rover_{looks:03}_{kind}.png"));
                renderer.rgb(&scene)?.save_png(name("rgb"))?;
                depth.to_picture([0.0, 5.0]).save_png(name("depth"))?;
                things.save_png(name("things"))?;
                bar.suspend(|| println!("{}", describe(&data, seen)));
            }
            looks += 1;
        }
        data.step()?;
        bar.set_position(progress::position(data.time()));
    }
    bar.finish_and_clear();
    println!("{}", describe(&data, seen));

    let [from, to] = [head, ball].map(|geom| *data.geom(geom).xpos());
    let apart = (from[0] - to[0]).hypot(from[1] - to[1]);
    println!("{looks} looks; the ball is {apart:.2} m from the mast");
    if let Some(out) = &out {
        println!("wrote pictures to {}", out.display());
    }
    Ok(())
}

/// Where a thing is, as far as the camera sees it.
#[derive(Clone, Copy, Debug)]
struct Sight {
    /// How far left of the middle: 1 is at the edge of the picture.
    left: f64,
    /// To its nearest point, m, along the camera's axis.
    distance: f64,
}

impl Sight {
    fn of(wanted: GeomId, depth: &DepthPicture, things: &SegmentationPicture) -> Option<Self> {
        let (mut pixels, mut columns, mut distance) = (0.0, 0.0, f64::INFINITY);
        for (index, segment) in things.pixels().enumerate() {
            if segment.is_some_and(|segment| segment.object == Some(SceneObject::Geom(wanted))) {
                pixels += 1.0;
                columns += (index % things.width()) as f64 + 0.5;
                distance = distance.min(f64::from(depth.as_slice()[index]));
            }
        }
        (pixels > 0.0).then(|| Self { left: 1.0 - 2.0 * columns / pixels / things.width() as f64, distance })
    }
}

fn describe(data: &Data, seen: Option<Sight>) -> String {
    match seen {
        Some(Sight { left, distance }) => {
            format!("{:.1} s: the ball is {distance:.2} m ahead, {left:+.2} to the left", data.time())
        }
        None => format!("{:.1} s: no ball in sight", data.time()),
    }
}
