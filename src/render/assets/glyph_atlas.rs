//! Glyph atlas of labels: all glyphs of the font, and their halos, in one image.
//!
//! The font is Noto Sans Mono, from the crate `noto-sans-mono-bitmap`, whose glyphs are bitmaps of
//! equal size.

use std::sync::LazyLock;

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Width and height of a glyph, which is also the advance and the line height, pixels.
pub(crate) const GLYPH_SIZE: [u32; 2] =
    [get_raster_width(FontWeight::Regular, RasterHeight::Size16) as u32, RasterHeight::Size16.val() as u32];
/// Padding around each glyph of the atlas, pixels. It contains the halo.
const PADDING: u32 = 2;
/// Characters of the font: printable ASCII, and the letters and signs of Latin-1 and Latin
/// Extended-A. The last glyph of the atlas is a box for all other characters.
const RANGES: [[char; 2]; 2] = [[' ', '~'], ['\u{a1}', '\u{17f}']];
const COUNT: u32 = characters(RANGES[0]) + characters(RANGES[1]) + 1;
const COLUMNS: u32 = 16;
/// Width of the halo around a glyph, pixels.
const HALO: i32 = 1;

/// Image of all glyphs.
#[derive(Debug, Clone)]
pub(crate) struct GlyphAtlas {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Row-major, two bytes per pixel: coverage by the glyph, and coverage by the glyph or its
    /// halo.
    pub(crate) pixels: Vec<u8>,
}

impl GlyphAtlas {
    /// Returns the atlas, which is created on first use.
    pub(crate) fn get() -> &'static Self {
        static ATLAS: LazyLock<GlyphAtlas> = LazyLock::new(GlyphAtlas::new);
        &ATLAS
    }

    fn new() -> Self {
        let [cell_width, cell_height] = GLYPH_SIZE.map(|length| length + 2 * PADDING);
        let (width, height) = (COLUMNS * cell_width, COUNT.div_ceil(COLUMNS) * cell_height);
        let mut atlas = Self { width, height, pixels: vec![0; 2 * (width * height) as usize] };
        for number in 0..COUNT {
            let [left, top] = position(number);
            let character = RANGES.into_iter().flat_map(|[first, last]| first..=last).nth(number as usize);
            let raster =
                character.and_then(|character| get_raster(character, FontWeight::Regular, RasterHeight::Size16));
            let coverage = |x: i32, y: i32| {
                let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return 0 };
                raster.map_or_else(|| replacement_box(x as u32, y as u32), |raster| raster.pixel(x, y).unwrap_or(0))
            };
            let padding = PADDING as i32;
            for y in -padding..GLYPH_SIZE[1] as i32 + padding {
                for x in -padding..GLYPH_SIZE[0] as i32 + padding {
                    let around = (-HALO..=HALO).flat_map(|dy| (-HALO..=HALO).map(move |dx| (dx, dy)));
                    let halo = around.map(|(dx, dy)| coverage(x + dx, y + dy)).max().unwrap_or(0);
                    let at = (left as i32 + x) as usize + (top as i32 + y) as usize * width as usize;
                    atlas.pixels[2 * at..][..2].copy_from_slice(&[coverage(x, y), halo]);
                }
            }
        }
        atlas
    }

    /// Returns the texture coordinates of a glyph, left, top, right and bottom, with `border`
    /// pixels of its padding.
    pub(crate) fn texcoords(&self, character: char, border: u32) -> [f32; 4] {
        let mut before = 0;
        let mut number = COUNT - 1;
        for [first, last] in RANGES {
            if (first..=last).contains(&character) {
                number = before + character as u32 - first as u32;
            }
            before += characters([first, last]);
        }
        let [left, top] = position(number);
        let ([right, bottom], size) =
            ([left + GLYPH_SIZE[0], top + GLYPH_SIZE[1]], [self.width as f32, self.height as f32]);
        [
            (left - border) as f32 / size[0],
            (top - border) as f32 / size[1],
            (right + border) as f32 / size[0],
            (bottom + border) as f32 / size[1],
        ]
    }
}

