//! Colours for geoms by their numbers.

/// A colour that differs from those of the neighbours: a point of Halton's low-discrepancy sequence, as the engine chooses it.
///
/// J. H. Halton, "On the efficiency of certain quasi-random sequences of points", Numerische Mathematik 2 (1960).
pub(super) fn color(segid: usize) -> [f32; 4] {
    let [red, green, blue] = [2, 3, 5].map(|base| 0.1 + 0.8 * halton(segid + 10, base));
    [red, green, blue, 1.0]
}

/// One more than the number, in 24 bits: red has the lowest.
pub(super) fn id_color(segid: usize) -> [f32; 4] {
    let number = segid as u64 + 1;
    let [red, green, blue] = [0, 8, 16].map(|shift| ((number >> shift) & 0xFF) as f32 / 255.0);
    [red, green, blue, 1.0]
}

/// The digits of a number in a base, mirrored at the point.
fn halton(mut index: usize, base: usize) -> f32 {
    let (mut number, mut digit) = (0.0, 1.0);
    while index > 0 {
        digit /= base as f64;
        number += digit * (index % base) as f64;
        index /= base;
    }
    number as f32
}

#[cfg(test)]
mod tests {
    use super::{halton, id_color};

    #[test]
    fn digits_are_mirrored() {
        assert_eq!([1, 2, 3, 4, 5, 6].map(|index| halton(index, 2)), [0.5, 0.25, 0.75, 0.125, 0.625, 0.375]);
        assert!((halton(5, 3) - 7.0 / 9.0).abs() < 1e-7, "2 1 becomes 0.21 in base 3");
    }

    #[test]
    fn the_colour_of_a_number_is_the_number() {
        assert_eq!(id_color(0), [1.0 / 255.0, 0.0, 0.0, 1.0]);
        assert_eq!(id_color(0x03_02_00), [1.0 / 255.0, 2.0 / 255.0, 3.0 / 255.0, 1.0]);
    }
}
