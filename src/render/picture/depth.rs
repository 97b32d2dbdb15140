//! How far away everything is.

use std::fmt;
use std::path::Path;

use super::{Picture, check, index, png};
use crate::error::Result;
use crate::file;

/// How far away everything is that is seen: for each pixel the distance along the direction in which the camera looks, m.
/// [`f32::INFINITY`] where nothing is.
///
/// It is not the length of the ray through the pixel, but that times the cosine of the ray's angle with the middle one: a wall
/// across the view has the same depth everywhere.
///
/// ```
/// use mujoco_safe::render::DepthPicture;
///
/// let depth = DepthPicture::from_metres(2, 1, vec![1.5, f32::INFINITY])?;
/// assert_eq!(depth.metres(0, 0), 1.5);
/// assert_eq!(depth.range(), Some([1.5, 1.5]));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Default, PartialEq)]
pub struct DepthPicture {
    width: usize,
    height: usize,
    metres: Vec<f32>,
}

impl DepthPicture {
    /// A picture of depths that are row-major from the top, m: `(height, width)`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`](crate::Error::Shape) unless there are `width * height`.
    pub fn from_metres(width: usize, height: usize, metres: Vec<f32>) -> Result<Self> {
        check("metres of a depth picture", [width, height], 1, metres.len())?;
        Ok(Self { width, height, metres })
    }

    /// Its width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Its height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The depth of the pixel in column `x` from the left, of row `y` from the top, m.
    ///
    /// # Panics
    ///
    /// If there is no such pixel.
    #[track_caller]
    pub fn metres(&self, x: usize, y: usize) -> f32 {
        self.metres[index([self.width, self.height], x, y)]
    }

    /// All depths, row-major from the top, m: `(height, width)`.
    pub fn as_slice(&self) -> &[f32] {
        &self.metres
    }

    /// The depths themselves.
    pub fn into_vec(self) -> Vec<f32> {
        self.metres
    }

    /// The smallest and the largest depth, m, of pixels where something is.
    pub fn range(&self) -> Option<[f32; 2]> {
        self.metres.iter().filter(|depth| depth.is_finite()).fold(None, |range, &depth| {
            let [low, high] = range.unwrap_or([depth; 2]);
            Some([low.min(depth), high.max(depth)])
        })
    }

    /// A grey picture to look at: white at depth `near`, darker with depth, down to a dark grey at `far` and beyond; black
    /// where nothing is. See [`range`](Self::range).
    pub fn to_picture(&self, [near, far]: [f32; 2]) -> Picture {
        const DARKEST: f32 = 40.0;
        let mut picture = Picture::new(self.width, self.height);
        for (pixel, &depth) in picture.as_bytes_mut().as_chunks_mut::<3>().0.iter_mut().zip(&self.metres) {
            if depth.is_finite() {
                let share = (depth - near) / (far - near);
                // One depth for all, and limits that are no numbers, are white.
                let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
                *pixel = [(255.0 - share * (255.0 - DARKEST)).round() as u8; 3];
            }
        }
        picture
    }

    /// Writes it as a PNG file of 16 bits for each pixel: depths in millimetres, as cameras for depth give them. What is nearer
    /// than half a millimetre, farther than 65.535 m, or nowhere, is 0, as it is with them.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written; one that was there before is as it was. A picture
    /// without pixels has no file.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| png::depth16(out, [self.width, self.height], &self.millimetres()))
    }

    /// As [`save_png`](Self::save_png) writes it.
    fn millimetres(&self) -> Vec<u16> {
        let in_millimetres = |metres: &f32| {
            let millimetres = (f64::from(*metres) * 1e3).round();
            if millimetres <= f64::from(u16::MAX) { millimetres as u16 } else { 0 }
        };
        self.metres.iter().map(in_millimetres).collect()
    }

    /// Makes it one of another size, of which the depths are anything, to be filled.
    pub(crate) fn resize(&mut self, width: usize, height: usize) -> &mut [f32] {
        let area = super::area(width, height).expect("Bug: a size that was not checked");
        (self.width, self.height) = (width, height);
        self.metres.resize(area, 0.0);
        &mut self.metres
    }
}

impl fmt::Debug for DepthPicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DepthPicture({} x {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::DepthPicture;

    fn picture() -> DepthPicture {
        DepthPicture::from_metres(4, 2, vec![0.5, 1.0, 2.5, f32::INFINITY, 0.0004, 65.535, 65.536, f32::NAN]).unwrap()
    }

    #[test]
    fn a_file_has_millimetres() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.png");
        picture().save_png(&path).unwrap();
        let mut reader =
            png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Grayscale, png::BitDepth::Sixteen));
        let millimetres: Vec<u16> = bytes.as_chunks().0.iter().map(|&pixel| u16::from_be_bytes(pixel)).collect();
        assert_eq!(millimetres, [500, 1000, 2500, 0, 0, 65535, 0, 0]);
    }

    #[test]
    fn what_is_nearer_is_brighter_and_what_is_nowhere_is_black() {
        let picture = picture();
        assert_eq!(picture.range(), Some([0.0004, 65.536]));
        let grey = picture.to_picture([0.5, 2.5]);
        let level = |x, y| {
            let [red, green, blue] = grey.pixel(x, y);
            assert!(red == green && green == blue);
            red
        };
        assert_eq!([level(0, 0), level(0, 1), level(2, 0), level(1, 1)], [255, 255, 40, 40]);
        assert!(level(1, 0) < 255 && level(1, 0) > 40);
        assert_eq!([level(3, 0), level(3, 1)], [0, 0]);
        // One depth for all, or limits that are none.
        assert_eq!(picture.to_picture([0.5, 0.5]).pixel(0, 0), [255; 3]);
        assert_eq!(picture.to_picture([f32::NAN; 2]).pixel(0, 0), [255; 3]);
    }

    #[test]
    fn where_nothing_is_there_is_no_range() {
        assert_eq!(DepthPicture::from_metres(1, 1, vec![f32::INFINITY]).unwrap().range(), None);
        assert_eq!(DepthPicture::default().range(), None);
    }

    #[test]
    fn a_number_of_depths_that_does_not_fit_is_an_error() {
        for (width, height, depths) in [(2, 1, 1), (2, 1, 3), (usize::MAX, usize::MAX, 1)] {
            DepthPicture::from_metres(width, height, vec![0.0; depths]).unwrap_err();
        }
    }
}
