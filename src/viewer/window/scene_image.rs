//! Image of the scene on the GPU, from which the window copies it while only the panels change.

use crate::render::{Gpu, RenderError};

/// Colour of the window where the scene is not drawn: the background of the side panels, which have no other.
const EMPTY: wgpu::Color = wgpu::Color { r: 0.094, g: 0.102, b: 0.122, a: 1.0 };

/// Draws the texture pixel by pixel into the viewport whose upper left corner is `origin`.
const SHADER: &str = "
@group(0) @binding(0) var image: texture_2d<f32>;

struct Vertex {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    return Vertex(vec4f(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0), corner);
}

@fragment
fn fragment(vertex: Vertex) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(image));
    return textureLoad(image, vec2u(vertex.uv * size), 0);
}
";

/// Area of the window that shows the scene, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PictureArea {
    /// Upper left corner.
    pub origin: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// Pipeline that copies images of one format to a window.
pub(super) struct ImageCopier {
    pipeline: wgpu::RenderPipeline,
    format: wgpu::TextureFormat,
}

/// Image of the scene.
pub(super) struct SceneImage {
    view: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
    size: [u32; 2],
}

impl ImageCopier {
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, RenderError> {
        let device = gpu.device();
        gpu.guarded(|| {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("scene image"),
                source: wgpu::ShaderSource::Wgsl(SHADER.into()),
            });
            let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("scene image"),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: None,
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: None,
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            });
            Ok(Self { pipeline, format })
        })
    }

    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Creates an image of this size.
    pub fn image(&self, gpu: &Gpu, [width, height]: [u32; 2]) -> Result<SceneImage, RenderError> {
        let device = gpu.device();
        gpu.guarded(|| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("scene image"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: self.format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("scene image"),
                layout: &self.pipeline.get_bind_group_layout(0),
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) }],
            });
            Ok(SceneImage { view, bind_group, size: [width, height] })
        })
    }

    /// Clears the window and copies an image of the area's size to the area.
    pub fn copy(&self, gpu: &Gpu, image: &SceneImage, target: &wgpu::TextureView, area: PictureArea) {
        debug_assert_eq!(image.size, area.size);
        draw(gpu, target, |pass| {
            let [x, y, width, height] =
                [area.origin[0], area.origin[1], area.size[0], area.size[1]].map(|pixels| pixels as f32);
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
            pass.set_scissor_rect(area.origin[0], area.origin[1], area.size[0], area.size[1]);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &image.bind_group, &[]);
            pass.draw(0..3, 0..1);
        });
    }
}

impl SceneImage {
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    pub fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// Clears the window.
pub(super) fn clear(gpu: &Gpu, target: &wgpu::TextureView) {
    draw(gpu, target, |_| ());
}

/// Clears the window and draws to it.
fn draw(gpu: &Gpu, target: &wgpu::TextureView, commands: impl FnOnce(&mut wgpu::RenderPass<'_>)) {
    let mut encoder =
        gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("scene image") });
    commands(&mut encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("scene image"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(EMPTY), store: wgpu::StoreOp::Store },
        })],
        ..wgpu::RenderPassDescriptor::default()
    }));
    gpu.queue().submit([encoder.finish()]);
}
