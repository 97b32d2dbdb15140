//! A model, a scene of it, and a renderer.
#![forbid(unsafe_code)]

use std::sync::OnceLock;

use mujoco_safe::render::{Gpu, Renderer, RendererOptions, RgbImage};
use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
use mujoco_safe::{Data, Model};

/// Returns the adapter shared by all tests: opening an adapter takes longer than rendering with it.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::new().expect("a graphics adapter"))
}

pub struct Stage {
    pub data: Data,
    pub scene: Scene,
    pub camera: Camera,
    pub renderer: Renderer,
}

impl Stage {
    /// Creates a stage with one sample per pixel.
    pub fn new(xml: &str, size: [usize; 2]) -> Self {
        Self::with(xml, size, RendererOptions::default().with_samples(1))
    }

    pub fn with(xml: &str, [width, height]: [usize; 2], options: RendererOptions) -> Self {
        let model = Model::from_xml_str(xml).unwrap();
        let mut data = Data::new(model).unwrap();
        data.forward().unwrap();
        let scene = scene(&mut data);
        let camera = Camera::free(data.model());
        let renderer = Renderer::on(gpu(), data.model(), width, height, options).unwrap();
        Self { data, scene, camera, renderer }
    }

    /// Moves the camera to look from `distance` along x, at the height `lookat`.
    pub fn look_along_x(&mut self, lookat: [f64; 3], distance: f64) {
        self.look(lookat, distance, 0.0, 0.0);
    }

    pub fn look(&mut self, lookat: [f64; 3], distance: f64, azimuth: f64, elevation: f64) {
        self.camera = Camera { lookat, distance, azimuth, elevation, ..self.camera };
        self.update();
    }

    pub fn update(&mut self) {
        let Self { data, scene, camera, .. } = self;
        scene.update_camera(data, camera).unwrap();
        scene.update(data, &SceneOptions::default(), None, camera, Categories::all()).unwrap();
    }

    pub fn rgb(&mut self) -> RgbImage {
        self.renderer.rgb(&self.scene).unwrap()
    }
}

/// Returns the scene of a simulation from the free camera.
pub fn scene(data: &mut Data) -> Scene {
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update_camera(data, &mut camera).unwrap();
    scene.update(data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    scene
}
