//! Draw list, buffers and bind groups of one image, and the encoding of its render passes.

use super::assets::Assets;
use crate::error::Error;
use crate::render::draw_list::{AuxOutput, DrawList, DrawListInputs};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::pass::{
    AuxLayer, FrameInputs, Labels, MainPass, ShadowMaps, ShadowTextures, Sky, Target, TileDetail, TileView, ViewInputs,
    draw_ids, draw_segment_colors,
};
use crate::render::shader::Shading;
use crate::render::view::{LightFeatures, Lights, Place, ShadowRegion, UniformData, ViewFrustum, ViewUniforms};
use crate::render::{Gpu, Lighting, RenderError};
use crate::scene::{RenderFlags, Scene};

/// Draw list, buffers and bind groups of one image.
pub(super) struct Frame {
    pub(super) list: DrawList,
    pub(super) shadow_maps: ShadowMaps,
    instances: GrowableBuffer,
    main_pass: MainPass,
    pub(super) sky: Sky,
    pub(super) labels: Labels,
    /// Uniform buffer and bind group of the view for auxiliary output.
    aux_uniform: GrowableBuffer,
    aux_view: Option<wgpu::BindGroup>,
    /// Set by the last preparation.
    pub(super) view: Option<FrameView>,
}

/// View of a prepared frame.
pub(super) struct FrameView {
    pub(super) frustum: ViewFrustum,
    pub(super) lights: Lights,
    pub(super) features: Vec<LightFeatures>,
    /// Regions that the shadow maps must have.
    pub(super) regions: Vec<ShadowRegion>,
    pub(super) flags: RenderFlags,
    pub(super) aux: Option<AuxOutput>,
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
            main_pass: MainPass::new(gpu, false),
            sky: Sky::new(gpu),
            labels: Labels::new(gpu),
            aux_uniform: GrowableBuffer::new(gpu, "uniforms of ids and depths", wgpu::BufferUsages::UNIFORM),
            aux_view: None,
            view: None,
        }
    }

    /// Prepares an image: its view, draw list and sky. `aux` is `None` for colours, which are those
    /// of segments if the scene asks for them.
    pub(super) fn prepare(
        &mut self,
        assets: &mut Assets,
        scene: &Scene,
        size: [u32; 2],
        aux: Option<AuxOutput>,
        flip_y: bool,
    ) -> Result<(), RenderError> {
        let flags = scene.render_flags();
        let colors = if flags.contains(RenderFlags::IDCOLOR) { AuxOutput::IdColors } else { AuxOutput::SegmentColors };
        let aux = aux.or(flags.contains(RenderFlags::SEGMENT).then_some(colors));
        self.update(assets, scene, size, aux, flip_y)?;
        let (Assets { gpu, settings, options, .. }, Self { list, sky, labels, view: Some(view), .. }) =
            (&*assets, self)
        else {
            return Ok(());
        };
        if aux.is_none() {
            sky.prepare(gpu, list, &view.frustum, settings, flags.contains(RenderFlags::HAZE))?;
            labels.prepare(gpu, scene, &view.frustum, size, options.font_scale)?;
        }
        Ok(())
    }

    /// Updates the view and the draw list.
    fn update(
        &mut self,
        assets: &mut Assets,
        scene: &Scene,
        size: [u32; 2],
        aux: Option<AuxOutput>,
        flip_y: bool,
    ) -> Result<(), RenderError> {
        if scene.lineage() != assets.lineage {
            return Err(Error::OtherModel { what: "the scene to draw" }.into());
        }
        let frustum = ViewFrustum::new(scene, &scene.viewpoint(), size)?;
        let frustum = if flip_y { frustum.flipped() } else { frustum };
        let has_shadows = aux.is_none() && self.shadow_maps.is_enabled();
        let lights = Lights::new(scene, &frustum, &assets.settings, has_shadows, assets.options.max_lights);
        let Assets { gpu, shapes, textures, bounds, .. } = assets;
        if aux.is_some_and(AuxOutput::has_depth) {
            shapes.create_depth_levels(gpu)?;
        }
        shapes.update_flexes(gpu, scene)?;
        let list = &mut self.list;
        list.update(scene, &DrawListInputs { frustum: &frustum, lights: &lights, shapes, textures, bounds, aux });
        shapes.update_skins(gpu, scene, &frustum.pixel_rows(size));
        let regions = self.shadow_maps.required_regions(&frustum, &lights, list).collect();
        let features = lights.features().collect();
        self.view = Some(FrameView { frustum, lights, features, regions, flags: scene.render_flags(), aux, size });
        Ok(())
    }

    /// Uploads the instances and the view of the prepared image, and allocates its shadow maps.
    pub(super) fn upload(&mut self, assets: &Assets) -> Result<(), RenderError> {
        let Self { list, shadow_maps, instances, main_pass, sky, aux_uniform, aux_view, view, .. } = self;
        let (Assets { gpu, settings, .. }, Some(view)) = (assets, view) else { return Ok(()) };
        instances.write(gpu, bytemuck::cast_slice(&list.calls.instances))?;
        if view.aux.is_some() {
            let uniforms = ViewUniforms::new(&view.frustum, settings, view.size, false);
            if aux_uniform.write(gpu, UniformData::unlit(&uniforms).bytes())? || aux_view.is_none() {
                *aux_view = Some(gpu.pipelines().view_bind_group(gpu, aux_uniform, &[]));
            }
            return Ok(());
        }
        shadow_maps.prepare(gpu, &view.lights, list, &view.regions)?;
        let inputs = view.of_image(list, sky, shadow_maps.regions(), Place::WHOLE);
        let maps: Vec<_> = shadow_maps.views().collect();
        let shadows = ShadowTextures { views: &maps, size: shadow_maps.size(), version: shadow_maps.version() };
        main_pass.prepare(gpu, &view.of_pass(assets, &view.features), &[inputs], &shadows)
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

    /// Returns the number of texels that the shadow maps need.
    pub(super) fn shadow_texels(&self) -> u64 {
        let texels = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        self.view.iter().flat_map(|view| &view.regions).map(|region| texels(region.size)).sum()
    }

    /// Encodes the passes that precede the main pass.
    pub(super) fn encode_shadows(&mut self, encoder: &mut wgpu::CommandEncoder, assets: &Assets) {
        let Some(view) = &self.view else { return };
        if view.aux.is_none() {
            let draw = assets.draw_context(&self.list.calls, &self.instances, None);
            self.shadow_maps.encode(encoder, &draw, view.flags);
        }
    }

    /// Draws the prepared colour image in a pass of the target.
    pub(super) fn draw_color(&mut self, pass: &mut wgpu::RenderPass<'_>, assets: &Assets, target: &Target) {
        let Self { list, shadow_maps, instances, main_pass, sky, labels, aux_view, view, .. } = self;
        let Some(view) = view else { return };
        let tile_views = [view.tiles(assets)];
        let draw = assets.draw_context(&list.calls, instances, Some(&tile_views));
        if view.aux.is_some() {
            let flips = [view.flags.contains(RenderFlags::CULL_FACE), view.frustum.flip_y];
            if let Some(aux_view) = aux_view {
                draw_segment_colors(pass, &draw, aux_view, target, flips);
            }
            return;
        }
        let inputs = view.of_image(list, sky, shadow_maps.regions(), Place::WHOLE);
        let maps: Vec<_> = shadow_maps.views().collect();
        let frame = view.of_pass(assets, &view.features);
        main_pass.draw(pass, &draw, &frame, &[inputs], (&maps, labels), target);
    }

    /// Draws the geom ids and depths of the prepared auxiliary output in a pass.
    pub(super) fn draw_ids(&self, pass: &mut wgpu::RenderPass<'_>, assets: &Assets, layer: AuxLayer) {
        if let (Some(view), Some(aux_view)) = (&self.view, &self.aux_view) {
            let tile_views = [view.tiles(assets)];
            let draw = assets.draw_context(&self.list.calls, &self.instances, Some(&tile_views));
            draw_ids(pass, &draw, (aux_view, None), (layer, view.flags.contains(RenderFlags::CULL_FACE)));
        }
    }
}

