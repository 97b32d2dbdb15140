//! Image of the window's content on the GPU. A frame repaints only the parts that have changed, and
//! copies the image to the window.

use super::pixel_rect::PixelRect;
use crate::render::{Gpu, RenderError, create_texture, screen_pipeline};

/// Draws the blend constant, or a texture of the target's size pixel by pixel.
const SHADER: &str = "
@group(0) @binding(0) var image: texture_2d<f32>;

@fragment
fn fill() -> @location(0) vec4f {
    return vec4f(1.0);
}

@fragment
fn draw(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return textureLoad(image, vec2u(position.xy), 0);
}
";

/// Layout of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CanvasLayout {
    /// Width and height of the window, pixels.
    pub size: [u32; 2],
    /// Area of the scene, which starts at the upper edge of the window, or an empty rectangle.
    pub scene: PixelRect,
    /// Colour beside and below the scene.
    pub background: wgpu::Color,
}

impl CanvasLayout {
    /// Returns the areas on the left of the scene, of the scene, on its right, and below all of
    /// them. They cover the window.
    pub fn areas(&self) -> [PixelRect; 4] {
        let ([left, _], [right, bottom], [width, height]) = (self.scene.origin, self.scene.end(), self.size);
        let column = |start, end| PixelRect::between([start, 0], [end, bottom]);
        let below = PixelRect::between([0, bottom], [width, height]);
        [column(0, left), column(left, right), column(right, width), below]
    }
}

/// Image of the window's content.
pub(super) struct Canvas {
    format: wgpu::TextureFormat,
    fill: wgpu::RenderPipeline,
    /// Pipeline that draws the image to the window, created on first use.
    draw: Option<wgpu::RenderPipeline>,
    image: Option<Image>,
}

struct Image {
    layout: CanvasLayout,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Canvas {
    /// Creates a canvas of a window with this format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, RenderError> {
        let constant = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::Zero,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = wgpu::BlendState { color: constant, alpha: constant };
        gpu.guarded(|| Ok(Self { format, fill: pipeline(gpu, format, "fill", Some(blend)), draw: None, image: None }))
    }

    /// Discards the image, so that the next frame repaints the window completely.
    pub fn clear(&mut self) {
        self.image = None;
    }

    /// Adopts a layout. Returns `true` if the window must be repainted completely.
    pub fn prepare(&mut self, gpu: &Gpu, layout: CanvasLayout) -> Result<bool, RenderError> {
        if self.image.as_ref().is_some_and(|image| image.layout == layout) {
            return Ok(false);
        }
        self.image = match self.image.take().filter(|image| image.layout.size == layout.size) {
            Some(image) => Some(Image { layout, ..image }),
            None => Some(gpu.guarded(|| {
                use wgpu::TextureUsages as Usages;
                let usage = Usages::RENDER_ATTACHMENT | Usages::TEXTURE_BINDING | Usages::COPY_SRC | Usages::COPY_DST;
                let texture = create_texture(gpu, "panels and scene", layout.size, self.format, 1, usage);
                Ok(Image { layout, view: texture.create_view(&wgpu::TextureViewDescriptor::default()), texture })
            })?),
        };
        Ok(true)
    }

    /// Returns the image, on which panels are painted.
    pub fn view(&self) -> Option<&wgpu::TextureView> {
        self.image.as_ref().map(|image| &image.view)
    }

    /// Draws what is behind the panels in parts of the window, each of which is in one area of the
    /// layout: the image of the scene, or the background.
    pub fn draw_background(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        parts: &[PixelRect],
        scene: Option<&wgpu::Texture>,
    ) {
        let Some(image) = &self.image else { return };
        let area = image.layout.scene;
        let shows_scene = |part: &&PixelRect| area.intersection(**part) == **part;
        {
            let mut pass = begin_pass(encoder, "canvas", &image.view);
            pass.set_pipeline(&self.fill);
            pass.set_blend_constant(image.layout.background);
            for part in parts.iter().filter(|part| !shows_scene(part)) {
                pass.set_scissor_rect(part.origin[0], part.origin[1], part.size[0], part.size[1]);
                pass.draw(0..3, 0..1);
            }
        }
        let Some(scene) = scene else { return };
        for part in parts.iter().filter(shows_scene) {
            let at = |texture, [x, y]: [u32; 2]| wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x, y, z: 0 },
                aspect: wgpu::TextureAspect::All,
            };
            let from = at(scene, [0, 1].map(|axis| part.origin[axis] - area.origin[axis]));
            let extent = wgpu::Extent3d { width: part.size[0], height: part.size[1], depth_or_array_layers: 1 };
            encoder.copy_texture_to_texture(from, at(&image.texture, part.origin), extent);
        }
    }

    /// Copies the image to the window's texture of the same size.
    pub fn copy_to(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, target: &wgpu::Texture) {
        let Some(image) = &self.image else { return };
        if target.usage().contains(wgpu::TextureUsages::COPY_DST) {
            encoder.copy_texture_to_texture(image.texture.as_image_copy(), target.as_image_copy(), target.size());
            return;
        }
        // OpenGL cannot copy to the texture of a window.
        let draw = self.draw.get_or_insert_with(|| pipeline(gpu, self.format, "draw", None));
        let bind_group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("canvas"),
            layout: &draw.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&image.view) }],
        });
        let mut pass = begin_pass(encoder, "canvas", &target.create_view(&wgpu::TextureViewDescriptor::default()));
        pass.set_pipeline(draw);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Creates a pipeline with one of the fragment shaders.
