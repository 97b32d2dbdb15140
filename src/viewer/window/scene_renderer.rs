//! Renderer of the scene of a window.

use super::scene_image::{ImageCopier, PictureArea, SceneImage};
use crate::render::{Gpu, RenderError, Renderer, RendererOptions, RgbImage};
use crate::scene::{Camera, RenderFlags};
use crate::viewer::link::{Asset, Snapshot};

/// Renderer of the current model.
#[derive(Default)]
pub(super) struct SceneRenderer {
    /// Generation of the model, and its renderer.
    renderer: Option<(u64, Renderer)>,
    copier: Option<ImageCopier>,
    /// Image of the last scene, and its content.
    drawn: Option<(SceneContent, SceneImage)>,
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
    /// Drops the GPU resources.
    pub fn drop_renderer(&mut self) {
        (self.renderer, self.copier, self.drawn) = (None, None, None);
    }

    fn renderer(
        &mut self,
        gpu: &Gpu,
        snapshot: &Snapshot,
        [width, height]: [u32; 2],
    ) -> Result<&mut Renderer, RenderError> {
        let kept = self.renderer.take().filter(|(generation, _)| *generation == snapshot.generation);
        let renderer = match kept {
            Some((_, renderer)) => renderer,
            None => Renderer::on(gpu, &snapshot.model, width, height, &RendererOptions::default())?,
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

    /// Draws a snapshot to an area of the window, seen by the camera of its last update. The scene is rendered only if it has changed:
    /// otherwise its last image is copied.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        snapshot: &Snapshot,
        camera: &Camera,
        target: &wgpu::TextureView,
        area: PictureArea,
    ) -> Result<(), RenderError> {
        let format = target.texture().format();
        let copier = match self.copier.take().filter(|copier| copier.format() == format) {
            Some(copier) => copier,
            None => ImageCopier::new(gpu, format)?,
        };
        let content = SceneContent {
            generation: snapshot.generation,
            number: snapshot.number,
            camera: *camera,
            effects: snapshot.scene.render_flags(),
        };
        let drawn = self.drawn.take().filter(|(_, image)| image.size() == area.size);
        let image = match drawn {
            Some((shown, image)) if shown == content => image,
            drawn => {
                #[cfg(feature = "test-hooks")]
                crate::viewer::test_hooks::count_scene();
                let image = drawn.map_or_else(|| copier.image(gpu, area.size), |(_, image)| Ok(image))?;
                self.renderer(gpu, snapshot, area.size)?.draw_to(&snapshot.scene, image.view(), area.size)?;
                image
            }
        };
        copier.copy(gpu, &image, target, area);
        (self.copier, self.drawn) = (Some(copier), Some((content, image)));
        Ok(())
    }

    /// Renders a snapshot without the panels to an image.
    pub fn picture(&mut self, gpu: &Gpu, snapshot: &Snapshot, size: [u32; 2]) -> Result<&RgbImage, RenderError> {
        // Reuses the memory of the last image.
        let mut picture = std::mem::take(&mut self.picture);
        let renderer = self.renderer(gpu, snapshot, size)?;
        if renderer.size() != size {
            renderer.resize(size[0], size[1])?;
        }
        let drawn = renderer.rgb_into(&snapshot.scene, &mut picture);
        self.picture = picture;
        drawn.map(|()| &self.picture)
    }
}
