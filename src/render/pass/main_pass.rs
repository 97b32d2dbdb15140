//! Main render pass: mirror images, the reflector, opaque geoms, the skybox and the haze,
//! transparent geoms, and labels.

use super::{DrawContext, Labels, PassKind, PipelineKey, ShadowMaps, Sky, Target, Wireframe};
use crate::render::draw_list::{Batch, BatchKey, DrawList, MirrorSide, Visibility};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::settings::VisualSettings;
use crate::render::shader::{Shading, TextureKind};
use crate::render::view::{LightFeatures, Lights, UniformData, ViewFrustum, ViewUniforms};
use crate::render::{Gpu, RenderError};
use crate::scene::RenderFlags;

/// Inputs of the main pass that change from frame to frame.
#[derive(Clone, Copy)]
pub(crate) struct FrameInputs<'a> {
    pub(crate) frustum: &'a ViewFrustum,
    pub(crate) lights: &'a Lights,
    pub(crate) settings: &'a VisualSettings,
    pub(crate) size: [u32; 2],
    pub(crate) flags: RenderFlags,
    pub(crate) shading: Shading,
}

/// Uniform buffers and bind groups of the main pass.
#[derive(Debug)]
pub(crate) struct MainPass {
    uniform: GrowableBuffer,
    mirror_uniform: GrowableBuffer,
    /// View with shadow maps.
    shadowed: Option<wgpu::BindGroup>,
    /// View without shadow maps.
    unshadowed: Option<wgpu::BindGroup>,
    /// Mirrored view.
    mirrored: Option<wgpu::BindGroup>,
    /// Number and version of the shadow maps in `shadowed`.
    shadow_maps: (usize, u64),
}

