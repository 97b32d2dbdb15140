//! An image of another size.

/// Bytes of a pixel.
const PIXEL: usize = 4;

/// Appends an image of another size: each pixel is interpolated between the four that are nearest to its middle.
///
/// A length that is halved evenly makes each pixel the mean of four. One that is odd does not: means of two by two would leave
/// its last row or column out, and with it a line that is one pixel wide.
pub(super) fn shrunk(image: &[u8], from: [u32; 2], to: [u32; 2], out: &mut Vec<u8>) {
    let columns: Vec<Between> = (0..to[0]).map(|column| Between::new(column, from[0], to[0])).collect();
    let width = from[0] as usize * PIXEL;
    for row in 0..to[1] {
        let Between { low, high, weight } = Between::new(row, from[1], to[1]);
        let (above, below) = (&image[low * width..][..width], &image[high * width..][..width]);
        for column in &columns {
            for channel in 0..PIXEL {
                let [left, right] = [column.low, column.high].map(|column| {
                    let at = column * PIXEL + channel;
                    mix(f32::from(above[at]), f32::from(below[at]), weight)
                });
                // A mean of bytes is in the range of bytes.
                out.push((mix(left, right, column.weight) + 0.5) as u8);
            }
        }
    }
}

/// Two neighbouring pixels, and how much of the second is in the mixture.
struct Between {
    low: usize,
    high: usize,
    weight: f32,
}

impl Between {
    /// Those between which the middle of a pixel of the other size is.
    fn new(pixel: u32, from: u32, to: u32) -> Self {
        let last = f64::from(from - 1);
        let place = ((f64::from(pixel) + 0.5) * f64::from(from) / f64::from(to) - 0.5).clamp(0.0, last);
        let low = place.floor();
        Self { low: low as usize, high: (low + 1.0).min(last) as usize, weight: (place - low) as f32 }
    }
}

fn mix(a: f32, b: f32, weight: f32) -> f32 {
    a + (b - a) * weight
}

#[cfg(test)]
mod tests {
    use super::shrunk;

    fn grey(pixels: &[u8]) -> Vec<u8> {
        pixels.iter().flat_map(|&pixel| [pixel; 4]).collect()
    }

    #[test]
    fn even_sizes_are_means_of_four() {
        let mut out = Vec::new();
        shrunk(&grey(&[0, 100, 8, 8, 50, 50, 0, 0]), [4, 2], [2, 1], &mut out);
        assert_eq!(out, grey(&[50, 4]));
    }

    #[test]
    fn odd_sizes_keep_their_last_line() {
        // A line of three: the one pixel in the middle of it is the middle one; of five, two at 0.75 and 3.25.
        let mut out = Vec::new();
        shrunk(&grey(&[10, 20, 90]), [3, 1], [1, 1], &mut out);
        assert_eq!(out, grey(&[20]));
        out.clear();
        shrunk(&grey(&[0, 0, 0, 0, 200]), [5, 1], [2, 1], &mut out);
        assert_eq!(out, grey(&[0, 50]));
    }

    #[test]
    fn a_line_of_one_colour_stays_as_it_is() {
        for length in 1..40_u32 {
            for level in [0, 1, 127, 255] {
                let mut out = Vec::new();
                let half = (length / 2).max(1);
                shrunk(&grey(&vec![level; length as usize]), [length, 1], [half, 1], &mut out);
                assert_eq!(out, grey(&vec![level; half as usize]));
            }
        }
    }
}
