//! Rendering speed, on its own and against the engine's renderer.
//!
//! ```text
//! MUJOCO_PYTHON=python3 cargo bench --features renderer --bench render
//! ```
//!
//! `MUJOCO_PYTHON` names an interpreter with the official bindings of the same engine version
//! (`mujoco==2.2.2`, `numpy<2`, `pyopengl`, `pillow`) to run `render.py` beside this file; it also
//! requires Debian's `libosmesa6`. Without the variable, the engine's renderer is omitted.
//!
//! Both render the same scenes of `tests/render/pictures` with the model's number of samples and
//! shadow settings, and read the pixels back. The interpreter uses the engine's library of this
//! program (`LD_PRELOAD`). They alternate in turns of a few images each, and every pair of turns
//! gives a ratio. The comparison uses the processor time of all threads. With a software renderer,
//! such as Mesa's lavapipe and OSMesa, this is the full cost of an image, independent of other
//! load. With a graphics card it is only the cost on the CPU.
//!
//! The benchmark also measures the time to the first image, the cost of colours, depth and
//! segmentation together relative to colours alone, the cost of images of many simulations relative
//! to single calls, the images per second of two threads (by wall time), and the CPU time to
//! prepare a frame for up to 10,000 geoms.
//!
//! The argument `hardware` prints other tables, for graphics cards, by wall time: `single` calls
//! for colours, depth and segmentation, up to 16 `threads`, and images of `many` simulations. The
//! names of tables after it select some. `scripts/gpu-bench` makes a folder that prints them on
//! another machine.
//!
//! Further arguments select from `first`, `humanoid`, `crowd`, `hundred`, `skin`, `mirror`,
//! `grains`, `meshes`, `lights`, `small`, `batch`, `threads`, `outputs` and `prepare`. Processor
//! time comes from `/proc` (Linux).
//!
//! The argument `pictures` compares the images of all scenes with the engine's instead: those of
//! the tests, and those of `render/scenes.json`. It writes them to `target/tmp/pictures`, with all
//! of them on `sheet.png`: the engine's image, ours, and their difference scaled by eight.

#[path = "render/arm.rs"]
mod arm;
#[path = "render/batch.rs"]
mod batch;
#[path = "../tests/render/pictures/difference.rs"]
mod difference;
#[path = "render/drawing.rs"]
mod drawing;
#[path = "render/engine.rs"]
mod engine;
#[path = "render/hardware.rs"]
mod hardware;
#[path = "render/more_scenes.rs"]
mod more_scenes;
#[path = "render/pictures.rs"]
mod pictures;
#[path = "../tests/render/pictures/scenes.rs"]
mod scenes;

use std::env;
use std::error::Error;
use std::fs;
use std::process::Command;
use std::time::Instant;

use mujoco_safe::render::{Gpu, Images, Lighting, Renderer, RendererOptions};
use mujoco_safe::scene::{Camera, Categories, NewGeom, SceneOptions};
use mujoco_safe::{Data, Scene, sample};

use crate::drawing::{Drawing, rate_of_threads};
use crate::engine::Engine;
use crate::scenes::Setting;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const SIZES: [[usize; 2]; 2] = [[640, 480], [1280, 720]];
/// Pairs of turns per setting.
const ROUNDS: usize = 9;
/// Approximate processor time of a turn, s.
const TURN: f64 = 1.0;
/// Further groups of the comparison with the engine, and their scenes.
const CASES: [(&str, &str); 5] = [
    ("skin", "skin_1"),
    ("mirror", "rooms_mirror"),
    ("grains", "grains_1"),
    ("meshes", "arm_1"),
    ("lights", "lights_front"),
];

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == FIRST_FRAME) {
        return first_frame_of_this_process();
    }
    // `cargo test --benches` runs each benchmark once, as a smoke test.
    let rounds = if arguments.iter().any(|argument| argument == "--bench") { ROUNDS } else { 1 };
    let names: Vec<&String> = arguments.iter().filter(|argument| !argument.starts_with('-')).collect();
    let wanted = |name: &str| names.is_empty() || names.iter().any(|wanted| *wanted == name);

    let mut engine = Engine::start()?;
    if names.iter().any(|name| *name == "hardware") {
        return hardware::print_tables(engine.as_mut(), rounds, |table| {
            names.len() == 1 || names.iter().any(|name| *name == table)
        });
    }
    if wanted("first") {
        first_frame(rounds)?;
    }
    for name in ["humanoid", "crowd", "hundred"] {
        let lightings: &[Lighting] =
            if name == "humanoid" { &[Lighting::PerVertex, Lighting::PerPixel] } else { &[Lighting::PerVertex] };
        for size in SIZES.into_iter().filter(|_| wanted(name)) {
            for &lighting in lightings {
                let options = RendererOptions::default().with_lighting(lighting);
                let title = format!("{name} {}×{} {lighting:?}", size[0], size[1]);
                compare(&title, scenes::named(name), size, options, rounds, engine.as_mut())?;
            }
        }
    }
    let arm = arm::Arm::create()?;
    for (group, name) in CASES {
        if !wanted(group) {
            continue;
        }
        let setting = || more_scenes::named(&arm, name);
        for (label, options) in [
            ("", RendererOptions::default()),
            (", 1 sample", RendererOptions::default().with_samples(1)),
            (", no shadows", RendererOptions::default().with_shadow_size(0)),
            (", neither", RendererOptions::default().with_samples(1).with_shadow_size(0)),
        ] {
            let title = format!("{group} 640×480{label}");
            compare(&title, setting()?, SIZES[0], options, rounds, engine.as_mut())?;
        }
    }
    if wanted("small") {
        let options = RendererOptions::default();
        compare("small 84×84", scenes::named("humanoid"), [84; 2], options, rounds, engine.as_mut())?;
    }
    if wanted("batch") {
        batch::compare(rounds)?;
    }
    if wanted("threads") {
        threads(rounds)?;
    }
    if wanted("outputs") {
        for name in ["humanoid", "crowd", "hundred"] {
            for size in SIZES {
                outputs(name, size, rounds)?;
            }
        }
    }
    if wanted("prepare") {
        prepare(rounds)?;
    }
    if names.iter().any(|name| *name == "pictures") {
        pictures::compare_all(&arm, engine.as_mut().ok_or("the comparison of pictures needs MUJOCO_PYTHON")?)?;
    }
    Ok(())
}

