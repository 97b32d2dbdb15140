//! Labels: text at geoms, as glyph quads that are drawn over everything else.

use crate::render::assets::{GlyphAtlas, PlacedGlyph, glyph_atlas};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::settings::is_drawable;
use crate::render::view::ViewFrustum;
use crate::render::view::matrix::apply;
use crate::render::{Gpu, RenderError};
use crate::scene::Scene;

/// Height of a line at the font scale 1, pixels.
const LINE: f64 = 16.0;
/// Range of the font scale.
const SCALES: std::ops::RangeInclusive<f64> = 0.25..=10.0;
/// Colours of the halo and of the glyphs: white letters with a dark border, which are legible on
/// every background.
const COLORS: [[f32; 4]; 2] = [[0.0, 0.0, 0.0, 0.75], [1.0; 4]];

/// Labels of a scene.
#[derive(Debug)]
pub(crate) struct Labels {
    pub(crate) buffer: GrowableBuffer,
    /// Number of quads.
    pub(crate) count: u32,
    /// Bind group of the glyph atlas, and the version of its content.
    pub(crate) atlas: Option<(u64, wgpu::BindGroup)>,
    glyphs: GlyphAtlas,
    quads: Vec<Quad>,
}

impl Labels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let buffer = GrowableBuffer::new(gpu, "glyphs of labels", wgpu::BufferUsages::VERTEX);
        Self { buffer, count: 0, atlas: None, glyphs: GlyphAtlas::new(LINE as f32), quads: Vec::new() }
    }

    /// Lays out the labels of a scene at a font scale. The lower left corner of each label is at
    /// its geom.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        frustum: &ViewFrustum,
        size: [u32; 2],
        scale: f64,
    ) -> Result<(), RenderError> {
        let line = line_height(scale);
        if line != self.glyphs.line() {
            (self.glyphs, self.atlas) = (GlyphAtlas::new(line), None);
        }
        // A full atlas is filled again with the glyphs of this image only.
        if !self.lay_out(scene, frustum, size) {
            self.glyphs.clear();
            self.lay_out(scene, frustum, size);
        }
        if frustum.flip_y {
            let height = size[1] as f32;
            for Quad { rect: [_, top, _, bottom], .. } in &mut self.quads {
                (*top, *bottom) = (height - *top, height - *bottom);
            }
        }
        self.count = self.quads.len() as u32;
        if self.count > 0 && self.atlas.as_ref().is_none_or(|(version, _)| *version != self.glyphs.version) {
            self.atlas = Some((self.glyphs.version, glyph_atlas(gpu, &self.glyphs)));
        }
        self.buffer.write(gpu, bytemuck::cast_slice(&self.quads))?;
        Ok(())
    }

    /// Returns `false` if the atlas has no place for a glyph, which is then left out.
    fn lay_out(&mut self, scene: &Scene, frustum: &ViewFrustum, size: [u32; 2]) -> bool {
        self.quads.clear();
        let mut is_complete = true;
        for geom in scene.geoms().filter(|geom| !geom.label().is_empty()) {
            if let Some([x, y]) = project(geom.pos(), frustum, size) {
                let at = [x.round(), (y - self.glyphs.line()).round()];
                is_complete &= lay_out(geom.label(), at, &mut self.glyphs, &mut self.quads);
            }
        }
        is_complete
    }
}

/// Returns the height of a line at a font scale, pixels.
fn line_height(scale: f64) -> f32 {
    let scale = if scale.is_nan() { 1.0 } else { scale.clamp(*SCALES.start(), *SCALES.end()) };
    (LINE * scale).round() as f32
}

/// Projects a point to pixels from the upper left corner of the image; `None` if it is outside of
/// the frustum.
fn project(point: [f32; 3], frustum: &ViewFrustum, size: [u32; 2]) -> Option<[f32; 2]> {
    if !point.iter().all(|&coordinate| is_drawable(coordinate)) {
        return None;
    }
    let [x, y, z] = point.map(f64::from);
    let [x, y, z, w] = apply(&frustum.clip, [x, y, z, 1.0]);
    let is_visible = w > 0.0 && x.abs() <= w && y.abs() <= w && z >= 0.0 && z <= w;
    let [width, height] = size.map(f64::from);
    let y = if frustum.flip_y { -y } else { y };
    is_visible.then(|| [((0.5 + 0.5 * x / w) * width) as f32, ((0.5 - 0.5 * y / w) * height) as f32])
}

/// Rectangle that shows a glyph of the atlas. `label.wgsl` declares the same inputs.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Quad {
    /// Left, top, right and bottom, pixels from the upper left corner of the image.
    rect: [f32; 4],
    /// Left, top, right and bottom in the atlas, pixels.
    texels: [f32; 4],
    rgba: [f32; 4],
    /// Weights of the two channels of the atlas: `[1, 0]` for glyphs, `[0, 1]` for halos.
    channel: [f32; 2],
}

