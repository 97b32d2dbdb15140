//! RGB images.

use std::fmt;
use std::path::Path;

use super::{check, index, write_png_rgb8};
use crate::error::{Error, Result};
use crate::file;

/// RGB image with 8 bits per channel, as displayed on a screen.
///
/// ```
/// use mujoco_safe::render::RgbImage;
///
/// let mut picture = RgbImage::new(2, 1);
/// picture.set_pixel(1, 0, [255, 128, 0]);
/// assert_eq!(picture.as_bytes(), [0, 0, 0, 255, 128, 0]);
///
/// let path = std::env::temp_dir().join("mujoco_safe_picture.png");
/// picture.save_png(&path)?;
/// # std::fs::remove_file(path).ok();
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Default, PartialEq, Eq)]
pub struct RgbImage {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl RgbImage {
    /// Creates a black image.
    ///
    /// # Panics
    ///
    /// If the size exceeds the limits of memory or of PNG files.
    #[track_caller]
    pub fn new(width: usize, height: usize) -> Self {
        let area = super::area(width, height).expect("the image is too large");
        Self { width, height, rgb: vec![0; 3 * area] }
    }

    /// Creates an image from bytes `(height, width, 3)`, row-major from the top: red, green and
    /// blue of each pixel.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`](crate::Error::Shape) unless `rgb` has `3 * width * height` bytes.
    pub fn from_rgb(width: usize, height: usize, rgb: Vec<u8>) -> Result<Self> {
        check("the rgb of RgbImage::from_rgb", [width, height], 3, rgb.len())?;
        Ok(Self { width, height, rgb })
    }

    /// Returns the width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns red, green and blue of the pixel in column `x` from the left and row `y` from the
    /// top.
    ///
    /// # Panics
    ///
    /// If the pixel is outside of the image.
    #[track_caller]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        self.rgb.as_chunks().0[index([self.width, self.height], x, y)]
    }

    /// Sets the pixel in column `x` from the left and row `y` from the top.
    ///
    /// # Panics
    ///
    /// If the pixel is outside of the image.
    #[track_caller]
    pub fn set_pixel(&mut self, x: usize, y: usize, rgb: [u8; 3]) {
        let index = index([self.width, self.height], x, y);
        self.rgb.as_chunks_mut().0[index] = rgb;
    }

    /// Returns all bytes `(height, width, 3)`, row-major from the top.
    pub fn as_bytes(&self) -> &[u8] {
        &self.rgb
    }

    /// Returns all bytes as a mutable slice.
    pub fn as_bytes_mut(&mut self) -> &mut [u8] {
        &mut self.rgb
    }

    /// Converts the image to its bytes.
    pub fn into_bytes(self) -> Vec<u8> {
        self.rgb
    }

    /// Writes a PNG file.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written or the image is empty. An
    /// existing file is then unchanged.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| write_png_rgb8(out, [self.width, self.height], &self.rgb))
    }

    /// Encodes the image as the bytes of a PNG file, for example for a network message or a
    /// notebook.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) if the image is empty.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        // Writing to memory cannot fail, so any error is due to the image.
        write_png_rgb8(&mut bytes, [self.width, self.height], &self.rgb)
            .map_err(|error| Error::out_of_range("an image for a PNG file", error, "non-empty"))?;
        Ok(bytes)
    }

    /// Changes the size and returns the bytes, whose contents are unspecified.
    pub(crate) fn resize(&mut self, width: usize, height: usize) -> &mut [u8] {
        let area = super::area(width, height).expect("Bug: unchecked image size");
        (self.width, self.height) = (width, height);
        self.rgb.resize(3 * area, 0);
        &mut self.rgb
    }
}

impl fmt::Debug for RgbImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RgbImage({} x {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::RgbImage;
    use crate::error::Error;

    /// Returns an image whose bytes are all different.
    fn picture() -> RgbImage {
        RgbImage::from_rgb(5, 3, (0..45).collect()).unwrap()
    }

    #[test]
    fn pixels_are_row_major_from_the_top() {
        let mut picture = picture();
        assert_eq!(picture.pixel(4, 0), [12, 13, 14]);
        assert_eq!(picture.pixel(0, 1), [15, 16, 17]);
        picture.set_pixel(4, 2, [7, 8, 9]);
        assert_eq!(picture.as_bytes()[42..], [7, 8, 9]);
        assert_eq!(picture.into_bytes().len(), 45);
    }

    #[test]
    fn png_file_round_trips() {
        let picture = picture();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        picture.save_png(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), picture.to_png().unwrap());
        let mut reader =
            png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height, info.color_type), (5, 3, png::ColorType::Rgb));
        assert_eq!(pixels, picture.as_bytes());
    }

    #[test]
    fn saving_an_empty_image_fails_and_keeps_the_existing_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        std::fs::write(&path, "before").unwrap();
        for empty in [RgbImage::default(), RgbImage::new(0, 3), RgbImage::new(3, 0)] {
            assert!(matches!(empty.to_png(), Err(Error::Invalid { .. })));
            assert!(matches!(empty.save_png(&path), Err(Error::File { .. })));
        }
        assert_eq!(std::fs::read(&path).unwrap(), b"before");
    }

    #[test]
    fn wrong_number_of_bytes_is_an_error() {
        for (width, height, bytes) in [(2, 1, 5), (2, 1, 7), (1, 2, 0), (usize::MAX, 2, 6), (0, 0, 1)] {
            RgbImage::from_rgb(width, height, vec![0; bytes]).unwrap_err();
        }
        assert!(RgbImage::from_rgb(0, 7, Vec::new()).is_ok());
    }

    #[test]
    #[should_panic(expected = "pixel (5, 0) is outside of an image of 5 x 3 pixels")]
    fn pixel_out_of_bounds_panics() {
        picture().pixel(5, 0);
    }
}
