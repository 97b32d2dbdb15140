//! Shadow maps: the depth of the nearest surface in each direction of a light. Only the region that
//! contains casters is allocated, aligned to the texel grid of the full map, so that shadow edges
//! do not depend on the region.
//!
//! Software rasterisers take as long to clear a map as to render to it. Each frame therefore uses a
//! nearer depth range than the previous frame, which makes stale depths ineffective; see
//! [`ShadowRegion::depth_range`].
//!
//! A map is rendered with fewer texels if the texels of the full map are much smaller than a pixel:
//! see [`reduction`].

use super::target::{create_texture, default_view};
use super::{COLOR_FORMAT, DrawContext, PassKind, PipelineKey};
use crate::render::draw_list::{Batch, BatchKey, DrawList};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::view::matrix::product;
use crate::render::view::{Lights, Place, ShadowRegion, UniformData, ViewFrustum, ViewUniforms, reduction};
use crate::render::{Gpu, GpuKind, RenderError};
use crate::scene::RenderFlags;

/// Shadow map of one light.
#[derive(Debug)]
struct ShadowMap {
    region: ShadowRegion,
    view: wgpu::TextureView,
    uniform: GrowableBuffer,
    bind_group: Option<wgpu::BindGroup>,
    has_casters: bool,
    /// The map may contain depths nearer than the depth range of the frame.
    needs_clear: bool,
}

/// Shadow maps of all lights.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    /// Width and height of a full map, texels.
    size: u32,
    maps: Vec<ShadowMap>,
    regions: Vec<ShadowRegion>,
    /// Number of texture allocations.
    version: u64,
}

/// Granularity of the size of regions, texels. It reduces reallocations when geoms move.
const GRANULARITY: u32 = 128;

/// Smallest width and height of a region, texels.
const SMALLEST: u32 = 4;

/// Number of frames after which a map is cleared, long before its depth range underflows.
const CLEAR_INTERVAL: u32 = 64;

/// Ratio of allocated to required texels above which a smaller texture is allocated.
const MAX_EXCESS: u64 = 3;

impl ShadowMaps {
    pub(crate) fn new(size: u32) -> Self {
        // Smaller maps have no texel inside their border.
        let size = if size < 4 { 0 } else { size };
        Self { size, maps: Vec::new(), regions: Vec::new(), version: 0 }
    }

    /// Returns `true` if shadows are enabled.
    pub(crate) fn is_enabled(&self) -> bool {
        self.size > 0
    }

    pub(crate) fn size(&self) -> u32 {
        self.size
    }

    /// Returns the allocated regions for the lights of the last [`prepare`](Self::prepare).
    pub(crate) fn regions(&self) -> &[ShadowRegion] {
        &self.regions
    }

    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    /// Iterates over the texture views of the maps in use.
    pub(crate) fn views(&self) -> impl Iterator<Item = &wgpu::TextureView> {
        self.maps[..self.regions.len()].iter().map(|map| &map.view)
    }

    /// Returns the regions for the casters of a draw list, each with an empty texel around it.
    pub(crate) fn required_regions(
        &self,
        frustum: &ViewFrustum,
        lights: &Lights,
        list: &DrawList,
    ) -> impl Iterator<Item = ShadowRegion> {
        lights.shadows().zip(&list.shadow_bounds).map(|(matrix, bounds)| {
            self.required_region(*bounds, reduction(matrix, self.size, frustum, list.nearest_depth))
        })
    }

