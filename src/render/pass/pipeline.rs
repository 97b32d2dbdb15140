//! Programs with all that is set around them, made when they are first needed: to compile one takes as long as to draw a picture.

use std::borrow::Cow;
use std::collections::HashMap;
use std::mem::offset_of;

use super::Memory;
use super::target::depth_format;
use crate::render::Gpu;
use crate::render::content::Layouts;
use crate::render::frame::{LightKind, MOST_SHADOWS};
use crate::render::list::Instance;
use crate::render::shader::{Coat, Output, Program, Shade, Subject};
use crate::render::shape::Vertex;

/// For what something is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Step {
    /// To a shadow map.
    Shadow,
    /// To mark where the mirror is.
    Mark,
    /// As a mirror image, cut off at the mirror if need be.
    MirrorSolid {
        clip: bool,
    },
    MirrorClear {
        clip: bool,
    },
    /// As the mirror itself, added to the mirror images.
    Reflector,
    Solid,
    /// Transparent.
    Clear,
    Sky,
    Label,
    /// In one colour.
    Flat,
    /// As a number and a depth.
    Ids,
}

impl Step {
    /// Whether there are lights.
    fn is_lit(self) -> bool {
        matches!(
            self,
            Self::MirrorSolid { .. } | Self::MirrorClear { .. } | Self::Reflector | Self::Solid | Self::Clear
        )
    }
}

/// What a pipeline is made for.
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Key {
    pub(crate) step: Step,
    pub(crate) coat: Coat,
    pub(crate) line: bool,
    /// Whether backs are seen, and not fronts.
    pub(crate) back: bool,
    /// The number of the lights that [`Pipelines::lights`] gave.
    pub(crate) lights: u32,
    pub(crate) shade: Shade,
    pub(crate) fog: bool,
    /// Whether one side of surfaces is left out.
    pub(crate) culls: bool,
    /// Whether only edges are drawn.
    pub(crate) wire: bool,
    /// Whether what is transparent is added.
    pub(crate) additive: bool,
    pub(crate) format: wgpu::TextureFormat,
    pub(crate) samples: u32,
    pub(crate) stencil: bool,
    /// Whether the picture is upside down.
    pub(crate) turned: bool,
}

impl Key {
    /// One for shapes alone: without light, pictures, fog and samples. `culls`: whether one side of surfaces is left out; `turned`: whether
    /// the picture is upside down.
    pub(crate) fn plain(step: Step, format: wgpu::TextureFormat, [culls, turned]: [bool; 2]) -> Self {
        Self {
            step,
            coat: Coat::Plain,
            line: false,
            back: false,
            lights: 0,
            shade: Shade::None,
            fog: false,
            culls,
            wire: false,
            additive: false,
            format,
            samples: 1,
            stencil: false,
            turned,
        }
    }
}

/// All that were made.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) layouts: Layouts,
    /// Those of views, by the number of shadow maps.
    views: Vec<wgpu::BindGroupLayout>,
    lights: Vec<Vec<LightKind>>,
    made: HashMap<Key, wgpu::RenderPipeline>,
}

/// So many are kept. A scene needs ten or so; more come from lights that are switched and from windows that come and go.
const MOST: usize = 256;

