//! Tables for graphics cards, by wall time: images per second in single calls against the engine's
//! renderer, with several threads, and of many simulations.

use std::env;
use std::path::Path;
use std::time::Instant;

use mujoco_safe::render::{Gpu, Renderer, RendererOptions, RgbImage};
use mujoco_safe::scene::{Camera, Categories, SceneOptions};
use mujoco_safe::{Data, Model, Scene, StateSpec, sample};

use crate::arm::Arm;
use crate::drawing::{Drawing, rate_of_threads};
use crate::engine::Engine;
use crate::scenes::{self, Setting};
use crate::{Result, Spread, processor_time};

const SIZES: [[usize; 2]; 3] = [[84, 84], [256, 256], [640, 480]];
/// Wall time of a turn, s.
const TURN: f64 = 0.1;
/// Number of simulations of a batch.
const SIMULATIONS: usize = 1024;

/// Prints all tables. A model whose path is in `MUJOCO_SAFE_MODEL` is drawn too.
pub fn print_tables(mut engine: Option<&mut Engine>, rounds: usize, is_wanted: impl Fn(&str) -> bool) -> Result<()> {
    let gpu = Gpu::new()?;
    println!("{gpu:?}, MuJoCo {}", mujoco_safe::engine_version());
    println!("images per second; ratios to the engine's renderer: median [quartiles]");
    if is_wanted("single") {
        let arm = Arm::create()?;
        let mut settings =
            vec![scenes::named("humanoid"), scenes::named("crowd"), Setting::of_model(&arm.folder().join("arm.xml"))?];
        if let Some(path) = env::var_os("MUJOCO_SAFE_MODEL") {
            settings.push(Setting::of_model(Path::new(&path))?);
        }
        for setting in settings {
            for size in SIZES {
                single_calls(&gpu, &setting, size, engine.as_deref_mut(), rounds)?;
            }
        }
    }
    let options = RendererOptions::default();
    for (label, options) in [("", options), (", 1 sample, no shadows", options.with_samples(1).with_shadow_size(0))] {
        if is_wanted("threads") {
            threads(&gpu, label, options, rounds)?;
        }
        if is_wanted("many") {
            for (name, model, size) in [("humanoid", sample::humanoid(), 84), ("cart-pole", sample::cartpole(), 64)] {
                many(&gpu, (name, label), model, size, options, rounds)?;
            }
        }
    }
    Ok(())
}

