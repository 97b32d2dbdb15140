//! Settings of the visualiser.

use mujoco_sys::{
    mjVisual, mjVisual___bindgen_ty_1 as mjVisualGlobal, mjVisual___bindgen_ty_2 as mjVisualQuality,
    mjVisual___bindgen_ty_3 as mjVisualHeadlight, mjVisual___bindgen_ty_4 as mjVisualMap,
    mjVisual___bindgen_ty_5 as mjVisualScale, mjVisual___bindgen_ty_6 as mjVisualRgba,
};

use super::fields::{Mirror, mirror};
use crate::error::Result;
use crate::model::{Model, ModelMut};

/// Visualiser settings of a model.
///
/// The struct is a copy of the engine's values: [`Model::visual`] reads them,
/// [`ModelMut::edit_visual`] changes them. They do not affect the simulation. The defaults are the
/// engine's, for a model whose XML has no `<visual>`.
///
/// ```
/// use mujoco_safe::model::Visual;
/// use mujoco_safe::sample;
///
/// let visual: Visual = sample::humanoid().visual();
/// println!("{} x {} pixels", visual.global.offwidth, visual.global.offheight);
/// assert_eq!(Visual::default().global.fovy, 45.0);
/// ```
///
/// With the feature `serde` it can be serialised. Missing fields have their defaults.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
#[non_exhaustive]
pub struct Visual {
    /// Free camera, and size of offscreen images.
    pub global: VisualGlobal,
    /// Rendering quality.
    pub quality: VisualQuality,
    /// Light at the position of the camera.
    pub headlight: VisualHeadlight,
    /// Mapping from simulated quantities to visual ones.
    pub map: VisualMap,
    /// Sizes of decorative elements, in multiples of [`meansize`](super::Statistics::meansize).
    pub scale: VisualScale,
    /// Colours of decorative elements: red, green, blue and alpha, each from 0 to 1.
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
        // SAFETY: all-zero bytes are a valid structure of numbers.
        let mut raw: mjVisual = unsafe { std::mem::zeroed() };
        self.write_into(&mut raw);
        raw
    }

    fn write_into(self, raw: &mut mjVisual) {
        self.global.write_into(&mut raw.global);
        self.quality.write_into(&mut raw.quality);
        let active = raw.headlight.active;
        self.headlight.write_into(&mut raw.headlight);
        // Newer engines have a third value for a light that is on if the scene has no other light.
        if self.headlight.active == (active != 0) {
            raw.headlight.active = active;
        }
        self.map.write_into(&mut raw.map);
        self.scale.write_into(&mut raw.scale);
        self.rgba.write_into(&mut raw.rgba);
    }
}

mirror! {
    /// Free camera, and size of offscreen images.
    VisualGlobal = mjVisualGlobal {
        /// Vertical field of view of the free camera, degrees. Between 0 and 180.
        fovy: f32 = 45.0,
        /// Distance between the two eyes of the free camera, m.
        ipd: f32 = 0.068,
        /// Initial azimuth of the free camera about the vertical axis, degrees.
        azimuth: f32 = 90.0,
        /// Initial elevation of the free camera above the horizontal plane, degrees. Negative below
        /// it.
        elevation: f32 = -45.0,
        /// Line width of wireframes and rays, pixels. Positive.
        linewidth: f32 = 1.0,
        /// Emission of a selected body. Not negative.
        glow: f32 = 0.3,
        /// Width of offscreen images, pixels. From 1 to 32768.
        offwidth: usize = 640,
        /// Height of offscreen images, pixels. From 1 to 32768.
        offheight: usize = 480,
    }
}

mirror! {
    /// Rendering quality.
    VisualQuality = mjVisualQuality {
        /// Width and height of the shadow map, pixels. 0 for no shadows. At most 32768.
        shadowsize: usize = 4096,
        /// Samples per pixel (MSAA) of offscreen images. At most 64.
        offsamples: usize = 4,
        /// Number of slices around the axis of a round shape. From 1 to 1000.
        numslices: usize = 28,
        /// Number of stacks along the axis of a round shape. From 1 to 1000.
        numstacks: usize = 16,
        /// Number of rectangles along each edge of the face of a box. From 1 to 1000.
        numquads: usize = 4,
    }
}

mirror! {
    /// Light at the position of the camera. Its colours are RGB and not negative.
    VisualHeadlight = mjVisualHeadlight {
        /// Ambient colour.
        ambient: [f32; 3] = [0.1; 3],
        /// Diffuse colour.
        diffuse: [f32; 3] = [0.4; 3],
        /// Specular colour.
        specular: [f32; 3] = [0.5; 3],
        /// `true` if the light is on.
        active: bool = true,
    }
}