impl MainPass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let uniform = || GrowableBuffer::new(gpu, "uniforms of a view", wgpu::BufferUsages::UNIFORM);
        Self {
            uniform: uniform(),
            mirror_uniform: uniform(),
            shadowed: None,
            unshadowed: None,
            mirrored: None,
            shadow_maps: (0, 0),
        }
    }

    /// Writes the uniform buffers and invalidates stale bind groups.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &FrameInputs<'_>,
        list: &DrawList,
        shadows: &ShadowMaps,
    ) -> Result<(), RenderError> {
        let FrameInputs { frustum, lights, settings, size, flags, .. } = *frame;
        let has_fog = flags.contains(RenderFlags::FOG);
        let view = ViewUniforms::new(frustum, settings, size, has_fog);
        let shadow_maps = (shadows.regions().len(), shadows.version());
        if self.uniform.write(gpu, UniformData::lit(&view, lights, shadows.regions(), shadows.size()).bytes())? {
            (self.shadowed, self.unshadowed) = (None, None);
        }
        if self.shadow_maps != shadow_maps {
            (self.shadowed, self.shadow_maps) = (None, shadow_maps);
        }
        if let Some(mirror) = &list.mirror {
            let mut view = ViewUniforms::new(&frustum.mirrored(&mirror.reflection), settings, size, has_fog);
            view.camera[3] = mirror.reflectance;
            view.plane = mirror.plane;
            if self.mirror_uniform.write(gpu, UniformData::lit(&view, lights, &[], 0).bytes())? {
                self.mirrored = None;
            }
        }
        Ok(())
    }

    /// Requests an upload of the uniforms. Required if commands may not have been executed.
    pub(crate) fn invalidate(&mut self) {
        self.uniform.invalidate();
        self.mirror_uniform.invalidate();
    }

    /// Creates the missing bind groups.
    fn create_bind_groups(&mut self, draw: &DrawContext<'_>, shadows: &ShadowMaps) {
        let Self { uniform, mirror_uniform, shadowed, unshadowed, mirrored, .. } = self;
        let group = |uniform: &GrowableBuffer, maps: &[&wgpu::TextureView]| {
            draw.gpu.pipelines().view_bind_group(draw.gpu, uniform, maps)
        };
        shadowed.get_or_insert_with(|| group(uniform, &shadows.views().collect::<Vec<_>>()));
        unshadowed.get_or_insert_with(|| group(uniform, &[]));
        mirrored.get_or_insert_with(|| group(mirror_uniform, &[]));
    }

    /// Draws all geoms, the sky and the labels in a pass.
    pub(crate) fn draw(
        &mut self,
        pass: &mut wgpu::RenderPass<'_>,
        draw: &DrawContext<'_>,
        frame: &FrameInputs<'_>,
        list: &DrawList,
        (shadows, sky, labels): (&ShadowMaps, &Sky, &Labels),
        target: &Target,
    ) {
        self.create_bind_groups(draw, shadows);
        let (Some(shadowed), Some(unshadowed), Some(mirrored)) = (&self.shadowed, &self.unshadowed, &self.mirrored)
        else {
            return;
        };
        let flags = frame.flags;
        // Transparent geoms and mirror images receive no shadows.
        let pipelines = draw.gpu.pipelines();
        let light_set = pipelines.light_set(frame.lights.features());
        let unshadowed_light_set =
            pipelines.light_set(frame.lights.features().map(|features| LightFeatures { shadow: false, ..features }));
        let key = PipelineKey {
            pass_kind: PassKind::Opaque,
            texture_kind: TextureKind::D2,
            line: false,
            back_faces: false,
            light_set,
            shading: frame.shading,
            fog: flags.contains(RenderFlags::FOG),
            cull: flags.contains(RenderFlags::CULL_FACE),
            wireframe: draw.wireframe(flags),
            additive: flags.contains(RenderFlags::ADDITIVE),
            format: target.format,
            samples: target.samples,
            stencil: target.stencil,
            flip_y: frame.frustum.flip_y,
        };
        if let Some(mirror) = &list.mirror {
            pass.set_bind_group(0, mirrored, &[]);
            let key = PipelineKey { light_set: unshadowed_light_set, ..key };
            if let Some([left, top, width, height]) = mirror.bounds(frame.frustum, frame.size) {
                // A part of a larger target has a scissor rectangle already.
                let is_whole = frame.size == target.size;
                if is_whole {
                    pass.set_scissor_rect(left, top, width, height);
                }
                draw_mirror_images(pass, draw, list, unshadowed, mirrored, &key);
                if is_whole {
                    pass.set_scissor_rect(0, 0, target.size[0], target.size[1]);
                }
            }
        }
        pass.set_bind_group(0, shadowed, &[]);
        for batch in list.reflector.iter().filter(|batch| batch.visibility.in_frustum) {
            draw.batch(pass, batch, &PipelineKey { pass_kind: PassKind::Reflector, ..key });
        }
        for batch in list.opaque.iter().filter(|batch| batch.visibility.in_frustum) {
            if batch.key.unshadowed {
                pass.set_bind_group(0, unshadowed, &[]);
                draw.batch(pass, batch, &PipelineKey { light_set: unshadowed_light_set, ..key });
                pass.set_bind_group(0, shadowed, &[]);
            } else {
                draw.batch(pass, batch, &key);
            }
        }
        pass.set_bind_group(0, unshadowed, &[]);
        if flags.contains(RenderFlags::SKYBOX) && sky.is_visible {
            draw_sky(pass, draw, sky, frame.frustum, &key);
        }
        let transparent_key = PipelineKey { pass_kind: PassKind::Transparent, light_set: unshadowed_light_set, ..key };
        for batch in transparent_batches(list, &key).iter().filter(|batch| batch.visibility.in_frustum) {
            draw.batch(pass, batch, &transparent_key);
        }
        if let Some(atlas) = labels.atlas.as_ref().filter(|_| labels.count > 0) {
            let key = PipelineKey { fog: false, ..unlit_key(PassKind::Label, &key) };
            pass.set_pipeline(&pipelines.get(draw.gpu, key));
            pass.set_bind_group(1, atlas, &[]);
            pass.set_vertex_buffer(0, labels.buffer.buffer().slice(..));
            pass.draw(0..4, 0..labels.count);
        }
    }
}