/// Lays out a text whose upper left corner is at `at`, pixels. Adds its quads in drawing order:
/// first all halos, then all glyphs. A line feed starts a new line. Returns `false` if the atlas
/// has no place for a glyph.
fn lay_out(text: &str, at: [f32; 2], atlas: &mut GlyphAtlas, quads: &mut Vec<Quad>) -> bool {
    let mut is_complete = true;
    let first = quads.len();
    let mut pen = [at[0], at[1] + atlas.base_line()];
    for character in text.chars() {
        match character {
            '\n' => pen = [at[0], pen[1] + atlas.line()],
            '\r' => {}
            _ => match atlas.glyph(if character == '\t' { ' ' } else { character }) {
                Some(glyph) => {
                    if !glyph.size.contains(&0) {
                        quads.push(Quad::new(&glyph, pen, COLORS[0], [0.0, 1.0]));
                    }
                    pen[0] += glyph.advance;
                }
                None => is_complete = false,
            },
        }
    }
    quads.extend_from_within(first..);
    let count = (quads.len() - first) / 2;
    for quad in &mut quads[first + count..] {
        (quad.rgba, quad.channel) = (COLORS[1], [1.0, 0.0]);
    }
    is_complete
}

impl Quad {
    /// Creates the quad of a glyph with the pen at this position.
    fn new(glyph: &PlacedGlyph, pen: [f32; 2], rgba: [f32; 4], channel: [f32; 2]) -> Self {
        let rect = |[x, y]: [f32; 2]| [x, y, x + glyph.size[0] as f32, y + glyph.size[1] as f32];
        let corner = [0, 1].map(|axis| pen[axis] + glyph.origin[axis] as f32);
        Self { rect: rect(corner), texels: rect(glyph.place.map(|texel| texel as f32)), rgba, channel }
    }
}

#[cfg(test)]
mod tests {
    use super::{COLORS, GlyphAtlas, Quad, lay_out, line_height};

    fn laid_out(text: &str, at: [f32; 2], line: f32) -> Vec<Quad> {
        let mut quads = Vec::new();
        assert!(lay_out(text, at, &mut GlyphAtlas::new(line), &mut quads));
        quads
    }

    #[test]
    fn glyphs_are_arranged_in_lines() {
        let quads = laid_out("mm m\nm", [10.0, 20.0], 16.0);
        let glyphs = &quads[4..];
        let [x, y] = [0, 1].map(|side| glyphs.iter().map(|quad| quad.rect[side]).collect::<Vec<_>>());
        let mut atlas = GlyphAtlas::new(16.0);
        let (m, space) = (atlas.glyph('m').unwrap().advance, atlas.glyph(' ').unwrap().advance);
        assert_eq!(x, [x[0], x[0] + m, x[0] + 2.0 * m + space, x[0]]);
        assert_eq!(y, [y[0], y[0], y[0], y[0] + 16.0]);
        assert!((x[0] - 10.0).abs() <= 3.0 && y[0] >= 20.0 && glyphs[0].rect[3] <= 36.0, "{:?}", glyphs[0]);
    }

    #[test]
    fn halos_are_behind_all_glyphs() {
        let quads = laid_out("äb Ж", [0.0; 2], 16.0);
        assert_eq!(quads.len(), 6);
        assert!(quads[..3].iter().all(|quad| quad.channel == [0.0, 1.0] && quad.rgba == COLORS[0]));
        assert!(quads[3..].iter().all(|quad| quad.channel == [1.0, 0.0] && quad.rgba == COLORS[1]));
        assert!(quads.iter().zip(&quads[3..]).all(|(halo, glyph)| halo.rect == glyph.rect));
    }

    #[test]
    fn control_characters_have_no_boxes() {
        assert_eq!(laid_out("\r\n\t", [0.0; 2], 16.0), []);
        assert_eq!(laid_out("a\r\nb", [0.0; 2], 16.0), laid_out("a\nb", [0.0; 2], 16.0));
    }

    #[test]
    fn texts_are_scaled_within_limits() {
        assert_eq!([0.25, 1.0, 1.5, 3.0].map(line_height), [4.0, 16.0, 24.0, 48.0]);
        assert_eq!([f64::NAN, 0.0, -1.0, f64::INFINITY].map(line_height), [16.0, 4.0, 4.0, 160.0]);
        let width = |line| laid_out("Hello", [0.0; 2], line).last().unwrap().rect[2];
        assert!((width(48.0) / width(16.0) - 3.0).abs() < 0.2);
    }
}
