//! Images of everything that the linked engine shows, against those of its own renderer.
//!
//! The script `pictures/linked.py` draws the scenes with the official bindings of the same version.
//! A scene passes if in its colour, its depth and its segmentation image at most 0.7 % of the
//! pixels differ: a channel by more than 8 of 255, a depth by more than 0.1 %, an id at all.
//! [`WIDER`] lists the exceptions with their reasons.

#![forbid(unsafe_code)]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Command;

use mujoco_safe::render::{GpuKind, Renderer, RendererOptions, RgbImage};
use mujoco_safe::{Data, Scene};
use serde_json::Value;

use crate::cases::cases;
use crate::difference::{Difference, side_by_side};
use crate::row::{drawn, size_of, text_of};
use crate::scenes;
use crate::stage;

/// Largest share of the pixels that differ.
const LIMIT: f64 = 0.007;
/// Largest relative difference of depths. The engine draws those of round shapes with 200 slices.
const DEPTH: f32 = 0.001;

/// Scenes with a wider limit: the start of their names, their limit, and the reason.
const WIDER: [(&str, f64, &str); 7] = [
    ("label", 0.05, "another font"),
    ("camera_ortho_decor", 0.03, "labels have another font"),
    ("islands_contacts", 0.025, "labels have another font"),
    ("visual_frustum_inside", 0.035, "lines lie exactly on the near plane; visual_frustum_behind is equal"),
    ("rangefinder_camera", 0.03, "2,357 spheres of a few pixels have fewer vertices; rangefinder_coarse is equal"),
    ("render_wireframe", 0.09, "the engine adds a mirror once per polygon; render_matt_wireframe is equal"),
    // The engine draws a shadow map inside a border of one texel, and looks it up without. A floor
    // oblique to both axes of the map thus shadows itself near the edges. A floor that hides what
    // is behind it is not in the map, and the border of a reduced map is a fraction of a texel.
    ("lamp_coloured_shadows", 0.03, "the floor is not in the maps; lamp_shadows_unreduced is equal"),
];

/// Results of a scene: shares of the pixels that differ, in colour, depth and segmentation.
type Shares = [f64; 3];

#[test]
#[ignore = "long; needs the official bindings: MUJOCO_PYTHON"]
fn pictures_equal_those_of_the_bindings() {
    let folder = folder();
    let text = fs::read_to_string(folder.join("scenes.json")).unwrap();
    let listed: Value = serde_json::from_str(&text).unwrap();
    let version = mujoco_safe::engine_version().to_string();
    assert_eq!(listed["version"], Value::from(version.as_str()), "the bindings are those of the linked engine");
    let part = std::env::var("MUJOCO_SAFE_SCENE").unwrap_or_default();
    let rows = listed["scenes"].as_array().unwrap().iter().filter(|row| text_of(row, "name").contains(&part));
    let mut wrong = Vec::new();
    let (mut scenes, mut exceptions) = (0, 0);
    for row in rows {
        let name = text_of(row, "name");
        let shares = compare(&folder, row);
        let wider = WIDER.iter().find(|(start, ..)| name.starts_with(start));
        let limit = wider.map_or(LIMIT, |(_, limit, _)| *limit);
        let percent = shares.map(|share| format!("{:6.2}", 100.0 * share));
        println!("{name:40} {}{}", percent.join(" "), wider.map_or(String::new(), |(.., why)| format!("  {why}")));
        scenes += 1;
        exceptions += usize::from(wider.is_some());
        if shares.iter().any(|&share| share > limit) {
            wrong.push(format!("{name}: {}", percent.join(" ")));
        }
    }
    println!("{scenes} scenes with MuJoCo {version}, {exceptions} with a wider limit, {} differ", wrong.len());
    assert!(scenes >= 150 || !part.is_empty());
    assert!(wrong.is_empty(), "colour, depth and ids differ, % of the pixels:\n{}", wrong.join("\n"));
}

/// Returns the folder with the images of the bindings, and draws them unless `MUJOCO_SAFE_PICTURES`
/// names a folder that has them.
fn folder() -> PathBuf {
    if let Some(folder) = std::env::var_os("MUJOCO_SAFE_PICTURES") {
        return folder.into();
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("linked");
    let python = std::env::var_os("MUJOCO_PYTHON").expect("MUJOCO_PYTHON names a Python with the official bindings");
    let script = scenes::folder().join("linked.py");
    assert!(Command::new(python).arg(script).arg(&folder).status().unwrap().success());
    folder
}

/// Compares the images of a scene, and saves those that differ side by side.
fn compare(folder: &Path, row: &Value) -> Shares {
    let name = text_of(row, "name");
    let read = |ending: &str| fs::read(folder.join(format!("{name}.{ending}"))).unwrap();
    let [width, height] = size_of(row);
    let (data, scene) = drawn(folder, row);
    assert_eq!(scene.ngeom() as u64, row["geoms"].as_u64().unwrap(), "{name}: geoms");
    let options = RendererOptions::default().with_max_lights(8);
    let mut renderer = Renderer::on(stage::gpu(), data.model(), width, height, options).unwrap();
    let theirs = RgbImage::from_rgb(width, height, read("rgb")).unwrap();
    let ours = renderer.rgb(&scene).unwrap();
    let colours = Difference::of(&theirs, &ours).outliers;
    let pixels = (width * height) as f64;
    let depth = renderer.depth(&scene).unwrap();
    let bytes = read("depth");
    let depths: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|&bytes| f32::from_ne_bytes(bytes)).collect();
    let is_wrong =
        |(a, b): (&f32, &f32)| if a.is_finite() && b.is_finite() { (a - b).abs() > DEPTH * b } else { a != b };
    let far = depths.iter().zip(depth.as_slice()).filter(|&pair| is_wrong(pair)).count() as f64 / pixels;
    let ids = renderer.segmentation(&scene).unwrap();
    let expected = read("ids");
    let expected = expected.as_chunks::<4>().0.iter().map(|&bytes| i32::from_ne_bytes(bytes));
    let wrong = ids.as_slice().iter().zip(expected).filter(|&(&ours, theirs)| i64::from(ours) - 1 != i64::from(theirs));
    // As the second image of a batch, it is the same.
    let (second, _) = drawn_second(&data, scene, [width, height]);
    let colours = colours.max(Difference::of(&second, &ours).outliers);
    let shares = [colours, far, wrong.count() as f64 / pixels];
    if shares.iter().any(|&share| share > LIMIT) || std::env::var_os("MUJOCO_SAFE_SHEETS").is_some() {
        save_sheet(name, &theirs, &ours);
    }
    shares
}

