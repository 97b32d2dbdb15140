//! Depth images.

use std::fmt;
use std::path::Path;

use super::{RgbImage, check, index, write_png_grey16};
use crate::error::Result;
use crate::file;
use crate::scene::PinholeCamera;

/// Depth image: for each pixel the distance of the visible surface along the optical axis of the
/// camera, m. [`f32::INFINITY`] for the background.
///
/// The depth is the length of the ray through the pixel times the cosine of the ray's angle with
/// the optical axis: a wall perpendicular to the axis has constant depth.
///
/// ```
/// use mujoco_safe::render::DepthImage;
///
/// let depth = DepthImage::from_metres(2, 1, vec![1.5, f32::INFINITY])?;
/// assert_eq!(depth.metres(0, 0), 1.5);
/// assert_eq!(depth.range(), Some([1.5, 1.5]));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Default, PartialEq)]
pub struct DepthImage {
    width: usize,
    height: usize,
    metres: Vec<f32>,
}

impl DepthImage {
    /// Creates an image from depths `(height, width)`, row-major from the top, m.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`](crate::Error::Shape) unless `metres` has length `width * height`.
    pub fn from_metres(width: usize, height: usize, metres: Vec<f32>) -> Result<Self> {
        check("the metres of DepthImage::from_metres", [width, height], 1, metres.len())?;
        Ok(Self { width, height, metres })
    }

    /// Returns the width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the depth of the pixel in column `x` from the left and row `y` from the top, m.
    ///
    /// # Panics
    ///
    /// If the pixel is outside of the image.
    #[track_caller]
    pub fn metres(&self, x: usize, y: usize) -> f32 {
        self.metres[index([self.width, self.height], x, y)]
    }

    /// Returns all depths `(height, width)`, row-major from the top, m.
    pub fn as_slice(&self) -> &[f32] {
        &self.metres
    }

    /// Converts the image to its depths.
    pub fn into_vec(self) -> Vec<f32> {
        self.metres
    }

    /// Returns the smallest and the largest finite depth, m; `None` if all pixels are background.
    pub fn range(&self) -> Option<[f32; 2]> {
        self.metres.iter().filter(|depth| depth.is_finite()).fold(None, |range, &depth| {
            let [low, high] = range.unwrap_or([depth; 2]);
            Some([low.min(depth), high.max(depth)])
        })
    }

    /// Iterates over the pixels that show a surface, row by row from the top: the pixel `[x, y]`,
    /// column from the left and row from the top, and the point of the surface at the centre of the
    /// pixel, m, in the world frame. Skips the background.
    ///
    /// `camera` is the camera of the image: see
    /// [`Scene::pinhole_camera`](crate::scene::Scene::pinhole_camera) and
    /// [`Snapshot::pinhole_camera`](crate::render::Snapshot::pinhole_camera).
    ///
    /// # Panics
    ///
    /// If the image of the camera has another size.
    ///
    /// ```
    /// use mujoco_safe::render::DepthImage;
    /// use mujoco_safe::scene::PinholeCamera;
    ///
    /// // A camera at the origin looks down.
    /// let mat = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    /// let camera = PinholeCamera { width: 2, height: 1, fx: 2.0, fy: 2.0, cx: 1.0, cy: 0.5, pos: [0.0; 3], mat, orthographic: false };
    /// let depth = DepthImage::from_metres(2, 1, vec![f32::INFINITY, 3.0])?;
    /// let cloud: Vec<_> = depth.points(&camera).collect();
    /// assert_eq!(cloud, [([1, 0], [0.75, 0.0, -3.0])]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "point_cloud")]
    #[track_caller]
    pub fn points(&self, camera: &PinholeCamera) -> impl Iterator<Item = ([usize; 2], [f64; 3])> + '_ {
        assert!(
            [self.width, self.height] == [camera.width, camera.height],
            "a depth image of {} x {} pixels and a camera of {} x {} pixels",
            self.width,
            self.height,
            camera.width,
            camera.height
        );
        let (camera, width) = (*camera, self.width);
        self.metres.iter().enumerate().filter(|(_, depth)| depth.is_finite()).map(move |(index, &depth)| {
            let pixel = [index % width, index / width];
            (pixel, camera.unproject(pixel.map(|place| place as f64 + 0.5), f64::from(depth)))
        })
    }

    /// Converts the depths to a grey image for display: white at depth `near`, darker with depth,
    /// dark grey at `far` and beyond; black for the background. See [`range`](Self::range).
    pub fn to_rgb(&self, [near, far]: [f32; 2]) -> RgbImage {
        const DARKEST: f32 = 40.0;
        let mut picture = RgbImage::new(self.width, self.height);
        for (pixel, &depth) in picture.as_bytes_mut().as_chunks_mut::<3>().0.iter_mut().zip(&self.metres) {
            if depth.is_finite() {
                let fraction = (depth - near) / (far - near);
                // White for an empty range and for NaN limits.
                let fraction = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) };
                *pixel = [(255.0 - fraction * (255.0 - DARKEST)).round() as u8; 3];
            }
        }
        picture
    }

    /// Writes a greyscale PNG file with 16 bits per pixel: depths in millimetres, the usual format
    /// of depth cameras. As usual in this format, 0 marks pixels nearer than half a millimetre,
    /// farther than 65.535 m, or of the background.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written or the image is empty. An
    /// existing file is then unchanged.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| write_png_grey16(out, [self.width, self.height], &self.millimetres()))
    }

    /// Converts the depths to the values of [`save_png`](Self::save_png).
    fn millimetres(&self) -> Vec<u16> {
        let in_millimetres = |metres: &f32| {
            let millimetres = (f64::from(*metres) * 1e3).round();
            if millimetres <= f64::from(u16::MAX) { millimetres as u16 } else { 0 }
        };
        self.metres.iter().map(in_millimetres).collect()
    }

    /// Changes the size and returns the depths, whose values are unspecified.
    pub(crate) fn resize(&mut self, width: usize, height: usize) -> &mut [f32] {
        let area = super::area(width, height).expect("Bug: unchecked image size");
        (self.width, self.height) = (width, height);
        self.metres.resize(area, 0.0);
        &mut self.metres
    }
}

