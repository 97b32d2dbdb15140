//! Colour palette and dithering for GIF.

use std::collections::BTreeSet;

use color_quant::NeuQuant;

type Rgb = [u8; 3];

/// Palette of at most 255 colours, plus one index for transparency, with ordered dithering (Bayer,
/// ICC 1973).
///
/// The dither pattern is fixed to the pixel grid, so static regions neither flicker nor need to be
/// written again.
#[derive(Debug, Default)]
pub(super) struct Palette {
    colors: Vec<Rgb>,
    /// Amplitude of the dither pattern, in channel steps: the typical distance between two colours
    /// of the palette.
    strength: f32,
    /// Mean square error of the image for which the palette was computed.
    error: f64,
    /// Cache of nearest colours, indexed by a hash of the requested colour.
    cache: Vec<Option<(Rgb, u8)>>,
}

impl Palette {
    const MAX_COLORS: usize = 255;
    const CACHE_BITS: u32 = 16;

    /// Computes the palette of an image. If the image has few colours, the palette contains exactly
    /// these.
    pub(super) fn of(pixels: &[Rgb], width: usize) -> Self {
        // For a large image, a sample of every tenth pixel is sufficient.
        const LARGE: usize = 40_000;
        let cache = vec![None; 1 << Self::CACHE_BITS];
        if let Some(colors) = few_colors(pixels) {
            return Self { colors, cache, ..Self::default() };
        }
        let sampled = if pixels.len() >= LARGE { 10 } else { 1 };
        let rgba: Vec<u8> = pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let colors = NeuQuant::new(sampled, Self::MAX_COLORS, &rgba).color_map_rgb();
        let mut palette = Self { colors: colors.as_chunks().0.to_vec(), cache, ..Self::default() };
        let mut indices = Vec::new();
        // The distance to the nearest colour is about half the distance between two colours.
        let error = palette.quantise(pixels, width, &mut indices);
        palette.strength = (2.0 * (error / 3.0).sqrt() as f32).min(16.0);
        palette.error = palette.quantise(pixels, width, &mut indices);
        palette
    }

    /// Quantises an image: writes one palette index per pixel. Returns the mean square error.
    pub(super) fn quantise(&mut self, pixels: &[Rgb], width: usize, indices: &mut Vec<u8>) -> f64 {
        indices.clear();
        let mut error = 0;
        for (row, line) in pixels.chunks(width).enumerate() {
            for (column, &pixel) in line.iter().enumerate() {
                let offset = self.strength * bayer(row, column);
                let requested = pixel.map(|channel| (f32::from(channel) + offset).round() as u8);
                let index = self.nearest(requested);
                error += u64::from(square_distance(pixel, self.color(index)));
                indices.push(index);
            }
        }
        error as f64 / pixels.len() as f64
    }

    /// Returns `true` if this error is not much larger than the error of the image for which the
    /// palette was computed.
    pub(super) fn fits(&self, error: f64) -> bool {
        error <= 1.5 * self.error + 1.0
    }

    /// Returns the colour table, with an entry for the transparent index.
    pub(super) fn table(&self) -> Vec<u8> {
        let mut table = self.colors.as_flattened().to_vec();
        table.extend([0; 3]);
        table
    }

    pub(super) fn color(&self, index: u8) -> Rgb {
        self.colors[usize::from(index)]
    }

    pub(super) fn transparent(&self) -> u8 {
        self.colors.len() as u8
    }

    fn nearest(&mut self, requested: Rgb) -> u8 {
        let [r, g, b] = requested.map(u32::from);
        // Fibonacci hashing, which spreads similar colours.
        let slot = (r << 16 | g << 8 | b).wrapping_mul(2_654_435_769) >> (u32::BITS - Self::CACHE_BITS);
        let slot = slot as usize;
        if let Some((color, index)) = self.cache[slot]
            && color == requested
        {
            return index;
        }
        let nearest = (0..self.colors.len()).min_by_key(|&index| square_distance(requested, self.colors[index]));
        let index = nearest.unwrap_or(0) as u8;
        self.cache[slot] = Some((requested, index));
        index
    }
}

/// Returns all colours of an image, or `None` if they exceed the palette.
fn few_colors(pixels: &[Rgb]) -> Option<Vec<Rgb>> {
    let mut colors = BTreeSet::new();
    for &pixel in pixels {
        if colors.insert(pixel) && colors.len() > Palette::MAX_COLORS {
            return None;
        }
    }
    Some(colors.into_iter().collect())
}

fn square_distance(a: Rgb, b: Rgb) -> u32 {
    a.into_iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}

/// Returns an element of the 8 × 8 Bayer matrix: each of 64 values from -1/2 to 1/2 occurs once,
/// with similar values far apart.
fn bayer(row: usize, column: usize) -> f32 {
    let mixed = row ^ column;
    let bits = [mixed & 1, row & 1, mixed >> 1 & 1, row >> 1 & 1, mixed >> 2 & 1, row >> 2 & 1];
    let rank = bits.into_iter().fold(0, |rank, bit| 2 * rank + bit);
    (rank as f32 + 0.5) / 64.0 - 0.5
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{Palette, bayer};

    #[test]
    fn the_bayer_matrix_contains_each_value_once() {
        let values: BTreeSet<i32> = (0..64).map(|slot| (bayer(slot / 8, slot % 8) * 64.0 + 31.5) as i32).collect();
        assert_eq!(values, (0..64).collect());
    }

    #[test]
    fn an_image_with_few_colours_is_reproduced_exactly() {
        let pixels: Vec<[u8; 3]> = (0..1000_u32).map(|pixel| [(pixel % 200) as u8, 7, 255]).collect();
        let mut palette = Palette::of(&pixels, 100);
        let mut indices = Vec::new();
        assert_eq!(palette.quantise(&pixels, 100, &mut indices), 0.0);
        assert!(indices.iter().zip(&pixels).all(|(&index, &pixel)| palette.color(index) == pixel));
        assert!(palette.transparent() == 200 && palette.table().len() == 3 * 201);
    }

    #[test]
    fn dithering_preserves_local_mean_colours() {
        // A gradient from blue to orange with more colours than the palette has.
        let (width, height) = (256, 16);
        let slope = |slot: usize| {
            let (x, y) = ((slot % width) as u8, (slot / width) as u8);
            [x, 64 + x / 2 + y, 255 - x]
        };
        let pixels: Vec<[u8; 3]> = (0..width * height).map(slope).collect();
        let mut palette = Palette::of(&pixels, width);
        let mut indices = Vec::new();
        let error = palette.quantise(&pixels, width, &mut indices);
        assert!(palette.fits(error) && error < 100.0, "{error}");
        // Averaged over squares of 16 pixels, the dithered image matches the original.
        for (top, left) in (0..height).step_by(16).flat_map(|top| (0..width).step_by(16).map(move |left| (top, left))) {
            for channel in [0, 1, 2] {
                let mean = |value: &dyn Fn(usize) -> u8| {
                    let places = (0..256).map(|slot| (top + slot / 16) * width + left + slot % 16);
                    places.map(|slot| f64::from(value(slot))).sum::<f64>() / 256.0
                };
                let (found, expected) =
                    (mean(&|slot| palette.color(indices[slot])[channel]), mean(&|slot| pixels[slot][channel]));
                assert!((found - expected).abs() < 8.0, "{found} instead of {expected} in the square at {left}, {top}");
            }
        }
    }
}
