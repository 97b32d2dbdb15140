//! Images against those of the engine's own renderer.
//!
//! `engine/` has the engine's images (see `make.py`). With the default options of the renderer:
//!
//! - the mean of the absolute differences over all channels and pixels is at most 1.5 of 255;
//! - at most 0.7 % of the pixels have a channel with a difference above 8 of 255.
//!
//! With lighting per pixel the limit is 2.5 %, and 6 % in the scenes of `spots.xml`: the edge of a
//! spot light is sharp then, while the engine interpolates it over a cell of its floor.
//!
//! [`mujoco_safe::render`] explains the remaining differences. For a scene that differs, and for
//! every scene if the environment variable `MUJOCO_SAFE_PICTURES` is set, the test saves the
//! engine's image, ours, and their difference scaled by eight, side by side, in the folder
//! `pictures` of cargo's folder for tests (`target/tmp/pictures`).

#![forbid(unsafe_code)]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use mujoco_safe::render::{Lighting, Renderer, RendererOptions, RgbImage};
use mujoco_safe::{Data, Scene};

use crate::cases::cases;
use crate::difference::{Difference, side_by_side};
use crate::scenes::{self, Setting};
use crate::stage;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Largest mean difference, of 255.
const MEAN: f64 = 1.5;
/// Lighting modes, with the ending of the names of their images.
const MODES: [(&str, Lighting); 2] = [("", Lighting::PerVertex), ("_per_pixel", Lighting::PerPixel)];

/// Returns the largest share of outliers.
fn largest_share(name: &str, lighting: Lighting) -> f64 {
    match lighting {
        Lighting::PerPixel if name.starts_with("spots") => 0.06,
        Lighting::PerPixel => 0.025,
        _ => 0.007,
    }
}

fn is_small(difference: &Difference, outliers: f64) -> bool {
    difference.mean <= MEAN && difference.outliers <= outliers
}

/// Returns the folder for the saved images.
fn out() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pictures");
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn engines(setting: &Setting) -> RgbImage {
    let path = scenes::folder().join("engine").join(format!("{}.png", setting.name));
    let mut reader = png::Decoder::new(BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    RgbImage::from_rgb(info.width as usize, info.height as usize, rgb).unwrap()
}

fn ours(data: &Data, scene: &Scene, options: RendererOptions) -> RgbImage {
    let mut renderer = Renderer::on(stage::gpu(), data.model(), WIDTH, HEIGHT, options).unwrap();
    renderer.rgb(scene).unwrap()
}

fn compare(name: &str) {
    let setting = scenes::named(name);
    let engine = engines(&setting);
    let mut data = setting.as_drawn();
    let scene = setting.scene(&mut data);
    let is_saved = std::env::var_os("MUJOCO_SAFE_PICTURES").is_some();
    assert_eq!(MODES[0].1, RendererOptions::default().lighting);
    // Lighting per pixel changes the scenes with spot lights most.
    let modes = if name.starts_with("spots") { 2 } else { cases(1, 2) };
    let compare = |&(label, lighting): &(&str, Lighting)| {
        let ours = ours(&data, &scene, RendererOptions::default().with_lighting(lighting));
        let difference = Difference::of(&engine, &ours);
        let is_small = is_small(&difference, largest_share(name, lighting));
        if is_saved || !is_small {
            side_by_side(&engine, &ours).save_png(out().join(format!("{name}{label}.png"))).unwrap();
        }
        (difference, is_small)
    };
    let differences: Vec<_> = MODES[..modes].iter().map(compare).collect();
    println!("{name}: {differences:.4?}");
    assert!(differences.iter().all(|(_, is_small)| *is_small), "{name}: {differences:.4?}");
}

/// Generates one test per scene.
macro_rules! compare {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            compare(stringify!($name));
        })*

        #[test]
        fn every_image_of_the_engine_is_compared() {
            let mut pictures: Vec<String> = fs::read_dir(scenes::folder().join("engine"))
                .unwrap()
                .filter_map(|entry| entry.unwrap().file_name().to_str()?.strip_suffix(".png").map(str::to_owned))
                .collect();
            pictures.sort();
            assert_eq!(pictures, [$(stringify!($name)),*]);
        }
    };
}

compare! {
    adhesion
    arm
    cloth
    hammock
    humanoid
    humanoid_decor
    humanoid_fallen
    humanoid_horizon
    humanoid_seethru
    mug
    slider_crank
    softbox
    spots
    spots_above
    spots_low
}

#[test]
fn a_difference_is_detected() {
    let grey = RgbImage::from_rgb(10, 10, vec![100; 300]).unwrap();
    let mut other = grey.clone();
    other.set_pixel(3, 4, [100, 109, 97]);
    other.set_pixel(5, 6, [108, 100, 100]);
    let difference = Difference::of(&grey, &other);
    assert_eq!(difference.outliers, 0.01);
    assert!((difference.mean - 20.0 / 300.0).abs() < 1e-12 && (difference.mean_largest - 0.17).abs() < 1e-12);
}