fn compare(
    title: &str,
    setting: Setting,
    size: [usize; 2],
    options: RendererOptions,
    rounds: usize,
    engine: Option<&mut Engine>,
) -> Result<()> {
    let mut ours = Drawing::new(&Gpu::new()?, setting, size, options)?;
    let of_one = ours.turn(3)? / 3.0;
    let pictures = (TURN / of_one).ceil().clamp(2.0, 100.0) as usize;
    let Some(engine) = engine else {
        let mut times =
            (0..rounds).map(|_| Ok(ours.turn(pictures)? / pictures as f64)).collect::<Result<Vec<f64>>>()?;
        let Spread { low, median, high } = Spread::of(&mut times);
        println!("{title:40} {:.2} images per CPU second [{:.2}, {:.2}]", 1.0 / median, 1.0 / high, 1.0 / low);
        return Ok(());
    };
    engine.open(&ours.setting, &ours.data, size, &options)?;
    engine.turn(3)?;
    let (mut our_times, mut engine_times, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        let (ours, engines) = (ours.turn(pictures)?, engine.turn(pictures)?);
        our_times.push(1e3 * ours / pictures as f64);
        engine_times.push(1e3 * engines / pictures as f64);
        ratios.push(engines / ours);
    }
    let Spread { low, median, high } = Spread::of(&mut ratios);
    let (ours, engines) = (Spread::of(&mut our_times).median, Spread::of(&mut engine_times).median);
    println!("{title:40} ours {ours:6.2} ms, engine {engines:6.2} ms: {median:.2} times as fast [{low:.2}, {high:.2}]");
    Ok(())
}

/// Compares the images per second of two threads with those of one thread, with a shared adapter
/// and with one for each thread.
fn threads(rounds: usize) -> Result<()> {
    const PICTURES: usize = 100;
    let gpus = [Gpu::new()?, Gpu::new()?];
    let drawing = |gpu| Drawing::new(gpu, scenes::named("humanoid"), [84; 2], RendererOptions::default());
    let (mut first, mut second, mut other) = (drawing(&gpus[0])?, drawing(&gpus[0])?, drawing(&gpus[1])?);
    let (mut shared, mut separate) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        let alone = rate_of_threads([&mut first].into_iter(), PICTURES)?;
        shared.push(rate_of_threads([&mut first, &mut second].into_iter(), PICTURES)? / alone);
        separate.push(rate_of_threads([&mut first, &mut other].into_iter(), PICTURES)? / alone);
    }
    for (label, ratios) in [("a shared adapter", &mut shared), ("an adapter each", &mut separate)] {
        let Spread { low, median, high } = Spread::of(ratios);
        println!("two threads with {label:24} {median:.2} times the images of one [{low:.2}, {high:.2}]");
    }
    Ok(())
}

