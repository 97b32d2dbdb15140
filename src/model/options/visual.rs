//! The settings of the visualiser.

use mujoco_sys::{
    mjVisual, mjVisual___bindgen_ty_1 as mjVisualGlobal, mjVisual___bindgen_ty_2 as mjVisualQuality,
    mjVisual___bindgen_ty_3 as mjVisualHeadlight, mjVisual___bindgen_ty_4 as mjVisualMap,
    mjVisual___bindgen_ty_5 as mjVisualScale, mjVisual___bindgen_ty_6 as mjVisualRgba,
};

use super::mirror::{Mirror, mirror};
use crate::error::Result;
use crate::model::{Model, ModelMut};

/// How the model is to be shown. A copy: read it with [`Model::visual`], change it with [`ModelMut::visual`].
///
/// Simulation makes no use of it. The default is the engine's own, which is what a model gets whose XML has no `<visual>`.
///
/// ```
/// use mujoco_safe::{Visual, sample};
///
/// let visual: Visual = sample::humanoid().visual();
/// println!("{} x {} pixels", visual.global.offwidth, visual.global.offheight);
/// assert_eq!(Visual::default().global.fovy, 45.0);
/// ```
///
/// With the feature `serde` it can be kept in a file. What the file leaves out has its default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
#[non_exhaustive]
#[doc(alias = "mjVisual")]
#[doc(alias = "mj_defaultVisual")]
pub struct Visual {
    /// The free camera, and the size of pictures.
    pub global: VisualGlobal,
    /// The effort of rendering.
    pub quality: VisualQuality,
    /// The light at the camera.
    pub headlight: VisualHeadlight,
    /// From quantities of the simulation to those of the picture.
    pub map: VisualMap,
    /// Sizes of what is shown beside the model itself, in multiples of [`meansize`](super::Statistics::meansize).
    pub scale: VisualScale,
    /// Colours of what is shown beside the model itself: red, green, blue and alpha, each from 0 to 1.
    pub rgba: VisualRgba,
}

impl Mirror<mjVisual> for Visual {
    fn read(raw: mjVisual) -> Self {
        Self {
            global: Mirror::read(raw.global),
            quality: Mirror::read(raw.quality),
            headlight: Mirror::read(raw.headlight),
            map: Mirror::read(raw.map),
            scale: Mirror::read(raw.scale),
            rgba: Mirror::read(raw.rgba),
        }
    }

    fn write(self) -> mjVisual {
        mjVisual {
            global: self.global.write(),
            quality: self.quality.write(),
            headlight: self.headlight.write(),
            map: self.map.write(),
            scale: self.scale.write(),
            rgba: self.rgba.write(),
        }
    }
}

mirror! {
    /// The free camera, and the size of pictures.
    VisualGlobal = mjVisualGlobal {
        /// The free camera's vertical field of view, degrees. Between 0 and 180.
        fovy: f32 = 45.0,
        /// The distance between the free camera's eyes, m.
        ipd: f32 = 0.068,
        /// The free camera's first direction about the vertical axis, degrees.
        azimuth: f32 = 90.0,
        /// The free camera's first direction above the horizontal plane, degrees; below it where it is negative.
        elevation: f32 = -45.0,
        /// Width of the lines of wire frames and rays, pixels. Positive.
        linewidth: f32 = 1.0,
        /// How much a selected body shines by itself. Not negative.
        glow: f32 = 0.3,
        /// Width of pictures that are rendered without a window, pixels. From 1 to 32768.
        offwidth: usize = 640,
        /// Their height, pixels. From 1 to 32768.
        offheight: usize = 480,
    }
}

mirror! {
    /// The effort of rendering.
    VisualQuality = mjVisualQuality {
        /// Width and height of the texture that shadows are computed in, pixels; 0 for no shadows. Up to 32768.
        shadowsize: usize = 4096,
        /// Samples for a pixel of a picture without a window. Up to 64.
        offsamples: usize = 4,
        /// Into how many slices around its axis a round shape is cut. From 1 to 1000.
        numslices: usize = 28,
        /// Into how many stacks along its axis a round shape is cut. From 1 to 1000.
        numstacks: usize = 16,
        /// Into how many rectangles along each edge the face of a box is cut. From 1 to 1000.
        numquads: usize = 4,
    }
}