impl fmt::Debug for DepthImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DepthImage({} x {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::{DepthImage, PinholeCamera};

    fn picture() -> DepthImage {
        DepthImage::from_metres(4, 2, vec![0.5, 1.0, 2.5, f32::INFINITY, 0.0004, 65.535, 65.536, f32::NAN]).unwrap()
    }

    #[test]
    fn png_file_is_in_millimetres() {
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
    fn near_pixels_are_brighter_and_the_background_is_black() {
        let picture = picture();
        assert_eq!(picture.range(), Some([0.0004, 65.536]));
        let grey = picture.to_rgb([0.5, 2.5]);
        let level = |x, y| {
            let [red, green, blue] = grey.pixel(x, y);
            assert!(red == green && green == blue);
            red
        };
        assert_eq!([level(0, 0), level(0, 1), level(2, 0), level(1, 1)], [255, 255, 40, 40]);
        assert!(level(1, 0) < 255 && level(1, 0) > 40);
        assert_eq!([level(3, 0), level(3, 1)], [0, 0]);
        // Empty range and NaN limits.
        assert_eq!(picture.to_rgb([0.5, 0.5]).pixel(0, 0), [255; 3]);
        assert_eq!(picture.to_rgb([f32::NAN; 2]).pixel(0, 0), [255; 3]);
    }

    #[test]
    fn background_has_no_range() {
        assert_eq!(DepthImage::from_metres(1, 1, vec![f32::INFINITY]).unwrap().range(), None);
        assert_eq!(DepthImage::default().range(), None);
    }

    #[test]
    #[should_panic(expected = "a depth image of 4 x 2 pixels and a camera of 2 x 4 pixels")]
    fn points_of_a_camera_of_another_size_panic() {
        let camera = PinholeCamera {
            width: 2,
            height: 4,
            fx: 1.0,
            fy: 1.0,
            cx: 1.0,
            cy: 2.0,
            pos: [0.0; 3],
            mat: [0.0; 9],
            orthographic: false,
        };
        let _ = picture().points(&camera).count();
    }

    #[test]
    fn wrong_number_of_depths_is_an_error() {
        for (width, height, depths) in [(2, 1, 1), (2, 1, 3), (usize::MAX, usize::MAX, 1)] {
            DepthImage::from_metres(width, height, vec![0.0; depths]).unwrap_err();
        }
    }
}
