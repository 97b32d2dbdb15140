//! From a scene to commands of the graphics card, and from its memory to rows of pixels.

use super::Renderer;
use crate::error::Error;
use crate::render::frame::{Eye, Lights, View};
use crate::render::list::{Numbers, Scenery};
use crate::render::pass::{COLOR, Canvas, Draw, Frame, Ids, Target, check_size, numbers, texture, view};
use crate::render::read_back::ReadBack;
use crate::render::shader::Shade;
use crate::render::{Lighting, RenderError};
use crate::scene::{RenderFlags, Scene};

impl Renderer {
    /// Draws colours and shows the rows of the picture.
    pub(super) fn colors(&mut self, scene: &Scene, each: impl FnMut(&[u8])) -> Result<(), RenderError> {
        let gpu = self.gpu.clone();
        gpu.guarded(|| {
            let (texture, view) = self.color();
            let mut encoder = self.encode(scene, &view, COLOR, self.size, true)?;
            self.read(4)?.encode(&mut encoder, &texture);
            gpu.queue().submit([encoder.finish()]);
            self.read(4)?.rows(&gpu, each)
        })
        .inspect_err(|_| self.shadows.forget())
    }

    /// What colours are drawn to, to be read back.
    pub(super) fn color(&mut self) -> (wgpu::Texture, wgpu::TextureView) {
        let kept = self.color.take().filter(|(texture, _)| [texture.width(), texture.height()] == self.size);
        let color = kept.unwrap_or_else(|| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
            let color = texture(&self.gpu, self.size, COLOR, 1, usage);
            let view = view(&color);
            (color, view)
        });
        self.color.insert(color).clone()
    }

    /// Draws numbers and shows the rows of the picture: eight bytes for each pixel.
    pub(super) fn ids(&mut self, scene: &Scene, numbers: Numbers, each: impl FnMut(&[u8])) -> Result<(), RenderError> {
        let gpu = self.gpu.clone();
        gpu.guarded(|| {
            let eye = self.list(scene, self.size, Some(numbers), true)?.0;
            self.bind_numbers(&eye)?;
            if self.ids.as_ref().is_none_or(|ids| ids.size() != self.size) {
                self.ids = Some(Ids::new(&gpu, self.size));
            }
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let Self { list, pipelines, shapes, textures, instances, numbers_group, ids, .. } = self;
            let (Some(group), Some(ids)) = (numbers_group, ids) else { return Ok(()) };
            let mut draw = Draw { gpu: &gpu, pipelines, shapes, textures, instances: instances.buffer(), sight: None };
            let culls = scene.render_flags().contains(RenderFlags::CULL_FACE);
            numbers::encode_ids(&mut encoder, &mut draw, list, group, ids, [culls, true]);
            let texture = ids.texture.clone();
            self.read(8)?.encode(&mut encoder, &texture);
            gpu.queue().submit([encoder.finish()]);
            self.read(8)?.rows(&gpu, each)
        })
    }

    /// Memory for a picture of so many bytes for each pixel.
    fn read(&mut self, pixel: u32) -> Result<&ReadBack, RenderError> {
        if !self.read_back.as_ref().is_some_and(|memory| memory.is(self.size, pixel)) {
            self.read_back = Some(ReadBack::new(&self.gpu, self.size, pixel)?);
        }
        self.read_back.as_ref().ok_or(RenderError::OutOfMemory)
    }

    /// Makes the list of what is drawn, and uploads it.
    fn list(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        numbers: Option<Numbers>,
        turned: bool,
    ) -> Result<(Eye, Lights), RenderError> {
        if scene.lineage() != self.lineage {
            return Err(Error::OtherModel { what: "the scene to draw" }.into());
        }
        let eye = Eye::new(scene, &scene.viewpoint(), size)?;
        let eye = if turned { eye.turned() } else { eye };
        let lights = Lights::new(scene, &eye, &self.settings, numbers.is_none() && self.shadows.any());
        let Self { gpu, list, shapes, textures, bounds, instances, .. } = self;
        if matches!(numbers, Some(Numbers::Depths | Numbers::Ids)) {
            shapes.refine(gpu)?;
        }
        let scenery = Scenery { eye: &eye, lights: &lights, shapes, textures, bounds, numbers };
        list.update(scene, &scenery);
        // The mirror's mark is behind all others.
        list.instances.extend(list.mirror.as_ref().and_then(|mirror| mirror.mark).map(|(_, instance)| instance));
        instances.write(gpu, bytemuck::cast_slice(&list.instances))?;
        shapes.update_skins(gpu, scene);
        Ok((eye, lights))
    }

    fn bind_numbers(&mut self, eye: &Eye) -> Result<(), RenderError> {
        let view = View::new(eye, &self.settings, self.size, false);
        if numbers::prepare(&self.gpu, &mut self.numbers, &view)? || self.numbers_group.is_none() {
            self.numbers_group = Some(self.pipelines.group(&self.gpu, &self.numbers, &[]));
        }
        Ok(())
    }

    /// Draws a scene to a texture, upside down if it is to be read back.
    pub(super) fn encode(
        &mut self,
        scene: &Scene,
        color: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        turned: bool,
    ) -> Result<wgpu::CommandEncoder, RenderError> {
        check_size(&self.gpu, size)?;
        let flags = scene.render_flags();
        let numbers = flags.contains(RenderFlags::SEGMENT).then_some(if flags.contains(RenderFlags::IDCOLOR) {
            Numbers::IdColors
        } else {
            Numbers::Colors
        });
        let (eye, lights) = self.list(scene, size, numbers, turned)?;
        let marked = self.list.mirror.as_ref().is_some_and(|mirror| mirror.mark.is_some());
        let samples = if numbers.is_some() { 1 } else { self.samples };
        if !self.target.as_ref().is_some_and(|target| target.is(size, format, samples, marked)) {
            self.target = Some(Target::new(&self.gpu, size, format, samples, marked)?);
        }
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let culls = flags.contains(RenderFlags::CULL_FACE);
        if numbers.is_some() {
            self.bind_numbers(&eye)?;
            let Self { gpu, list, pipelines, shapes, textures, instances, numbers_group, target, .. } = self;
            let (Some(group), Some(target)) = (numbers_group, target) else { return Ok(encoder) };
            let mut draw = Draw { gpu, pipelines, shapes, textures, instances: instances.buffer(), sight: None };
            numbers::encode_flat(&mut encoder, &mut draw, list, group, (target, color), [culls, turned]);
            return Ok(encoder);
        }
        let shade = match self.options.lighting {
            Lighting::PerPixel => Shade::Pixel,
            Lighting::PerVertex => Shade::Vertex,
        };
        let Self {
            gpu,
            settings,
            list,
            pipelines,
            shapes,
            textures,
            instances,
            scenes,
            shadows,
            sky,
            labels,
            target,
            ..
        } = self;
        let Some(target) = target else { return Ok(encoder) };
        let frame = Frame { eye: &eye, lights: &lights, settings, size, flags, shade };
        let planes = eye.planes();
        shadows.prepare(gpu, &lights, list)?;
        let has_haze = flags.contains(RenderFlags::HAZE);
        sky.prepare(gpu, list, &eye, settings, has_haze)?;
        labels.prepare(gpu, scene, &eye, size)?;
        if labels.count > 0 && labels.atlas.is_none() {
            labels.atlas = Some(textures.atlas(gpu));
        }
        scenes.prepare(gpu, &frame, list, shadows)?;
        let mut draw = Draw { gpu, pipelines, shapes, textures, instances: instances.buffer(), sight: None };
        shadows.encode(&mut encoder, &mut draw, list, culls);
        draw.sight = Some((&planes, &list.instances));
        let viewport = [0, 0, size[0], size[1]];
        let canvas = Canvas { target, view: color, viewport, keeps: false };
        scenes.encode(&mut encoder, &mut draw, &frame, list, (shadows, sky, labels), &canvas);
        Ok(encoder)
    }
}
