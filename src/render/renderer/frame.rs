//! Draw list, buffers and bind groups of one image, and the encoding of its render passes.

use super::assets::Assets;
use crate::error::Error;
use crate::render::assets::glyph_atlas;
use crate::render::draw_list::{AuxOutput, DrawList, DrawListInputs};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::pass::{
    AuxLayer, DrawContext, FrameInputs, Labels, MainPass, ShadowMaps, Sky, Target, TileDetail, TileSelection, draw_ids,
    draw_segment_colors,
};
use crate::render::shader::Shading;
use crate::render::view::{Lights, UniformData, ViewFrustum, ViewUniforms};
use crate::render::{Gpu, Lighting, RenderError};
use crate::scene::{RenderFlags, Scene};

/// Draw list, buffers and bind groups of one image.
pub(super) struct Frame {
    pub(super) list: DrawList,
    pub(super) shadow_maps: ShadowMaps,
    instances: GrowableBuffer,
    main_pass: MainPass,
    sky: Sky,
    labels: Labels,
    /// Uniform buffer and bind group of the view for auxiliary output.
    aux_uniform: GrowableBuffer,
    aux_view: Option<wgpu::BindGroup>,
    /// Set by the last preparation.
    view: Option<FrameView>,
}

/// View of a prepared frame.
struct FrameView {
    frustum: ViewFrustum,
    lights: Lights,
    flags: RenderFlags,
    aux: Option<AuxOutput>,
    size: [u32; 2],
}

/// Properties of the render target that a frame needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TargetNeeds {
    pub(super) samples: u32,
    /// The depth buffer has a stencil component.
    pub(super) stencil: bool,
}

impl Frame {
    pub(super) fn new(gpu: &Gpu, shadow_size: u32) -> Self {
        Self {
            list: DrawList::default(),
            shadow_maps: ShadowMaps::new(shadow_size),
            instances: GrowableBuffer::new(gpu, "instances", wgpu::BufferUsages::VERTEX),
            main_pass: MainPass::new(gpu),
            sky: Sky::new(gpu),
            labels: Labels::new(gpu),
            aux_uniform: GrowableBuffer::new(gpu, "uniforms of ids and depths", wgpu::BufferUsages::UNIFORM),
            aux_view: None,
            view: None,
        }
    }

    /// Prepares a colour image: the draw list, and uploads of instances and uniforms.
    pub(super) fn prepare_color(
        &mut self,
        assets: &mut Assets,
        scene: &Scene,
        size: [u32; 2],
        flip_y: bool,
    ) -> Result<(), RenderError> {
        let flags = scene.render_flags();
        let aux = flags.contains(RenderFlags::SEGMENT).then_some(if flags.contains(RenderFlags::IDCOLOR) {
            AuxOutput::IdColors
        } else {
            AuxOutput::SegmentColors
        });
        if aux.is_some() {
            return self.prepare_aux(assets, scene, size, aux, flip_y);
        }
        let (frustum, lights) = self.update_draw_list(assets, scene, size, None, flip_y)?;
        let Assets { gpu, settings, .. } = &*assets;
        let Self { list, shadow_maps, sky, labels, main_pass, .. } = self;
        shadow_maps.prepare(gpu, &frustum, &lights, list)?;
        sky.prepare(gpu, list, &frustum, settings, flags.contains(RenderFlags::HAZE))?;
        labels.prepare(gpu, scene, &frustum, size)?;
        if labels.count > 0 && labels.atlas.is_none() {
            labels.atlas = Some(glyph_atlas(gpu));
        }
        let view = self.view.insert(FrameView { frustum, lights, flags, aux, size });
        main_pass.prepare(gpu, &view.inputs(assets), list, shadow_maps)
    }

    /// Prepares auxiliary output: the draw list, and uploads of instances and uniforms.
    pub(super) fn prepare_aux(
        &mut self,
        assets: &mut Assets,
        scene: &Scene,
        size: [u32; 2],
        aux: Option<AuxOutput>,
        flip_y: bool,
    ) -> Result<(), RenderError> {
        let (frustum, lights) = self.update_draw_list(assets, scene, size, aux, flip_y)?;
        let Assets { gpu, settings, .. } = &*assets;
        let view = ViewUniforms::new(&frustum, settings, size, false);
        let is_stale = self.aux_uniform.write(gpu, UniformData::unlit(&view).bytes())?;
        if is_stale || self.aux_view.is_none() {
            self.aux_view = Some(gpu.pipelines().view_bind_group(gpu, &self.aux_uniform, &[]));
        }
        self.view = Some(FrameView { frustum, lights, flags: scene.render_flags(), aux, size });
        Ok(())
    }

