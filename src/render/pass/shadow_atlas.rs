//! Shadow maps of several images in one texture, rendered in one pass.

use super::shadow_map::{draw_casters, inside_border, map_view, shadow_key};
use super::{DrawContext, PipelineKey};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::view::matrix::product;
use crate::render::view::{Lights, Place, ShadowRegion, UniformData, ViewUniforms};
use crate::render::{Gpu, RenderError};
use crate::scene::RenderFlags;

/// Texture with the shadow maps of several images, and the views of the lights.
#[derive(Debug)]
pub(crate) struct ShadowAtlas {
    /// Width and height of a full map, texels.
    size: u32,
    texture: Option<(wgpu::TextureView, [u32; 2])>,
    /// Number of texture allocations.
    version: u64,
    /// Views of each light, one of each image.
    views: Vec<(GrowableBuffer, Option<wgpu::BindGroup>)>,
}

/// Largest number of texels of an atlas: 256 MiB.
const MAX_TEXELS: u64 = 1 << 26;

impl ShadowAtlas {
    /// Creates an atlas for full maps of `size` texels.
    pub(crate) fn new(size: u32) -> Self {
        Self { size, texture: None, version: 0, views: Vec::new() }
    }

    pub(crate) fn size(&self) -> u32 {
        self.size
    }

    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    pub(crate) fn view(&self) -> Option<&wgpu::TextureView> {
        self.texture.as_ref().map(|(view, _)| view)
    }

    /// Gives each region its place in the texture. `regions` has the regions of each image, one for
    /// each of its lights with shadows. Returns `false` if they do not fit into a texture.
    pub(crate) fn place(&mut self, gpu: &Gpu, regions: &mut [&mut [ShadowRegion]]) -> bool {
        let limit = gpu.limits().max_texture_dimension_2d;
        let mut all: Vec<&mut ShadowRegion> = regions.iter_mut().flat_map(|regions| regions.iter_mut()).collect();
        let Some([width, height]) = place(&mut all, limit) else { return false };
        let fits = |&(_, size): &(_, [u32; 2])| size[0] >= width && size[1] >= height;
        if self.texture.as_ref().is_none_or(|texture| !fits(texture)) && height > 0 {
            // More rows than required, because the regions change from call to call.
            let size = [width, (height + height / 8).min(limit)];
            self.texture = Some((map_view(gpu, size), size));
            self.version += 1;
        }
        true
    }

    /// Writes the views of the lights, for the lights of each image and their placed regions.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, images: &[(&Lights, &[ShadowRegion])]) -> Result<(), RenderError> {
        let Some((_, size)) = &self.texture else { return Ok(()) };
        let lights = images.first().map_or(0, |(_, regions)| regions.len());
        while self.views.len() < lights {
            let buffer = GrowableBuffer::new(gpu, "views of a light", wgpu::BufferUsages::STORAGE);
            self.views.push((buffer, None));
        }
        let mut data: Vec<UniformData> = (0..lights).map(|_| UniformData::default()).collect();
        for (lights, regions) in images {
            for ((matrix, region), data) in lights.shadows().zip(*regions).zip(&mut data) {
                let clip = product(&region.clip_to_region(self.size), matrix);
                let place = Place::new(region.place, region.size, *size);
                let place = place.limited(inside_border(region, self.size), region.size);
                data.push_unlit(&ViewUniforms::of_shadow_map(&clip, place));
            }
        }
        for ((buffer, bind_group), data) in self.views.iter_mut().zip(data) {
            if buffer.write(gpu, data.bytes())? || bind_group.is_none() {
                *bind_group = Some(gpu.pipelines().view_bind_group(gpu, buffer, &[]));
            }
        }
        Ok(())
    }

    /// Requests an upload of the views. Required if commands may not have been executed.
    pub(crate) fn invalidate(&mut self) {
        self.views.iter_mut().for_each(|(buffer, _)| buffer.invalidate());
    }

    /// Encodes the pass that renders the maps of this number of lights.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        draw: &DrawContext<'_>,
        lights: usize,
        flags: RenderFlags,
    ) {
        let Some((view, size)) = &self.texture else { return };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow maps"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        // The depth range of a cleared map.
        let [near, far] = ShadowRegion::CLEARED_RANGE;
        pass.set_viewport(0.0, 0.0, size[0] as f32, size[1] as f32, near, far);
        let key = PipelineKey { vectors: Some(UniformData::VECTORS[0] as u32), ..shadow_key(draw, flags) };
        for (light, (_, bind_group)) in self.views.iter().take(lights).enumerate() {
            pass.set_bind_group(0, bind_group, &[]);
            draw_casters(&mut pass, draw, light, &key);
        }
    }
}

