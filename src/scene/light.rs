//! Lights of a scene.

use mujoco_sys::{guard, mjvLight};

use super::Scene;
use super::needs::check_poses;
use crate::data::Data;
use crate::error::Result;
use crate::ffi;

/// Light of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneLight {
    /// Position, m, world frame. Zero for the headlight, which is placed at the camera.
    pub pos: [f32; 3],
    /// Direction, world frame. Zero for the headlight, which points along the viewing direction.
    pub dir: [f32; 3],
    /// Constant, linear and quadratic attenuation. Zero for directional lights.
    pub attenuation: [f32; 3],
    /// Half the opening angle of a spot light, degrees. Zero for directional lights.
    pub cutoff: f32,
    /// Spot exponent: larger values concentrate the light. Zero for directional lights.
    pub exponent: f32,
    /// Ambient red, green and blue.
    pub ambient: [f32; 3],
    /// Diffuse red, green and blue.
    pub diffuse: [f32; 3],
    /// Specular red, green and blue.
    pub specular: [f32; 3],
    /// Marks the headlight.
    pub headlight: bool,
    /// Marks a directional light.
    pub directional: bool,
    /// Enables shadows of this light.
    pub castshadow: bool,
    /// `false` for a light that neither the engine's OpenGL renderer nor this crate's draws: a
    /// point light or an image light, with engines from 3.3.3. Those from 3.5 and before 3.17 draw
    /// it as a light without a place, which shines along the view.
    pub drawn: bool,
    /// Marks a light that the engine's renderer neither places nor directs.
    #[cfg(feature = "renderer")]
    pub(crate) shines_along_view: bool,
}

/// The engine's renderer draws point and image lights, without setting their places and directions:
/// the values of OpenGL's initial state remain.
const DRAWS_UNPLACED_LIGHTS: bool = cfg!(all(engine_since = "3.5.0", not(engine_since = "3.17.0")));

impl SceneLight {
    fn new(raw: &mjvLight) -> Self {
        let &mjvLight { pos, dir, attenuation, cutoff, exponent, ambient, diffuse, specular, .. } = raw;
        // SAFETY: a valid light, of which the function reads a number.
        let kind = unsafe { mujoco_sys::adapted::scene_light_kind(raw) };
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
            directional: kind == 1,
            castshadow: raw.castshadow != 0,
            drawn: kind < 2 || DRAWS_UNPLACED_LIGHTS,
            #[cfg(feature = "renderer")]
            shines_along_view: kind >= 2,
        }
    }
}

impl Scene {
    /// Iterates over the active lights: first the headlight if it is active, then the lights of the
    /// model.
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

    /// Returns the position and the direction of the headlight.
    #[cfg(feature = "viewer")]
    pub(crate) fn headlight(&self) -> Option<[[f32; 3]; 2]> {
        self.lights().next().filter(|light| light.headlight).map(|light| [light.pos, light.dir])
    }

    /// Moves the headlight to another viewpoint, as an update of the scene does.
    #[cfg(feature = "viewer")]
    pub(crate) fn set_headlight(&mut self, pos: [f32; 3], dir: [f32; 3]) {
        if self.headlight().is_some() {
            let light = &mut self.raw_mut().lights[0];
            (light.pos, light.dir) = (pos, dir);
        }
    }

    /// Updates only the lights.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`](crate::Error::NotComputed) if positions have not been computed,
    /// [`Error::OtherModel`](crate::Error::OtherModel) for data of another model,
    /// [`Error::Engine`](crate::Error::Engine) with newer engines before the first update of the
    /// camera.
    #[doc(alias = "mjv_makeLights")]
    pub fn update_lights(&mut self, data: &Data) -> Result<()> {
        self.check_model(data.model(), "the data to show")?;
        check_poses("Scene::update_lights", data)?;
        let scene = std::ptr::from_mut(self.raw_mut());
        data.call("mjv_makeLights", |m, d| {
            // SAFETY: the model and the data belong together, and the function only reads them.
            unsafe { guard::mjv_make_lights(m, d.cast_mut(), scene) }
        })
    }
}
