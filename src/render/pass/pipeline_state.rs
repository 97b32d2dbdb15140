//! Fixed-function state, bind group layouts and vertex buffer layouts of the pipelines.

use std::mem::offset_of;

use super::target::depth_format;
use super::{PassKind, PipelineKey, Wireframe};
use crate::render::Gpu;
use crate::render::draw_list::Instance;
use crate::render::settings::ALL_FACES_CAST_SHADOWS;
use crate::render::shader::{Output, ShaderKind};
use crate::shape::Vertex;

/// State of a pipeline, derived from its key.
pub(super) struct PipelineState {
    pub(super) shader: ShaderKind,
    pub(super) output: Output,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) color_writes: wgpu::ColorWrites,
    pub(super) primitive: wgpu::PrimitiveState,
    pub(super) depth_stencil: wgpu::DepthStencilState,
}

impl PipelineState {
    pub(super) fn new(gpu: &Gpu, key: &PipelineKey) -> Self {
        let geom = if key.line { ShaderKind::Line } else { ShaderKind::Surface };
        let (shader, output) = match key.pass_kind {
            PassKind::Shadow => (ShaderKind::Depth, Output::DepthOnly),
            PassKind::MirrorStencil => (ShaderKind::Depth, Output::Color),
            PassKind::Sky { haze } => (ShaderKind::Sky { haze }, Output::Color),
            PassKind::Label => (ShaderKind::Label, Output::Color),
            PassKind::Ids => (geom, Output::Ids),
            _ => (geom, Output::Color),
        };
        let color_writes = match key.pass_kind {
            PassKind::MirrorStencil => wgpu::ColorWrites::empty(),
            _ => wgpu::ColorWrites::ALL,
        };
        Self {
            shader,
            output,
            blend: blend(key),
            color_writes,
            primitive: primitive(key, shader),
            depth_stencil: depth_stencil(gpu, key),
        }
    }
}

/// Distance by which surfaces are moved away from the light in a shadow map, so that they do not
/// shadow themselves: the slope is the engine's, and the constant exceeds the rounding of depths in
/// single precision.
const SHADOW_BIAS: wgpu::DepthBiasState = wgpu::DepthBiasState { constant: 8, slope_scale: 1.5, clamp: 0.0 };

fn blend(key: &PipelineKey) -> Option<wgpu::BlendState> {
    use wgpu::BlendFactor::{One, OneMinusSrcAlpha, SrcAlpha, Zero};
    let (src_factor, dst_factor) = match key.pass_kind {
        PassKind::Reflector => (One, One),
        PassKind::Transparent | PassKind::MirrorTransparent { .. } if key.additive => (SrcAlpha, One),
        PassKind::Transparent | PassKind::MirrorTransparent { .. } | PassKind::Sky { haze: true } | PassKind::Label => {
            (SrcAlpha, OneMinusSrcAlpha)
        }
        _ => return None,
    };
    let operation = wgpu::BlendOperation::Add;
    Some(wgpu::BlendState {
        color: wgpu::BlendComponent { src_factor, dst_factor, operation },
        // The alpha channel of the image is unused.
        alpha: wgpu::BlendComponent { src_factor: Zero, dst_factor: One, operation },
    })
}

fn primitive(key: &PipelineKey, shader: ShaderKind) -> wgpu::PrimitiveState {
    use wgpu::Face::{Back, Front};
    // Mirror images have the opposite winding order, as have frames rendered upside down.
    let is_clockwise =
        key.flip_y != matches!(key.pass_kind, PassKind::MirrorOpaque { .. } | PassKind::MirrorTransparent { .. });
    let culled = match key.pass_kind {
        PassKind::Shadow if ALL_FACES_CAST_SHADOWS => None,
        // Culling front faces avoids self-shadowing. The skybox is seen from inside.
        PassKind::Shadow | PassKind::Sky { .. } => Some(Front),
        PassKind::Label => None,
        _ if key.line => None,
        _ => Some(if key.back_faces { Front } else { Back }),
    };
    let is_wireframe = key.wireframe != Wireframe::Off && matches!(shader, ShaderKind::Surface | ShaderKind::Depth);
    wgpu::PrimitiveState {
        topology: if shader == ShaderKind::Label {
            wgpu::PrimitiveTopology::TriangleStrip
        } else {
            wgpu::PrimitiveTopology::TriangleList
        },
        front_face: if is_clockwise { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
        cull_mode: culled.filter(|_| key.cull),
        polygon_mode: if is_wireframe { wgpu::PolygonMode::Line } else { wgpu::PolygonMode::Fill },
        ..Default::default()
    }
}

fn depth_stencil(gpu: &Gpu, key: &PipelineKey) -> wgpu::DepthStencilState {
    let ignores_depth = matches!(key.pass_kind, PassKind::MirrorStencil | PassKind::Label);
    let face = |compare, pass_op| wgpu::StencilFaceState {
        compare,
        fail_op: wgpu::StencilOperation::Keep,
        depth_fail_op: wgpu::StencilOperation::Keep,
        pass_op,
    };
    let face = match key.pass_kind {
        _ if !key.stencil => wgpu::StencilFaceState::IGNORE,
        PassKind::MirrorStencil => face(wgpu::CompareFunction::Always, wgpu::StencilOperation::Replace),
        PassKind::MirrorOpaque { .. } | PassKind::MirrorTransparent { .. } => {
            face(wgpu::CompareFunction::Equal, wgpu::StencilOperation::Keep)
        }
        _ => wgpu::StencilFaceState::IGNORE,
    };
    wgpu::DepthStencilState {
        format: depth_format(gpu, key.stencil),
        depth_write_enabled: Some(!ignores_depth && !key.pass_kind.is_transparent()),
        depth_compare: Some(match key.pass_kind {
            _ if ignores_depth => wgpu::CompareFunction::Always,
            PassKind::Shadow => wgpu::CompareFunction::LessEqual,
            _ => wgpu::CompareFunction::GreaterEqual,
        }),
        stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xFF, write_mask: 0xFF },
        bias: if key.pass_kind == PassKind::Shadow && ALL_FACES_CAST_SHADOWS {
            SHADOW_BIAS
        } else {
            wgpu::DepthBiasState::default()
        },
    }
}

