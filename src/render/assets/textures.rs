//! GPU textures of the model, and the glyph atlas.

use super::GlyphAtlas;
use super::mipmap::{Faces, MipChain, MipLevel};
use crate::id::TextureId;
use crate::model::Model;
use crate::render::Gpu;
use crate::render::shader::TextureKind;

/// Samplers, and bind group layouts of a texture with its sampler. All renderers of a [`Gpu`] share
/// them.
#[derive(Debug)]
pub(crate) struct TextureBindings {
    pub(crate) d2: wgpu::BindGroupLayout,
    pub(crate) cube: wgpu::BindGroupLayout,
    repeat: wgpu::Sampler,
    clamp: wgpu::Sampler,
}

impl TextureBindings {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = |view_dimension| {
            let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty,
                count: None,
            };
            let sample_type = wgpu::TextureSampleType::Float { filterable: true };
            let texture = wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
            let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
            gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("texture of a model"),
                entries: &[entry(0, texture), entry(1, sampler)],
            })
        };
        let sampler = |address_mode| {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                label: Some("texture of a model"),
                address_mode_u: address_mode,
                address_mode_v: address_mode,
                address_mode_w: address_mode,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            })
        };
        Self {
            d2: layout(wgpu::TextureViewDimension::D2),
            cube: layout(wgpu::TextureViewDimension::Cube),
            repeat: sampler(wgpu::AddressMode::Repeat),
            clamp: sampler(wgpu::AddressMode::ClampToEdge),
        }
    }
}

/// Textures of a model, as bind groups.
#[derive(Debug)]
pub(crate) struct Textures {
    bind_groups: Vec<(TextureKind, wgpu::BindGroup)>,
    /// First skybox texture.
    sky: Option<SkyTexture>,
}

/// Skybox texture.
#[derive(Debug)]
pub(crate) struct SkyTexture {
    index: usize,
    /// Width of a face of the cube, texels.
    width: u32,
    all_levels: wgpu::BindGroup,
    base_level: wgpu::BindGroup,
}

impl SkyTexture {
    /// Returns the bind group for images with this number of pixels per radian at their centre. It
    /// has no mip levels if the image shows none of them: software rasterisers then select no
    /// levels.
    pub(crate) fn bind_group(&self, pixels_per_radian: f64) -> &wgpu::BindGroup {
        // The position on a face, from -1 to 1, is the tangent of an angle. It changes fastest in a
        // corner: by 3 per radian. A pixel has its largest angle at the centre of the image.
        let is_magnified = 3.0 * f64::from(self.width) / 2.0 <= pixels_per_radian;
        if is_magnified { &self.base_level } else { &self.all_levels }
    }
}

impl Textures {
    pub(crate) fn new(gpu: &Gpu, model: &Model) -> Self {
        let mut textures = Self { bind_groups: Vec::new(), sky: None };
        for texture in model.textures() {
            let is_sky = textures.sky.is_none() && texture.texture_type() == crate::enums::TextureType::Skybox;
            let created = textures.create(gpu, model, texture.id(), is_sky);
            textures.bind_groups.push(created);
        }
        textures
    }

    /// Replaces a texture.
    pub(crate) fn update(&mut self, gpu: &Gpu, model: &Model, id: TextureId) {
        let is_sky = self.sky.as_ref().is_some_and(|sky| sky.index == id.index());
        self.bind_groups[id.index()] = self.create(gpu, model, id, is_sky);
    }

