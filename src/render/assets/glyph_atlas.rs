//! Glyph atlas of labels: the glyphs that the labels of an image need, and their halos, in one
//! image.

use std::collections::HashMap;

use super::font::{self, Glyph};

/// Width of the atlas, pixels.
const WIDTH: u32 = 1024;
/// Initial and largest height of the atlas, pixels.
const HEIGHTS: [u32; 2] = [64, 2048];
/// Size of the em square relative to the height of a line.
const EM: f32 = 14.0 / 16.0;
/// Width of the halo around a glyph relative to the height of a line.
const HALO: f32 = 1.5 / 16.0;

/// Image of glyphs of one size. It grows with the number of glyphs.
#[derive(Debug, Clone)]
pub(crate) struct GlyphAtlas {
    /// Height of a line, pixels.
    line: f32,
    pub(crate) size: [u32; 2],
    /// Row-major, two bytes per pixel: coverage by the glyph, and coverage by the glyph or its
    /// halo.
    pub(crate) pixels: Vec<u8>,
    glyphs: HashMap<char, PlacedGlyph>,
    /// Upper left corner of the next glyph, and the height of its row.
    next: [u32; 2],
    row: u32,
    /// Number of changes of the pixels.
    pub(crate) version: u64,
}

/// Glyph of the atlas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedGlyph {
    /// Upper left corner in the atlas, pixels, with the halo.
    pub(crate) place: [u32; 2],
    /// Width and height with the halo, pixels. Zero for a space.
    pub(crate) size: [u32; 2],
    /// Upper left corner from the position of the pen on the base line, pixels.
    pub(crate) origin: [i32; 2],
    /// Distance of the pen to the next glyph, in whole pixels.
    pub(crate) advance: f32,
}

impl GlyphAtlas {
    /// Creates an atlas for lines of this height, pixels.
    pub(crate) fn new(line: f32) -> Self {
        let size = [WIDTH, HEIGHTS[0]];
        let pixels = vec![0; 2 * (size[0] * size[1]) as usize];
        Self { line, size, pixels, glyphs: HashMap::new(), next: [0; 2], row: 0, version: 0 }
    }

    /// Removes all glyphs.
    pub(crate) fn clear(&mut self) {
        *self = Self { version: self.version + 1, ..Self::new(self.line) };
    }

    /// Returns the height of a line, pixels.
    pub(crate) fn line(&self) -> f32 {
        self.line
    }

    /// Returns the distance of the base line from the top of the line, pixels.
    pub(crate) fn base_line(&self) -> f32 {
        (0.8 * self.line).round()
    }

    /// Returns a glyph, which is added on first use. `None` if the atlas is full.
    pub(crate) fn glyph(&mut self, character: char) -> Option<PlacedGlyph> {
        if let Some(known) = self.glyphs.get(&character) {
            return Some(*known);
        }
        let glyph = font::glyph(character, EM * self.line);
        let advance = glyph.advance.round();
        let placed = if glyph.size.contains(&0) {
            PlacedGlyph { place: [0; 2], size: [0; 2], origin: [0; 2], advance }
        } else {
            let halo = self.halo_pixels();
            let size = glyph.size.map(|length| length + 2 * halo);
            let place = self.place(size)?;
            self.draw(&glyph, place);
            PlacedGlyph { place, size, origin: glyph.origin.map(|part| part - halo as i32), advance }
        };
        self.glyphs.insert(character, placed);
        Some(placed)
    }

    /// Returns the width of the border of a glyph that contains its halo.
    fn halo_pixels(&self) -> u32 {
        (HALO * self.line + 0.5).ceil() as u32
    }

    /// Reserves a rectangle. The border of one pixel keeps the linear filter from its neighbours.
    fn place(&mut self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        let [width, height] = [width + 1, height + 1];
        let [mut x, mut y] = self.next;
        let mut row = self.row;
        if x + width > self.size[0] {
            ([x, y], row) = ([0, y + row], 0);
        }
        if width > self.size[0] || y + height > HEIGHTS[1] {
            return None;
        }
        while y + height > self.size[1] {
            self.size[1] *= 2;
            self.pixels.resize(2 * (self.size[0] * self.size[1]) as usize, 0);
        }
        (self.next, self.row) = ([x + width, y], row.max(height));
        Some([x, y])
    }

