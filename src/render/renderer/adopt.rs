//! A new model for a renderer.

use super::{RenderError, Renderer};
use crate::model::Model;

impl Renderer {
    /// Makes this the renderer of another model, such as an edited one that a simulation has
    /// [adopted](crate::Data::adopt): copies the model's meshes, textures and visual settings. The
    /// graphics adapter, the size of the images and the options stay.
    ///
    /// Scenes of the old model cannot be drawn any more: create a new [`Scene`](crate::Scene).
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new). The renderer is unchanged then.
    ///
    /// ```no_run
    /// use mujoco_safe::render::Renderer;
    /// use mujoco_safe::spec::Spec;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// let mut renderer = Renderer::new(data.model(), 640, 480)?;
    /// data.adopt(Spec::from_xml_path("edited.xml")?.compile()?)?;
    /// renderer.adopt(data.model())?;
    /// data.forward()?;
    /// let picture = renderer.snapshot(&mut data, "side")?.rgb()?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    pub fn adopt(&mut self, model: &Model) -> Result<(), RenderError> {
        let [width, height] = self.size();
        let mut new = Self::on(&self.assets.gpu, model, width, height, self.assets.options)?;
        new.assets.merges = self.assets.merges;
        *self = new;
        Ok(())
    }
}