fn pipeline(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    shader: &str,
    blend: Option<wgpu::BlendState>,
) -> wgpu::RenderPipeline {
    let target = wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL };
    screen_pipeline(gpu, SHADER, shader, target)
}

/// Begins a pass that keeps the content of the target.
pub(super) fn begin_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    target: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
        })],
        ..wgpu::RenderPassDescriptor::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::ReadBackBuffer;

    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
    const SIZE: [u32; 2] = [8, 4];

    /// Returns the red and green parts of the canvas after a copy to a texture with this usage.
    fn copied(gpu: &Gpu, canvas: &mut Canvas, usage: wgpu::TextureUsages) -> Vec<Vec<[u8; 2]>> {
        let window = create_texture(gpu, "window", SIZE, FORMAT, 1, usage | wgpu::TextureUsages::COPY_SRC);
        let buffer = ReadBackBuffer::new(gpu, SIZE, 4).unwrap();
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        canvas.copy_to(gpu, &mut encoder, &window);
        buffer.encode(&mut encoder, &window);
        let submission = gpu.submit(encoder);
        let mut rows = Vec::new();
        buffer
            .rows(gpu, submission, |row| {
                rows.push(row.as_chunks::<4>().0.iter().map(|pixel| [pixel[0], pixel[1]]).collect());
            })
            .unwrap();
        rows.reverse();
        rows
    }

    #[test]
    fn repainted_parts_show_scene_and_background() {
        let gpu = Gpu::new().unwrap();
        let mut canvas = Canvas::new(&gpu, FORMAT).unwrap();
        let background = wgpu::Color { r: 1.0, g: 0.0, b: 0.0, a: 1.0 };
        let layout = CanvasLayout { size: SIZE, scene: PixelRect::between([2, 0], [6, 3]), background };
        let corners = |area: PixelRect| [area.origin, area.end()];
        let areas = [[[0, 0], [2, 3]], [[2, 0], [6, 3]], [[6, 0], [8, 3]], [[0, 3], [8, 4]]];
        assert_eq!(layout.areas().map(corners), areas);
        assert!(canvas.prepare(&gpu, layout).unwrap());
        assert!(!canvas.prepare(&gpu, layout).unwrap());

        // A scene whose green part is the number of the pixel.
        let scene = create_texture(
            &gpu,
            "scene",
            [4, 3],
            FORMAT,
            1,
            wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
        );
        let pixels: Vec<u8> = (0..12).flat_map(|number| [0, number, 0, 255]).collect();
        let rows = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16), rows_per_image: None };
        gpu.queue().write_texture(scene.as_image_copy(), &pixels, rows, scene.size());
        let draw = |canvas: &Canvas, parts: &[PixelRect]| {
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            canvas.draw_background(&mut encoder, parts, Some(&scene));
            gpu.submit(encoder);
        };
        let expected = |is_drawn: &dyn Fn(u8, u8) -> bool| -> Vec<Vec<[u8; 2]>> {
            let pixel = |x, y| match x {
                _ if !is_drawn(x, y) => [0, 0],
                2..6 if y < 3 => [0, 4 * y + x - 2],
                _ => [255, 0],
            };
            (0..4).map(|y| (0..8).map(|x| pixel(x, y)).collect()).collect()
        };
        draw(&canvas, &[PixelRect::between([1, 1], [2, 3]), PixelRect::between([3, 1], [5, 3])]);
        let copy = wgpu::TextureUsages::COPY_DST;
        let partial = |x, y| x == 1 && (1..3).contains(&y) || (3..5).contains(&x) && (1..3).contains(&y);
        assert_eq!(copied(&gpu, &mut canvas, copy), expected(&partial));
        draw(&canvas, &layout.areas());
        assert_eq!(copied(&gpu, &mut canvas, copy), expected(&|_, _| true));
        // The texture of a window of OpenGL cannot be the target of a copy, so the image is drawn.
        assert_eq!(copied(&gpu, &mut canvas, wgpu::TextureUsages::RENDER_ATTACHMENT), expected(&|_, _| true));
    }
}