/// Creates the bind group layout of a view, or of an array of views: its buffer and shadow maps.
pub(super) fn view_layout(gpu: &Gpu, ty: wgpu::BufferBindingType, shadow_maps: usize) -> wgpu::BindGroupLayout {
    let views = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    // No comparison sampler: the shader compares depths itself, in the same way on every adapter.
    let map = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let entry = |binding: usize, visibility, ty| wgpu::BindGroupLayoutEntry {
        binding: binding as u32,
        visibility,
        ty,
        count: None,
    };
    let mut entries = vec![entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, views)];
    entries.extend((1..=shadow_maps).map(|binding| entry(binding, wgpu::ShaderStages::FRAGMENT, map)));
    let label = Some("views and shadow maps");
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries })
}

/// Attributes of the vertex buffer and of the instance buffer.
pub(super) const VERTEX_ATTRIBUTES: [&[wgpu::VertexAttribute]; 2] = {
    use wgpu::VertexFormat::{Float32, Float32x2, Float32x3, Float32x4, Uint32};
    const VERTEX: [wgpu::VertexAttribute; 4] = [
        attribute(0, Float32x3, offset_of!(Vertex, position)),
        attribute(1, Float32x3, offset_of!(Vertex, normal)),
        attribute(2, Float32x2, offset_of!(Vertex, texcoord)),
        attribute(11, Float32, offset_of!(Vertex, parity)),
    ];
    const INSTANCE: [wgpu::VertexAttribute; 10] = [
        attribute(3, Float32x4, offset_of!(Instance, rows)),
        attribute(4, Float32x4, offset_of!(Instance, rows) + 16),
        attribute(5, Float32x4, offset_of!(Instance, rows) + 32),
        attribute(6, Float32x4, offset_of!(Instance, rgba)),
        attribute(7, Float32x3, offset_of!(Instance, material)),
        attribute(8, Float32x4, offset_of!(Instance, texgen)),
        attribute(9, Uint32, offset_of!(Instance, id)),
        attribute(10, Float32x3, offset_of!(Instance, normal_scale)),
        attribute(12, Float32x3, offset_of!(Instance, texture_offset)),
        attribute(13, Uint32, offset_of!(Instance, view)),
    ];
    [&VERTEX, &INSTANCE]
};

const fn attribute(shader_location: u32, format: wgpu::VertexFormat, offset: usize) -> wgpu::VertexAttribute {
    wgpu::VertexAttribute { format, offset: offset as u64, shader_location }
}

/// Returns the layouts of the vertex buffers of a shader. `read` contains the attributes that the
/// shader reads.
pub(super) fn vertex_buffers(
    shader: ShaderKind,
    read: &[Vec<wgpu::VertexAttribute>; 2],
) -> Vec<Option<wgpu::VertexBufferLayout<'_>>> {
    use wgpu::VertexFormat::{Float32x2, Float32x4};
    const SKY: [wgpu::VertexAttribute; 2] = [attribute(0, Float32x4, 0), attribute(1, Float32x4, 16)];
    const LABEL: [wgpu::VertexAttribute; 4] = [
        attribute(0, Float32x4, 0),
        attribute(1, Float32x4, 16),
        attribute(2, Float32x4, 32),
        attribute(3, Float32x2, 48),
    ];
    let buffer = |size: usize, step_mode, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride: size as u64, step_mode, attributes })
    };
    match shader {
        ShaderKind::Surface | ShaderKind::Line | ShaderKind::Depth => vec![
            buffer(size_of::<Vertex>(), wgpu::VertexStepMode::Vertex, &read[0]),
            buffer(size_of::<Instance>(), wgpu::VertexStepMode::Instance, &read[1]),
        ],
        ShaderKind::Sky { .. } => vec![buffer(32, wgpu::VertexStepMode::Vertex, &SKY)],
        ShaderKind::Label => vec![buffer(56, wgpu::VertexStepMode::Instance, &LABEL)],
    }
}
