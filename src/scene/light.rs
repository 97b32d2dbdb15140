//! The lights of a scene.

use mujoco_sys::mjvLight;

use super::Scene;
use crate::ffi;

/// A light in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "mjvLight")]
pub struct SceneLight {
    /// Position, m, world frame. Zero for the headlight, which is where the camera is.
    pub pos: [f32; 3],
    /// Direction, world frame. Zero for the headlight, which shines where the camera looks.
    pub dir: [f32; 3],
    /// Constant, linear and quadratic attenuation. Zero for directional lights.
    pub attenuation: [f32; 3],
    /// Half the angle of the cone of a spot light, degrees. Zero for directional lights.
    pub cutoff: f32,
    /// How much a spot light is focused. Zero for directional lights.
    pub exponent: f32,
    /// Ambient red, green and blue.
    pub ambient: [f32; 3],
    /// Diffuse red, green and blue.
    pub diffuse: [f32; 3],
    /// Specular red, green and blue.
    pub specular: [f32; 3],
    /// Whether it is the headlight.
    pub headlight: bool,
    /// Whether it is directional.
    pub directional: bool,
    /// Whether it casts shadows.
    pub castshadow: bool,
}

impl SceneLight {
    fn new(raw: &mjvLight) -> Self {
        let &mjvLight { pos, dir, attenuation, cutoff, exponent, ambient, diffuse, specular, .. } = raw;
        Self {
            pos,
            dir,
            attenuation,
            cutoff,
            exponent,
            ambient,
            diffuse,
            specular,
            headlight: raw.headlight != 0,
            directional: raw.directional != 0,
            castshadow: raw.castshadow != 0,
        }
    }
}

impl Scene {
    /// The lights that are on: the headlight if it is, then those of the model.
    ///
    /// ```
    /// use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut scene = Scene::new(data.model(), 1000)?;
    /// let mut camera = Camera::free(data.model());
    /// scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all())?;
    /// assert!(scene.lights().next().is_some_and(|light| light.headlight));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn lights(&self) -> impl ExactSizeIterator<Item = SceneLight> + '_ {
        self.raw().lights[..ffi::size(self.raw().nlight)].iter().map(SceneLight::new)
    }
}
