//! Comparison of the images of many scenes with the engine's.

use std::fs;
use std::path::Path;

use mujoco_safe::render::{Gpu, Renderer, RendererOptions, RgbImage};
use mujoco_safe::scene::{Categories, RenderFlags};

use crate::Result;
use crate::arm::Arm;
use crate::difference::{Difference, side_by_side};
use crate::engine::Engine;
use crate::{more_scenes, scenes};

const SIZE: [usize; 2] = [640, 480];
/// Size of small images, whose shadow maps have fewer texels.
const SMALL: [usize; 2] = [84, 84];
/// Largest share of pixels with a channel that is off by more than 8 of 255.
const OUTLIERS: f64 = 0.007;
/// Images of a scene on the sheet have a quarter of the width and height.
const REDUCTION: usize = 4;
/// Scenes in a row of the sheet.
const COLUMNS: usize = 3;

/// Compares all scenes, and returns an error if one exceeds the limit.
pub fn compare_all(arm: &Arm, engine: &mut Engine) -> Result<()> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pictures");
    fs::create_dir_all(&folder)?;
    let gpu = Gpu::new()?;
    let raw = folder.join("engine.rgb");
    let (mut sides, mut worse) = (Vec::new(), Vec::new());
    for setting in scenes::all().into_iter().chain(more_scenes::all(arm)?) {
        let mut options = RendererOptions::default().with_max_lights(8);
        if setting.render.contains(RenderFlags::WIREFRAME) {
            // The engine's renderer adds the light that casts shadows once for each of the polygons
            // that share an edge.
            options = options.with_shadow_size(0);
        }
        let mut data = setting.after_steps();
        let mut scene = setting.scene(&mut data);
        // An infinite plane follows the camera of the previous update. The engine's process has
        // updated its scene before, too.
        let mut camera = setting.camera(data.model());
        scene.update(&mut data, &setting.options(), None, &mut camera, Categories::all())?;
        let mut pair = |size: [usize; 2]| -> Result<[RgbImage; 2]> {
            let ours = Renderer::on(&gpu, data.model(), size[0], size[1], options)?.rgb(&scene)?;
            engine.open(&setting, &data, size, &options)?;
            engine.picture(&raw)?;
            let [width, height] = size;
            Ok([RgbImage::from_rgb(width, height, fs::read(&raw)?)?, ours])
        };
        let [engines, ours] = pair(SMALL)?;
        let small = 100.0 * Difference::of(&engines, &ours).outliers;
        side_by_side(&engines, &ours).save_png(folder.join(format!("{}_small.png", setting.name)))?;
        let [engines, ours] = pair(SIZE)?;
        let Difference { mean, outliers, .. } = Difference::of(&engines, &ours);
        println!(
            "{:32} mean {mean:5.2} of 255, {:5.2} % of pixels off by more than 8, of a small image {small:5.2} %",
            setting.name,
            100.0 * outliers
        );
        let both = side_by_side(&engines, &ours);
        both.save_png(folder.join(&setting.name).with_extension("png"))?;
        sides.push(reduced(&both));
        if outliers > OUTLIERS {
            worse.push(setting.name);
        }
    }
    fs::remove_file(raw)?;
    sheet(&sides).save_png(folder.join("sheet.png"))?;
    println!("{} scenes, written to {}", sides.len(), folder.display());
    if worse.is_empty() {
        Ok(())
    } else {
        Err(format!("more than 0.7 % of the pixels differ: {}", worse.join(", ")).into())
    }
}

/// Returns every fourth pixel of every fourth row.
fn reduced(image: &RgbImage) -> RgbImage {
    let mut small = RgbImage::new(image.width() / REDUCTION, image.height() / REDUCTION);
    copy(&mut small, [0; 2], |x, y| image.pixel(REDUCTION * x, REDUCTION * y), [image.width(), image.height()]);
    small
}

fn copy(to: &mut RgbImage, [left, top]: [usize; 2], from: impl Fn(usize, usize) -> [u8; 3], size: [usize; 2]) {
    let [width, height] = [size[0].min(to.width() - left), size[1].min(to.height() - top)];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        to.set_pixel(left + x, top + y, from(x, y));
    }
}

/// Arranges images of one size in a grid.
fn sheet(images: &[RgbImage]) -> RgbImage {
    let [width, height] = images.first().map_or([1; 2], |image| [image.width(), image.height()]);
    let mut sheet = RgbImage::new(COLUMNS * width, images.len().div_ceil(COLUMNS).max(1) * height);
    for (number, image) in images.iter().enumerate() {
        let at = [number % COLUMNS * width, number / COLUMNS * height];
        copy(&mut sheet, at, |x, y| image.pixel(x, y), [width, height]);
    }
    sheet
}
