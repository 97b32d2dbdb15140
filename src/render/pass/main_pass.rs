//! Main render pass: mirror images, the reflector, opaque geoms, the skybox and the haze,
//! transparent geoms, and labels.

use super::{DrawContext, Labels, PassKind, PipelineKey, Sky, Target, Wireframe};
use crate::render::draw_list::{Batch, DrawCalls, Mirror, MirrorSide};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::settings::VisualSettings;
use crate::render::shader::{Shading, TextureKind};
use crate::render::view::{LightFeatures, Lights, Place, ShadowRegion, UniformData, ViewFrustum, ViewUniforms};
use crate::render::{Gpu, RenderError};
use crate::scene::RenderFlags;

/// Inputs of the main pass that are the same for all of its images.
#[derive(Clone, Copy)]
pub(crate) struct FrameInputs<'a> {
    pub(crate) settings: &'a VisualSettings,
    /// Features of the lights of every image.
    pub(crate) features: &'a [LightFeatures],
    pub(crate) size: [u32; 2],
    pub(crate) flags: RenderFlags,
    pub(crate) shading: Shading,
}

/// Inputs of an image of the main pass.
#[derive(Clone, Copy)]
pub(crate) struct ViewInputs<'a> {
    pub(crate) frustum: &'a ViewFrustum,
    pub(crate) lights: &'a Lights,
    pub(crate) mirror: Option<&'a Mirror>,
    pub(crate) sky: &'a Sky,
    pub(crate) regions: &'a [ShadowRegion],
    pub(crate) place: Place,
}

/// Shadow maps of the lights.
#[derive(Clone, Copy)]
pub(crate) struct ShadowTextures<'a> {
    pub(crate) views: &'a [&'a wgpu::TextureView],
    /// Width and height of a full map, texels.
    pub(crate) size: u32,
    /// Number of allocations of these textures.
    pub(crate) version: u64,
}

/// Buffers of the views of the main pass, and their bind groups.
#[derive(Debug)]
pub(crate) struct MainPass {
    views: GrowableBuffer,
    mirror_views: GrowableBuffer,
    /// Views with shadow maps.
    shadowed: Option<wgpu::BindGroup>,
    /// Views without shadow maps.
    unshadowed: Option<wgpu::BindGroup>,
    /// Mirrored views.
    mirrored: Option<wgpu::BindGroup>,
    /// Number and version of the shadow maps in `shadowed`.
    shadow_maps: (usize, u64),
    /// Size of a view and of a mirrored view, vectors of four numbers.
    vectors: [u32; 2],
    is_array: bool,
}

impl MainPass {
    /// Creates a pass of one image, or of an array of images.
    pub(crate) fn new(gpu: &Gpu, is_array: bool) -> Self {
        let usage = if is_array { wgpu::BufferUsages::STORAGE } else { wgpu::BufferUsages::UNIFORM };
        let buffer = || GrowableBuffer::new(gpu, "views", usage);
        Self {
            views: buffer(),
            mirror_views: buffer(),
            shadowed: None,
            unshadowed: None,
            mirrored: None,
            shadow_maps: (0, 0),
            vectors: [0; 2],
            is_array,
        }
    }