mirror! {
    /// The light at the camera. Its colours are red, green and blue, not negative.
    VisualHeadlight = mjVisualHeadlight {
        /// Colour of the light that comes from everywhere.
        ambient: [f32; 3] = [0.1; 3],
        /// Colour of the light that is reflected to all sides.
        diffuse: [f32; 3] = [0.4; 3],
        /// Colour of the light that is reflected as by a mirror.
        specular: [f32; 3] = [0.5; 3],
        /// Whether it is on.
        active: bool = true,
    }
}

mirror! {
    /// From quantities of the simulation to those of the picture. Distances are multiples of the model's
    /// [`extent`](super::Statistics::extent).
    VisualMap = mjVisualMap {
        /// Stiffness of the spring by which the mouse pulls a body, for a unit of mass, 1/s². Not negative.
        stiffness: f32 = 100.0,
        /// Stiffness of the spring by which the mouse turns a body, for a unit of inertia, 1/s². Positive, for the engine
        /// divides by it.
        stiffnessrot: f32 = 500.0,
        /// Length of the arrow of a force, m/N, for bodies with a mean mass of 1 kg. Not negative.
        force: f32 = 0.005,
        /// Length of the arrow of a torque, 1/N. The engine keeps the number and makes no use of it. Not negative.
        torque: f32 = 0.1,
        /// By what the alpha of geoms is multiplied where they are shown transparent. From 0 to 1.
        alpha: f32 = 0.3,
        /// Where fog begins, in extents. Not negative.
        fogstart: f32 = 3.0,
        /// Where fog hides everything, in extents. Beyond `fogstart`.
        fogend: f32 = 10.0,
        /// The plane in front of which nothing is shown, in extents. At least 1e-6.
        znear: f32 = 0.01,
        /// The plane beyond which nothing is shown, in extents. Beyond `znear`, and up to 1e10.
        zfar: f32 = 50.0,
        /// Share of the way to the horizon that haze covers. From 0 to 1.
        haze: f32 = 0.3,
        /// How far around the model a directional light casts shadows, in extents. Positive.
        shadowclip: f32 = 1.0,
        /// Share of a spot light's cone in which it casts shadows. Positive.
        shadowscale: f32 = 0.6,
        /// Width of a tendon that an actuator pulls, in widths of the tendon. Not negative.
        actuatortendon: f32 = 2.0,
    }
}

mirror! {
    /// Sizes of what is shown beside the model itself, in multiples of [`meansize`](super::Statistics::meansize). None is
    /// negative.
    VisualScale = mjVisualScale {
        /// Width of the arrow of a force.
        forcewidth: f32 = 0.1,
        /// Radius of the disc of a contact.
        contactwidth: f32 = 0.3,
        /// Half the height of the disc of a contact.
        contactheight: f32 = 0.1,
        /// Radius of the capsules that connect joints and centres of mass.
        connect: f32 = 0.2,
        /// Radius of the ball at a centre of mass.
        com: f32 = 0.4,
        /// Size of a camera.
        camera: f32 = 0.3,
        /// Size of a light.
        light: f32 = 0.3,
        /// Radius of the ball at the selected point.
        selectpoint: f32 = 0.2,
        /// Length of the arrow of a joint.
        jointlength: f32 = 1.0,
        /// Width of the arrow of a joint.
        jointwidth: f32 = 0.1,
        /// Length of an actuator at a joint.
        actuatorlength: f32 = 0.7,
        /// Width of an actuator at a joint.
        actuatorwidth: f32 = 0.2,
        /// Length of the axes of a frame.
        framelength: f32 = 1.0,
        /// Width of the axes of a frame.
        framewidth: f32 = 0.1,
        /// Radius of what shows an equality constraint, and of the line along which the mouse pulls.
        constraint: f32 = 0.1,
        /// Radius of a slider-crank.
        slidercrank: f32 = 0.2,
    }
}

