//! Cache of render pipelines, created on first use and shared by all renderers of a [`Gpu`]:
//! compiling a shader takes as long as rendering a frame.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use super::pipeline_state::{PipelineState, VERTEX_ATTRIBUTES, vertex_buffers, view_layout};
use crate::render::Gpu;
use crate::render::assets::TextureBindings;
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::shader::{Output, ShaderKind, ShaderVariant, Shading, TextureKind};
use crate::render::view::{LightFeatures, MAX_SHADOWS};

/// Purpose of a draw call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum PassKind {
    /// Depth in a shadow map.
    Shadow,
    /// Mark of the mirror in the stencil buffer.
    MirrorStencil,
    /// Mirror image of an opaque geom, optionally clipped at the plane of the mirror.
    MirrorOpaque {
        clip: bool,
    },
    /// Mirror image of a transparent geom.
    MirrorTransparent {
        clip: bool,
    },
    /// Reflective geom, blended additively over the mirror images.
    Reflector,
    Opaque,
    Transparent,
    /// Skybox, optionally with haze, which is blended.
    Sky {
        haze: bool,
    },
    Label,
    /// Segmentation colour.
    FlatColor,
    /// Geom id and depth.
    Ids,
}

impl PassKind {
    /// Returns `true` for transparent geoms, whose colours are blended by their opacity.
    pub(super) fn is_transparent(self) -> bool {
        matches!(self, Self::Transparent | Self::MirrorTransparent { .. })
    }

    /// Returns `true` if the view of the pass contains lights.
    fn has_lights(self) -> bool {
        matches!(
            self,
            Self::MirrorOpaque { .. }
                | Self::MirrorTransparent { .. }
                | Self::Reflector
                | Self::Opaque
                | Self::Transparent
        )
    }
}

/// Lines that a pipeline draws instead of filled triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Wireframe {
    /// Filled triangles.
    Off,
    /// All edges of the triangles.
    Triangles,
    /// The edges of the quadrilaterals, without their diagonals.
    Quads,
}

/// Parameters for which a pipeline is created.
#[allow(clippy::struct_excessive_bools, reason = "each is an independent switch")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    pub(crate) pass_kind: PassKind,
    pub(crate) texture_kind: TextureKind,
    pub(crate) line: bool,
    /// Front faces are culled instead of back faces.
    pub(crate) back_faces: bool,
    /// Index of the light set, from [`Pipelines::light_set`].
    pub(crate) light_set: u32,
    pub(crate) shading: Shading,
    pub(crate) fog: bool,
    /// Face culling is enabled.
    pub(crate) cull: bool,
    pub(crate) wireframe: Wireframe,
    /// Transparent geoms are blended additively.
    pub(crate) additive: bool,
    pub(crate) format: wgpu::TextureFormat,
    pub(crate) samples: u32,
    pub(crate) stencil: bool,
    /// The frame is rendered upside down.
    pub(crate) flip_y: bool,
    /// Several images are drawn together, whose views are in an array: number of vectors of four
    /// numbers in a view.
    pub(crate) vectors: Option<u32>,
}

impl PipelineKey {
    /// Returns `true` if only the triangles that face the camera are visible: not in shadow maps
    /// and mirror images, which have other viewpoints.
    pub(super) fn draws_front_faces(&self) -> bool {
        use PassKind::{FlatColor, Ids, Opaque, Transparent};
        self.cull && !self.back_faces && matches!(self.pass_kind, Opaque | Transparent | FlatColor | Ids)
    }

    /// Returns a key without lighting, texture, fog and multisampling.
    pub(crate) fn untextured(pass_kind: PassKind, format: wgpu::TextureFormat, cull: bool, flip_y: bool) -> Self {
        Self {
            pass_kind,
            texture_kind: TextureKind::None,
            line: false,
            back_faces: false,
            light_set: 0,
            shading: Shading::None,
            fog: false,
            cull,
            wireframe: Wireframe::Off,
            additive: false,
            format,
            samples: 1,
            stencil: false,
            flip_y,
            vectors: None,
        }
    }
}

/// Render pipelines and their layouts.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) textures: TextureBindings,
    /// Bind group layouts of a view and of an array of views, by the number of shadow maps.
    view_layouts: [Vec<wgpu::BindGroupLayout>; 2],
    cache: RwLock<Cache>,
}

#[derive(Debug, Default)]
struct Cache {
    light_sets: Vec<Vec<LightFeatures>>,
    pipelines: HashMap<PipelineKey, wgpu::RenderPipeline>,
}

/// Maximum size of the cache. A scene needs about ten pipelines; further ones result from other
/// scenes, toggled lights and other windows.
const MAX_PIPELINES: usize = 1024;