    /// Writes the views and invalidates stale bind groups. Either all views have a mirror or none.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &FrameInputs<'_>,
        views: &[ViewInputs<'_>],
        shadows: &ShadowTextures<'_>,
    ) -> Result<(), RenderError> {
        let has_fog = frame.flags.contains(RenderFlags::FOG);
        let (mut data, mut mirrored) = (UniformData::default(), UniformData::default());
        for ViewInputs { frustum, lights, mirror, regions, place, .. } in views {
            let view =
                ViewUniforms { place: *place, ..ViewUniforms::new(frustum, frame.settings, frame.size, has_fog) };
            data.push_lit(&view, lights, regions, shadows.size);
            if let Some(mirror) = mirror {
                let frustum = frustum.mirrored(&mirror.reflection);
                let mut view = ViewUniforms::new(&frustum, frame.settings, frame.size, has_fog);
                view.camera[3] = mirror.reflectance;
                (view.plane, view.place) = (mirror.plane, *place);
                mirrored.push_lit(&view, lights, &[], 0);
            }
        }
        self.vectors = [&data, &mirrored].map(|data| (data.bytes().len() / 16 / views.len().max(1)) as u32);
        if self.views.write(gpu, data.bytes())? {
            (self.shadowed, self.unshadowed) = (None, None);
        }
        let shadow_maps = (shadows.views.len(), shadows.version);
        if self.shadow_maps != shadow_maps {
            (self.shadowed, self.shadow_maps) = (None, shadow_maps);
        }
        if self.mirror_views.write(gpu, mirrored.bytes())? {
            self.mirrored = None;
        }
        Ok(())
    }

    /// Requests an upload of the views. Required if commands may not have been executed.
    pub(crate) fn invalidate(&mut self) {
        self.views.invalidate();
        self.mirror_views.invalidate();
    }

    /// Creates the missing bind groups.
    fn create_bind_groups(&mut self, gpu: &Gpu, shadow_maps: &[&wgpu::TextureView]) {
        let Self { views, mirror_views, shadowed, unshadowed, mirrored, .. } = self;
        let group = |views: &GrowableBuffer, maps| gpu.pipelines().view_bind_group(gpu, views, maps);
        shadowed.get_or_insert_with(|| group(views, shadow_maps));
        unshadowed.get_or_insert_with(|| group(views, &[]));
        mirrored.get_or_insert_with(|| group(mirror_views, &[]));
    }

