//! Images and cameras in logs.

use crate::error::{Error, InvalidKind, Result};
use crate::math;
use crate::mcap::{Log, Message};
use crate::render::{DepthImage, RgbImage, SegmentationImage};
use crate::scene::PinholeCamera;

/// Image for [`Log::write_image`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum LogImage<'i> {
    /// Colours, as they are: topic `rgb`.
    Rgb(&'i RgbImage),
    /// Colours, compressed without loss: topic `png`.
    Png(&'i RgbImage),
    /// Distances along the optical axis, m: topic `depth`.
    Depth(&'i DepthImage),
    /// For each pixel 0, or the index of the model's geom plus 1: topic `segmentation`.
    Segmentation(&'i SegmentationImage),
}

macro_rules! from_image {
    ($($variant:ident $image:ident),*) => {
        $(impl<'i> From<&'i $image> for LogImage<'i> {
            fn from(image: &'i $image) -> Self {
                Self::$variant(image)
            }
        })*
    };
}

from_image!(Rgb RgbImage, Depth DepthImage, Segmentation SegmentationImage);

/// # Images
///
/// These methods require the features `mcap` and `renderer`.
impl Log {
    /// Writes an image of a camera at a simulated time, s: a `foxglove.RawImage`, or a
    /// `foxglove.CompressedImage` for [`LogImage::Png`]. The topic is `/camera/NAME/rgb`, with the
    /// kind of the image at the end. [`write_camera`](Self::write_camera) writes the pose and the
    /// focal length of the camera.
    ///
    /// The image is copied; its compression takes place in this call. The log keeps the memory of
    /// up to five images.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; [`Error::Invalid`] for an empty image, and
    /// for a segmentation with more than 65,535 geoms.
    ///
    /// ```no_run
    /// use mujoco_safe::mcap::Log;
    /// use mujoco_safe::render::{LogImage, Renderer};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// let mut renderer = Renderer::new(data.model(), 320, 240)?;
    /// let mut log = Log::create("fall.mcap", data.model())?;
    /// for step in 0..200 {
    ///     log.step(&mut data)?;
    ///     if step % 10 == 0 {
    ///         data.forward()?;
    ///         let mut snapshot = renderer.snapshot(&mut data, "side")?;
    ///         let (images, camera) = (snapshot.images()?, snapshot.pinhole_camera()?);
    ///         log.write_camera("side", data.time(), &camera)?;
    ///         log.write_image("side", data.time(), LogImage::Png(&images.rgb))?;
    ///         log.write_image("side", data.time(), &images.depth)?;
    ///     }
    /// }
    /// log.finish()?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    pub fn write_image<'i>(&mut self, camera: &str, time: f64, image: impl Into<LogImage<'i>>) -> Result<()> {
        let frame = frame(camera);
        let mut message = Message::default();
        message.put_stamp(1);
        let (kind, schema) = match image.into() {
            LogImage::Rgb(image) => {
                put_raw(&mut message, &frame, [image.width(), image.height()], "rgb8", image.as_bytes())?;
                ("rgb", "foxglove.RawImage")
            }
            LogImage::Depth(image) => {
                let bytes: Vec<u8> = image.as_slice().iter().flat_map(|depth| depth.to_le_bytes()).collect();
                put_raw(&mut message, &frame, [image.width(), image.height()], "32FC1", &bytes)?;
                ("depth", "foxglove.RawImage")
            }
            LogImage::Segmentation(image) => {
                let bytes = geom_numbers(image)?;
                put_raw(&mut message, &frame, [image.width(), image.height()], "16UC1", &bytes)?;
                ("segmentation", "foxglove.RawImage")
            }
            LogImage::Png(image) => {
                message.put_bytes(2, &image.to_png()?);
                message.put_text(3, "png");
                message.put_text(4, &frame);
                ("png", "foxglove.CompressedImage")
            }
        };
        self.write_message(time, &format!("/{frame}/{kind}"), schema, &mut message)
    }

    /// Writes a camera at a simulated time, s: its frame `camera/NAME` in the topic `/tf`, and a
    /// `foxglove.CameraCalibration` in `/camera/NAME/calibration`, by which programs project the
    /// scene into its images and depths into the scene. A moving camera needs the call for each
    /// image, a fixed one once.
    ///
    /// As usual for cameras of robots, z points into the image, x to the right and y down in the
    /// frame, and a pixel's coordinates are those of its centre, half a pixel less than in a
    /// [`PinholeCamera`].
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written, and [`Error::Invalid`] for an orthographic
    /// camera.
    pub fn write_camera(&mut self, camera: &str, time: f64, pinhole: &PinholeCamera) -> Result<()> {
        let &PinholeCamera { width, height, fx, fy, cx, cy, ref pos, ref mat, orthographic } = pinhole;
        if orthographic {
            let expected = "with a perspective";
            return Err(Error::invalid(InvalidKind::Unsuitable, "the camera of a log", "orthographic", expected));
        }
        let frame = frame(camera);
        // Half a turn around x.
        let [w, x, y, z] = math::mul_quat(&math::mat2quat(mat), &[0.0, 1.0, 0.0, 0.0]);
        let mut transforms = Message::default();
        transforms.put_message(1, |transform| {
            transform.put_stamp(1);
            transform.put_text(2, "world");
            transform.put_text(3, &frame);
            transform.put_tuple(4, pos);
            transform.put_tuple(5, &[x, y, z, w]);
        });
        self.write_message(time, "/tf", "foxglove.FrameTransforms", &mut transforms)?;
        let mut calibration = Message::default();
        calibration.put_stamp(1);
        put_size(&mut calibration, [width, height])?;
        calibration.put_text(4, "plumb_bob");
        calibration.put_array(5, &[0.0; 5]);
        let (cx, cy) = (cx - 0.5, cy - 0.5);
        calibration.put_array(6, &[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]);
        calibration.put_array(7, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        calibration.put_array(8, &[fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]);
        calibration.put_text(9, &frame);
        self.write_message(time, &format!("/{frame}/calibration"), "foxglove.CameraCalibration", &mut calibration)
    }
}

/// Returns the frame of a camera. Bodies can have the same names as cameras.
fn frame(camera: &str) -> String {
    format!("camera/{camera}")
}

fn put_size(message: &mut Message, size: [usize; 2]) -> Result<()> {
    for (field, length) in [2, 3].into_iter().zip(size) {
        let length = u32::try_from(length).ok().filter(|&length| length > 0);
        let found = || format!("{} x {} pixels", size[0], size[1]);
        let length = length.ok_or_else(|| Error::out_of_range("the size of an image", found(), "not empty"))?;
        message.put_u32(field, length);
    }
    Ok(())
}

fn put_raw(message: &mut Message, frame: &str, size: [usize; 2], encoding: &str, bytes: &[u8]) -> Result<()> {
    put_size(message, size)?;
    message.put_text(4, encoding);
    message.put_u32(5, (bytes.len() / size[1]) as u32);
    message.put_bytes(6, bytes);
    message.put_text(7, frame);
    Ok(())
}

/// Returns the numbers of the geoms as bytes.
fn geom_numbers(image: &SegmentationImage) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for geom in image.geom_ids() {
        let too_large = |_| Error::out_of_range("a geom in an image of a log", geom, "less than 65,535");
        bytes.extend(u16::try_from(geom + 1).map_err(too_large)?.to_le_bytes());
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::{SegmentationImage, geom_numbers};
    use crate::element::Object;
    use crate::scene::{Camera, Categories, Scene, SceneOptions};
    use crate::{Data, sample};

    #[test]
    fn geoms_are_counted_from_one() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 1000).unwrap();
        let mut camera = Camera::free(data.model());
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        let geoms = scene.geoms().len();
        let mut image = SegmentationImage::default();
        image.resize(geoms + 1, 1, &scene).iter_mut().zip(0..).for_each(|(id, number)| *id = number);
        let of_geom = |object| if let Some(Object::Geom(geom)) = object { geom.index() + 1 } else { 0 };
        let expected = [0].into_iter().chain(scene.geoms().map(|geom| of_geom(geom.object())));
        let expected: Vec<u8> = expected.flat_map(|number| (number as u16).to_le_bytes()).collect();
        assert_eq!(geom_numbers(&image).unwrap(), expected);
        assert!(expected.iter().any(|&byte| byte > 1));
    }
}
