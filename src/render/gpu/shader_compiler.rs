//! Shader compiler of the graphics driver.

use super::Gpu;
use crate::render::RenderError;
use crate::render::pass::{COLOR_FORMAT, create_texture, default_view, screen_pipeline};

const SHADER: &str = "
@fragment
fn fill() -> @location(0) vec4f {
    return vec4f(1.0);
}
";

impl Gpu {
    /// Draws one pixel and waits for it. Drivers load their shader compiler at the first draw,
    /// which registers exit handlers that must precede the handler of
    /// [`DriverUse`](super::DriverUse).
    pub(super) fn load_shader_compiler(&self) -> Result<(), RenderError> {
        self.guarded(|| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            let view = default_view(&create_texture(self, "image of one pixel", [1, 1], COLOR_FORMAT, 1, usage));
            let pipeline = screen_pipeline(self, SHADER, "fill", COLOR_FORMAT.into());
            let mut encoder = self.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                })],
                ..Default::default()
            });
            pass.set_pipeline(&pipeline);
            pass.draw(0..3, 0..1);
            drop(pass);
            self.submit(encoder);
            self.wait()
        })
    }
}
