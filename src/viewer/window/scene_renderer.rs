//! Renderer of the scene of a window.

use crate::render::{Gpu, RenderError, Renderer, RendererOptions, RgbImage, create_texture};
use crate::scene::{Camera, RenderFlags};
use crate::viewer::link::{Asset, Snapshot};

/// Renderer of the current model.
pub(super) struct SceneRenderer {
    /// Generation of the model, and its renderer.
    renderer: Option<(u64, Renderer)>,
    options: RendererOptions,
    /// Image of the last scene, and its content.
    drawn: Option<(SceneContent, wgpu::Texture)>,
    picture: RgbImage,
}

/// Values that determine the image of a scene of a certain size.
#[derive(PartialEq)]
struct SceneContent {
    generation: u64,
    /// Sequence number of the snapshot.
    number: u64,
    camera: Camera,
    effects: RenderFlags,
}

impl SceneRenderer {
    pub fn new(options: RendererOptions) -> Self {
        Self { renderer: None, options, drawn: None, picture: RgbImage::default() }
    }

    /// Sets the size of the labels, as in [`RendererOptions`].
    pub fn set_font_scale(&mut self, scale: f64) {
        if scale != self.options.font_scale {
            (self.options.font_scale, self.drawn) = (scale, None);
            if let Some((_, renderer)) = &mut self.renderer {
                renderer.set_font_scale(scale);
            }
        }
    }

    /// Drops the GPU resources.
    pub fn drop_renderer(&mut self) {
        (self.renderer, self.drawn) = (None, None);
    }

    fn renderer(&mut self, gpu: &Gpu, snapshot: &Snapshot, size: [u32; 2]) -> Result<&mut Renderer, RenderError> {
        let [width, height] = size.map(|length| length as usize);
        let kept = self.renderer.take().filter(|(generation, _)| *generation == snapshot.generation);
        let renderer = match kept {
            Some((_, renderer)) => renderer,
            None => Renderer::on(gpu, &snapshot.model, width, height, self.options)?,
        };
        Ok(&mut self.renderer.insert((snapshot.generation, renderer)).1)
    }

    /// Uploads a modified asset. A renderer that is created later contains it anyway.
    pub fn update(&mut self, snapshot: &Snapshot, asset: Asset) -> Result<(), RenderError> {
        self.drawn = None;
        let Some((generation, renderer)) = &mut self.renderer else { return Ok(()) };
        if *generation != snapshot.generation {
            return Ok(());
        }
        match asset {
            Asset::Texture(id) => renderer.update_texture(&snapshot.model, id),
            Asset::Mesh(id) => renderer.update_mesh(&snapshot.model, id),
            Asset::HeightField(id) => renderer.update_height_field(&snapshot.model, id),
        }
    }

    /// Renders a snapshot, seen by the camera of its last update, to an image of a window's format.
    /// Returns `false` if the scene has not changed since the last call, so that its image is the
    /// same.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        snapshot: &Snapshot,
        camera: &Camera,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Result<bool, RenderError> {
        let content = SceneContent {
            generation: snapshot.generation,
            number: snapshot.number,
            camera: *camera,
            effects: snapshot.scene.render_flags(),
        };
        let fits = |image: &wgpu::Texture| [image.width(), image.height()] == size && image.format() == format;
        let drawn = self.drawn.take().filter(|(_, image)| fits(image));
        if let Some((shown, _)) = &drawn
            && *shown == content
        {
            self.drawn = drawn;
            return Ok(false);
        }
        #[cfg(feature = "_test-hooks")]
        crate::viewer::test_hooks::count_scene();
        let image = match drawn {
            Some((_, image)) => image,
            None => gpu.guarded(|| {
                let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
                Ok(create_texture(gpu, "scene", size, format, 1, usage))
            })?,
        };
        let view = image.create_view(&wgpu::TextureViewDescriptor::default());
        self.renderer(gpu, snapshot, size)?.draw_to(&snapshot.scene, &view, size)?;
        self.drawn = Some((content, image));
        Ok(true)
    }

    /// Returns the image of the last scene.
    pub fn image(&self) -> Option<&wgpu::Texture> {
        self.drawn.as_ref().map(|(_, image)| image)
    }

    /// Renders a snapshot without the panels to an image.
    pub fn picture(&mut self, gpu: &Gpu, snapshot: &Snapshot, size: [u32; 2]) -> Result<&RgbImage, RenderError> {
        // Reuses the memory of the last image.
        let mut picture = std::mem::take(&mut self.picture);
        let renderer = self.renderer(gpu, snapshot, size)?;
        let [width, height] = size.map(|length| length as usize);
        if renderer.size() != [width, height] {
            renderer.resize(width, height)?;
        }
        let drawn = renderer.rgb_into(&snapshot.scene, &mut picture);
        self.picture = picture;
        drawn.map(|()| &self.picture)
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;
    use crate::render::ReadBackBuffer;
    use crate::viewer::tests::Bench;
    use crate::{Data, Model};

    const SIZE: [u32; 2] = [160, 120];

    /// Returns the bytes of the image that a window shows, without the opacity.
    fn shown(gpu: &Gpu, renderer: &mut SceneRenderer, snapshot: &Snapshot) -> Vec<u8> {
        let format = wgpu::TextureFormat::Rgba8Unorm;
        assert!(renderer.draw(gpu, snapshot, &snapshot.camera, format, SIZE).unwrap());
        let buffer = ReadBackBuffer::new(gpu, SIZE, 4).unwrap();
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        buffer.encode(&mut encoder, renderer.image().unwrap());
        let submission = gpu.submit(encoder);
        let mut rows = Vec::new();
        buffer
            .rows(gpu, submission, |row| {
                rows.push(row.as_chunks::<4>().0.iter().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect());
            })
            .unwrap();
        // The rows of a window are stored from the top, those of a screenshot from the bottom.
        rows.reverse();
        let rows: Vec<Vec<u8>> = rows;
        rows.concat()
    }

    #[test]
    fn window_shows_the_image_of_a_screenshot_with_any_number_of_lights() {
        let gpu = Gpu::new().unwrap();
        for lights in [1, 6, 9] {
            let mut text = String::from("<mujoco><worldbody><geom type='plane' size='3 3 .1'/>");
            for light in 0..lights {
                let x = light - 4;
                write!(text, "<light pos='{x} 1 3' dir='{} -.3 -1' diffuse='.2 .1 .1'/>", -0.2 * f64::from(x)).unwrap();
            }
            text.push_str(
                "<body pos='0 0 .6'><freejoint/><geom type='box' size='.2 .3 .4'/></body></worldbody></mujoco>",
            );
            let mut bench = Bench::new(Data::new(Model::from_xml_str(&text).unwrap()).unwrap());
            let snapshot = bench.snapshot();
            let mut renderer = SceneRenderer::new(RendererOptions::default());
            let window = shown(&gpu, &mut renderer, snapshot);
            let picture = renderer.picture(&gpu, snapshot, SIZE).unwrap().as_bytes();
            let differ = window.iter().zip(picture).filter(|(one, other)| one.abs_diff(**other) > 8).count();
            // The samples of edges are elsewhere in an image that is drawn upside down.
            assert!(differ * 50 < window.len(), "{lights} lights: {differ} of {} bytes differ", window.len());
        }
    }
}