impl Pipelines {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let views = (0..=MOST_SHADOWS).map(|shadows| view_layout(gpu, shadows)).collect();
        Self { layouts: Layouts::new(gpu), views, lights: Vec::new(), made: HashMap::new() }
    }

    /// The number of lights of such kinds.
    pub(crate) fn lights(&mut self, kinds: impl Iterator<Item = LightKind> + Clone) -> u32 {
        if let Some(index) = self.lights.iter().position(|lights| lights.iter().copied().eq(kinds.clone())) {
            return index as u32;
        }
        if self.made.len() > MOST {
            // Numbers that were given stay as they are; what was made with them is made again.
            self.made.clear();
        }
        self.lights.push(kinds.collect());
        self.lights.len() as u32 - 1
    }

    /// How a view with so many shadow maps is bound.
    fn view(&self, shadows: usize) -> &wgpu::BindGroupLayout {
        &self.views[shadows]
    }

    /// What a view's programs read: its numbers, and the shadow maps of its lights.
    pub(crate) fn group(&self, gpu: &Gpu, uniform: &Memory, maps: &[&wgpu::TextureView]) -> wgpu::BindGroup {
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: uniform.buffer().as_entire_binding() }];
        entries.extend(
            maps.iter().zip(1..).map(|(map, binding)| wgpu::BindGroupEntry {
                binding,
                resource: wgpu::BindingResource::TextureView(map),
            }),
        );
        let layout = self.view(maps.len());
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// The pipeline for a key.
    pub(crate) fn get(&mut self, gpu: &Gpu, key: Key) -> &wgpu::RenderPipeline {
        if !self.made.contains_key(&key) {
            let pipeline = self.make(gpu, &key);
            self.made.insert(key, pipeline);
        }
        &self.made[&key]
    }

    fn make(&self, gpu: &Gpu, key: &Key) -> wgpu::RenderPipeline {
        let parts = Parts::new(key);
        // A line is bound as the surfaces around it are.
        let bound: &[LightKind] = if key.step.is_lit() { &self.lights[key.lights as usize] } else { &[] };
        let lights: &[LightKind] = if parts.lit { bound } else { &[] };
        let program = Program {
            subject: parts.subject,
            output: parts.output,
            coat: key.coat,
            shade: key.shade,
            lights,
            fog: key.fog,
            clip: matches!(key.step, Step::MirrorSolid { clip: true } | Step::MirrorClear { clip: true }),
        };
        let device = gpu.device();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(program.source())),
        });
        let shadows = bound.iter().filter(|light| light.shadow).count();
        let picture = match parts.subject {
            Subject::Sky => Some(&self.layouts.cube),
            Subject::Label => Some(&self.layouts.flat),
            _ => match key.coat {
                Coat::Plain => None,
                Coat::Flat => Some(&self.layouts.flat),
                Coat::Cube => Some(&self.layouts.cube),
            },
        };
        let layouts = [Some(self.view(shadows)), picture];
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts[..=usize::from(picture.is_some())],
            immediate_size: 0,
        });
        let targets = [Some(wgpu::ColorTargetState {
            format: key.format,
            blend: parts.blend,
            write_mask: if key.step == Step::Mark { wgpu::ColorWrites::empty() } else { wgpu::ColorWrites::ALL },
        })];
        let fragment = (parts.output != Output::Nothing).then(|| wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        });
        let mut attributes = ATTRIBUTES.map(<[_]>::to_vec);
        for of_buffer in &mut attributes {
            of_buffer.retain(|attribute| program.reads(attribute.shader_location));
        }
        let buffers = vertex_buffers(parts.subject, &attributes);
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: parts.primitive,
            depth_stencil: Some(parts.depth_stencil),
            multisample: wgpu::MultisampleState { count: key.samples, ..Default::default() },
            fragment,
            multiview_mask: None,
            cache: None,
        })
    }
}

/// What of a pipeline follows from its key.
struct Parts {
    subject: Subject,
    output: Output,
    lit: bool,
    blend: Option<wgpu::BlendState>,
    primitive: wgpu::PrimitiveState,
    depth_stencil: wgpu::DepthStencilState,
}

impl Parts {
    fn new(key: &Key) -> Self {
        let (subject, output) = match key.step {
            Step::Shadow => (Subject::Depth, Output::Nothing),
            Step::Mark => (Subject::Depth, Output::Color),
            Step::Sky => (Subject::Sky, Output::Color),
            Step::Label => (Subject::Label, Output::Color),
            Step::Ids => (if key.line { Subject::Line } else { Subject::Surface }, Output::Ids),
            _ => (if key.line { Subject::Line } else { Subject::Surface }, Output::Color),
        };
        let lit = subject == Subject::Surface && output == Output::Color && key.shade != Shade::None;
        Self { subject, output, lit, blend: blend(key), primitive: primitive(key, subject), depth_stencil: depth(key) }
    }
}

fn blend(key: &Key) -> Option<wgpu::BlendState> {
    use wgpu::BlendFactor::{One, OneMinusSrcAlpha, SrcAlpha, Zero};
    let (src_factor, dst_factor) = match key.step {
        Step::Reflector => (One, One),
        Step::Clear | Step::MirrorClear { .. } if key.additive => (SrcAlpha, One),
        Step::Clear | Step::MirrorClear { .. } | Step::Sky | Step::Label => (SrcAlpha, OneMinusSrcAlpha),
        _ => return None,
    };
    let operation = wgpu::BlendOperation::Add;
    Some(wgpu::BlendState {
        color: wgpu::BlendComponent { src_factor, dst_factor, operation },
        // A picture has no opacity of its own.
        alpha: wgpu::BlendComponent { src_factor: Zero, dst_factor: One, operation },
    })
}