    /// Allocates the regions for the casters of a draw list, and writes the uniform buffers.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        lights: &Lights,
        list: &DrawList,
        required: &[ShadowRegion],
    ) -> Result<(), RenderError> {
        self.regions.clear();
        let clears_every_frame = gpu.kind() != GpuKind::Software;
        let casters = list.shadow_bounds.iter().map(Option::is_some);
        for (index, ((matrix, required), has_casters)) in lights.shadows().zip(required).zip(casters).enumerate() {
            let reduced = self.size.div_ceil(required.reduction);
            let size = required.size.map(|length| length.next_multiple_of(GRANULARITY).min(reduced));
            let required = ShadowRegion { size, ..*required };
            if index == self.maps.len() {
                self.maps.push(ShadowMap::new(gpu, required));
                self.version += 1;
            }
            let map = &mut self.maps[index];
            let texels = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
            let allocated = map.region.size;
            let fits = allocated[0] >= required.size[0] && allocated[1] >= required.size[1];
            if fits && texels(allocated) <= MAX_EXCESS * texels(required.size) {
                (map.region.reduction, map.region.origin) = (required.reduction, required.origin);
                // Hardware clears at no cost and renders faster to a cleared attachment.
                map.region.frames_since_clear =
                    if clears_every_frame { 0 } else { (map.region.frames_since_clear + 1) % CLEAR_INTERVAL };
            } else {
                (map.region, map.view) = (required, map_view(gpu, required.size));
                self.version += 1;
            }
            map.needs_clear |= map.region.frames_since_clear == 0;
            map.has_casters = has_casters;
            let clip = product(&map.region.clip_to_region(self.size), matrix);
            if map.uniform.write(gpu, UniformData::unlit(&ViewUniforms::of_shadow_map(&clip, Place::WHOLE)).bytes())? {
                map.bind_group = None;
            }
            self.regions.push(map.region);
        }
        Ok(())
    }

    /// Returns the region for bounds in the clip space of a light.
    fn required_region(&self, bounds: Option<[[f64; 2]; 2]>, reduction: u32) -> ShadowRegion {
        let reduced = self.size.div_ceil(reduction);
        let Some([low, high]) = bounds else {
            let size = [SMALLEST.min(reduced); 2];
            return ShadowRegion { reduction, origin: [0; 2], size, place: [0; 2], frames_since_clear: 0 };
        };
        let inner = f64::from(self.size) - 2.0;
        let texel = |coordinate: f64| (1.0 + (0.5 + 0.5 * coordinate) * inner) / f64::from(reduction);
        let origin = low.map(|low| (texel(low).floor() as u32).saturating_sub(2));
        let end = high.map(|high| (texel(high).ceil() as u32 + 2).min(reduced));
        let size = [0, 1].map(|axis| end[axis].saturating_sub(origin[axis]).max(SMALLEST).min(reduced));
        ShadowRegion { reduction, origin, size, place: [0; 2], frames_since_clear: 0 }
    }

    /// Requests a clear of all maps, and the upload of their uniforms. Required if commands may not
    /// have been executed.
    pub(crate) fn invalidate(&mut self) {
        for map in &mut self.maps {
            map.needs_clear = true;
            map.uniform.invalidate();
        }
    }

    /// Encodes the shadow passes.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, draw: &DrawContext<'_>, flags: RenderFlags) {
        let key = shadow_key(draw, flags);
        for (light, map) in self.maps[..self.regions.len()].iter_mut().enumerate() {
            if !map.has_casters && !map.needs_clear {
                continue;
            }
            let load = if map.needs_clear { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
            map.needs_clear = false;
            let bind_group =
                map.bind_group.get_or_insert_with(|| draw.gpu.pipelines().view_bind_group(draw.gpu, &map.uniform, &[]));
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow map"),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &map.view,
                    depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            if !map.has_casters {
                continue;
            }
            let Some([[left, right], [top, bottom]]) = inside_border(&map.region, self.size) else { continue };
            let [width, height] = map.region.size.map(|length| length as f32);
            let [near, far] = map.region.depth_range();
            pass.set_viewport(0.0, 0.0, width, height, near, far);
            pass.set_scissor_rect(left, top, right - left, bottom - top);
            pass.set_bind_group(0, &*bind_group, &[]);
            draw_casters(&mut pass, draw, light, &key);
        }
    }
}

