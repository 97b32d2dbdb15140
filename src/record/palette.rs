//! The few colours of a GIF.

use std::collections::BTreeSet;

use color_quant::NeuQuant;

type Rgb = [u8; 3];

/// At most 255 colours, and a way to paint with them. One more index is left for transparency.
///
/// Between two colours it paints a pattern of both (ordered dither: Bayer, ICC 1973). The pattern stays where it is from
/// picture to picture: what does not move does not flicker, and need not be written again.
#[derive(Debug, Default)]
pub(super) struct Palette {
    colors: Vec<Rgb>,
    /// How strong the pattern is, in steps of a channel: as the colours are apart.
    strength: f32,
    /// The mean square error of the picture that the colours were chosen for.
    error: f64,
    /// The nearest colours of those that were looked up last.
    known: Vec<Option<(Rgb, u8)>>,
}

impl Palette {
    const MOST_COLORS: usize = 255;
    const KNOWN_BITS: u32 = 16;

    /// The best for a picture: its own colours, if they are few.
    pub(super) fn of(pixels: &[Rgb], width: usize) -> Self {
        // Of a large picture one pixel in ten is sample enough.
        const LARGE: usize = 40_000;
        let known = vec![None; 1 << Self::KNOWN_BITS];
        if let Some(colors) = few_colors(pixels) {
            return Self { colors, known, ..Self::default() };
        }
        let sampled = if pixels.len() >= LARGE { 10 } else { 1 };
        let rgba: Vec<u8> = pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let colors = NeuQuant::new(sampled, Self::MOST_COLORS, &rgba).color_map_rgb();
        let mut palette = Self { colors: colors.as_chunks().0.to_vec(), known, ..Self::default() };
        let mut indices = Vec::new();
        // The distance to the nearest colour is about half of that between two.
        let error = palette.paint(pixels, width, &mut indices);
        palette.strength = (2.0 * (error / 3.0).sqrt() as f32).min(16.0);
        palette.error = palette.paint(pixels, width, &mut indices);
        palette
    }

    /// Paints a picture: an index for each pixel. Returns the mean square error.
    pub(super) fn paint(&mut self, pixels: &[Rgb], width: usize, indices: &mut Vec<u8>) -> f64 {
        indices.clear();
        let mut error = 0;
        for (row, line) in pixels.chunks(width).enumerate() {
            for (column, &pixel) in line.iter().enumerate() {
                let offset = self.strength * pattern(row, column);
                let wanted = pixel.map(|channel| (f32::from(channel) + offset).round() as u8);
                let index = self.nearest(wanted);
                error += u64::from(square_distance(pixel, self.color(index)));
                indices.push(index);
            }
        }
        error as f64 / pixels.len() as f64
    }

    /// Whether a picture that was painted with this error is about as good as that which the colours were chosen for.
    pub(super) fn suits(&self, error: f64) -> bool {
        error <= 1.5 * self.error + 1.0
    }

    /// Red, green and blue of all, and of the transparent one.
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

    fn nearest(&mut self, wanted: Rgb) -> u8 {
        let [r, g, b] = wanted.map(u32::from);
        // Fibonacci's hash: neighbouring colours come to lie far apart.
        let place = (r << 16 | g << 8 | b).wrapping_mul(2_654_435_769) >> (u32::BITS - Self::KNOWN_BITS);
        let place = place as usize;
        if let Some((color, index)) = self.known[place]
            && color == wanted
        {
            return index;
        }
        let nearest = (0..self.colors.len()).min_by_key(|&index| square_distance(wanted, self.colors[index]));
        let index = nearest.unwrap_or(0) as u8;
        self.known[place] = Some((wanted, index));
        index
    }
}

/// All colours of a picture, unless they are too many.
fn few_colors(pixels: &[Rgb]) -> Option<Vec<Rgb>> {
    let mut colors = BTreeSet::new();
    for &pixel in pixels {
        if colors.insert(pixel) && colors.len() > Palette::MOST_COLORS {
            return None;
        }
    }
    Some(colors.into_iter().collect())
}

fn square_distance(a: Rgb, b: Rgb) -> u32 {
    a.into_iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}

/// Bayer's pattern of 8 by 8: each of 64 values from -1/2 to 1/2 once, and neighbours far from each other.
fn pattern(row: usize, column: usize) -> f32 {
    let mixed = row ^ column;
    let bits = [mixed & 1, row & 1, mixed >> 1 & 1, row >> 1 & 1, mixed >> 2 & 1, row >> 2 & 1];
    let rank = bits.into_iter().fold(0, |rank, bit| 2 * rank + bit);
    (rank as f32 + 0.5) / 64.0 - 0.5
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{Palette, pattern};

    #[test]
    fn the_pattern_has_each_value_once() {
        let values: BTreeSet<i32> = (0..64).map(|place| (pattern(place / 8, place % 8) * 64.0 + 31.5) as i32).collect();
        assert_eq!(values, (0..64).collect());
    }

    #[test]
    fn few_colours_stay_as_they_are() {
        let pixels: Vec<[u8; 3]> = (0..1000_u32).map(|pixel| [(pixel % 200) as u8, 7, 255]).collect();
        let mut palette = Palette::of(&pixels, 100);
        let mut indices = Vec::new();
        assert_eq!(palette.paint(&pixels, 100, &mut indices), 0.0);
        assert!(indices.iter().zip(&pixels).all(|(&index, &pixel)| palette.color(index) == pixel));
        assert!(palette.transparent() == 200 && palette.table().len() == 3 * 201);
    }

    #[test]
    fn many_colours_keep_their_mean() {
        // A slope from blue to orange, with more colours than there are.
        let (width, height) = (256, 64);
        let slope = |place: usize| {
            let (x, y) = ((place % width) as u8, (place / width) as u8);
            [x, 64 + x / 2 + y, 255 - x]
        };
        let pixels: Vec<[u8; 3]> = (0..width * height).map(slope).collect();
        let mut palette = Palette::of(&pixels, width);
        let mut indices = Vec::new();
        let error = palette.paint(&pixels, width, &mut indices);
        assert!(palette.suits(error) && error < 100.0, "{error}");
        // Squares of 16 pixels look as they should from afar.
        for (top, left) in (0..height).step_by(16).flat_map(|top| (0..width).step_by(16).map(move |left| (top, left))) {
            for channel in [0, 1, 2] {
                let mean = |value: &dyn Fn(usize) -> u8| {
                    let places = (0..256).map(|place| (top + place / 16) * width + left + place % 16);
                    places.map(|place| f64::from(value(place))).sum::<f64>() / 256.0
                };
                let (found, expected) =
                    (mean(&|place| palette.color(indices[place])[channel]), mean(&|place| pixels[place][channel]));
                assert!((found - expected).abs() < 8.0, "{found}, not {expected}, at {left}, {top}");
            }
        }
    }
}