fn primitive(key: &Key, subject: Subject) -> wgpu::PrimitiveState {
    use wgpu::Face::{Back, Front};
    // What is in a mirror is upside down.
    let is_turned = key.turned != matches!(key.step, Step::MirrorSolid { .. } | Step::MirrorClear { .. });
    let hidden = match key.step {
        // Fronts cast no shadows, so that they are not in their own.
        Step::Shadow | Step::Sky => Some(Front),
        Step::Label => None,
        _ if key.line => None,
        _ => Some(if key.back { Front } else { Back }),
    };
    let is_wire = key.wire && subject == Subject::Surface;
    wgpu::PrimitiveState {
        topology: if subject == Subject::Label {
            wgpu::PrimitiveTopology::TriangleStrip
        } else {
            wgpu::PrimitiveTopology::TriangleList
        },
        front_face: if is_turned { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
        cull_mode: hidden.filter(|_| key.culls),
        polygon_mode: if is_wire { wgpu::PolygonMode::Line } else { wgpu::PolygonMode::Fill },
        ..Default::default()
    }
}

fn depth(key: &Key) -> wgpu::DepthStencilState {
    let is_last = matches!(key.step, Step::Mark | Step::Label);
    let is_clear = matches!(key.step, Step::Clear | Step::MirrorClear { .. });
    let face = |compare, pass_op| wgpu::StencilFaceState {
        compare,
        fail_op: wgpu::StencilOperation::Keep,
        depth_fail_op: wgpu::StencilOperation::Keep,
        pass_op,
    };
    let face = match key.step {
        _ if !key.stencil => wgpu::StencilFaceState::IGNORE,
        Step::Mark => face(wgpu::CompareFunction::Always, wgpu::StencilOperation::Replace),
        Step::MirrorSolid { .. } | Step::MirrorClear { .. } => {
            face(wgpu::CompareFunction::Equal, wgpu::StencilOperation::Keep)
        }
        _ => wgpu::StencilFaceState::IGNORE,
    };
    wgpu::DepthStencilState {
        format: depth_format(key.stencil),
        depth_write_enabled: Some(!is_last && !is_clear),
        depth_compare: Some(if is_last { wgpu::CompareFunction::Always } else { wgpu::CompareFunction::LessEqual }),
        stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xFF, write_mask: 0xFF },
        bias: wgpu::DepthBiasState::default(),
    }
}

/// How a view is bound: its uniforms, and so many shadow maps.
fn view_layout(gpu: &Gpu, shadows: usize) -> wgpu::BindGroupLayout {
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    // Depths are read as plain numbers: to compare them is left to the program, on every kind of adapter.
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
    let mut entries = vec![entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, uniform)];
    entries.extend((1..=shadows).map(|binding| entry(binding, wgpu::ShaderStages::FRAGMENT, map)));
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

/// What the buffers of corners and of instances have in them.
const ATTRIBUTES: [&[wgpu::VertexAttribute]; 2] = {
    use wgpu::VertexFormat::{Float32x2, Float32x3, Float32x4, Uint32};
    const CORNER: [wgpu::VertexAttribute; 3] = [
        at(0, Float32x3, offset_of!(Vertex, position)),
        at(1, Float32x3, offset_of!(Vertex, normal)),
        at(2, Float32x2, offset_of!(Vertex, texcoord)),
    ];
    const INSTANCE: [wgpu::VertexAttribute; 7] = [
        at(3, Float32x4, offset_of!(Instance, rows)),
        at(4, Float32x4, offset_of!(Instance, rows) + 16),
        at(5, Float32x4, offset_of!(Instance, rows) + 32),
        at(6, Float32x4, offset_of!(Instance, rgba)),
        at(7, Float32x4, offset_of!(Instance, material)),
        at(8, Float32x4, offset_of!(Instance, texgen)),
        at(9, Uint32, offset_of!(Instance, id)),
    ];
    [&CORNER, &INSTANCE]
};

const fn at(shader_location: u32, format: wgpu::VertexFormat, offset: usize) -> wgpu::VertexAttribute {
    wgpu::VertexAttribute { format, offset: offset as u64, shader_location }
}

/// The buffers of corners and of instances, of which so much is read, of the sky, or of letters.
fn vertex_buffers(
    subject: Subject,
    read: &[Vec<wgpu::VertexAttribute>; 2],
) -> Vec<Option<wgpu::VertexBufferLayout<'_>>> {
    use wgpu::VertexFormat::{Float32x2, Float32x4};
    const SKY: [wgpu::VertexAttribute; 2] = [at(0, Float32x4, 0), at(1, Float32x4, 16)];
    const LABEL: [wgpu::VertexAttribute; 4] =
        [at(0, Float32x4, 0), at(1, Float32x4, 16), at(2, Float32x4, 32), at(3, Float32x2, 48)];
    let buffer = |size: usize, step_mode, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride: size as u64, step_mode, attributes })
    };
    let corner = |attributes| buffer(size_of::<Vertex>(), wgpu::VertexStepMode::Vertex, attributes);
    match subject {
        Subject::Surface | Subject::Line | Subject::Depth => {
            vec![corner(&read[0]), buffer(size_of::<Instance>(), wgpu::VertexStepMode::Instance, &read[1])]
        }
        Subject::Sky => vec![buffer(32, wgpu::VertexStepMode::Vertex, &SKY)],
        Subject::Label => vec![buffer(56, wgpu::VertexStepMode::Instance, &LABEL)],
    }
}
