//! Scenes for comparing images and for benchmarks: models of `models/` and of the engine's package,
//! and cameras.

#![allow(dead_code, reason = "included by several programs, each of which uses some of it")]

use std::fs;
use std::path::{Path, PathBuf};

use mujoco_safe::scene::{Camera, CameraView, Categories, RenderFlags, Scene, SceneOptions, VisualFlags};
use mujoco_safe::{Data, Model, sample};
use serde_json::Value;

/// A scene of `scenes.json`.
#[derive(Clone)]
pub struct Setting {
    pub name: String,
    pub model: PathBuf,
    /// Number of steps after a reset, without control.
    pub steps: usize,
    pub lookat: [f64; 3],
    /// Metres.
    pub distance: f64,
    /// Degrees.
    pub azimuth: f64,
    /// Degrees.
    pub elevation: f64,
    /// Camera of the model, instead of the free camera above.
    pub fixed: Option<String>,
    /// Enabled visual flags beside the defaults.
    pub visual: VisualFlags,
    /// Enabled render flags beside the defaults.
    pub render: RenderFlags,
}

/// Returns the root of the repository, or of the folder that `scripts/gpu-bench` makes.
pub fn root() -> PathBuf {
    std::env::var_os("MUJOCO_SAFE_ROOT").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from)
}

/// Returns the folder of this file.
pub fn folder() -> PathBuf {
    root().join("tests/render/pictures")
}

/// Returns all scenes.
pub fn all() -> Vec<Setting> {
    read("scenes.json").as_array().expect("a list of scenes").iter().map(Setting::of).collect()
}

/// Returns the scene of this name.
pub fn named(name: &str) -> Setting {
    all().into_iter().find(|setting| setting.name == name).unwrap_or_else(|| panic!("no scene is named {name}"))
}

impl Setting {
    /// Returns a model at rest, seen from its free camera.
    pub fn of_model(path: &Path) -> mujoco_safe::Result<Self> {
        let free = Camera::free(&Model::from_xml_path(path)?);
        Ok(Self {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            model: path.to_owned(),
            steps: 0,
            lookat: free.lookat,
            distance: free.distance,
            azimuth: free.azimuth,
            elevation: free.elevation,
            fixed: None,
            visual: VisualFlags::empty(),
            render: RenderFlags::empty(),
        })
    }

    fn of(row: &Value) -> Self {
        let text = |key: &str| row[key].as_str().unwrap_or_else(|| panic!("{key} must be a string")).to_owned();
        Self {
            name: text("name"),
            model: [folder().join("models"), PathBuf::from(sample::SYSTEM_MODELS)]
                .map(|folder| folder.join(text("model")))
                .into_iter()
                .find(|path| path.exists())
                .unwrap_or_else(|| panic!("no model {}", text("model"))),
            steps: number(&row["steps"]) as usize,
            lookat: numbers(&row["lookat"]).try_into().unwrap(),
            distance: number(&row["distance"]),
            azimuth: number(&row["azimuth"]),
            elevation: number(&row["elevation"]),
            fixed: None,
            visual: row["visual"].as_array().unwrap().iter().map(flag).collect(),
            render: RenderFlags::empty(),
        }
    }

    /// Loads the model, and fills its height fields with hills.
    pub fn model(&self) -> Model {
        let mut model = Model::from_xml_path(&self.model).unwrap_or_else(|error| panic!("{}: {error}", self.name));
        for (index, elevation) in model.edit().hfield_data_mut().iter_mut().enumerate() {
            let (x, y) = ((index % 80) as f32, (index / 80) as f32);
            *elevation = 0.5 + 0.25 * (0.15 * x).sin() * (0.12 * y).cos() + 0.2 * (0.05 * x + 0.2 * y).sin();
        }
        model
    }

    /// Returns the state in which the engine's renderer has drawn the scene.
    pub fn as_drawn(&self) -> Data {
        let mut data = Data::new(self.model()).unwrap();
        let state = &read("engine/states.json")[&self.name];
        data.qpos_mut().copy_from_slice(&numbers(&state["qpos"]));
        data.qvel_mut().copy_from_slice(&numbers(&state["qvel"]));
        data.act_mut().copy_from_slice(&numbers(&state["act"]));
        data.forward().unwrap();
        data
    }

    /// Returns the state after the steps, computed by the linked engine.
    pub fn after_steps(&self) -> Data {
        let mut data = Data::new(self.model()).unwrap();
        for _ in 0..self.steps {
            data.step().unwrap();
        }
        data.forward().unwrap();
        data
    }

    /// Returns the scene of a simulation.
    pub fn scene(&self, data: &mut Data) -> Scene {
        let mut scene = Scene::new(data.model(), 20_000).unwrap();
        let mut camera = self.camera(data.model());
        scene
            .update(data, &self.options(), None, &mut camera, Categories::all())
            .unwrap_or_else(|error| panic!("{}: {error}", self.name));
        scene.set_render_flags(scene.render_flags() | self.render);
        scene
    }

    /// Returns the visual options.
    pub fn options(&self) -> SceneOptions {
        let mut options = SceneOptions::default();
        options.flags |= self.visual;
        options
    }

    /// Returns the camera.
    pub fn camera(&self, model: &Model) -> Camera {
        if let Some(name) = &self.fixed {
            return Camera::fixed(model, name.as_str()).unwrap_or_else(|error| panic!("{}: {error}", self.name));
        }
        let &Self { lookat, distance, azimuth, elevation, .. } = self;
        Camera { view: CameraView::Free, lookat, distance, azimuth, elevation }
    }
}

fn flag(name: &Value) -> VisualFlags {
    name.as_str().and_then(VisualFlags::from_name).unwrap_or_else(|| panic!("{name} must be a visual flag"))
}

fn read(name: &str) -> Value {
    let path = folder().join(name);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}