impl FrameView {
    /// Returns the view in which tiles of large planes are visible, and their level of detail.
    pub(super) fn tiles(&self, assets: &Assets) -> TileView<'_> {
        let is_lit_per_vertex = self.aux.is_none() && assets.options.lighting == Lighting::PerVertex;
        let detail = if self.aux.is_none() && self.flags.contains(RenderFlags::WIREFRAME) {
            TileDetail::Cells
        } else if is_lit_per_vertex {
            TileDetail::Lighting(&self.lights, self.frustum.position)
        } else {
            TileDetail::Blocks
        };
        TileView { planes: self.frustum.planes(), detail }
    }

    /// Returns the inputs of a main pass with lights of these features.
    pub(super) fn of_pass<'a>(&self, assets: &'a Assets, features: &'a [LightFeatures]) -> FrameInputs<'a> {
        let shading = match assets.options.lighting {
            Lighting::PerPixel => Shading::Pixel,
            Lighting::PerVertex => Shading::Vertex,
        };
        FrameInputs { settings: &assets.settings, features, size: self.size, flags: self.flags, shading }
    }

    /// Returns the inputs of its image in a main pass.
    pub(super) fn of_image<'a>(
        &'a self,
        list: &'a DrawList,
        sky: &'a Sky,
        regions: &'a [ShadowRegion],
        place: Place,
    ) -> ViewInputs<'a> {
        let Self { frustum, lights, .. } = self;
        ViewInputs { frustum, lights, mirror: list.mirror.as_ref(), sky, regions, place }
    }
}
