//! What an eye sees.

use std::fmt;
use std::path::Path;

use super::{check, index, png};
use crate::error::Result;
use crate::file;

/// A picture: red, green and blue of each pixel, 8 bits each, as a screen shows them.
///
/// ```
/// use mujoco_safe::render::Picture;
///
/// let mut picture = Picture::new(2, 1);
/// picture.set_pixel(1, 0, [255, 128, 0]);
/// assert_eq!(picture.as_bytes(), [0, 0, 0, 255, 128, 0]);
///
/// let path = std::env::temp_dir().join("mujoco_safe_picture.png");
/// picture.save_png(&path)?;
/// # std::fs::remove_file(path).ok();
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Picture {
    /// A black picture of so many pixels.
    ///
    /// # Panics
    ///
    /// If it does not fit into memory.
    #[track_caller]
    pub fn new(width: usize, height: usize) -> Self {
        let area = super::area(width, height).expect("a picture must fit into memory");
        Self { width, height, rgb: vec![0; 3 * area] }
    }

    /// A picture of bytes that are row-major from the top: red, green and blue of each pixel, `(height, width, 3)`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`](crate::Error::Shape) unless there are `3 * width * height` bytes.
    pub fn from_rgb(width: usize, height: usize, rgb: Vec<u8>) -> Result<Self> {
        check("rgb of a picture", [width, height], 3, rgb.len())?;
        Ok(Self { width, height, rgb })
    }

    /// Its width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Its height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue of the pixel in column `x` from the left, of row `y` from the top.
    ///
    /// # Panics
    ///
    /// If there is no such pixel.
    #[track_caller]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        self.rgb.as_chunks().0[index([self.width, self.height], x, y)]
    }

    /// Sets the pixel in column `x` from the left, of row `y` from the top.
    ///
    /// # Panics
    ///
    /// If there is no such pixel.
    #[track_caller]
    pub fn set_pixel(&mut self, x: usize, y: usize, rgb: [u8; 3]) {
        let index = index([self.width, self.height], x, y);
        self.rgb.as_chunks_mut().0[index] = rgb;
    }

    /// All bytes, row-major from the top: `(height, width, 3)`.
    pub fn as_bytes(&self) -> &[u8] {
        &self.rgb
    }

    /// All bytes, to be written to.
    pub fn as_bytes_mut(&mut self) -> &mut [u8] {
        &mut self.rgb
    }

    /// The bytes themselves.
    pub fn into_bytes(self) -> Vec<u8> {
        self.rgb
    }

    /// Writes it as a PNG file.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written; one that was there before is as it was. A picture
    /// without pixels has no file.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| png::rgb(out, [self.width, self.height], &self.rgb))
    }

    /// The bytes of a PNG file: to be sent, or shown in a notebook.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) for a picture without pixels, of which there is no such file.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        png::to_bytes(|out| png::rgb(out, [self.width, self.height], &self.rgb))
    }

    /// Makes it one of another size, of which the pixels are anything, to be filled.
    pub(crate) fn resize(&mut self, width: usize, height: usize) -> &mut [u8] {
        let area = super::area(width, height).expect("Bug: a size that was not checked");
        (self.width, self.height) = (width, height);
        self.rgb.resize(3 * area, 0);
        &mut self.rgb
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Picture({} x {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::Picture;
    use crate::Error;

    /// Each byte is another.
    fn picture() -> Picture {
        Picture::from_rgb(5, 3, (0..45).collect()).unwrap()
    }

    #[test]
    fn pixels_are_row_by_row_from_the_top() {
        let mut picture = picture();
        assert_eq!(picture.pixel(4, 0), [12, 13, 14]);
        assert_eq!(picture.pixel(0, 1), [15, 16, 17]);
        picture.set_pixel(4, 2, [7, 8, 9]);
        assert_eq!(picture.as_bytes()[42..], [7, 8, 9]);
        assert_eq!(picture.into_bytes().len(), 45);
    }

    #[test]
    fn a_file_has_the_same_pixels() {
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
    fn what_has_no_pixels_has_no_file_and_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        std::fs::write(&path, "before").unwrap();
        for empty in [Picture::default(), Picture::new(0, 3), Picture::new(3, 0)] {
            assert!(matches!(empty.to_png(), Err(Error::Invalid { .. })));
            assert!(matches!(empty.save_png(&path), Err(Error::File { .. })));
        }
        assert_eq!(std::fs::read(&path).unwrap(), b"before");
    }

    #[test]
    fn a_number_of_bytes_that_does_not_fit_is_an_error() {
        for (width, height, bytes) in [(2, 1, 5), (2, 1, 7), (1, 2, 0), (usize::MAX, 2, 6), (0, 0, 1)] {
            Picture::from_rgb(width, height, vec![0; bytes]).unwrap_err();
        }
        assert!(Picture::from_rgb(0, 7, Vec::new()).is_ok());
    }

    #[test]
    #[should_panic(expected = "there is no pixel (5, 0) in a picture of 5 x 3 pixels")]
    fn a_pixel_that_is_not_there_panics() {
        picture().pixel(5, 0);
    }
}
