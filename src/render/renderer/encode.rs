//! Encoding of the render passes of a scene, and read-back of the results.

use super::Renderer;
use super::read_back::ReadBack;
use crate::error::Error;
use crate::render::assets::glyph_atlas;
use crate::render::draw_list::{AuxOutput, DrawListInputs};
use crate::render::pass::{
    AuxLayer, AuxTarget, COLOR_FORMAT, DrawContext, FrameInputs, Target, check_size, create_texture, default_view,
    encode_ids, encode_segment_colors,
};
use crate::render::shader::Shading;
use crate::render::view::{Lights, UniformData, ViewFrustum, ViewUniforms};
use crate::render::{Lighting, RenderError};
use crate::scene::{RenderFlags, Scene};

impl Renderer {
    /// Submits the commands that render a colour image and copy it to its read-back buffer.
    pub(super) fn submit_color(&mut self, scene: &Scene) -> Result<(), RenderError> {
        let gpu = self.gpu.clone();
        let (texture, view) = self.color_texture();
        let mut encoder = self.encode(scene, &view, COLOR_FORMAT, self.size, true)?;
        self.read_back_buffer(ReadBack::Color)?.encode(&mut encoder, &texture);
        gpu.queue().submit([encoder.finish()]);
        Ok(())
    }

    /// Returns the colour texture for read-back, which is recreated after a change of the size.
    pub(super) fn color_texture(&mut self) -> (wgpu::Texture, wgpu::TextureView) {
        let existing = self.color.take().filter(|(texture, _)| [texture.width(), texture.height()] == self.size);
        let color = existing.unwrap_or_else(|| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
            let texture = create_texture(&self.gpu, self.size, COLOR_FORMAT, 1, usage);
            let view = default_view(&texture);
            (texture, view)
        });
        self.color.insert(color).clone()
    }

    /// Submits the commands that render geom ids and depths and copy them to [`ReadBack::Aux`]. Returns `true` if the depths are those of
    /// [`ReadBack::Opaque`] instead: for both outputs of a scene with transparent geoms.
    pub(super) fn submit_aux(&mut self, scene: &Scene, output: AuxOutput) -> Result<bool, RenderError> {
        let gpu = self.gpu.clone();
        let frustum = self.update_draw_list(scene, self.size, Some(output), true)?.0;
        self.update_aux_view(&frustum)?;
        if self.aux_target.as_ref().is_none_or(|target| target.size() != self.size) {
            self.aux_target = Some(AuxTarget::new(&gpu, self.size));
        }
        let has_transparent = !self.list.transparent.is_empty();
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if has_transparent {
            self.encode_aux(&mut encoder, scene, AuxLayer::Opaque, ReadBack::Opaque)?;
            self.encode_aux(&mut encoder, scene, AuxLayer::Transparent, ReadBack::Aux)?;
        } else {
            self.encode_aux(&mut encoder, scene, AuxLayer::Only, ReadBack::Aux)?;
        }
        gpu.queue().submit([encoder.finish()]);
        Ok(has_transparent)
    }

    /// Encodes a pass for geom ids and depths, and the copy to a read-back buffer.
    fn encode_aux(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        layer: AuxLayer,
        to: ReadBack,
    ) -> Result<(), RenderError> {
        let cull = scene.render_flags().contains(RenderFlags::CULL_FACE);
        let Self { gpu, list, shapes, textures, instances, aux_view, aux_target, .. } = self;
        let (Some(view), Some(target)) = (aux_view, aux_target) else { return Ok(()) };
        let instances = instances.buffer();
        let draw = DrawContext { gpu, shapes, textures, instances, tile_culling: None };
        encode_ids(encoder, &draw, list, view, target, (layer, cull));
        let texture = target.texture.clone();
        self.read_back_buffer(to)?.encode(encoder, &texture);
        Ok(())
    }

    /// Updates the draw list and uploads its instances.
    fn update_draw_list(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        aux: Option<AuxOutput>,
        flip_y: bool,
    ) -> Result<(ViewFrustum, Lights), RenderError> {
        if scene.lineage() != self.lineage {
            return Err(Error::OtherModel { what: "the scene to draw" }.into());
        }
        let frustum = ViewFrustum::new(scene, &scene.viewpoint(), size)?;
        let frustum = if flip_y { frustum.flipped() } else { frustum };
        let has_shadows = aux.is_none() && self.shadow_maps.is_enabled();
        let lights = Lights::new(scene, &frustum, &self.settings, has_shadows, self.options.max_lights);
        let Self { gpu, list, shapes, textures, bounds, instances, .. } = self;
        if aux.is_some_and(AuxOutput::has_depth) {
            shapes.create_depth_levels(gpu)?;
        }
        shapes.update_flexes(gpu, scene)?;
        list.update(scene, &DrawListInputs { frustum: &frustum, lights: &lights, shapes, textures, bounds, aux });
        // The stencil mark of the mirror is the last instance.
        let stencil_mark = list.mirror.as_ref().and_then(|mirror| mirror.stencil_mark);
        list.instances.extend(stencil_mark.map(|(_, instance)| instance));
        instances.write(gpu, bytemuck::cast_slice(&list.instances))?;
        shapes.update_skins(gpu, scene);
        Ok((frustum, lights))
    }

    /// Writes the uniform buffer of auxiliary output and creates its bind group.
    fn update_aux_view(&mut self, frustum: &ViewFrustum) -> Result<(), RenderError> {
        let view = ViewUniforms::new(frustum, &self.settings, self.size, false);
        let is_stale = self.aux_uniform.write(&self.gpu, UniformData::unlit(&view).bytes())?;
        if is_stale || self.aux_view.is_none() {
            self.aux_view = Some(self.gpu.pipelines().view_bind_group(&self.gpu, &self.aux_uniform, &[]));
        }
        Ok(())
    }

    /// Encodes all passes that render a scene to a colour texture, upside down for read-back.
    pub(super) fn encode(
        &mut self,
        scene: &Scene,
        color: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        flip_y: bool,
    ) -> Result<wgpu::CommandEncoder, RenderError> {
        check_size(&self.gpu, size)?;
        let flags = scene.render_flags();
        let aux = flags.contains(RenderFlags::SEGMENT).then_some(if flags.contains(RenderFlags::IDCOLOR) {
            AuxOutput::IdColors
        } else {
            AuxOutput::SegmentColors
        });
        let (frustum, lights) = self.update_draw_list(scene, size, aux, flip_y)?;
        let stencil = self.list.mirror.as_ref().is_some_and(|mirror| mirror.stencil_mark.is_some());
        let samples = if aux.is_some() { 1 } else { self.samples };
        if !self.target.as_ref().is_some_and(|target| target.matches(size, format, samples, stencil)) {
            self.target = Some(Target::new(&self.gpu, size, format, samples, stencil)?);
        }
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let cull = flags.contains(RenderFlags::CULL_FACE);
        if aux.is_some() {
            self.update_aux_view(&frustum)?;
            let Self { gpu, list, shapes, textures, instances, aux_view, target, .. } = self;
            let (Some(view), Some(target)) = (aux_view, target) else { return Ok(encoder) };
            let instances = instances.buffer();
            let draw = DrawContext { gpu, shapes, textures, instances, tile_culling: None };
            encode_segment_colors(&mut encoder, &draw, list, view, (target, color), [cull, flip_y]);
            return Ok(encoder);
        }
        let shading = match self.options.lighting {
            Lighting::PerPixel => Shading::Pixel,
            Lighting::PerVertex => Shading::Vertex,
        };
        let Self {
            gpu, settings, list, shapes, textures, instances, main_pass, shadow_maps, sky, labels, target, ..
        } = self;
        let Some(target) = target else { return Ok(encoder) };
        let frame = FrameInputs { frustum: &frustum, lights: &lights, settings, size, flags, shading };
        let planes = frustum.planes();
        shadow_maps.prepare(gpu, &lights, list)?;
        sky.prepare(gpu, list, &frustum, settings, flags.contains(RenderFlags::HAZE))?;
        labels.prepare(gpu, scene, &frustum, size)?;
        if labels.count > 0 && labels.atlas.is_none() {
            labels.atlas = Some(glyph_atlas(gpu));
        }
        main_pass.prepare(gpu, &frame, list, shadow_maps)?;
        let instances = instances.buffer();
        let draw = DrawContext { gpu, shapes, textures, instances, tile_culling: None };
        shadow_maps.encode(&mut encoder, &draw, list, cull);
        let draw = DrawContext { tile_culling: Some((&planes, &list.instances)), ..draw };
        main_pass.encode(&mut encoder, &draw, &frame, list, (shadow_maps, sky, labels), (target, color));
        Ok(encoder)
    }
}
