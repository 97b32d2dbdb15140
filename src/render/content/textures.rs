//! Pictures on surfaces, and of the sky.

use crate::id::TextureId;
use crate::model::Model;
use crate::render::Gpu;
use crate::render::shader::Coat;
use crate::render::text::Atlas;
use crate::render::texture::{Faces, Images, Level, images};

/// How programs are given pictures.
#[derive(Debug, Clone)]
pub(crate) struct Layouts {
    pub(crate) flat: wgpu::BindGroupLayout,
    pub(crate) cube: wgpu::BindGroupLayout,
}

impl Layouts {
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
                label: None,
                entries: &[entry(0, texture), entry(1, sampler)],
            })
        };
        Self { flat: layout(wgpu::TextureViewDimension::D2), cube: layout(wgpu::TextureViewDimension::Cube) }
    }
}

/// The pictures of a model.
#[derive(Debug)]
pub(crate) struct Textures {
    pictures: Vec<(Coat, wgpu::BindGroup)>,
    sky: Option<usize>,
    layouts: Layouts,
    repeating: wgpu::Sampler,
    clamping: wgpu::Sampler,
}

impl Textures {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, model: &Model) -> Self {
        let sampler = |address, mipmap_filter| {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                address_mode_u: address,
                address_mode_v: address,
                address_mode_w: address,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter,
                ..Default::default()
            })
        };
        let mut textures = Self {
            pictures: Vec::new(),
            sky: None,
            layouts: layouts.clone(),
            repeating: sampler(wgpu::AddressMode::Repeat, wgpu::MipmapFilterMode::Linear),
            clamping: sampler(wgpu::AddressMode::ClampToEdge, wgpu::MipmapFilterMode::Linear),
        };
        for texture in model.textures() {
            if textures.sky.is_none() && texture.texture_type() == crate::TextureType::Skybox {
                textures.sky = Some(textures.pictures.len());
            }
            let picture = textures.picture(gpu, model, texture.id());
            textures.pictures.push(picture);
        }
        textures
    }

    /// Makes a picture anew.
    pub(crate) fn update(&mut self, gpu: &Gpu, model: &Model, id: TextureId) {
        self.pictures[id.index()] = self.picture(gpu, model, id);
    }

    fn picture(&self, gpu: &Gpu, model: &Model, id: TextureId) -> (Coat, wgpu::BindGroup) {
        let Images { faces, levels } = images(model, id, gpu.limits().max_texture_dimension_2d);
        let (coat, layers, dimension, layout, sampler) = match faces {
            Faces::Flat => (Coat::Flat, 1, wgpu::TextureViewDimension::D2, &self.layouts.flat, &self.repeating),
            Faces::Cube => (Coat::Cube, 6, wgpu::TextureViewDimension::Cube, &self.layouts.cube, &self.clamping),
        };
        let white = [Level { width: 1, height: 1, rgba: vec![u8::MAX; 4 * layers as usize] }];
        let levels = if is_whole(&levels, layers) { &levels[..] } else { &white };
        let first = &levels[0];
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: first.width, height: first.height, depth_or_array_layers: layers },
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (number, level) in levels.iter().enumerate() {
            write(gpu, &texture, number as u32, level, layers, 4);
        }
        let view =
            texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() });
        (coat, bind(gpu, layout, &view, sampler))
    }

    /// The picture of a texture.
    pub(crate) fn get(&self, texture: u32) -> Option<&wgpu::BindGroup> {
        self.pictures.get(texture as usize).map(|(_, group)| group)
    }

    /// How a texture is put on.
    pub(crate) fn coat(&self, texture: usize) -> Coat {
        self.pictures.get(texture).map_or(Coat::Plain, |(coat, _)| *coat)
    }

    /// The first that is a sky.
    pub(crate) fn sky(&self) -> Option<&wgpu::BindGroup> {
        self.pictures.get(self.sky?).map(|(_, group)| group)
    }

    /// The letters.
    pub(crate) fn atlas(&self, gpu: &Gpu) -> wgpu::BindGroup {
        let atlas = Atlas::get();
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("letters"),
            size: wgpu::Extent3d { width: atlas.width, height: atlas.height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rg8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let level = Level { width: atlas.width, height: atlas.height, rgba: atlas.pixels.clone() };
        write(gpu, &texture, 0, &level, 1, 2);
        bind(gpu, &self.layouts.flat, &texture.create_view(&wgpu::TextureViewDescriptor::default()), &self.clamping)
    }
}

/// Whether each image is there, each half as large as the one before.
fn is_whole(levels: &[Level], layers: u32) -> bool {
    let Some(first) = levels.first() else { return false };
    let is_square = layers == 1 || first.width == first.height;
    is_square
        && levels.iter().enumerate().all(|(number, level)| {
            let size = [first.width, first.height].map(|length| (length >> number).max(1));
            let bytes = 4 * u64::from(level.width) * u64::from(level.height) * u64::from(layers);
            [level.width, level.height] == size && level.rgba.len() as u64 == bytes
        })
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, mip_level: u32, level: &Level, layers: u32, bytes: u32) {
    gpu.queue().write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        &level.rgba,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes * level.width),
            rows_per_image: Some(level.height),
        },
        wgpu::Extent3d { width: level.width, height: level.height, depth_or_array_layers: layers },
    );
}

fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    view: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}