/// Largest share of the pixels that differ from a recorded image, which has a quarter of the pixels
/// and thus more at edges.
const RECORDED_LIMIT: f64 = 0.012;

/// The same for hardware. The recorded images are of a software rasteriser, which filters textures
/// with more bits and has other positions of samples.
const RECORDED_LIMIT_OF_HARDWARE: f64 = 0.016;

#[test]
fn recorded_pictures_are_drawn() {
    let version = mujoco_safe::engine_version().to_string();
    let folder = scenes::folder().join("recorded").join(&version);
    let Ok(text) = fs::read_to_string(folder.join("scenes.json")) else { return };
    let rows: Vec<Value> = serde_json::from_str(&text).unwrap();
    assert!(rows.len() >= 16, "{} images of MuJoCo {version}", rows.len());
    let is_software = stage::gpu().kind() == GpuKind::Software;
    let limit = if is_software { RECORDED_LIMIT } else { RECORDED_LIMIT_OF_HARDWARE };
    let (mut wrong, mut together) = (Vec::new(), 0);
    let rows: Vec<&Value> = rows.iter().step_by(cases(2, 1)).collect();
    for row in &rows {
        let name = text_of(row, "name");
        // An image that equals that of 4.0.1 is not stored twice.
        let file = format!("{name}.png");
        let own = folder.join(&file);
        let theirs = read_png(&if own.exists() { own } else { folder.join("../4.0.1").join(file) });
        let (data, scene) = drawn(&folder, row);
        assert_eq!(scene.ngeom() as u64, row["geoms"].as_u64().unwrap(), "{name}: geoms");
        let [width, height] = [theirs.width(), theirs.height()];
        let draw = |lights| {
            let options = RendererOptions::default().with_max_lights(lights);
            Renderer::on(stage::gpu(), data.model(), width, height, options).unwrap().rgb(&scene).unwrap()
        };
        let ours = draw(8);
        let share = Difference::of(&theirs, &ours).outliers;
        // The headlight and seven lamps: the last one is seen.
        assert!(name != "light_shadows_7" || Difference::of(&theirs, &draw(7)).outliers > limit);
        let (second, is_together) = drawn_second(&data, scene, [width, height]);
        let apart = Difference::of(&second, &ours).outliers;
        assert!(apart <= limit, "{name} as the second image of a batch: {apart}");
        together += usize::from(is_together);
        println!("{name}: {:.2} %", 100.0 * share);
        if share > limit {
            save_sheet(name, &theirs, &ours);
            wrong.push(format!("{name}: {:.2} %", 100.0 * share));
        }
    }
    assert!(wrong.is_empty(), "pixels differ from the images of MuJoCo {version}: {wrong:?}");
    assert!(!is_software || 2 * together > rows.len(), "{together} of {} scenes were drawn together", rows.len());
}

/// Draws a scene as the second image of a batch, whose first image shows it with other colours.
/// Returns the image, and if both were drawn together.
fn drawn_second(data: &Data, mut scene: Scene, [width, height]: [usize; 2]) -> (RgbImage, bool) {
    let options = RendererOptions::default().with_max_lights(8);
    let mut renderer = Renderer::on(stage::gpu(), data.model(), width, height, options).unwrap();
    renderer.set_merging(true);
    let mut rgb = vec![0; 2 * 3 * width * height];
    let colours: Vec<[f32; 4]> = scene.geoms().map(|geom| geom.rgba()).collect();
    let update = |index: usize, shown: &mut Scene| {
        // The scene of the first image remains.
        if index == 0 {
            std::mem::swap(shown, &mut scene);
        }
        for (mut geom, [red, green, blue, alpha]) in shown.geoms_mut().zip(colours.iter().copied()) {
            geom.set_rgba(if index == 0 { [blue, 1.0 - red, 1.0 - green, alpha] } else { [red, green, blue, alpha] });
        }
        Ok(())
    };
    renderer.rgb_batch_into(update, &mut rgb).unwrap();
    let second = rgb.split_off(rgb.len() / 2);
    (RgbImage::from_rgb(width, height, second).unwrap(), renderer.images_drawn_together() == 2)
}

fn read_png(file: &Path) -> RgbImage {
    let mut reader = png::Decoder::new(BufReader::new(File::open(file).unwrap())).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    RgbImage::from_rgb(info.width as usize, info.height as usize, rgb).unwrap()
}

fn save_sheet(name: &str, theirs: &RgbImage, ours: &RgbImage) {
    let sheets = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sheets");
    fs::create_dir_all(&sheets).unwrap();
    side_by_side(theirs, ours).save_png(sheets.join(format!("{name}.png"))).unwrap();
}
