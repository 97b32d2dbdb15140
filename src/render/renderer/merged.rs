//! Images of several scenes that are drawn together: one draw call shows a shape in all of them.

use super::assets::Assets;
use super::frame::{Frame, FrameView};
use super::layout::Tiles;
use crate::render::draw_list::{AuxOutput, DrawCalls, merge};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::pass::{AuxLayer, MainPass, ShadowAtlas, ShadowTextures, Target, ViewInputs, draw_ids};
use crate::render::view::{LightFeatures, ShadowRegion, UniformData, ViewUniforms};
use crate::render::{Gpu, RenderError};
use crate::scene::RenderFlags;

/// Draw calls, buffers and bind groups of images that are drawn together.
pub(super) struct Merged {
    calls: DrawCalls,
    instances: GrowableBuffer,
    main_pass: MainPass,
    atlas: ShadowAtlas,
    /// Regions of the shadow maps of each image, with their places in the atlas.
    regions: Vec<Vec<ShadowRegion>>,
    /// Features that the lights of any image have.
    features: Vec<LightFeatures>,
    /// Views for auxiliary output and their bind group.
    aux_views: GrowableBuffer,
    aux_group: Option<wgpu::BindGroup>,
}

impl Merged {
    pub(super) fn new(gpu: &Gpu, shadow_size: u32) -> Self {
        Self {
            calls: DrawCalls::default(),
            instances: GrowableBuffer::new(gpu, "instances of several images", wgpu::BufferUsages::VERTEX),
            main_pass: MainPass::new(gpu, true),
            atlas: ShadowAtlas::new(shadow_size),
            regions: Vec::new(),
            features: Vec::new(),
            aux_views: GrowableBuffer::new(gpu, "views of ids and depths", wgpu::BufferUsages::STORAGE),
            aux_group: None,
        }
    }

    /// Uploads the instances and the views of prepared images. Returns `false` if the images cannot
    /// be drawn together.
    pub(super) fn prepare(&mut self, assets: &Assets, frames: &[Frame], tiles: &Tiles) -> Result<bool, RenderError> {
        let (gpu, views) = (&assets.gpu, views(frames));
        let Some(features) = common_features(frames, &views) else { return Ok(false) };
        self.features = features;
        self.regions.clear();
        self.regions.extend(views.iter().map(|view| view.regions.clone()));
        if !self.atlas.place(gpu, &mut self.regions.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>()) {
            return Ok(false);
        }
        merge(&frames.iter().map(|frame| &frame.list.calls).collect::<Vec<_>>(), &mut self.calls);
        self.instances.write(gpu, bytemuck::cast_slice(&self.calls.instances))?;
        let Some(first) = views.first() else { return Ok(false) };
        if first.aux.is_some() {
            let mut data = UniformData::default();
            for (index, view) in views.iter().enumerate() {
                let uniforms = ViewUniforms::new(&view.frustum, &assets.settings, tiles.tile, false);
                data.push_unlit(&ViewUniforms { place: tiles.place(index), ..uniforms });
            }
            if self.aux_views.write(gpu, data.bytes())? || self.aux_group.is_none() {
                self.aux_group = Some(gpu.pipelines().view_bind_group(gpu, &self.aux_views, &[]));
            }
            return Ok(true);
        }
        let of_lights: Vec<_> =
            views.iter().zip(&self.regions).map(|(view, regions)| (&view.lights, regions.as_slice())).collect();
        self.atlas.prepare(gpu, &of_lights)?;
        let inputs = inputs(frames, &views, &self.regions, tiles);
        let maps = shadow_maps(&self.atlas, &self.regions);
        let shadows = ShadowTextures { views: &maps, size: self.atlas.size(), version: self.atlas.version() };
        self.main_pass.prepare(gpu, &first.of_pass(assets, &self.features), &inputs, &shadows)?;
        Ok(true)
    }

    /// Makes the next preparation upload everything. Required if commands may not have been
    /// executed.
    pub(super) fn invalidate(&mut self) {
        self.instances.invalidate();
        self.main_pass.invalidate();
        self.atlas.invalidate();
        self.aux_views.invalidate();
    }

