//! This crate's renderer with a scene, and the time that it takes.

use std::time::Instant;

use mujoco_safe::render::{Gpu, Images, Renderer, RendererOptions};
use mujoco_safe::scene::{Camera, Categories};
use mujoco_safe::{Data, Scene};

use crate::scenes::Setting;
use crate::{Result, processor_time};

/// Renderer of one scene.
pub struct Drawing {
    pub setting: Setting,
    pub data: Data,
    pub scene: Scene,
    camera: Camera,
    pub renderer: Renderer,
    pub images: Images,
}

impl Drawing {
    pub fn new(gpu: &Gpu, setting: Setting, [width, height]: [usize; 2], options: RendererOptions) -> Result<Self> {
        let mut data = setting.after_steps();
        let scene = setting.scene(&mut data);
        let renderer = Renderer::on(gpu, data.model(), width, height, options)?;
        let camera = setting.camera(data.model());
        let mut drawing = Self { setting, data, scene, camera, renderer, images: Images::default() };
        drawing.draw("rgb")?;
        Ok(drawing)
    }

    /// Renders an image of this kind: `rgb`, `depth` or `ids`.
    fn draw(&mut self, kind: &str) -> Result<()> {
        let options = self.setting.options();
        self.scene.update(&mut self.data, &options, None, &mut self.camera, Categories::all())?;
        let Self { renderer, scene, images, .. } = self;
        match kind {
            "rgb" => renderer.rgb_into(scene, &mut images.rgb)?,
            "depth" => renderer.depth_into(scene, &mut images.depth)?,
            _ => renderer.segmentation_into(scene, &mut images.segmentation)?,
        }
        Ok(())
    }

    /// Renders several colour images and returns the processor time, s.
    pub fn turn(&mut self, images: usize) -> Result<f64> {
        let start = processor_time()?;
        for _ in 0..images {
            self.draw("rgb")?;
        }
        Ok(processor_time()? - start)
    }

    /// Renders several images of this kind and returns the wall time, s.
    pub fn wall_time(&mut self, kind: &str, images: usize) -> Result<f64> {
        let start = Instant::now();
        for _ in 0..images {
            self.draw(kind)?;
        }
        Ok(start.elapsed().as_secs_f64())
    }
}

/// Renders this number of colour images with each drawing, in a thread of its own. Returns all
/// images per second.
pub fn rate_of_threads<'d>(drawings: impl ExactSizeIterator<Item = &'d mut Drawing>, images: usize) -> Result<f64> {
    let (start, count) = (Instant::now(), drawings.len());
    std::thread::scope(|scope| {
        let threads: Vec<_> =
            drawings.map(|drawing| scope.spawn(move || drawing.wall_time("rgb", images).is_ok())).collect();
        threads.into_iter().all(|thread| thread.join().is_ok_and(|is_drawn| is_drawn))
    })
    .then(|| (count * images) as f64 / start.elapsed().as_secs_f64())
    .ok_or_else(|| "a thread failed".into())
}
