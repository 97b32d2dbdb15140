//! Labels: text at geoms, as glyph quads that are drawn over everything else.

use crate::render::assets::{GLYPH_SIZE, GlyphAtlas};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::settings::is_drawable;
use crate::render::view::ViewFrustum;
use crate::render::view::matrix::apply;
use crate::render::{Gpu, RenderError};
use crate::scene::Scene;

/// Labels of a scene.
#[derive(Debug)]
pub(crate) struct Labels {
    pub(crate) buffer: GrowableBuffer,
    /// Number of quads.
    pub(crate) count: u32,
    /// Bind group of the glyph atlas, created for the first label.
    pub(crate) atlas: Option<wgpu::BindGroup>,
    quads: Vec<Quad>,
}

impl Labels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let buffer = GrowableBuffer::new(gpu, "glyphs of labels", wgpu::BufferUsages::VERTEX);
        Self { buffer, count: 0, atlas: None, quads: Vec::new() }
    }

    /// Lays out the labels of a scene. The lower left corner of each label is at its geom.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        frustum: &ViewFrustum,
        size: [u32; 2],
    ) -> Result<(), RenderError> {
        self.quads.clear();
        for geom in scene.geoms() {
            let label = geom.label();
            if label.is_empty() {
                continue;
            }
            if let Some([x, y]) = project(geom.pos(), frustum, size) {
                let at = [x.round(), (y - GLYPH_SIZE[1] as f32 * Style::LABEL.scale).round()];
                self.quads.extend(layout(label, at, Style::LABEL));
            }
        }
        if frustum.flip_y {
            let height = size[1] as f32;
            for Quad { rect: [_, top, _, bottom], .. } in &mut self.quads {
                (*top, *bottom) = (height - *top, height - *bottom);
            }
        }
        self.count = self.quads.len() as u32;
        self.buffer.write(gpu, bytemuck::cast_slice(&self.quads))?;
        Ok(())
    }
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

/// Text style.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Style {
    /// Colour of the glyphs.
    rgba: [f32; 4],
    /// Colour of the halo behind the glyphs; no halo if it is transparent.
    halo: [f32; 4],
    /// Scale relative to the size of the font.
    scale: f32,
}

impl Style {
    /// Style of labels: white, with a half-transparent black halo.
    const LABEL: Self = Self { rgba: [1.0; 4], halo: [0.0, 0.0, 0.0, 0.5], scale: 1.0 };
}

/// Rectangle that shows a glyph of the atlas. `label.wgsl` declares the same inputs.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Quad {
    /// Left, top, right and bottom, pixels from the upper left corner of the image.
    rect: [f32; 4],
    /// Left, top, right and bottom in the atlas, as texture coordinates.
    texcoords: [f32; 4],
    rgba: [f32; 4],
    /// Weights of the two channels of the atlas: `[1, 0]` for glyphs, `[0, 1]` for halos.
    channel: [f32; 2],
}

/// Lays out a text whose upper left corner is at `at`, pixels. Returns its quads in drawing order:
/// first all halos, then all glyphs. A line feed starts a new line; characters missing in the font
/// are boxes.
fn layout(text: &str, at: [f32; 2], style: Style) -> impl Iterator<Item = Quad> + '_ {
    let halos =
        (style.halo[3] > 0.0).then(|| layer(text, at, style.scale, style.halo, [0.0, 1.0])).into_iter().flatten();
    halos.chain(layer(text, at, style.scale, style.rgba, [1.0, 0.0]))
}

fn layer(text: &str, at: [f32; 2], scale: f32, rgba: [f32; 4], channel: [f32; 2]) -> impl Iterator<Item = Quad> + '_ {
    // Empty border around glyphs, too, so that enlarged glyphs have no hard edge.
    const BORDER: u32 = 1;
    glyphs(text).map(move |(character, [column, row])| {
        let position = |axis: usize, cells: u32| at[axis] + scale * (cells * GLYPH_SIZE[axis]) as f32;
        let (left, top) = (position(0, column) - scale * BORDER as f32, position(1, row) - scale * BORDER as f32);
        let size = GLYPH_SIZE.map(|length| scale * (length + 2 * BORDER) as f32);
        Quad {
            rect: [left, top, left + size[0], top + size[1]],
            texcoords: GlyphAtlas::get().texcoords(character, BORDER),
            rgba,
            channel,
        }
    })
}

/// Iterates over the visible characters, with their columns and rows.
fn glyphs(text: &str) -> impl Iterator<Item = (char, [u32; 2])> + '_ {
    let mut next = [0, 0];
    text.chars().filter_map(move |character| {
        let cell = next;
        next = if character == '\n' { [0, cell[1] + 1] } else { [cell[0] + 1, cell[1]] };
        // A tab has the width of a space.
        (!matches!(character, '\n' | ' ' | '\u{a0}' | '\t' | '\r')).then_some((character, cell))
    })
}

#[cfg(test)]
mod tests {
    use super::{GLYPH_SIZE, Style, layout};

    #[test]
    fn glyphs_are_arranged_in_columns_and_rows() {
        let style = Style { halo: [0.0; 4], ..Style::LABEL };
        let [width, height] = GLYPH_SIZE.map(|length| length as f32);
        let quads: Vec<_> = layout("ab c\nd", [10.0, 20.0], style).collect();
        let cells: Vec<_> = quads.iter().map(|quad| [quad.rect[0] + 1.0 - 10.0, quad.rect[1] + 1.0 - 20.0]).collect();
        assert_eq!(cells, [[0.0, 0.0], [width, 0.0], [3.0 * width, 0.0], [0.0, height]]);
    }

    #[test]
    fn halos_are_behind_all_glyphs() {
        let quads: Vec<_> = layout("äb", [0.0; 2], Style::LABEL).collect();
        assert_eq!(quads.len(), 4);
        assert!(quads[..2].iter().all(|quad| quad.channel == [0.0, 1.0] && quad.rgba == Style::LABEL.halo));
        assert!(quads[2..].iter().all(|quad| quad.channel == [1.0, 0.0] && quad.rgba == Style::LABEL.rgba));
    }

    #[test]
    fn quads_are_scaled() {
        for scale in [0.5, 1.0, 3.0] {
            let quad = layout("x", [0.0; 2], Style { scale, ..Style::LABEL }).next().unwrap();
            assert_eq!(quad.rect[2] - quad.rect[0], scale * (GLYPH_SIZE[0] + 2) as f32);
            assert_eq!(quad.rect[3] - quad.rect[1], scale * (GLYPH_SIZE[1] + 2) as f32);
        }
    }
}
