//! Pass for auxiliary output: geom ids and depths, and segmentation colours. It has no lighting,
//! textures or multisampling.

use super::target::{create_texture, default_view, depth_format};
use super::{DrawContext, PassKind, PipelineKey, Target};
use crate::render::Gpu;
use crate::render::draw_list::Batch;

/// Format of geom ids and depths in metres. The depth is the bit pattern of a floating-point
/// number, because not every adapter can render to 32-bit float formats.
const ID_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// Render target for geom ids and depths.
#[derive(Debug)]
pub(crate) struct AuxTarget {
    pub(crate) texture: wgpu::Texture,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    size: [u32; 2],
}

impl AuxTarget {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let texture = create_texture(
            gpu,
            "ids and depths to read back",
            size,
            ID_DEPTH_FORMAT,
            1,
            usage | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING,
        );
        let depth = default_view(&create_texture(gpu, "depths behind ids", size, depth_format(gpu, false), 1, usage));
        Self { color: default_view(&texture), texture, depth, size }
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// Geoms of a pass for ids and depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AuxLayer {
    /// The opaque list, alone.
    Only,
    /// The opaque list, to which a pass of the transparent list is added.
    Opaque,
    /// The transparent list, in addition to the opaque list.
    Transparent,
}

/// Draws geom ids and depths in a pass, upside down. `vectors` is the size of a view in an array of
/// views.
pub(crate) fn draw_ids(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &DrawContext<'_>,
    (view, vectors): (&wgpu::BindGroup, Option<u32>),
    (layer, cull): (AuxLayer, bool),
) {
    // The order of the transparent geoms does not matter.
    let calls = draw.calls;
    let batches =
        if layer == AuxLayer::Transparent { &calls.transparent[..calls.front_to_back] } else { &calls.opaque[..] };
    let key = PipelineKey { vectors, ..PipelineKey::untextured(PassKind::Ids, ID_DEPTH_FORMAT, cull, true) };
    draw_batches(pass, draw, batches, view, &key);
}

/// Draws segmentation colours in a pass without multisampling.
pub(crate) fn draw_segment_colors(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &DrawContext<'_>,
    view: &wgpu::BindGroup,
    target: &Target,
    [cull, flip_y]: [bool; 2],
) {
    let key = PipelineKey::untextured(PassKind::FlatColor, target.format, cull, flip_y);
    draw_batches(pass, draw, &draw.calls.opaque, view, &key);
}

fn draw_batches(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &DrawContext<'_>,
    batches: &[Batch],
    view: &wgpu::BindGroup,
    key: &PipelineKey,
) {
    pass.set_bind_group(0, view, &[]);
    for batch in batches.iter().filter(|batch| batch.visibility.in_frustum) {
        draw.batch(pass, batch, key);
    }
}

/// Begins a pass for geom ids and depths.
pub(crate) fn begin_ids<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    target: &AuxTarget,
    layer: AuxLayer,
) -> wgpu::RenderPass<'e> {
    let is_first = layer != AuxLayer::Transparent;
    let store = if layer == AuxLayer::Opaque { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("auxiliary output"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: if is_first { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load },
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth,
            depth_ops: Some(wgpu::Operations {
                load: if is_first { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load },
                store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
