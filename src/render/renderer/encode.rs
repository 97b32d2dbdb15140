//! Submission of the render passes of a scene.

use super::Renderer;
use super::frame::TargetNeeds;
use super::read_back::ReadBack;
use crate::render::draw_list::AuxOutput;
use crate::render::pass::{
    AuxLayer, AuxTarget, COLOR_FORMAT, Target, begin_ids, begin_main, check_size, create_texture, default_view,
};
use crate::render::{Gpu, RenderError};
use crate::scene::Scene;

impl Renderer {
    /// Submits the commands that render a colour image and copy it to its read-back buffer.
    pub(super) fn submit_color(&mut self, scene: &Scene) -> Result<wgpu::SubmissionIndex, RenderError> {
        let gpu = self.assets.gpu.clone();
        let (texture, view) = self.color_texture();
        let mut encoder = self.encode(scene, &view, COLOR_FORMAT, self.size, true)?;
        self.read_back_buffer(ReadBack::Color)?.encode(&mut encoder, &texture);
        Ok(gpu.submit(encoder))
    }

    /// Returns the colour texture for read-back, which is recreated after a change of the size.
    pub(super) fn color_texture(&mut self) -> (wgpu::Texture, wgpu::TextureView) {
        color_texture(&self.assets.gpu, &mut self.color, self.size)
    }

    /// Submits the commands that render geom ids and depths and copy them to [`ReadBack::Aux`].
    /// Also returns `true` if the depths are in [`ReadBack::Opaque`] instead: for both outputs of a
    /// scene with transparent geoms.
    pub(super) fn submit_aux(
        &mut self,
        scene: &Scene,
        output: AuxOutput,
    ) -> Result<(wgpu::SubmissionIndex, bool), RenderError> {
        let gpu = self.assets.gpu.clone();
        self.frame.prepare(&mut self.assets, scene, self.size, Some(output), true)?;
        self.frame.upload(&self.assets)?;
        if self.aux_target.as_ref().is_none_or(|target| target.size() != self.size) {
            self.aux_target = Some(AuxTarget::new(&gpu, self.size));
        }
        let has_transparent = !self.frame.list.calls.transparent.is_empty();
        let mut encoder = command_encoder(&gpu);
        if has_transparent {
            self.encode_aux(&mut encoder, AuxLayer::Opaque, ReadBack::Opaque)?;
            self.encode_aux(&mut encoder, AuxLayer::Transparent, ReadBack::Aux)?;
        } else {
            self.encode_aux(&mut encoder, AuxLayer::Only, ReadBack::Aux)?;
        }
        Ok((gpu.submit(encoder), has_transparent))
    }

    /// Encodes a pass for geom ids and depths, and the copy to a read-back buffer.
    fn encode_aux(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        layer: AuxLayer,
        to: ReadBack,
    ) -> Result<(), RenderError> {
        let Some(target) = &self.aux_target else { return Ok(()) };
        self.frame.draw_ids(&mut begin_ids(encoder, target, layer), &self.assets, layer);
        let texture = target.texture.clone();
        self.read_back_buffer(to)?.encode(encoder, &texture);
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
        let Self { assets, frame, target, samples, .. } = self;
        check_size(&assets.gpu, size.map(|length| length as usize))?;
        frame.prepare(assets, scene, size, None, flip_y)?;
        frame.upload(assets)?;
        let needs = frame.target_needs(*samples);
        let target = matching_target(&assets.gpu, target, size, format, needs)?;
        let mut encoder = command_encoder(&assets.gpu);
        frame.encode_shadows(&mut encoder, assets);
        frame.draw_color(&mut begin_main(&mut encoder, target, color), assets, target);
        Ok(encoder)
    }
}

pub(super) fn command_encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

/// Returns a colour texture for read-back, which is recreated after a change of the size.
pub(super) fn color_texture(
    gpu: &Gpu,
    color: &mut Option<(wgpu::Texture, wgpu::TextureView)>,
    size: [u32; 2],
) -> (wgpu::Texture, wgpu::TextureView) {
    let existing = color.take().filter(|(texture, _)| [texture.width(), texture.height()] == size);
    let (texture, view) = existing.unwrap_or_else(|| {
        use wgpu::TextureUsages as Usage;
        let usage = Usage::RENDER_ATTACHMENT | Usage::COPY_SRC | Usage::TEXTURE_BINDING;
        let texture = create_texture(gpu, "image to read back", size, COLOR_FORMAT, 1, usage);
        let view = default_view(&texture);
        (texture, view)
    });
    color.insert((texture, view)).clone()
}

/// Returns a target with the needed properties, which is recreated after a change.
pub(super) fn matching_target<'t>(
    gpu: &Gpu,
    target: &'t mut Option<Target>,
    size: [u32; 2],
    format: wgpu::TextureFormat,
    needs: TargetNeeds,
) -> Result<&'t Target, RenderError> {
    let TargetNeeds { samples, stencil } = needs;
    let existing = target.take().filter(|target| target.matches(size, format, samples, stencil));
    let matching = match existing {
        Some(target) => target,
        None => Target::new(gpu, size, format, samples, stencil)?,
    };
    Ok(target.insert(matching))
}