    /// Updates the draw list and uploads its instances.
    fn update_draw_list(
        &mut self,
        assets: &mut Assets,
        scene: &Scene,
        size: [u32; 2],
        aux: Option<AuxOutput>,
        flip_y: bool,
    ) -> Result<(ViewFrustum, Lights), RenderError> {
        if scene.lineage() != assets.lineage {
            return Err(Error::OtherModel { what: "the scene to draw" }.into());
        }
        let frustum = ViewFrustum::new(scene, &scene.viewpoint(), size)?;
        let frustum = if flip_y { frustum.flipped() } else { frustum };
        let has_shadows = aux.is_none() && self.shadow_maps.is_enabled();
        let lights = Lights::new(scene, &frustum, &assets.settings, has_shadows, assets.options.max_lights);
        let Assets { gpu, shapes, textures, bounds, .. } = assets;
        let list = &mut self.list;
        if aux.is_some_and(AuxOutput::has_depth) {
            shapes.create_depth_levels(gpu)?;
        }
        shapes.update_flexes(gpu, scene)?;
        list.update(scene, &DrawListInputs { frustum: &frustum, lights: &lights, shapes, textures, bounds, aux });
        // The stencil mark of the mirror is the last instance.
        let stencil_mark = list.mirror.as_ref().and_then(|mirror| mirror.stencil_mark);
        list.instances.extend(stencil_mark.map(|(_, instance)| instance));
        self.instances.write(gpu, bytemuck::cast_slice(&list.instances))?;
        shapes.update_skins(gpu, scene, &frustum.pixel_rows(size));
        Ok((frustum, lights))
    }

    /// Returns the render target that the prepared colour image needs, with multisampling of
    /// `samples`.
    pub(super) fn target_needs(&self, samples: u32) -> TargetNeeds {
        let is_aux = self.view.as_ref().is_some_and(|view| view.aux.is_some());
        let stencil = self.list.mirror.as_ref().is_some_and(|mirror| mirror.stencil_mark.is_some());
        TargetNeeds { samples: if is_aux { 1 } else { samples }, stencil }
    }

    /// Makes the next preparation upload everything and clear all shadow maps. Required if commands
    /// may not have been executed.
    pub(super) fn invalidate(&mut self) {
        self.shadow_maps.invalidate();
        self.main_pass.invalidate();
        self.sky.invalidate();
        self.labels.buffer.invalidate();
        self.instances.invalidate();
        self.aux_uniform.invalidate();
    }

    /// Returns the number of texels of the allocated shadow maps.
    pub(super) fn shadow_texels(&self) -> u64 {
        let texels = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        self.shadow_maps.regions().iter().map(|region| texels(region.size)).sum()
    }

    /// Encodes the passes that precede the main pass.
    pub(super) fn encode_shadows(&mut self, encoder: &mut wgpu::CommandEncoder, assets: &Assets) {
        let Some(view) = &self.view else { return };
        if view.aux.is_none() {
            let draw = assets.draw_context(&self.instances);
            self.shadow_maps.encode(encoder, &draw, &self.list, view.flags);
        }
    }

    /// Draws the prepared colour image in a pass of the target.
    pub(super) fn draw_color(&mut self, pass: &mut wgpu::RenderPass<'_>, assets: &Assets, target: &Target) {
        let Self { list, shadow_maps, instances, main_pass, sky, labels, aux_view, view, .. } = self;
        let Some(view) = view else { return };
        let planes = view.frustum.planes();
        let detail = view.tile_detail(assets);
        let tiles = Some(TileSelection { planes: &planes, instances: &list.instances, detail });
        let draw = DrawContext { tiles, ..assets.draw_context(instances) };
        if view.aux.is_some() {
            let flips = [view.flags.contains(RenderFlags::CULL_FACE), view.frustum.flip_y];
            if let Some(aux_view) = aux_view {
                draw_segment_colors(pass, &draw, list, aux_view, target, flips);
            }
            return;
        }
        main_pass.draw(pass, &draw, &view.inputs(assets), list, (shadow_maps, sky, labels), target);
    }

    /// Draws the geom ids and depths of the prepared auxiliary output in a pass.
    pub(super) fn draw_ids(&self, pass: &mut wgpu::RenderPass<'_>, assets: &Assets, layer: AuxLayer) {
        if let (Some(view), Some(aux_view)) = (&self.view, &self.aux_view) {
            let planes = view.frustum.planes();
            let detail = view.tile_detail(assets);
            let tiles = Some(TileSelection { planes: &planes, instances: &self.list.instances, detail });
            let draw = DrawContext { tiles, ..assets.draw_context(&self.instances) };
            draw_ids(pass, &draw, &self.list, aux_view, (layer, view.flags.contains(RenderFlags::CULL_FACE)));
        }
    }
}

impl FrameView {
    /// Returns the level of detail of the tiles of large planes.
    fn tile_detail(&self, assets: &Assets) -> TileDetail<'_> {
        let is_lit_per_vertex = self.aux.is_none() && assets.options.lighting == Lighting::PerVertex;
        if self.aux.is_none() && self.flags.contains(RenderFlags::WIREFRAME) {
            TileDetail::Cells
        } else if is_lit_per_vertex {
            TileDetail::Lighting(&self.lights, self.frustum.position)
        } else {
            TileDetail::Blocks
        }
    }

    fn inputs<'a>(&'a self, assets: &'a Assets) -> FrameInputs<'a> {
        let shading = match assets.options.lighting {
            Lighting::PerPixel => Shading::Pixel,
            Lighting::PerVertex => Shading::Vertex,
        };
        let Self { frustum, lights, flags, size, .. } = self;
        FrameInputs { frustum, lights, settings: &assets.settings, size: *size, flags: *flags, shading }
    }
}