    /// Draws all geoms, the skies and the labels in a pass.
    pub(crate) fn draw(
        &mut self,
        pass: &mut wgpu::RenderPass<'_>,
        draw: &DrawContext<'_>,
        frame: &FrameInputs<'_>,
        views: &[ViewInputs<'_>],
        (shadow_maps, labels): (&[&wgpu::TextureView], &Labels),
        target: &Target,
    ) {
        self.create_bind_groups(draw.gpu, shadow_maps);
        let (Some(shadowed), Some(unshadowed), Some(mirrored)) = (&self.shadowed, &self.unshadowed, &self.mirrored)
        else {
            return;
        };
        let (Some(first), calls) = (views.first(), draw.calls) else { return };
        let flags = frame.flags;
        // Transparent geoms and mirror images receive no shadows.
        let pipelines = draw.gpu.pipelines();
        let light_set = pipelines.light_set(frame.features.iter().copied());
        let unlit_shadows = frame.features.iter().map(|&features| LightFeatures { shadow: false, ..features });
        let unshadowed_light_set = pipelines.light_set(unlit_shadows);
        let [vectors, mirror_vectors] = self.vectors.map(|vectors| self.is_array.then_some(vectors));
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
            flip_y: first.frustum.flip_y,
            vectors,
        };
        if let Some(mirror) = first.mirror {
            // A part of a larger target has a scissor rectangle already.
            let is_whole = frame.size == target.size;
            let bounds = mirror.bounds(first.frustum, frame.size);
            if views.len() > 1 || bounds.is_some() {
                if let Some([left, top, width, height]) = bounds.filter(|_| is_whole) {
                    pass.set_scissor_rect(left, top, width, height);
                }
                let mark = PipelineKey { fog: false, ..unlit_key(PassKind::MirrorStencil, &key) };
                pass.set_bind_group(0, unshadowed, &[]);
                pass.set_stencil_reference(1);
                calls.marks.iter().for_each(|batch| draw.batch(pass, batch, &mark));
                pass.set_bind_group(0, mirrored, &[]);
                let key = PipelineKey { light_set: unshadowed_light_set, vectors: mirror_vectors, ..key };
                draw_mirror_images(pass, draw, &key);
                if is_whole {
                    pass.set_scissor_rect(0, 0, target.size[0], target.size[1]);
                }
            }
        }
        pass.set_bind_group(0, shadowed, &[]);
        for batch in calls.reflector.iter().filter(|batch| batch.visibility.in_frustum) {
            draw.batch(pass, batch, &PipelineKey { pass_kind: PassKind::Reflector, ..key });
        }
        for batch in calls.opaque.iter().filter(|batch| batch.visibility.in_frustum) {
            if batch.key.unshadowed {
                pass.set_bind_group(0, unshadowed, &[]);
                draw.batch(pass, batch, &PipelineKey { light_set: unshadowed_light_set, ..key });
                pass.set_bind_group(0, shadowed, &[]);
            } else {
                draw.batch(pass, batch, &key);
            }
        }
        pass.set_bind_group(0, unshadowed, &[]);
        if flags.contains(RenderFlags::SKYBOX) {
            draw_skies(pass, draw, views, &key);
        }
        let transparent_key = PipelineKey { pass_kind: PassKind::Transparent, light_set: unshadowed_light_set, ..key };
        for batch in transparent_batches(calls, &key).iter().filter(|batch| batch.visibility.in_frustum) {
            draw.batch(pass, batch, &transparent_key);
        }
        if let Some((_, atlas)) = labels.atlas.as_ref().filter(|_| labels.count > 0) {
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
fn draw_mirror_images(pass: &mut wgpu::RenderPass<'_>, draw: &DrawContext<'_>, key: &PipelineKey) {
    // Tiles outside of the frustum may be visible in the mirror.
    let draw = DrawContext { tiles: None, ..*draw };
    let clip = |batch: &Batch| match batch.visibility.mirror_side {
        MirrorSide::InFront => Some(false),
        MirrorSide::Across => Some(true),
        MirrorSide::Behind => None,
    };
    for batch in &draw.calls.opaque {
        if let Some(clip) = clip(batch) {
            draw.batch(pass, batch, &PipelineKey { pass_kind: PassKind::MirrorOpaque { clip }, ..*key });
        }
    }
    for batch in transparent_batches(draw.calls, key) {
        if let Some(clip) = clip(batch) {
            draw.batch(pass, batch, &PipelineKey { pass_kind: PassKind::MirrorTransparent { clip }, ..*key });
        }
    }
}

/// Returns the transparent batches: only front to back if blending is additive, otherwise also back
/// to front.
fn transparent_batches<'c>(calls: &'c DrawCalls, key: &PipelineKey) -> &'c [Batch] {
    if key.additive { &calls.transparent[..calls.front_to_back] } else { &calls.transparent }
}

/// Draws the visible skies. Consecutive images with equal skies share a draw call.
fn draw_skies(pass: &mut wgpu::RenderPass<'_>, draw: &DrawContext<'_>, views: &[ViewInputs<'_>], key: &PipelineKey) {
    let Some(texture) = draw.textures.sky() else { return };
    // The image of an orthographic camera shows a small part of the sky, on which the texture is
    // magnified.
    let pixels_per_radian =
        |view: &ViewInputs<'_>| if view.frustum.orthographic { f64::INFINITY } else { view.frustum.pixels_per_metre };
    let mut first = 0;
    let is_same = |a: &ViewInputs<'_>, b: &ViewInputs<'_>| {
        a.sky.is_equal(b.sky) && pixels_per_radian(a).total_cmp(&pixels_per_radian(b)).is_eq()
    };
    for images in views.chunk_by(is_same) {
        let (view, range) = (&images[0], first..first + images.len() as u32);
        first = range.end;
        if view.sky.is_visible {
            let pass_kind = PassKind::Sky { haze: view.sky.has_haze() };
            pass.set_pipeline(&draw.gpu.pipelines().get(draw.gpu, unlit_key(pass_kind, key)));
            pass.set_bind_group(1, texture.bind_group(pixels_per_radian(view)), &[]);
            pass.set_vertex_buffer(0, view.sky.buffer.buffer().slice(..));
            pass.draw(0..view.sky.vertex_count(), range);
        }
    }
}