/// Places regions on shelves: rows as high as their first region, from high to low. Returns the
/// width and height that they need; `None` if that exceeds a limit.
fn place(regions: &mut [&mut ShadowRegion], limit: u32) -> Option<[u32; 2]> {
    let texels: u64 = regions.iter().map(|region| u64::from(region.size[0]) * u64::from(region.size[1])).sum();
    let widest = regions.iter().map(|region| region.size[0]).max().unwrap_or(0);
    // The widths of textures are powers of two, so that few are allocated.
    let width = ((texels as f64).sqrt() as u32).max(widest).next_power_of_two().min(limit);
    regions.sort_by_key(|region| std::cmp::Reverse(region.size[1]));
    let ([mut x, mut y], mut shelf) = ([0, 0], 0);
    for region in regions {
        if x + region.size[0] > width {
            (x, y, shelf) = (0, y + shelf, 0);
        }
        shelf = shelf.max(region.size[1]);
        region.place = [x, y];
        x += region.size[0];
    }
    let height = y + shelf;
    let fits = widest <= limit && height <= limit && u64::from(width) * u64::from(height) <= MAX_TEXELS;
    fits.then_some([width, height])
}

#[cfg(test)]
mod tests {
    use super::{ShadowRegion, place};

    fn regions(sizes: &[[u32; 2]]) -> Vec<ShadowRegion> {
        let region = |&size: &[u32; 2]| ShadowRegion {
            reduction: 1,
            origin: [0; 2],
            size,
            place: [0; 2],
            frames_since_clear: 0,
        };
        sizes.iter().map(region).collect()
    }

    #[test]
    fn places_do_not_overlap_and_are_inside_of_the_texture() {
        let sizes: Vec<[u32; 2]> = (0..60).map(|k: u32| [4 + k * 7 % 130, 4 + k * 31 % 260]).collect();
        let mut regions = regions(&sizes);
        let [width, height] = place(&mut regions.iter_mut().collect::<Vec<_>>(), 4096).unwrap();
        let mut texels = vec![0; (width * height) as usize];
        for ShadowRegion { place: [x, y], size, .. } in &regions {
            assert!(x + size[0] <= width && y + size[1] <= height);
            for row in *y..y + size[1] {
                texels[(row * width + x) as usize..][..size[0] as usize].iter_mut().for_each(|texel| *texel += 1);
            }
        }
        assert_eq!(texels.iter().max(), Some(&1));
        let used: u32 = sizes.iter().map(|[width, height]| width * height).sum();
        assert!(f64::from(width * height) < 1.7 * f64::from(used), "{width} x {height} for {used}");
    }

    #[test]
    fn regions_that_exceed_the_limit_have_no_place() {
        let mut too_wide = regions(&[[300, 10]]);
        assert_eq!(place(&mut too_wide.iter_mut().collect::<Vec<_>>(), 256), None);
        let mut too_many = regions(&[[200, 200]; 3]);
        assert_eq!(place(&mut too_many.iter_mut().collect::<Vec<_>>(), 256), None);
        assert_eq!(place(&mut [], 256), Some([1, 0]));
    }
}
