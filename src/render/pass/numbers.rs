//! Numbers and depths of geoms, and geoms in colours for their numbers.

use super::target::{depth_format, texture, view};
use super::{Draw, Key, Memory, Step, Target};
use crate::render::frame::{Uniform, View};
use crate::render::list::List;
use crate::render::{Gpu, RenderError};

/// For each pixel the number of a geom, and its depth in metres: the bits of a floating-point number, which not every adapter can
/// draw as such.
const NUMBERS: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// A picture of numbers.
#[derive(Debug)]
pub(crate) struct Ids {
    pub(crate) texture: wgpu::Texture,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    size: [u32; 2],
}

impl Ids {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let target = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let texture_ = texture(gpu, size, NUMBERS, 1, target | wgpu::TextureUsages::COPY_SRC);
        let depth = view(&texture(gpu, size, depth_format(false), 1, target));
        Self { color: view(&texture_), texture: texture_, depth, size }
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// The uniforms of a picture of numbers.
pub(crate) fn prepare(gpu: &Gpu, memory: &mut Memory, view: &View) -> Result<bool, RenderError> {
    memory.write(gpu, Uniform::plain(view).bytes())
}

/// Draws numbers and depths. `sides`: whether one side of surfaces is left out, and whether the picture is upside down.
pub(crate) fn encode_ids(
    encoder: &mut wgpu::CommandEncoder,
    draw: &mut Draw<'_>,
    list: &List,
    group: &wgpu::BindGroup,
    ids: &Ids,
    sides: [bool; 2],
) {
    let pass = begin(encoder, &ids.color, &ids.depth);
    encode(pass, draw, list, group, &Key::plain(Step::Ids, NUMBERS, sides));
}

/// Draws geoms in their colours, to a target without samples; `sides` as above.
pub(crate) fn encode_flat(
    encoder: &mut wgpu::CommandEncoder,
    draw: &mut Draw<'_>,
    list: &List,
    group: &wgpu::BindGroup,
    (target, color): (&Target, &wgpu::TextureView),
    sides: [bool; 2],
) {
    let pass = begin(encoder, color, &target.depth);
    encode(pass, draw, list, group, &Key::plain(Step::Flat, target.format, sides));
}

fn encode(mut pass: wgpu::RenderPass<'_>, draw: &mut Draw<'_>, list: &List, group: &wgpu::BindGroup, key: &Key) {
    pass.set_bind_group(0, group, &[]);
    for batch in list.solid.iter().filter(|batch| batch.place.seen) {
        draw.batch(&mut pass, batch, key);
    }
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    color: &wgpu::TextureView,
    depth: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("numbers"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