fn single_calls(
    gpu: &Gpu,
    setting: &Setting,
    size: [usize; 2],
    mut engine: Option<&mut Engine>,
    rounds: usize,
) -> Result<()> {
    let options = RendererOptions::default();
    let mut ours = Drawing::new(gpu, setting.clone(), size, options)?;
    if let Some(engine) = &mut engine {
        engine.open(setting, &ours.data, size, &options)?;
    }
    for kind in ["rgb", "depth", "ids"] {
        ours.wall_time(kind, 10)?;
        let images = (10.0 * TURN / ours.wall_time(kind, 10)?).ceil() as usize;
        let (mut rates, mut theirs, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..rounds {
            let time = ours.wall_time(kind, images)?;
            rates.push(images as f64 / time);
            if let Some(engine) = &mut engine {
                let of_engine = engine.wall_time(kind, images)?;
                theirs.push(images as f64 / of_engine);
                ratios.push(of_engine / time);
            }
        }
        let rate = Spread::of(&mut rates).median;
        let title = format!("{} {}×{} {kind}", setting.name, size[0], size[1]);
        if ratios.is_empty() {
            println!("{title:32} {rate:8.0}");
        } else {
            let (other, Spread { low, median, high }) = (Spread::of(&mut theirs).median, Spread::of(&mut ratios));
            println!("{title:32} {rate:8.0}, engine {other:8.0}: {median:.2} [{low:.2}, {high:.2}]");
        }
    }
    Ok(())
}

/// Prints the images per second of threads that share the adapter.
fn threads(gpu: &Gpu, label: &str, options: RendererOptions, rounds: usize) -> Result<()> {
    const IMAGES: usize = 200;
    let cores = std::thread::available_parallelism()?.get();
    let mut alone = 0.0;
    for count in [1, 2, 4, 8, 16].into_iter().filter(|&count| count <= cores) {
        let mut drawings = (0..count)
            .map(|_| Drawing::new(gpu, scenes::named("humanoid"), SIZES[0], options))
            .collect::<Result<Vec<Drawing>>>()?;
        rate_of_threads(drawings.iter_mut(), IMAGES)?;
        let mut rates =
            (0..rounds).map(|_| rate_of_threads(drawings.iter_mut(), IMAGES)).collect::<Result<Vec<f64>>>()?;
        let rate = Spread::of(&mut rates).median;
        if count == 1 {
            alone = rate;
        }
        println!("humanoid 84×84{label}, {count:2} threads: {rate:.0}, {:.2} of one thread", rate / alone);
    }
    Ok(())
}

/// Prints the images per second, and the processor time, of images of many simulations in one call.
fn many(
    gpu: &Gpu,
    (name, label): (&str, &str),
    model: Model,
    size: usize,
    options: RendererOptions,
    rounds: usize,
) -> Result<()> {
    let mut data = Data::new(model)?;
    let mut states = Vec::new();
    for _ in 0..64 {
        states.push(data.state(StateSpec::PHYSICS));
        data.step_n(5)?;
    }
    let mut renderer = Renderer::on(gpu, data.model(), size, size, options)?;
    let (view, mut camera) = (SceneOptions::default(), Camera::free(data.model()));
    let mut rgb = vec![0; SIMULATIONS * 3 * size * size];
    let (mut scene, mut image) = (Scene::new(data.model(), 1000)?, RgbImage::default());
    let mut update = |index: usize, scene: &mut Scene| {
        data.set_state(StateSpec::PHYSICS, &states[index % states.len()])?;
        data.kinematics()?;
        data.com_pos()?;
        data.camlight()?;
        scene.update(&mut data, &view, None, &mut camera, Categories::all())
    };
    let (mut rates, mut costs, mut ratios, mut apart) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    // The system counts processor time in hundredths of a second.
    let (before, updates) = (processor_time()?, 16 * SIMULATIONS);
    for index in 0..updates {
        update(index, &mut scene)?;
    }
    let of_scenes = 1e6 * (processor_time()? - before) / updates as f64;
    // The first round creates the pipelines.
    for round in 0..=rounds {
        let (start, before) = (Instant::now(), processor_time()?);
        renderer.rgb_batch_into(&mut update, &mut rgb)?;
        let (time, cost) = (start.elapsed().as_secs_f64(), processor_time()? - before);
        renderer.set_merging(false);
        let start = Instant::now();
        renderer.rgb_batch_into(&mut update, &mut rgb)?;
        let time_apart = start.elapsed().as_secs_f64();
        renderer.set_merging(true);
        let start = Instant::now();
        for index in 0..SIMULATIONS {
            update(index, &mut scene)?;
            renderer.rgb_into(&scene, &mut image)?;
        }
        if round > 0 {
            rates.push(SIMULATIONS as f64 / time);
            apart.push(SIMULATIONS as f64 / time_apart);
            costs.push(1e6 * cost / SIMULATIONS as f64);
            ratios.push(start.elapsed().as_secs_f64() / time);
        }
    }
    let medians = [&mut rates, &mut apart, &mut costs, &mut ratios].map(|values| Spread::of(values).median);
    let [rate, apart, cost, ratio] = medians;
    let title = format!("{SIMULATIONS} × {name} {size}×{size}{label}");
    println!(
        "{title}: {rate:.0} together, {apart:.0} one by one, {ratio:.2} of single calls, {cost:.1} µs of processor time per image, of which states and \
         scenes {of_scenes:.1}"
    );
    Ok(())
}