    /// Encodes the pass of the shadow maps, which precedes the main pass.
    pub(super) fn encode_shadows(&self, encoder: &mut wgpu::CommandEncoder, assets: &Assets, frames: &[Frame]) {
        let lights = self.regions.first().map_or(0, Vec::len);
        if let (Some(view), 1..) = (views(frames).first(), lights) {
            let draw = assets.draw_context(&self.calls, &self.instances, None);
            self.atlas.encode(encoder, &draw, lights, view.flags);
        }
    }

    /// Draws the prepared colour images in a pass of the target.
    pub(super) fn draw_color(
        &mut self,
        pass: &mut wgpu::RenderPass<'_>,
        assets: &Assets,
        frames: &[Frame],
        tiles: &Tiles,
        target: &Target,
    ) {
        let Self { calls, instances, main_pass, atlas, regions, features, .. } = self;
        let (Some(frame), views) = (frames.first(), views(frames)) else { return };
        let Some(first) = views.first() else { return };
        let tile_views: Vec<_> = views.iter().map(|view| view.tiles(assets)).collect();
        let draw = assets.draw_context(calls, instances, Some(&tile_views));
        let inputs = inputs(frames, &views, regions, tiles);
        let maps = shadow_maps(atlas, regions);
        main_pass.draw(pass, &draw, &first.of_pass(assets, features), &inputs, (&maps, &frame.labels), target);
    }

    /// Draws the geom ids and depths of the prepared images in a pass.
    pub(super) fn draw_ids(&self, pass: &mut wgpu::RenderPass<'_>, assets: &Assets, frames: &[Frame]) {
        let views = views(frames);
        let (Some(first), Some(group)) = (views.first(), &self.aux_group) else { return };
        let tile_views: Vec<_> = views.iter().map(|view| view.tiles(assets)).collect();
        let draw = assets.draw_context(&self.calls, &self.instances, Some(&tile_views));
        let cull = first.flags.contains(RenderFlags::CULL_FACE);
        let vectors = Some(UniformData::VECTORS[0] as u32);
        draw_ids(pass, &draw, (group, vectors), (AuxLayer::Only, cull));
    }
}

fn views(frames: &[Frame]) -> Vec<&FrameView> {
    frames.iter().filter_map(|frame| frame.view.as_ref()).collect()
}

fn inputs<'a>(
    frames: &'a [Frame],
    views: &[&'a FrameView],
    regions: &'a [Vec<ShadowRegion>],
    tiles: &Tiles,
) -> Vec<ViewInputs<'a>> {
    let images = frames.iter().zip(views).zip(regions).enumerate();
    images
        .map(|(index, ((frame, view), regions))| view.of_image(&frame.list, &frame.sky, regions, tiles.place(index)))
        .collect()
}

/// Returns the texture of the shadow maps once for each light.
fn shadow_maps<'a>(atlas: &'a ShadowAtlas, regions: &[Vec<ShadowRegion>]) -> Vec<&'a wgpu::TextureView> {
    let lights = regions.first().map_or(0, Vec::len);
    atlas.view().into_iter().flat_map(|view| std::iter::repeat_n(view, lights)).collect()
}

/// Returns the features that the lights of any image have. The code for a feature changes the
/// colour of a light without it by less than 1e-4. `None` if the images cannot share shaders and
/// passes.
fn common_features(frames: &[Frame], views: &[&FrameView]) -> Option<Vec<LightFeatures>> {
    let (first, rest) = views.split_first()?;
    let mut features = first.features.clone();
    let has_mirror = |frame: &Frame| frame.list.mirror.is_some();
    if first.aux.is_some_and(AuxOutput::has_depth) {
        // These images have no lights and no other effects.
        let cull = |view: &FrameView| view.flags.contains(RenderFlags::CULL_FACE);
        return rest.iter().all(|view| view.aux == first.aux && cull(view) == cull(first)).then(Vec::new);
    }
    let is_alone = |frame: &Frame| frame.labels.count > 0 || has_mirror(frame) != has_mirror(&frames[0]);
    // Clipping at the edges of an image adds lines to a wireframe.
    let is_wireframe = first.flags.contains(RenderFlags::WIREFRAME);
    if first.aux.is_some() || frames.iter().any(is_alone) || is_wireframe {
        return None;
    }
    for view in rest {
        if (view.flags, view.aux, view.features.len()) != (first.flags, first.aux, features.len()) {
            return None;
        }
        for (all, features) in features.iter_mut().zip(&view.features) {
            *all = all.union(*features)?;
        }
    }
    Some(features)
}