mirror! {
    /// Mapping from simulated quantities to visual ones. Distances are multiples of the model's
    /// [`extent`](super::Statistics::extent).
    VisualMap = mjVisualMap {
        /// Stiffness of the spring by which the mouse pulls a body, per unit of mass, 1/s². Not
        /// negative.
        stiffness: f32 = 100.0,
        /// Stiffness of the spring by which the mouse rotates a body, per unit of inertia, 1/s².
        /// Positive, because the engine divides by it.
        stiffnessrot: f32 = 500.0,
        /// Length of the arrow of a force, m/N, for bodies with a mean mass of 1 kg. Not negative.
        force: f32 = 0.005,
        /// Length of the arrow of a torque, 1/N. The engine stores the value and does not use it.
        /// Not negative.
        torque: f32 = 0.1,
        /// Factor for the alpha of geoms that are shown transparent. From 0 to 1.
        alpha: f32 = 0.3,
        /// Distance at which fog starts, in extents. Not negative.
        fogstart: f32 = 3.0,
        /// Distance at which fog is opaque, in extents. Greater than `fogstart`.
        fogend: f32 = 10.0,
        /// Distance of the near clipping plane, in extents. At least 1e-6.
        znear: f32 = 0.01,
        /// Distance of the far clipping plane, in extents. Greater than `znear`, and at most 1e10.
        zfar: f32 = 50.0,
        /// Fraction of the distance to the horizon that haze covers. From 0 to 1.
        haze: f32 = 0.3,
        /// Half the size of the region in which a directional light casts shadows, in extents.
        /// Positive.
        shadowclip: f32 = 1.0,
        /// Fraction of the cone of a spot light in which it casts shadows. Positive.
        shadowscale: f32 = 0.6,
        /// Width at which an actuated tendon is drawn, relative to the width of the tendon. Not
        /// negative.
        actuatortendon: f32 = 2.0,
    }
}

mirror! {
    /// Sizes of decorative elements, in multiples of [`meansize`](super::Statistics::meansize). Not
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
        /// Radius of the sphere at a centre of mass.
        com: f32 = 0.4,
        /// Size of a camera.
        camera: f32 = 0.3,
        /// Size of a light.
        light: f32 = 0.3,
        /// Radius of the sphere at the selected point.
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
        /// Radius of the decoration of an equality constraint, and of the line along which the
        /// mouse pulls.
        constraint: f32 = 0.1,
        /// Radius of a slider-crank.
        slidercrank: f32 = 0.2,
    }
}

mirror! {
    /// Colours of decorative elements: red, green, blue and alpha, each from 0 to 1.
    VisualRgba = mjVisualRgba {
        /// Fog.
        fog: [f32; 4] = [0.0, 0.0, 0.0, 1.0],
        /// Haze at the horizon.
        haze: [f32; 4] = [1.0, 1.0, 1.0, 1.0],
        /// An external force.
        force: [f32; 4] = [1.0, 0.5, 0.5, 1.0],
        /// The equivalent inertia box of a body.
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
        /// A connection between a joint and a centre of mass; the anchor of an equality constraint
        /// on its first body.
        connect: [f32; 4] = [0.2, 0.2, 0.8, 1.0],
        /// A contact.
        contactpoint: [f32; 4] = [0.9, 0.6, 0.2, 1.0],
        /// The force of a contact.
        contactforce: [f32; 4] = [0.7, 0.9, 0.9, 1.0],
        /// The friction force of a contact.
        contactfriction: [f32; 4] = [0.9, 0.8, 0.4, 1.0],
        /// The torque of a contact.
        contacttorque: [f32; 4] = [0.9, 0.7, 0.9, 1.0],
        /// A contact within its gap.
        contactgap: [f32; 4] = [0.5, 0.8, 0.9, 1.0],
        /// The ray of a range finder.
        rangefinder: [f32; 4] = [1.0, 1.0, 0.1, 1.0],
        /// The anchor of an equality constraint on its second body, and the violation of a distance
        /// constraint.
        constraint: [f32; 4] = [0.9, 0.0, 0.0, 1.0],
        /// A slider-crank.
        slidercrank: [f32; 4] = [0.5, 0.3, 0.8, 1.0],
        /// A slider-crank whose rod is too short.
        crankbroken: [f32; 4] = [0.9, 0.0, 0.0, 1.0],
    }
}

/// # Visual settings
impl Model {
    /// Returns a copy of the visualiser settings.
    ///
    /// The engine's compiler accepts any value in XML, so only settings from
    /// [`ModelMut::edit_visual`] are certain to be in range. A negative count is read as 0.
    #[doc(alias = "vis")]
    pub fn visual(&self) -> Visual {
        Visual::read(self.raw().vis)
    }
}

/// # Visual settings
impl ModelMut<'_> {
    /// Changes the visualiser settings. Rejects the change if a setting is out of range. The check
    /// includes settings that `change` does not modify, for example those from the XML.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the setting, its value and the valid values.
    /// The model is then unchanged.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::humanoid();
    /// model.edit().edit_visual(|visual| {
    ///     (visual.global.offwidth, visual.global.offheight) = (1920, 1080);
    ///     visual.rgba.fog = [0.8, 0.8, 0.9, 1.0];
    /// })?;
    /// assert_eq!(model.visual().global.offheight, 1080);
    /// let error = model.edit().edit_visual(|visual| visual.map.znear = 0.0).unwrap_err();
    /// assert_eq!(error.to_string(), "visual.map.znear is 0, but must be at least 1e-6 and less than zfar");
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mjVisual")]
    pub fn edit_visual(&mut self, change: impl FnOnce(&mut Visual)) -> Result<()> {
        let mut visual = self.visual();
        change(&mut visual);
        visual.check()?;
        visual.write_into(&mut self.raw_mut().vis);
        Ok(())
    }
}