/// Returns the number of characters of a range.
const fn characters([first, last]: [char; 2]) -> u32 {
    last as u32 - first as u32 + 1
}

/// Returns the upper left pixel of a glyph in the atlas.
fn position(number: u32) -> [u32; 2] {
    let [width, height] = GLYPH_SIZE.map(|length| length + 2 * PADDING);
    [number % COLUMNS * width + PADDING, number / COLUMNS * height + PADDING]
}

/// Returns the coverage of the box that replaces missing glyphs.
fn replacement_box(x: u32, y: u32) -> u8 {
    let (left, right, top, bottom) = (1, GLYPH_SIZE[0] - 2, 3, GLYPH_SIZE[1] - 4);
    let within = (left..=right).contains(&x) && (top..=bottom).contains(&y);
    if within && (x == left || x == right || y == top || y == bottom) { u8::MAX } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::{COUNT, GlyphAtlas, PADDING, RANGES};

    /// Returns the sum of the coverage in a rectangle.
    fn ink(texcoords: [f32; 4], channel: usize) -> usize {
        let atlas = GlyphAtlas::get();
        let [left, right] = [0, 2].map(|side| (texcoords[side] * atlas.width as f32).round() as usize);
        let [top, bottom] = [1, 3].map(|side| (texcoords[side] * atlas.height as f32).round() as usize);
        assert!(right <= atlas.width as usize && bottom <= atlas.height as usize);
        let rows = top..bottom;
        rows.flat_map(|y| {
            (left..right).map(move |x| usize::from(atlas.pixels[2 * (y * atlas.width as usize + x) + channel]))
        })
        .sum()
    }

    fn all() -> impl Iterator<Item = char> {
        RANGES.into_iter().flat_map(|[first, last]| first..=last)
    }

    #[test]
    fn every_visible_glyph_is_distinct_and_has_a_larger_halo() {
        let atlas = GlyphAtlas::get();
        let mut rectangles: Vec<_> = all().chain(['\u{200b}']).map(|character| atlas.texcoords(character, 0)).collect();
        for character in all() {
            let rectangle = atlas.texcoords(character, 0);
            assert!(ink(rectangle, 0) > 0 || matches!(character, ' ' | '\u{ad}'), "{character:?} is empty");
            assert!(ink(rectangle, 0) == 0 || ink(rectangle, 1) > ink(rectangle, 0), "{character:?} has no halo");
        }
        rectangles.sort_by(|a, b| a.partial_cmp(b).unwrap());
        rectangles.dedup();
        assert_eq!(rectangles.len(), COUNT as usize);
    }

    #[test]
    fn letters_with_accents_differ_from_their_base_and_from_a_box() {
        let atlas = GlyphAtlas::get();
        for [accented, base] in [['é', 'e'], ['ö', 'o'], ['Å', 'A'], ['ñ', 'n'], ['š', 's'], ['ł', 'l']] {
            assert!(ink(atlas.texcoords(accented, 0), 0) > ink(atlas.texcoords(base, 0), 0), "{accented}");
            assert_ne!(atlas.texcoords(accented, 0), atlas.texcoords('\u{200b}', 0), "{accented}");
        }
    }

    #[test]
    fn missing_glyphs_are_replaced_by_a_box() {
        let atlas = GlyphAtlas::get();
        for character in ['\n', '\0', '机', 'λ', '\u{7f}', char::MAX] {
            assert_eq!(atlas.texcoords(character, 0), atlas.texcoords('\u{200b}', 0));
        }
    }

    #[test]
    fn halos_stay_within_the_padding() {
        let atlas = GlyphAtlas::get();
        for character in all() {
            let (within, around) = (atlas.texcoords(character, 1), atlas.texcoords(character, PADDING));
            assert_eq!(ink(within, 1), ink(around, 1), "the halo of '{character}' exceeds a pixel");
        }
    }
}