/// Begins the pass with cleared attachments.
pub(crate) fn begin_main<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    target: &Target,
    color: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    // Multisampled colours are discarded after the MSAA resolve.
    let (view, resolve_target, store) = match &target.multisampled {
        Some(multisampled) => (multisampled, Some(color), wgpu::StoreOp::Discard),
        None => (color, None, wgpu::StoreOp::Store),
    };
    let stencil_ops =
        target.stencil.then_some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Discard });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("main"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops,
        }),
        ..Default::default()
    })
}

/// Returns the key of a pass without lighting, texture and wireframe mode.
fn unlit_key(pass_kind: PassKind, key: &PipelineKey) -> PipelineKey {
    PipelineKey {
        pass_kind,
        texture_kind: TextureKind::None,
        shading: Shading::None,
        wireframe: Wireframe::Off,
        light_set: 0,
        ..*key
    }
}

/// Draws the mirror images of all geoms except the reflector, where the stencil buffer marks the
/// mirror.
fn draw_mirror_images(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &DrawContext<'_>,
    list: &DrawList,
    unshadowed: &wgpu::BindGroup,
    mirrored: &wgpu::BindGroup,
    key: &PipelineKey,
) {
    let Some(mirror) = &list.mirror else { return };
    pass.set_stencil_reference(1);
    if let Some((shape, _)) = mirror.stencil_mark {
        // The mark is rendered in the unmirrored view. Its instance is the last one.
        let index = list.instances.len() as u32 - 1;
        let batch = Batch {
            key: BatchKey {
                shape,
                texture_kind: TextureKind::None,
                texture: 0,
                line: false,
                back_faces: false,
                unshadowed: false,
            },
            visibility: Visibility { in_frustum: true, mirror_side: MirrorSide::Across, shadow_mask: 0 },
            instances: index..index + 1,
        };
        pass.set_bind_group(0, unshadowed, &[]);
        draw.batch(pass, &batch, &PipelineKey { fog: false, ..unlit_key(PassKind::MirrorStencil, key) });
        pass.set_bind_group(0, mirrored, &[]);
    }
    // Tiles outside of the frustum may be visible in the mirror.
    let draw = DrawContext { tiles: None, ..*draw };
    let clip = |batch: &Batch| match batch.visibility.mirror_side {
        MirrorSide::InFront => Some(false),
        MirrorSide::Across => Some(true),
        MirrorSide::Behind => None,
    };
    for batch in &list.opaque {
        if let Some(clip) = clip(batch) {
            draw.batch(pass, batch, &PipelineKey { pass_kind: PassKind::MirrorOpaque { clip }, ..*key });
        }
    }
    for batch in transparent_batches(list, key) {
        if let Some(clip) = clip(batch) {
            draw.batch(pass, batch, &PipelineKey { pass_kind: PassKind::MirrorTransparent { clip }, ..*key });
        }
    }
}

/// Returns the transparent batches: only front to back if blending is additive, otherwise also back
/// to front.
fn transparent_batches<'l>(list: &'l DrawList, key: &PipelineKey) -> &'l [Batch] {
    if key.additive { &list.transparent[..list.front_to_back] } else { &list.transparent }
}

fn draw_sky(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &DrawContext<'_>,
    sky: &Sky,
    frustum: &ViewFrustum,
    key: &PipelineKey,
) {
    let Some(texture) = draw.textures.sky() else { return };
    let pass_kind = PassKind::Sky { haze: sky.has_haze() };
    pass.set_pipeline(&draw.gpu.pipelines().get(draw.gpu, unlit_key(pass_kind, key)));
    // The image of an orthographic camera shows a small part of the sky, on which the texture is
    // magnified.
    let pixels_per_radian = if frustum.orthographic { f64::INFINITY } else { frustum.pixels_per_metre };
    pass.set_bind_group(1, texture.bind_group(pixels_per_radian), &[]);
    pass.set_vertex_buffer(0, sky.buffer.buffer().slice(..));
    pass.draw(0..sky.vertex_count(), 0..1);
}
