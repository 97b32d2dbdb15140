//! Images of many simulations, relative to single calls.

use mujoco_safe::render::{DepthImage, Gpu, RenderError, Renderer, RendererOptions, RgbImage, SegmentationImage};
use mujoco_safe::scene::{Categories, SceneOptions};
use mujoco_safe::{Data, Scene};

use crate::scenes::{self, Setting};
use crate::{Result, Spread, processor_time};

/// Number of simulations.
const COUNT: usize = 64;
/// Steps between the states of two simulations.
const STEPS: usize = 5;

/// Compares the processor time of the images of many simulations in one call with that of one call
/// for each.
pub fn compare(rounds: usize) -> Result<()> {
    let gpu = Gpu::new()?;
    let setting = scenes::named("humanoid");
    let mut data = setting.after_steps();
    let mut simulations = Vec::new();
    for _ in 0..COUNT {
        data.step_n(STEPS)?;
        data.forward()?;
        simulations.push(data.clone());
    }
    let fast = RendererOptions::default().with_samples(1).with_shadow_size(0);
    for size in [84, 64] {
        for (label, options) in [
            ("", RendererOptions::default()),
            (", shadows of 512 texels, 1 sample", fast.with_shadow_size(512)),
            (", neither", fast),
        ] {
            let mut both = Both::new(&gpu, &setting, &mut simulations, size, options)?;
            let title = |output| format!("batch {size}×{size} {output}{label}");
            both.print(&title("colours"), rounds, Both::single_colours, Both::colours)?;
            if label.is_empty() {
                both.print(&title("depth"), rounds, Both::single_depths, Both::depths)?;
                both.print(&title("segments"), rounds, Both::single_segments, Both::segments)?;
            }
        }
    }
    Ok(())
}

/// Renderers for single calls and for calls with many simulations.
struct Both<'a> {
    simulations: &'a mut [Data],
    setting: &'a Setting,
    scene: Scene,
    single: Renderer,
    many: Renderer,
    rgb: Vec<u8>,
    metres: Vec<f32>,
    ids: Vec<u32>,
}

impl<'a> Both<'a> {
    fn new(
        gpu: &Gpu,
        setting: &'a Setting,
        simulations: &'a mut [Data],
        size: usize,
        options: RendererOptions,
    ) -> Result<Self> {
        let model = simulations[0].model();
        let renderer = || Renderer::on(gpu, model, size, size, options);
        let (single, many, scene) = (renderer()?, renderer()?, Scene::new(model, 1000)?);
        let pixels = COUNT * size * size;
        let (rgb, metres, ids) = (vec![0; 3 * pixels], vec![0.0; pixels], vec![0; pixels]);
        Ok(Self { simulations, setting, scene, single, many, rgb, metres, ids })
    }

    /// Draws each simulation by itself.
    fn each<T>(
        &mut self,
        mut draw: impl FnMut(&mut Renderer, &Scene) -> std::result::Result<T, RenderError>,
    ) -> Result<()> {
        let (options, mut camera) = (SceneOptions::default(), self.setting.camera(self.simulations[0].model()));
        for data in &mut *self.simulations {
            self.scene.update(data, &options, None, &mut camera, Categories::all())?;
            draw(&mut self.single, &self.scene)?;
        }
        Ok(())
    }

    fn single_colours(&mut self) -> Result<()> {
        let mut image = RgbImage::default();
        self.each(|renderer, scene| renderer.rgb_into(scene, &mut image))
    }

    fn single_depths(&mut self) -> Result<()> {
        let mut image = DepthImage::default();
        self.each(|renderer, scene| renderer.depth_into(scene, &mut image))
    }

    fn single_segments(&mut self) -> Result<()> {
        let mut image = SegmentationImage::default();
        self.each(|renderer, scene| renderer.segmentation_into(scene, &mut image))
    }

    /// Returns the function that updates the scene to a simulation.
    fn update<'s>(
        simulations: &'s mut [Data],
        setting: &Setting,
    ) -> impl FnMut(usize, &mut Scene) -> mujoco_safe::Result<()> + 's {
        let (options, mut camera) = (SceneOptions::default(), setting.camera(simulations[0].model()));
        move |index, scene| scene.update(&mut simulations[index], &options, None, &mut camera, Categories::all())
    }

    fn colours(&mut self) -> Result<()> {
        Ok(self.many.rgb_batch_into(Self::update(self.simulations, self.setting), &mut self.rgb)?)
    }

    fn depths(&mut self) -> Result<()> {
        Ok(self.many.depth_batch_into(Self::update(self.simulations, self.setting), &mut self.metres)?)
    }

    fn segments(&mut self) -> Result<()> {
        Ok(self.many.segmentation_batch_into(Self::update(self.simulations, self.setting), &mut self.ids)?)
    }

    fn print(
        &mut self,
        title: &str,
        rounds: usize,
        single: fn(&mut Self) -> Result<()>,
        many: fn(&mut Self) -> Result<()>,
    ) -> Result<()> {
        let (mut ratios, mut times) = (Vec::new(), Vec::new());
        // The first pair of turns creates the pipelines.
        for round in 0..=rounds {
            let start = processor_time()?;
            single(self)?;
            let between = processor_time()?;
            many(self)?;
            let of_many = processor_time()? - between;
            if round > 0 {
                ratios.push((between - start) / of_many);
                times.push(1e3 * of_many / COUNT as f64);
            }
        }
        let (time, Spread { low, median, high }) = (Spread::of(&mut times).median, Spread::of(&mut ratios));
        println!("{title:40} {time:5.2} ms per image: {median:.2} times as fast as single calls [{low:.2}, {high:.2}]");
        Ok(())
    }
}