impl Pipelines {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layouts = |ty| (0..=MAX_SHADOWS).map(|shadows| view_layout(gpu, ty, shadows)).collect();
        // Not every adapter has storage buffers.
        let arrays = gpu.can_merge().then(|| layouts(wgpu::BufferBindingType::Storage { read_only: true }));
        let view_layouts = [layouts(wgpu::BufferBindingType::Uniform), arrays.unwrap_or_default()];
        Self { textures: TextureBindings::new(gpu), view_layouts, cache: RwLock::default() }
    }

    /// Returns the index of a set of light features.
    pub(crate) fn light_set(&self, features: impl Iterator<Item = LightFeatures> + Clone) -> u32 {
        if let Some(index) = self.cached().light_set(&features) {
            return index;
        }
        let mut cache = self.cached_mut();
        // Another thread may have added the set since.
        if let Some(index) = cache.light_set(&features) {
            return index;
        }
        cache.light_sets.push(features.collect());
        cache.light_sets.len() as u32 - 1
    }

    /// Creates the bind group of a view, or of an array of views: its buffer and shadow maps.
    pub(crate) fn view_bind_group(
        &self,
        gpu: &Gpu,
        views: &GrowableBuffer,
        shadow_maps: &[&wgpu::TextureView],
    ) -> wgpu::BindGroup {
        let buffer = views.buffer();
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }];
        entries.extend(
            shadow_maps.iter().zip(1..).map(|(map, binding)| wgpu::BindGroupEntry {
                binding,
                resource: wgpu::BindingResource::TextureView(map),
            }),
        );
        let is_array = buffer.usage().contains(wgpu::BufferUsages::STORAGE);
        let layout = &self.view_layouts[usize::from(is_array)][shadow_maps.len()];
        let label = Some("uniforms and shadow maps of a view");
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
    }

    /// Returns the pipeline for a key. Threads that need a new pipeline wait for each other, so
    /// that none is created twice.
    pub(crate) fn get(&self, gpu: &Gpu, key: PipelineKey) -> wgpu::RenderPipeline {
        if let Some(pipeline) = self.cached().pipelines.get(&key) {
            return pipeline.clone();
        }
        let mut cache = self.cached_mut();
        if let Some(pipeline) = cache.pipelines.get(&key) {
            return pipeline.clone();
        }
        if cache.pipelines.len() >= MAX_PIPELINES {
            // Indices of light sets remain valid; their pipelines are created again.
            cache.pipelines.clear();
        }
        let pipeline = self.create(gpu, &key, &cache.light_sets);
        cache.pipelines.insert(key, pipeline.clone());
        pipeline
    }

    /// Removes all pipelines, because an error, such as a lack of memory, may have left an invalid
    /// one.
    pub(crate) fn clear(&self) {
        self.cached_mut().pipelines.clear();
    }

    fn cached(&self) -> RwLockReadGuard<'_, Cache> {
        self.cache.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn cached_mut(&self) -> RwLockWriteGuard<'_, Cache> {
        self.cache.write().unwrap_or_else(PoisonError::into_inner)
    }

    fn create(&self, gpu: &Gpu, key: &PipelineKey, light_sets: &[Vec<LightFeatures>]) -> wgpu::RenderPipeline {
        let state = PipelineState::new(gpu, key);
        // Unlit shapes of a lit pass, such as lines, use the same bind group of the view.
        let bound: &[LightFeatures] =
            if key.pass_kind.has_lights() { &light_sets[key.light_set as usize] } else { &[] };
        let mut shader = ShaderVariant {
            kind: state.shader,
            output: state.output,
            texture_kind: key.texture_kind,
            shading: key.shading,
            lights: bound,
            fog: key.fog,
            blended: key.pass_kind.is_transparent(),
            quad_edges: key.wireframe == Wireframe::Quads,
            clip: matches!(
                key.pass_kind,
                PassKind::MirrorOpaque { clip: true } | PassKind::MirrorTransparent { clip: true }
            ),
            aliased: key.samples == 1,
            vectors: key.vectors,
        };
        if !shader.has_lights() {
            shader.lights = &[];
        }
        let label = format!("{:?}", key.pass_kind);
        let label = Some(label.as_str());
        let device = gpu.device();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(shader.source())),
        });
        let shadows = bound.iter().filter(|light| light.shadow).count();
        let texture_layout = match (state.shader, key.texture_kind) {
            (ShaderKind::Sky { .. }, _) => Some(&self.textures.cube),
            (ShaderKind::Label, _) | (_, TextureKind::D2) => Some(&self.textures.d2),
            (_, TextureKind::None) => None,
            (_, TextureKind::Cube) => Some(&self.textures.cube),
        };
        let layouts = [Some(&self.view_layouts[usize::from(key.vectors.is_some())][shadows]), texture_layout];
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &layouts[..=usize::from(texture_layout.is_some())],
            immediate_size: 0,
        });
        let targets =
            [Some(wgpu::ColorTargetState { format: key.format, blend: state.blend, write_mask: state.color_writes })];
        let fragment = (state.output != Output::DepthOnly).then(|| wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs_main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        });
        let mut attributes = VERTEX_ATTRIBUTES.map(<[_]>::to_vec);
        for of_buffer in &mut attributes {
            of_buffer.retain(|attribute| shader.reads(attribute.shader_location));
        }
        let buffers = vertex_buffers(state.shader, &attributes);
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: state.primitive,
            depth_stencil: Some(state.depth_stencil),
            multisample: wgpu::MultisampleState { count: key.samples, ..Default::default() },
            fragment,
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Cache {
    fn light_set(&self, features: &(impl Iterator<Item = LightFeatures> + Clone)) -> Option<u32> {
        let index = self.light_sets.iter().position(|set| set.iter().copied().eq(features.clone()));
        index.map(|index| index as u32)
    }
}
