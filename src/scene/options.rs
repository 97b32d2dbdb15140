//! Options of visualisation: labels, frames, groups, flags and rendering effects.

use std::ffi::c_int;

use bitflags::bitflags;
use mujoco_sys::{self as sys, mjvOption};

use crate::ffi;
use crate::macros::engine_enum;
use crate::macros::with_methods;

engine_enum! {
    /// Kind of element that carries labels.
    LabelMode {
        /// No labels.
        None = mjLABEL_NONE,
        /// Bodies.
        Body = mjLABEL_BODY,
        /// Joints, if shown.
        Joint = mjLABEL_JOINT,
        /// Geoms.
        Geom = mjLABEL_GEOM,
        /// Sites.
        Site = mjLABEL_SITE,
        /// Cameras, if shown.
        Camera = mjLABEL_CAMERA,
        /// Lights, if shown.
        Light = mjLABEL_LIGHT,
        /// Tendons.
        Tendon = mjLABEL_TENDON,
        /// Actuators, if shown.
        Actuator = mjLABEL_ACTUATOR,
        /// Equality constraints, if shown.
        Constraint = mjLABEL_CONSTRAINT,
        /// Flexes. With engines from 3.0.
        Flex = mjLABEL_FLEX,
        /// Skins.
        Skin = mjLABEL_SKIN,
        /// The selected body.
        Selection = mjLABEL_SELECTION,
        /// Coordinates of the selected point, if shown.
        SelectionPoint = mjLABEL_SELPNT,
        /// Names of the geoms in contact, if contact points are shown. With engines from 2.3.3.
        ContactPoint = mjLABEL_CONTACTPOINT,
        /// Magnitudes of contact forces, if shown.
        ContactForce = mjLABEL_CONTACTFORCE,
        /// Constraint islands of bodies. With engines from 3.0.
        Island = mjLABEL_ISLAND,
    }
}

engine_enum! {
    /// Kind of object whose frames are drawn, as three cylinders: x red, y green, z blue.
    FrameMode {
        /// No frames.
        None = mjFRAME_NONE,
        /// Bodies.
        Body = mjFRAME_BODY,
        /// Geoms.
        Geom = mjFRAME_GEOM,
        /// Sites.
        Site = mjFRAME_SITE,
        /// Cameras, if shown.
        Camera = mjFRAME_CAMERA,
        /// Lights, if shown.
        Light = mjFRAME_LIGHT,
        /// Contacts.
        Contact = mjFRAME_CONTACT,
        /// World.
        World = mjFRAME_WORLD,
    }
}

bitflags! {
    /// Visible parts of a model and its simulation.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    pub struct VisualFlags: u32 {
        /// Convex hulls instead of the meshes.
        const CONVEXHULL = 1 << sys::mjVIS_CONVEXHULL;
        /// Textures.
        const TEXTURE = 1 << sys::mjVIS_TEXTURE;
        /// Joints.
        const JOINT = 1 << sys::mjVIS_JOINT;
        /// Cameras.
        const CAMERA = 1 << sys::mjVIS_CAMERA;
        /// Actuators.
        const ACTUATOR = 1 << sys::mjVIS_ACTUATOR;
        /// Activations instead of controls, in the colours of actuators.
        const ACTIVATION = 1 << sys::mjVIS_ACTIVATION;
        /// Lights.
        const LIGHT = 1 << sys::mjVIS_LIGHT;
        /// Spatial tendons.
        const TENDON = 1 << sys::mjVIS_TENDON;
        /// Rays of rangefinders.
        const RANGEFINDER = 1 << sys::mjVIS_RANGEFINDER;
        /// Anchor points of equality constraints.
        const CONSTRAINT = 1 << sys::mjVIS_CONSTRAINT;
        /// Equivalent inertia boxes of the bodies.
        const INERTIA = 1 << sys::mjVIS_INERTIA;
        /// Inertia boxes scaled to the density of water.
        const SCLINERTIA = 1 << sys::mjVIS_SCLINERTIA;
        /// Applied forces.
        const PERTFORCE = 1 << sys::mjVIS_PERTFORCE;
        /// Target of a perturbation.
        const PERTOBJ = 1 << sys::mjVIS_PERTOBJ;
        /// Contact points.
        const CONTACTPOINT = 1 << sys::mjVIS_CONTACTPOINT;
        /// Contact forces.
        const CONTACTFORCE = 1 << sys::mjVIS_CONTACTFORCE;
        /// Contact forces split into normal and friction.
        const CONTACTSPLIT = 1 << sys::mjVIS_CONTACTSPLIT;
        /// Higher transparency for the geoms of moving bodies.
        const TRANSPARENT = 1 << sys::mjVIS_TRANSPARENT;
        /// Lines from bodies to their joints and parents.
        const AUTOCONNECT = 1 << sys::mjVIS_AUTOCONNECT;
        /// Centres of mass of kinematic trees.
        const COM = 1 << sys::mjVIS_COM;
        /// Selected point.
        const SELECT = 1 << sys::mjVIS_SELECT;
        /// Static geoms and sites.
        const STATIC = 1 << sys::mjVIS_STATIC;
        /// Skins.
        const SKIN = 1 << sys::mjVIS_SKIN;
        /// Vertices of flexes, as spheres. As all flags of flexes, without effect in engines before
        /// 3.0.
        const FLEXVERT = 1 << sys::mjVIS_FLEXVERT;
        /// Edges of flexes, as cylinders.
        const FLEXEDGE = 1 << sys::mjVIS_FLEXEDGE;
        /// Faces of the elements of flexes.
        const FLEXFACE = 1 << sys::mjVIS_FLEXFACE;
        /// Smooth surfaces of flexes, instead of the other parts. One-dimensional flexes have none.
        const FLEXSKIN = 1 << sys::mjVIS_FLEXSKIN;
        /// Colours of constraint islands, for bodies and contacts. As all following flags, without
        /// effect in engines before 3.0.
        const ISLAND = 1 << sys::mjVIS_ISLAND;
        /// Bounding volumes of bodies, at the depth [`SceneOptions::bvh_depth`].
        const BODYBVH = 1 << sys::mjVIS_BODYBVH;
        /// Bounding volumes of meshes, at the depth [`SceneOptions::bvh_depth`].
        const MESHBVH = 1 << sys::mjVIS_MESHBVH;
        /// Iterations of the collision of signed distance fields.
        const SDFITER = 1 << sys::mjVIS_SDFITER;
    }
}