/// Returns the key of the pipelines of shadow maps, which are rendered upside down, so that the
/// texels are in OpenGL's order.
pub(super) fn shadow_key(draw: &DrawContext<'_>, flags: RenderFlags) -> PipelineKey {
    // The colour format is unused.
    let key = PipelineKey::untextured(PassKind::Shadow, COLOR_FORMAT, flags.contains(RenderFlags::CULL_FACE), true);
    // As in the engine's renderer, lines cast shadows in wireframe mode.
    PipelineKey { wireframe: draw.wireframe(flags), ..key }
}

/// Draws the casters of a light to its shadow maps.
pub(super) fn draw_casters(pass: &mut wgpu::RenderPass<'_>, draw: &DrawContext<'_>, light: usize, key: &PipelineKey) {
    let calls = draw.calls;
    let opaque = calls.reflector.iter().chain(&calls.opaque);
    let casts = |batch: &&Batch| batch.visibility.shadow_mask & 1 << light != 0;
    for batch in opaque.chain(&calls.transparent[..calls.front_to_back]).filter(casts) {
        // The side of a plane that the camera sees does not matter for the light.
        let shape = draw.shapes.unlit(batch.key.shape);
        let batch = Batch { key: BatchKey { shape, back_faces: false, ..batch.key }, ..batch.clone() };
        draw.batch(pass, &batch, key);
    }
}

impl ShadowMap {
    fn new(gpu: &Gpu, region: ShadowRegion) -> Self {
        Self {
            region,
            view: map_view(gpu, region.size),
            uniform: GrowableBuffer::new(gpu, "uniforms of a shadow map", wgpu::BufferUsages::UNIFORM),
            bind_group: None,
            has_casters: false,
            needs_clear: true,
        }
    }
}

pub(super) fn map_view(gpu: &Gpu, size: [u32; 2]) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    default_view(&create_texture(gpu, "shadow map", size, wgpu::TextureFormat::Depth32Float, 1, usage))
}

/// Returns the part of a region inside the border of a map of `size` texels, as ranges in x and y;
/// `None` if it is empty. The border is one texel of the region wide.
pub(super) fn inside_border(region: &ShadowRegion, size: u32) -> Option<[[u32; 2]; 2]> {
    let size = size.div_ceil(region.reduction);
    let range = [0, 1].map(|axis| {
        let origin = region.origin[axis];
        let low = 1_u32.saturating_sub(origin);
        let high = (size - 1).saturating_sub(origin).min(region.size[axis]);
        [low, high]
    });
    range.iter().all(|[low, high]| low < high).then_some(range)
}

#[cfg(test)]
mod tests {
    use super::{ShadowMaps, ShadowRegion, inside_border};

    fn region(origin: [u32; 2], size: [u32; 2]) -> ShadowRegion {
        ShadowRegion { reduction: 1, origin, size, place: [0; 2], frames_since_clear: 0 }
    }

    #[test]
    fn a_region_has_an_empty_texel_around_the_casters() {
        let maps = ShadowMaps::new(1024);
        let ShadowRegion { origin, size, .. } = maps.required_region(Some([[-0.5, 0.0], [0.0, 0.25]]), 1);
        // Texels 1 + 0.25 * 1022 = 256.5 and 1 + 0.5 * 1022 = 512 in x; 512 and 639.75 in y.
        assert!(origin[0] < 256 && origin[0] + size[0] > 513, "{origin:?} {size:?}");
        assert!(origin[1] < 511 && origin[1] + size[1] > 641, "{origin:?} {size:?}");
        assert!(size[0] < 512 && size[1] < 384, "{size:?} exceeds the granularity");
    }

    #[test]
    fn the_border_of_the_full_map_stays_empty() {
        assert_eq!(inside_border(&region([0, 0], [1024, 1024]), 1024), Some([[1, 1023], [1, 1023]]));
        assert_eq!(inside_border(&region([900, 100], [128, 128]), 1024), Some([[0, 123], [0, 128]]));
        assert_eq!(inside_border(&region([1023, 0], [128, 128]), 1024), None);
    }
}
