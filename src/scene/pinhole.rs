//! Pinhole model of a camera: the map between points of the world and pixels.

use super::Scene;
use crate::error::{Error, InvalidKind, Result};
use crate::math;

/// Pinhole camera: the intrinsics of an image in pixels, and the pose of the camera in the world.
/// It can also describe an orthographic camera, whose rays are parallel.
///
/// Pixel coordinates `[u, v]` are measured from the upper left corner of the image, `u` to the
/// right and `v` down. The pixel in column `x` and row `y` covers one unit, and its centre, where
/// depth and segmentation are sampled, is `[x + 0.5, y + 0.5]`. OpenCV and ROS put the centres at
/// integers instead: subtract 0.5 from `cx` and `cy` for them.
///
/// The frame of the camera is the engine's: x to the right of the image, y up, z opposite to the
/// viewing direction. A point `[x, y, -depth]` in that frame is at
///
/// ```text
/// u = cx + fx x / depth        fx = fy = height / (2 tan(fovy / 2))
/// v = cy - fy y / depth        cx = width / 2,  cy = height / 2
/// ```
///
/// `fovy` is the vertical field of view: [`Model::cam_fovy`](crate::Model::cam_fovy) for a camera
/// of the model, and `model.visual().global.fovy` for a free or a tracking camera. With engines
/// from 3.0, a camera of the model with a `sensorsize` has its own focal lengths and principal
/// point, and its image is stretched to the image: `fx = width * focal_x / sensorsize_x`, and
/// likewise `fy`. There is no distortion.
///
/// With an [`orthographic`](Self::orthographic) camera, `u = cx + fx x` and `v = cy - fy y` at
/// every depth, where `fx` and `fy` are pixels per metre.
///
/// [`Scene::pinhole_camera`] computes it from the viewpoint of a scene. The fields are public, so
/// that a program can also describe a real camera.
///
/// ```
/// use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.forward()?;
/// let side = data.model().camera("side")?.id();
/// let mut scene = Scene::new(data.model(), 1000)?;
/// let mut view = Camera::fixed(data.model(), side);
/// scene.update(&mut data, &SceneOptions::default(), None, &mut view, Categories::all())?;
///
/// let camera = scene.pinhole_camera(640, 480)?;
/// let fovy = data.model().cam_fovy()[side.index()].to_radians();
/// assert!((camera.fy - 240.0 / (fovy / 2.0).tan()).abs() < 1e-3);
/// assert!((camera.pos[1] - data.camera(side).xpos()[1]).abs() < 1e-6);
///
/// // The pixel that shows the head, and the point at 2 m depth behind the centre of the image.
/// let [u, v] = camera.project(*data.body("head")?.xpos()).expect("a point in front of the camera");
/// assert!((0.0..640.0).contains(&u) && (0.0..480.0).contains(&v));
/// let point = camera.unproject([320.0, 240.0], 2.0);
/// assert!(point[1] > camera.pos[1] + 1.9);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinholeCamera {
    /// Width of the image, pixels.
    pub width: usize,
    /// Height of the image, pixels.
    pub height: usize,
    /// Horizontal focal length, pixels; pixels per metre if the camera is orthographic.
    pub fx: f64,
    /// Vertical focal length, pixels; pixels per metre if the camera is orthographic.
    pub fy: f64,
    /// Horizontal coordinate of the principal point, pixels from the left edge of the image.
    pub cx: f64,
    /// Vertical coordinate of the principal point, pixels from the top edge of the image.
    pub cy: f64,
    /// Position, m, world frame.
    pub pos: [f64; 3],
    /// Rotation matrix `(3, 3)`, row-major, from the frame of the camera to the world, as in
    /// [`Data::cam_xmat`](crate::Data::cam_xmat).
    pub mat: [f64; 9],
    /// Marks an orthographic camera.
    pub orthographic: bool,
}

impl PinholeCamera {
    /// Returns the direction of the ray through pixel coordinates, in the world frame. Its
    /// component along the optical axis is 1, so `origin + depth * direction` is the point at that
    /// depth, where `origin` is `pos` unless the camera is [orthographic](Self::origin).
    ///
    /// ```
    /// use mujoco_safe::data::RayOptions;
    /// use mujoco_safe::scene::PinholeCamera;
    /// use mujoco_safe::{Data, Model};
    ///
    /// let floor = r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/></worldbody></mujoco>"#;
    /// let mut data = Data::new(Model::from_xml_str(floor)?)?;
    /// data.forward()?;
    /// // A camera 3 m above the floor looks down.
    /// let mat = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    /// let camera =
    ///     PinholeCamera { width: 64, height: 48, fx: 60.0, fy: 60.0, cx: 32.0, cy: 24.0, pos: [0.0, 0.0, 3.0], mat, orthographic: false };
    /// let direction = camera.direction([40.5, 24.5]); // the centre of the pixel in column 40 and row 24
    /// let hit = data.ray(camera.pos, direction, &RayOptions::default())?.expect("the floor");
    /// assert!((hit.distance - 3.0).abs() < 1e-12, "its depth");
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn direction(&self, pixel: [f64; 2]) -> [f64; 3] {
        let [x, y] = if self.orthographic { [0.0; 2] } else { self.offset(pixel) };
        [0, 3, 6].map(|row| self.mat[row] * x + self.mat[row + 1] * y - self.mat[row + 2])
    }