mirror! {
    /// Colours of what is shown beside the model itself: red, green, blue and alpha, each from 0 to 1.
    VisualRgba = mjVisualRgba {
        /// Fog.
        fog: [f32; 4] = [0.0, 0.0, 0.0, 1.0],
        /// Haze at the horizon.
        haze: [f32; 4] = [1.0, 1.0, 1.0, 1.0],
        /// A force that is applied from outside.
        force: [f32; 4] = [1.0, 0.5, 0.5, 1.0],
        /// A box that has the inertia of a body.
        inertia: [f32; 4] = [0.8, 0.2, 0.2, 0.6],
        /// A joint.
        joint: [f32; 4] = [0.2, 0.6, 0.8, 1.0],
        /// An actuator whose control is zero.
        actuator: [f32; 4] = [0.2, 0.25, 0.2, 1.0],
        /// An actuator whose control is at its lower limit.
        actuatornegative: [f32; 4] = [0.2, 0.6, 0.9, 1.0],
        /// An actuator whose control is at its upper limit.
        actuatorpositive: [f32; 4] = [0.9, 0.4, 0.2, 1.0],
        /// A centre of mass.
        com: [f32; 4] = [0.9, 0.9, 0.9, 1.0],
        /// A camera.
        camera: [f32; 4] = [0.6, 0.9, 0.6, 1.0],
        /// A light.
        light: [f32; 4] = [0.6, 0.6, 0.9, 1.0],
        /// The selected point.
        selectpoint: [f32; 4] = [0.9, 0.9, 0.1, 1.0],
        /// What connects joints and centres of mass; the anchor of an equality constraint on its first body.
        connect: [f32; 4] = [0.2, 0.2, 0.8, 1.0],
        /// A contact.
        contactpoint: [f32; 4] = [0.9, 0.6, 0.2, 1.0],
        /// The force of a contact.
        contactforce: [f32; 4] = [0.7, 0.9, 0.9, 1.0],
        /// The friction of a contact.
        contactfriction: [f32; 4] = [0.9, 0.8, 0.4, 1.0],
        /// The torque of a contact.
        contacttorque: [f32; 4] = [0.9, 0.7, 0.9, 1.0],
        /// A contact within its gap.
        contactgap: [f32; 4] = [0.5, 0.8, 0.9, 1.0],
        /// The ray of a range finder.
        rangefinder: [f32; 4] = [1.0, 1.0, 0.1, 1.0],
        /// The anchor of an equality constraint on its second body, and how far a distance is from what it has to be.
        constraint: [f32; 4] = [0.9, 0.0, 0.0, 1.0],
        /// A slider-crank.
        slidercrank: [f32; 4] = [0.5, 0.3, 0.8, 1.0],
        /// A slider-crank whose rod is too short to reach.
        crankbroken: [f32; 4] = [0.9, 0.0, 0.0, 1.0],
    }
}

impl Model {
    /// How the model is to be shown, as a copy.
    ///
    /// The engine's compiler takes any number from XML; only those that were set with [`ModelMut::visual`] are known to be in
    /// range. A negative count is read as 0.
    #[doc(alias = "vis")]
    pub fn visual(&self) -> Visual {
        Visual::read(self.raw().vis)
    }
}

impl ModelMut<'_> {
    /// Changes how the model is to be shown, after checking it: nothing is changed if a setting is out of range. All of them
    /// are checked, also those that the XML had set.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the setting, its value and what is allowed.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::humanoid();
    /// model.edit().visual(|visual| {
    ///     (visual.global.offwidth, visual.global.offheight) = (1920, 1080);
    ///     visual.rgba.fog = [0.8, 0.8, 0.9, 1.0];
    /// })?;
    /// assert_eq!(model.visual().global.offheight, 1080);
    /// let error = model.edit().visual(|visual| visual.map.znear = 0.0).unwrap_err();
    /// assert_eq!(error.to_string(), "visual.map.znear is 0, but must be at least 1e-6 and below zfar");
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mjVisual")]
    pub fn visual(&mut self, change: impl FnOnce(&mut Visual)) -> Result<()> {
        let mut visual = Model::visual(self);
        change(&mut visual);
        visual.check()?;
        self.raw_mut().vis = visual.write();
        Ok(())
    }
}