    /// Creates the bind group of a texture, and the skybox if the texture is one.
    fn create(&mut self, gpu: &Gpu, model: &Model, id: TextureId, is_sky: bool) -> (TextureKind, wgpu::BindGroup) {
        let MipChain { faces, levels, is_srgb } = MipChain::new(model, id, gpu.limits().max_texture_dimension_2d);
        let layers = faces.count() as u32;
        let bindings = &gpu.pipelines().textures;
        let (kind, dimension, layout, sampler) = match faces {
            Faces::D2 => (TextureKind::D2, wgpu::TextureViewDimension::D2, &bindings.d2, &bindings.repeat),
            Faces::Cube => (TextureKind::Cube, wgpu::TextureViewDimension::Cube, &bindings.cube, &bindings.clamp),
        };
        let white = [MipLevel { width: 1, height: 1, rgba: vec![u8::MAX; 4 * faces.count()] }];
        let levels = if is_complete(&levels, layers) { &levels[..] } else { &white };
        let first = &levels[0];
        let size = wgpu::Extent3d { width: first.width, height: first.height, depth_or_array_layers: layers };
        let format = if is_srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm };
        let texture = create_texture(gpu, size, levels.len() as u32, format);
        for (number, MipLevel { width, height, rgba }) in levels.iter().enumerate() {
            let size = wgpu::Extent3d { width: *width, height: *height, depth_or_array_layers: layers };
            write(gpu, &texture, number as u32, size, rgba, 4);
        }
        let group = |mip_level_count| {
            let descriptor =
                wgpu::TextureViewDescriptor { dimension: Some(dimension), mip_level_count, ..Default::default() };
            bind_group(gpu, layout, &texture.create_view(&descriptor), sampler)
        };
        let all_levels = group(None);
        if is_sky {
            let (width, base_level) = (size.width, group(Some(1)));
            self.sky = Some(SkyTexture { index: id.index(), width, all_levels: all_levels.clone(), base_level });
        }
        (kind, all_levels)
    }

    /// Returns the bind group of a texture.
    pub(crate) fn get(&self, texture: u32) -> Option<&wgpu::BindGroup> {
        self.bind_groups.get(texture as usize).map(|(_, group)| group)
    }

    /// Returns the kind of a texture.
    pub(crate) fn kind(&self, texture: usize) -> TextureKind {
        self.bind_groups.get(texture).map_or(TextureKind::None, |(kind, _)| *kind)
    }

    /// Returns the first skybox texture.
    pub(crate) fn sky(&self) -> Option<&SkyTexture> {
        self.sky.as_ref()
    }
}

/// Creates the bind group of the glyph atlas.
pub(crate) fn glyph_atlas(gpu: &Gpu, atlas: &GlyphAtlas) -> wgpu::BindGroup {
    let size = wgpu::Extent3d { width: atlas.size[0], height: atlas.size[1], depth_or_array_layers: 1 };
    let texture = create_texture(gpu, size, 1, wgpu::TextureFormat::Rg8Unorm);
    write(gpu, &texture, 0, size, &atlas.pixels, 2);
    let bindings = &gpu.pipelines().textures;
    bind_group(gpu, &bindings.d2, &texture.create_view(&wgpu::TextureViewDescriptor::default()), &bindings.clamp)
}

/// Returns `true` if the mip chain is non-empty and each level has the size and the number of bytes
/// that wgpu requires.
fn is_complete(levels: &[MipLevel], layers: u32) -> bool {
    let Some(first) = levels.first() else { return false };
    let is_square = layers == 1 || first.width == first.height;
    is_square
        && levels.iter().enumerate().all(|(number, level)| {
            let size = [first.width, first.height].map(|length| (length >> number).max(1));
            let bytes = 4 * u64::from(level.width) * u64::from(level.height) * u64::from(layers);
            [level.width, level.height] == size && level.rgba.len() as u64 == bytes
        })
}

fn create_texture(gpu: &Gpu, size: wgpu::Extent3d, mip_level_count: u32, format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("texture of a model"),
        size,
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, mip_level: u32, size: wgpu::Extent3d, data: &[u8], bytes_per_pixel: u32) {
    gpu.queue().write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        data,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes_per_pixel * size.width),
            rows_per_image: Some(size.height),
        },
        size,
    );
}

fn bind_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    view: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("texture of a model"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}