    fn draw(&mut self, glyph: &Glyph, place: [u32; 2]) {
        let border = self.halo_pixels() as i32;
        let radius = HALO * self.line;
        let [width, height] = glyph.size.map(|length| length as i32);
        let coverage = |x: i32, y: i32| {
            let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
            if is_inside { glyph.coverage[(y * width + x) as usize] } else { 0 }
        };
        // Pixels of a disc, with their weights.
        let around = (-border..=border).flat_map(|dy| (-border..=border).map(move |dx| [dx, dy]));
        let weight = |[dx, dy]: [i32; 2]| (radius + 0.5 - (dx as f32).hypot(dy as f32)).clamp(0.0, 1.0);
        let disc: Vec<_> = around.map(|at| (at, weight(at))).filter(|(_, weight)| *weight > 0.0).collect();
        for y in -border..height + border {
            for x in -border..width + border {
                let part = |&([dx, dy], weight): &([i32; 2], f32)| weight * f32::from(coverage(x + dx, y + dy));
                let halo = disc.iter().map(part).fold(0.0, f32::max);
                let [left, top] = [0, 1].map(|axis| place[axis] as i32 + border + [x, y][axis]);
                let at = 2 * (top as usize * self.size[0] as usize + left as usize);
                self.pixels[at..at + 2].copy_from_slice(&[coverage(x, y), halo.round() as u8]);
            }
        }
        self.version += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::{GlyphAtlas, HEIGHTS, PlacedGlyph, WIDTH};

    /// Returns the sum of a channel in the rectangle of a glyph.
    fn ink(atlas: &GlyphAtlas, glyph: PlacedGlyph, channel: usize) -> usize {
        let pixels = |y: u32| (0..glyph.size[0]).map(move |x| [glyph.place[0] + x, glyph.place[1] + y]);
        let all = (0..glyph.size[1]).flat_map(pixels);
        all.map(|[x, y]| usize::from(atlas.pixels[2 * (y * atlas.size[0] + x) as usize + channel])).sum()
    }

    #[test]
    fn glyphs_have_larger_halos_within_their_rectangles() {
        for line in [8.0, 16.0, 40.0] {
            let mut atlas = GlyphAtlas::new(line);
            let glyphs: Vec<_> = ('!'..='~').map(|letter| atlas.glyph(letter).unwrap()).collect();
            for &glyph in &glyphs {
                assert!(0 < ink(&atlas, glyph, 0) && ink(&atlas, glyph, 0) < ink(&atlas, glyph, 1));
            }
            for channel in [0, 1] {
                let parts: usize = glyphs.iter().map(|&glyph| ink(&atlas, glyph, channel)).sum();
                let all: usize = atlas.pixels.iter().skip(channel).step_by(2).map(|&byte| usize::from(byte)).sum();
                assert_eq!(parts, all, "rectangles overlap, or do not contain their glyphs");
            }
        }
    }

    #[test]
    fn atlas_grows_and_keeps_its_glyphs() {
        let mut atlas = GlyphAtlas::new(16.0);
        let first = atlas.glyph('A').unwrap();
        let (before, version) = (ink(&atlas, first, 1), atlas.version);
        assert_eq!((atlas.glyph('A').unwrap(), atlas.version), (first, version));
        for letter in '\u{400}'..='\u{4ff}' {
            atlas.glyph(letter).unwrap();
        }
        assert!(atlas.size[1] > HEIGHTS[0] && atlas.version > version);
        assert_eq!((atlas.glyph('A').unwrap(), ink(&atlas, first, 1)), (first, before));
    }

    #[test]
    fn full_atlas_is_usable_after_it_is_cleared() {
        let mut atlas = GlyphAtlas::new(16.0);
        while atlas.place([WIDTH - 1, 4]).is_some() {}
        assert_eq!((atlas.size[1], atlas.glyph('A')), (HEIGHTS[1], None));
        atlas.clear();
        assert!(atlas.glyph('A').is_some());
    }
}
