//! Conversion of the images in a texture to one array on the graphics card: image by image, with
//! the numbers that callers get.

use crate::render::gpu::Length;
use crate::render::gpu::buffer::{create_buffer, read_mapped};
use crate::render::{Gpu, RenderError};

/// Numbers of a packed array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    /// Red, green and blue, one byte each.
    Rgb,
    /// Geom ids.
    Ids,
    /// Depths, infinite for the background.
    Depths,
}

impl Packing {
    pub(crate) const COUNT: usize = 3;

    pub(crate) fn bytes_per_pixel(self) -> u32 {
        match self {
            Self::Rgb => 3,
            Self::Ids | Self::Depths => 4,
        }
    }

    /// Returns the type of the texels, and the code of a word of the array.
    fn code(self) -> [&'static str; 2] {
        match self {
            Self::Rgb => [
                "f32",
                "byte(4u * word) | byte(4u * word + 1u) << 8u | byte(4u * word + 2u) << 16u | byte(4u * word + 3u) << 24u",
            ],
            Self::Ids => ["u32", "texel(word).r"],
            Self::Depths => ["u32", "select(0x7f800000u, texel(word).g, texel(word).r != 0u)"],
        }
    }
}

/// Layout of the images in the texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PackedImages {
    /// Width and height of an image, pixels.
    pub(crate) size: [u32; 2],
    pub(crate) columns: u32,
    pub(crate) count: u32,
}

/// Invocations of a workgroup.
const WORKGROUP: u32 = 64;

const SHADER: &str = "
override width: u32;
override height: u32;
override columns: u32;
override length: u32;

@group(0) @binding(0) var images: texture_2d<TEXEL>;
@group(0) @binding(1) var<storage, read_write> words: array<u32>;

// Returns the texel of a pixel of the array. Images are rendered upside down.
fn texel(pixel: u32) -> vec4<TEXEL> {
    let image = pixel / (width * height);
    let rest = pixel % (width * height);
    let place = vec2u(image % columns, image / columns) * vec2u(width, height);
    return textureLoad(images, place + vec2u(rest % width, height - 1u - rest / width), 0);
}

BYTE
@compute @workgroup_size(64)
fn pack(@builtin(global_invocation_id) id: vec3u) {
    let word = id.x;
    if word < length {
        words[word] = WORD;
    }
}
";

const BYTE: &str = "
fn byte(index: u32) -> u32 {
    return u32(round(255.0 * texel(index / 3u)[index % 3u]));
}
";

/// Pipeline and buffers that pack the images of a texture.
#[derive(Debug)]
pub(crate) struct Pack {
    packing: Packing,
    images: PackedImages,
    texture: wgpu::Texture,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// The array, and the buffer to read it back.
    packed: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl Pack {
    pub(crate) fn new(gpu: &Gpu, packing: Packing, images: PackedImages, texture: &wgpu::Texture) -> Self {
        use wgpu::BufferUsages as Usage;

        let device = gpu.device();
        let [texel, word] = packing.code();
        let byte = if packing == Packing::Rgb { BYTE } else { "" };
        let source = SHADER.replace("BYTE\n", byte).replace("TEXEL", texel).replace("WORD", word);
        let label = Some("packing of images");
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let buffer = |label, usage| create_buffer(gpu, label, images.bytes(packing).next_multiple_of(4), usage);
        let packed = buffer("packed images", Usage::STORAGE | Usage::COPY_SRC);
        let staging = buffer("packed images that are read back", Usage::COPY_DST | Usage::MAP_READ);
        let [width, height] = images.size;
        let constants =
            [("width", width), ("height", height), ("columns", images.columns), ("length", images.words(packing))];
        let constants = constants.map(|(name, value)| (name, f64::from(value)));
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: packed.as_entire_binding() },
            ],
        });
        Self { packing, images, texture: texture.clone(), pipeline, group, packed, staging }
    }

    pub(crate) fn matches(&self, packing: Packing, images: PackedImages, texture: &wgpu::Texture) -> bool {
        (self.packing, self.images, &self.texture) == (packing, images, texture)
    }

    /// Encodes the conversion and the copy to a buffer that can be read.
    pub(crate) fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(self.images.words(self.packing).div_ceil(WORKGROUP), 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&self.packed, 0, &self.staging, 0, self.packed.size());
    }

    /// Waits for the submission with the conversion, and passes the array to `read`.
    pub(crate) fn mapped(
        &self,
        gpu: &Gpu,
        submission: (wgpu::SubmissionIndex, Length),
        read: impl FnOnce(&[u8]),
    ) -> Result<(), RenderError> {
        let size = self.images.bytes(self.packing) as usize;
        read_mapped(gpu, &self.staging, submission, |bytes| read(&bytes[..size]))
    }
}

impl PackedImages {
    fn bytes(&self, packing: Packing) -> u64 {
        let [width, height] = self.size.map(u64::from);
        width * height * u64::from(self.count) * u64::from(packing.bytes_per_pixel())
    }

    fn words(&self, packing: Packing) -> u32 {
        self.bytes(packing).div_ceil(4) as u32
    }
}
