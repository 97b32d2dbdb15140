//! Cameras as arguments: names, ids and free cameras.

use super::Camera;
use crate::error::Result;
use crate::id::IntoId;
use crate::kind::{self, sealed::Sealed};
use crate::model::Model;

/// Camera as an argument.
///
/// - A camera of the model: its name, index, id or view, as for
///   [`Model::camera`](crate::Model::camera).
/// - `&mut Camera`: a free camera, or any other [`Camera`]. The call moves a tracking camera with
///   its body.
///
/// ```no_run
/// use mujoco_safe::render::Renderer;
/// use mujoco_safe::scene::Camera;
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.forward()?;
/// let model = data.model().clone();
/// let mut renderer = Renderer::new(&model, 640, 480)?;
/// let by_name = renderer.snapshot(&mut data, "side")?.rgb()?;
/// let by_id = renderer.snapshot(&mut data, model.camera("side")?.id())?.rgb()?;
/// let free = renderer.snapshot(&mut data, &mut Camera::free(&model))?.rgb()?;
/// let mut camera = Camera::tracking(&model, "torso")?;
/// let tracking = renderer.snapshot(&mut data, &mut camera)?.rgb()?;
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
pub trait CameraSource: Sealed {
    /// Calls a function with the camera.
    #[doc(hidden)]
    fn with_camera<T>(self, model: &Model, call: impl FnOnce(&mut Camera) -> Result<T>) -> Result<T>;
}

impl<K: IntoId<kind::Camera>> CameraSource for K {
    #[track_caller]
    fn with_camera<T>(self, model: &Model, call: impl FnOnce(&mut Camera) -> Result<T>) -> Result<T> {
        call(&mut Camera::fixed(model, self.id_in(model)?))
    }
}

impl Sealed for &mut Camera {}

impl CameraSource for &mut Camera {
    #[track_caller]
    fn with_camera<T>(self, _: &Model, call: impl FnOnce(&mut Camera) -> Result<T>) -> Result<T> {
        call(self)
    }
}