bitflags! {
    /// Rendering effects. The engine stores them in the scene.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    pub struct RenderFlags: u32 {
        /// Shadows.
        const SHADOW = 1 << sys::mjRND_SHADOW;
        /// Wireframe.
        const WIREFRAME = 1 << sys::mjRND_WIREFRAME;
        /// Reflections.
        const REFLECTION = 1 << sys::mjRND_REFLECTION;
        /// Additive blending of transparent geoms.
        const ADDITIVE = 1 << sys::mjRND_ADDITIVE;
        /// Skybox.
        const SKYBOX = 1 << sys::mjRND_SKYBOX;
        /// Fog.
        const FOG = 1 << sys::mjRND_FOG;
        /// Haze at the horizon of infinite planes.
        const HAZE = 1 << sys::mjRND_HAZE;
        /// A random flat colour for each geom.
        const SEGMENT = 1 << sys::mjRND_SEGMENT;
        /// With [`SEGMENT`](Self::SEGMENT): the colour encodes the geom's
        /// [`segid`](super::SceneGeom::segid) plus 1.
        const IDCOLOR = 1 << sys::mjRND_IDCOLOR;
        /// Back-face culling.
        const CULL_FACE = 1 << sys::mjRND_CULL_FACE;
    }
}

bitflags! {
    /// Categories of geoms in a scene, as a bit mask.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub struct Categories: u32 {
        /// Geoms and sites of the world and of bodies fixed to it.
        const STATIC = sys::mjCAT_STATIC;
        /// Geoms and sites of moving bodies, tendons, skins.
        const DYNAMIC = sys::mjCAT_DYNAMIC;
        /// Decoration that is not part of the model: frames, contacts, joints, …
        const DECOR = sys::mjCAT_DECOR;
    }
}

/// Options of visualisation for a [`Scene`](super::Scene).
///
/// Groups control the visibility of elements: `geomgroup[2]` shows or hides geoms of group 2. As in
/// the engine, groups below 0 count as 0 and groups above 5 as 5.
///
/// ```
/// use mujoco_safe::scene::{FrameMode, SceneOptions, VisualFlags};
///
/// let mut options = SceneOptions::default();
/// assert!(options.geomgroup[0] && !options.geomgroup[3]);
/// options.frame = FrameMode::Body;
/// options.flags |= VisualFlags::CONTACTPOINT | VisualFlags::CONTACTFORCE;
/// options.flags.remove(VisualFlags::TEXTURE);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[allow(
    clippy::unsafe_derive_deserialize,
    reason = "the unsafe calls copy plain numbers, which any value of the struct has"
)]
pub struct SceneOptions {
    /// Labelled kind of element.
    pub label: LabelMode,
    /// Kind of object whose frames are drawn.
    pub frame: FrameMode,
    /// Visibility of each group of geoms.
    pub geomgroup: [bool; 6],
    /// Visibility of each group of sites.
    pub sitegroup: [bool; 6],
    /// Visibility of each group of joints.
    pub jointgroup: [bool; 6],
    /// Visibility of each group of tendons.
    pub tendongroup: [bool; 6],
    /// Visibility of each group of actuators.
    pub actuatorgroup: [bool; 6],
    /// Visibility of each group of skins. A hidden skin still has a geom in the scene, with all
    /// vertices at zero.
    pub skingroup: [bool; 6],
    /// Visibility of each group of flexes, in engines from 3.0.
    pub flexgroup: [bool; 6],
    /// Visible parts.
    pub flags: VisualFlags,
    /// Visible layer of the elements of three-dimensional flexes, for [`VisualFlags::FLEXFACE`]: 0
    /// is the outermost. In engines from 3.0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub flex_layer: u32,
    /// Depth of the bounding volumes that [`VisualFlags::BODYBVH`] and [`VisualFlags::MESHBVH`]
    /// show, 1 by default. In engines from 3.0.
    #[cfg_attr(feature = "serde", serde(default = "default_bvh_depth"))]
    pub bvh_depth: u32,
}