    /// Returns the origin of the ray through pixel coordinates, m, in the world frame: the position
    /// of the camera, or for an orthographic camera the point of the pixel in the plane through
    /// that position.
    pub fn origin(&self, pixel: [f64; 2]) -> [f64; 3] {
        if !self.orthographic {
            return self.pos;
        }
        let [x, y] = self.offset(pixel);
        [0, 1, 2].map(|axis| self.pos[axis] + self.mat[3 * axis] * x + self.mat[3 * axis + 1] * y)
    }

    /// Returns the position of pixel coordinates to the right and up from the optical axis: at unit
    /// depth, or at every depth if the camera is orthographic.
    fn offset(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [(u - self.cx) / self.fx, (self.cy - v) / self.fy]
    }

    /// Returns the point at pixel coordinates and a depth, m, in the world frame. The depth is
    /// measured along the optical axis, as in a depth image.
    pub fn unproject(&self, pixel: [f64; 2], depth: f64) -> [f64; 3] {
        let (origin, direction) = (self.origin(pixel), self.direction(pixel));
        [0, 1, 2].map(|axis| origin[axis] + depth * direction[axis])
    }

    /// Returns the pixel coordinates of a point, m, world frame; `None` for a point that is not in
    /// front of the camera. The coordinates can be outside of the image. Inverse of
    /// [`unproject`](Self::unproject).
    ///
    /// ```
    /// # use mujoco_safe::scene::PinholeCamera;
    /// let mat = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    /// let camera = PinholeCamera { width: 64, height: 48, fx: 60.0, fy: 60.0, cx: 32.0, cy: 24.0, pos: [0.0; 3], mat, orthographic: false };
    /// assert_eq!(camera.project([0.5, 0.5, -2.0]), Some([47.0, 9.0]));
    /// assert_eq!(camera.unproject([47.0, 9.0], 2.0), [0.5, 0.5, -2.0]);
    /// assert_eq!(camera.project([0.5, 0.5, 2.0]), None);
    /// ```
    pub fn project(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let offset = [0, 1, 2].map(|axis| point[axis] - self.pos[axis]);
        let [x, y, z] = math::rot_vec_mat_t(&offset, &self.mat);
        let scale = if self.orthographic { 1.0 } else { -1.0 / z };
        (z < 0.0).then_some([self.cx + self.fx * x * scale, self.cy - self.fy * y * scale])
    }
}

impl Scene {
    /// Returns the pinhole model of the viewpoint, for images of the given size in pixels.
    ///
    /// The viewpoint is the [average](Self::viewpoint) of both eyes, as in a monoscopic image. Its
    /// values have single precision, and are those that a renderer uses.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for an empty image, for a scene that was never updated, and for a scene
    /// with a [`transform`](Self::transform), whose images are in room space.
    pub fn pinhole_camera(&self, width: usize, height: usize) -> Result<PinholeCamera> {
        if width == 0 || height == 0 {
            return Err(Error::out_of_range("the size of an image", format!("{width} x {height} pixels"), "not empty"));
        }
        if let Some(transform) = self.transform() {
            return Err(Error::invalid(
                InvalidKind::Unsuitable,
                "the scene of a pinhole camera",
                format!("{transform:?}"),
                "without a transform",
            ));
        }
        let viewpoint = self.viewpoint();
        let [center, bottom, top, near] =
            [viewpoint.frustum_center, viewpoint.frustum_bottom, viewpoint.frustum_top, viewpoint.frustum_near]
                .map(f64::from);
        if !(viewpoint.is_finite() && top > bottom && near > 0.0) {
            return Err(Error::invalid(
                InvalidKind::Unsuitable,
                "the viewpoint of the scene",
                format!("{viewpoint:?}"),
                "from an updated scene",
            ));
        }
        // Pixels per metre in the near plane, which an orthographic camera has at every depth.
        let up = height as f64 / (top - bottom);
        // Without a width of the near plane, pixels are square.
        let half_width = f64::from(viewpoint.frustum_width);
        let across = if half_width > 0.0 { width as f64 / (2.0 * half_width) } else { up };
        let distance = if viewpoint.orthographic { 1.0 } else { near };
        Ok(PinholeCamera {
            width,
            height,
            fx: distance * across,
            fy: distance * up,
            cx: 0.5 * width as f64 - center * across,
            cy: top * up,
            orthographic: viewpoint.orthographic,
            pos: viewpoint.pos.map(f64::from),
            mat: rotation(viewpoint.forward.map(f64::from), viewpoint.up.map(f64::from)),
        })
    }
}

/// Returns the rotation matrix of a camera with the given viewing direction and upward direction.
fn rotation(mut forward: [f64; 3], up: [f64; 3]) -> [f64; 9] {
    math::normalize(&mut forward);
    let mut right = math::cross(&forward, &up);
    math::normalize(&mut right);
    let up = math::cross(&right, &forward);
    let [x, y, z] = [0, 1, 2].map(|axis| [right[axis], up[axis], -forward[axis]]);
    [x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]]
}
