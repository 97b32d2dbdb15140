//! The letters, and their halos.

use std::sync::LazyLock;

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Width and height of a letter, pixels. Neighbours and lines touch.
pub(crate) const CELL: [u32; 2] =
    [get_raster_width(FontWeight::Regular, RasterHeight::Size16) as u32, RasterHeight::Size16.val() as u32];
/// Empty pixels around each letter of the atlas, where its halo is.
pub(super) const MARGIN: u32 = 2;
/// The letters that the font has are all that can be printed of ASCII; after them comes the box for those that it has not.
const FIRST: char = ' ';
const LAST: char = '~';
const COUNT: u32 = LAST as u32 - FIRST as u32 + 2;
const COLUMNS: u32 = 16;
/// How far the halo reaches around a letter, pixels.
const HALO: i32 = 1;

/// An image of all letters.
#[derive(Debug, Clone)]
pub(crate) struct Atlas {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Row by row, two bytes for each pixel: how much of it is within the letter, and within the letter or its halo.
    pub(crate) pixels: Vec<u8>,
}

impl Atlas {
    /// The one that there is.
    pub(crate) fn get() -> &'static Self {
        static ATLAS: LazyLock<Atlas> = LazyLock::new(Atlas::new);
        &ATLAS
    }

    fn new() -> Self {
        let [cell_width, cell_height] = CELL.map(|length| length + 2 * MARGIN);
        let (width, height) = (COLUMNS * cell_width, COUNT.div_ceil(COLUMNS) * cell_height);
        let mut atlas = Self { width, height, pixels: vec![0; 2 * (width * height) as usize] };
        for number in 0..COUNT {
            let [left, top] = place(number);
            let letter = (number + 1 < COUNT).then(|| char::from_u32(FIRST as u32 + number)).flatten();
            let raster = letter.and_then(|letter| get_raster(letter, FontWeight::Regular, RasterHeight::Size16));
            let coverage = |x: i32, y: i32| {
                let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return 0 };
                raster.map_or_else(|| outline(x as u32, y as u32), |raster| raster.pixel(x, y).unwrap_or(0))
            };
            let margin = MARGIN as i32;
            for y in -margin..CELL[1] as i32 + margin {
                for x in -margin..CELL[0] as i32 + margin {
                    let around = (-HALO..=HALO).flat_map(|dy| (-HALO..=HALO).map(move |dx| (dx, dy)));
                    let halo = around.map(|(dx, dy)| coverage(x + dx, y + dy)).max().unwrap_or(0);
                    let at = (left as i32 + x) as usize + (top as i32 + y) as usize * width as usize;
                    atlas.pixels[2 * at..][..2].copy_from_slice(&[coverage(x, y), halo]);
                }
            }
        }
        atlas
    }

    /// Where a letter is in the atlas: left, top, right and bottom as fractions of it, with `border` pixels of its margin.
    pub(super) fn texcoords(&self, letter: char, border: u32) -> [f32; 4] {
        let number = if (FIRST..=LAST).contains(&letter) { letter as u32 - FIRST as u32 } else { COUNT - 1 };
        let [left, top] = place(number);
        let ([right, bottom], size) = ([left + CELL[0], top + CELL[1]], [self.width as f32, self.height as f32]);
        [
            (left - border) as f32 / size[0],
            (top - border) as f32 / size[1],
            (right + border) as f32 / size[0],
            (bottom + border) as f32 / size[1],
        ]
    }
}

/// The corner of a letter in the atlas.
fn place(number: u32) -> [u32; 2] {
    let [width, height] = CELL.map(|length| length + 2 * MARGIN);
    [number % COLUMNS * width + MARGIN, number / COLUMNS * height + MARGIN]
}

/// The box that stands for a letter that the font has not.
fn outline(x: u32, y: u32) -> u8 {
    let (left, right, top, bottom) = (1, CELL[0] - 2, 3, CELL[1] - 4);
    let within = (left..=right).contains(&x) && (top..=bottom).contains(&y);
    if within && (x == left || x == right || y == top || y == bottom) { u8::MAX } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::{Atlas, CELL, FIRST, LAST, MARGIN};

    fn ink(texcoords: [f32; 4], channel: usize) -> usize {
        let atlas = Atlas::get();
        let [left, right] = [0, 2].map(|side| (texcoords[side] * atlas.width as f32).round() as usize);
        let [top, bottom] = [1, 3].map(|side| (texcoords[side] * atlas.height as f32).round() as usize);
        assert!(right <= atlas.width as usize && bottom <= atlas.height as usize);
        let rows = top..bottom;
        rows.flat_map(|y| {
            (left..right).map(move |x| usize::from(atlas.pixels[2 * (y * atlas.width as usize + x) + channel]))
        })
        .sum()
    }

    #[test]
    fn every_letter_but_the_space_has_a_shape_of_its_own_and_a_halo_that_is_larger() {
        let atlas = Atlas::get();
        assert_eq!(ink(atlas.texcoords(' ', MARGIN), 1), 0);
        let mut places: Vec<_> = (FIRST..=LAST).chain(['é']).map(|letter| atlas.texcoords(letter, 0)).collect();
        for &place in &places[1..] {
            assert!(ink(place, 0) > 255, "empty");
            assert!(ink(place, 1) > ink(place, 0), "no halo");
        }
        places.sort_by(|a, b| a.partial_cmp(b).unwrap());
        places.dedup();
        assert_eq!(places.len(), (LAST as usize - FIRST as usize + 1) + 1);
    }

    #[test]
    fn what_the_font_has_not_is_a_box() {
        let atlas = Atlas::get();
        for letter in ['é', '\n', '\0', '机', '\u{7f}', char::MAX] {
            assert_eq!(atlas.texcoords(letter, 0), atlas.texcoords('\u{200b}', 0));
        }
        assert_ne!(atlas.texcoords('é', 0), atlas.texcoords('e', 0));
    }

    #[test]
    fn letters_do_not_reach_into_each_others_margins() {
        let atlas = Atlas::get();
        for letter in FIRST..=LAST {
            let (within, around) = (atlas.texcoords(letter, 1), atlas.texcoords(letter, MARGIN));
            assert_eq!(ink(within, 1), ink(around, 1), "'{letter}' of {CELL:?} has a halo beyond a pixel");
        }
    }
}