/// Returns the engine's default.
fn default_bvh_depth() -> u32 {
    1
}

impl Default for SceneOptions {
    /// Returns the engine's defaults: groups 0 to 2, no labels, no frames; textures, tendons,
    /// rangefinders, the target of a perturbation, static geoms, skins; the edges and the smooth
    /// surfaces of flexes.
    #[doc(alias = "mjv_defaultOption")]
    fn default() -> Self {
        let group = [true, true, true, false, false, false];
        Self {
            label: LabelMode::None,
            frame: FrameMode::None,
            geomgroup: group,
            sitegroup: group,
            jointgroup: group,
            tendongroup: group,
            actuatorgroup: group,
            skingroup: group,
            flexgroup: group,
            flags: VisualFlags::TEXTURE
                | VisualFlags::TENDON
                | VisualFlags::RANGEFINDER
                | VisualFlags::PERTOBJ
                | VisualFlags::STATIC
                | VisualFlags::SKIN
                | VisualFlags::FLEXEDGE
                | VisualFlags::FLEXSKIN,
            flex_layer: 0,
            bvh_depth: default_bvh_depth(),
        }
    }
}

with_methods!(SceneOptions {
    with_label(label: LabelMode),
    with_frame(frame: FrameMode),
    with_geomgroup(geomgroup: [bool; 6]),
    with_sitegroup(sitegroup: [bool; 6]),
    with_jointgroup(jointgroup: [bool; 6]),
    with_tendongroup(tendongroup: [bool; 6]),
    with_actuatorgroup(actuatorgroup: [bool; 6]),
    with_skingroup(skingroup: [bool; 6]),
    with_flexgroup(flexgroup: [bool; 6]),
    with_flags(flags: VisualFlags),
    with_flex_layer(flex_layer: u32),
    with_bvh_depth(bvh_depth: u32),
});

impl SceneOptions {
    pub(super) fn raw(&self) -> mjvOption {
        // SAFETY: the function sets all fields of the structure, including those that only newer
        // engines have.
        let mut raw: mjvOption = unsafe { ffi::made_by(|raw| sys::mjv_defaultOption(raw)) };
        (raw.label, raw.frame) = (self.label.raw(), self.frame.raw());
        for (to, from) in [
            (&mut raw.geomgroup, self.geomgroup),
            (&mut raw.sitegroup, self.sitegroup),
            (&mut raw.jointgroup, self.jointgroup),
            (&mut raw.tendongroup, self.tendongroup),
            (&mut raw.actuatorgroup, self.actuatorgroup),
            (&mut raw.skingroup, self.skingroup),
        ] {
            *to = from.map(u8::from);
        }
        let flexgroup = self.flexgroup.map(u8::from);
        // SAFETY: a valid structure, and one byte for each of the engine's groups.
        unsafe { sys::adapted::set_flex_groups(&raw mut raw, flexgroup.as_ptr()) };
        let [layer, depth] =
            [self.flex_layer, self.bvh_depth].map(|number| c_int::try_from(number).unwrap_or(c_int::MAX));
        // SAFETY: a valid structure.
        unsafe { sys::adapted::set_layers(&raw mut raw, layer, depth) };
        // Flags that only newer engines have keep their defaults.
        set_flags(&mut raw.flags, self.flags.bits(), VisualFlags::all().bits());
        raw
    }

    /// Returns `true` if the options show contacts, constraints or islands, for which the engine
    /// reads results of the constraint solver.
    pub(crate) fn shows_contacts(&self) -> bool {
        const FLAGS: VisualFlags = VisualFlags::CONTACTPOINT
            .union(VisualFlags::CONTACTFORCE)
            .union(VisualFlags::CONSTRAINT)
            .union(VisualFlags::ISLAND)
            .union(VisualFlags::SDFITER);
        self.flags.intersects(FLAGS) || self.frame == FrameMode::Contact || self.label == LabelMode::Island
    }
}

/// Sets the engine's flags, one byte each, from the bits in `mask`.
pub(super) fn set_flags(flags: &mut [u8], bits: u32, mask: u32) {
    for (bit, flag) in flags.iter_mut().enumerate().filter(|(bit, _)| (mask >> bit) & 1 == 1) {
        *flag = u8::from((bits >> bit) & 1 == 1);
    }
}

/// Packs the engine's flags, one byte each, into bits.
pub(super) fn bits(bytes: &[u8]) -> u32 {
    bytes.iter().enumerate().fold(0, |bits, (bit, &byte)| bits | (u32::from(byte != 0) << bit))
}