/// Compares the processor time of colours, depth and segmentation together with that of colours
/// alone.
fn outputs(name: &str, size: [usize; 2], rounds: usize) -> Result<()> {
    let mut drawing = Drawing::new(&Gpu::new()?, scenes::named(name), size, RendererOptions::default())?;
    let of_one = drawing.turn(3)? / 3.0;
    let pictures = (0.5 * TURN / of_one).ceil().clamp(2.0, 100.0) as usize;
    let mut images = Images::default();
    let mut ratios = Vec::new();
    // The first pair of turns creates the pipelines.
    for round in 0..=rounds {
        let start = processor_time()?;
        for _ in 0..pictures {
            drawing.renderer.images_into(&drawing.scene, &mut images)?;
        }
        let together = processor_time()? - start;
        let start = processor_time()?;
        for _ in 0..pictures {
            drawing.renderer.rgb_into(&drawing.scene, &mut drawing.images.rgb)?;
        }
        if round > 0 {
            ratios.push(together / (processor_time()? - start));
        }
    }
    let Spread { low, median, high } = Spread::of(&mut ratios);
    let title = format!("{name} {}×{}", size[0], size[1]);
    println!("{title:40} all images cost {median:.2} times the colours [{low:.2}, {high:.2}]");
    Ok(())
}

const FIRST_FRAME: &str = "--first-frame";

/// Measures the time from the creation of the renderer to the first pixels, each in a new process,
/// with an empty and with a filled shader cache of Mesa on disk.
fn first_frame(rounds: usize) -> Result<()> {
    let kept = tempfile::tempdir()?;
    for (label, keeps) in [("empty shader cache", false), ("filled shader cache", true)] {
        let mut times = Vec::new();
        // The first of these runs, which fills the cache, is not counted.
        for round in 0..=rounds {
            let fresh = tempfile::tempdir()?;
            let folder = if keeps { &kept } else { &fresh };
            let mut command = Command::new(env::current_exe()?);
            let output = command.arg(FIRST_FRAME).env("MESA_SHADER_CACHE_DIR", folder.path()).output()?;
            if !output.status.success() {
                return Err(String::from_utf8_lossy(&output.stderr).into());
            }
            if round > 0 {
                times.push(String::from_utf8(output.stdout)?.trim().parse()?);
            }
        }
        let Spread { low, median, high } = Spread::of(&mut times);
        println!("first image of the humanoid, {label}: {median:.3} s [{low:.3}, {high:.3}]");
    }
    Ok(())
}

fn first_frame_of_this_process() -> Result<()> {
    let setting = scenes::named("humanoid");
    let mut data = setting.after_steps();
    let scene = setting.scene(&mut data);
    let start = Instant::now();
    let mut renderer = Renderer::new(data.model(), 640, 480)?;
    let picture = renderer.rgb(&scene)?;
    let time = start.elapsed().as_secs_f64();
    assert!(picture.as_bytes().iter().any(|&byte| byte > 0), "the image is black");
    println!("{time}");
    Ok(())
}

/// Measures the CPU time from the abstract scene to the GPU buffers, without drawing. Spheres are
/// added to the humanoid.
fn prepare(rounds: usize) -> Result<()> {
    const PER_TURN: usize = 50;
    let mut data = Data::new(sample::humanoid())?;
    data.forward()?;
    let mut camera = Camera::free(data.model());
    for geoms in [0, 10, 100, 1000, 10_000] {
        let mut scene = Scene::new(data.model(), 20_000)?;
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all())?;
        for index in 0..geoms {
            let at = |place: usize| (place % 22) as f64 * 0.2 - 2.2;
            let pos = [at(index), at(index / 22), at(index / 484)];
            scene.add_geom(&NewGeom::sphere(0.05).with_pos(pos))?;
        }
        let mut renderer = Renderer::new(data.model(), 640, 480)?;
        renderer.prepare(&scene)?;
        let mut times = Vec::new();
        for _ in 0..rounds {
            let start = Instant::now();
            for _ in 0..PER_TURN {
                renderer.prepare(&scene)?;
            }
            times.push(1e3 * start.elapsed().as_secs_f64() / PER_TURN as f64);
        }
        let Spread { low, median, high } = Spread::of(&mut times);
        println!("preparing {:6} geoms: {median:.4} ms [{low:.4}, {high:.4}]", scene.ngeom());
    }
    Ok(())
}

/// Median and quartiles.
struct Spread {
    low: f64,
    median: f64,
    high: f64,
}

impl Spread {
    fn of(values: &mut [f64]) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let at = |fraction: f64| values[(fraction * (values.len() - 1) as f64).round() as usize];
        Self { low: at(0.25), median: at(0.5), high: at(0.75) }
    }
}

/// Returns the processor time of all threads, s.
fn processor_time() -> Result<f64> {
    let mut nanoseconds = 0.0;
    for thread in fs::read_dir("/proc/self/task")? {
        // A thread can end while this loop runs.
        if let Ok(text) = fs::read_to_string(thread?.path().join("schedstat")) {
            nanoseconds += text.split(' ').next().unwrap_or_default().parse::<f64>()?;
        }
    }
    Ok(1e-9 * nanoseconds)
}
