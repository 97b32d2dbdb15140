//! What is shown, and how.

use bitflags::bitflags;
use mujoco_sys::{self as sys, mjvOption};

use crate::enums::engine_enum;

engine_enum! {
    /// What is labelled.
    #[doc(alias = "mjtLabel")]
    LabelMode {
        /// Nothing.
        None = mjLABEL_NONE,
        /// Bodies.
        Body = mjLABEL_BODY,
        /// Joints, where they are shown.
        Joint = mjLABEL_JOINT,
        /// Geoms.
        Geom = mjLABEL_GEOM,
        /// Sites.
        Site = mjLABEL_SITE,
        /// Cameras, where they are shown.
        Camera = mjLABEL_CAMERA,
        /// Lights, where they are shown.
        Light = mjLABEL_LIGHT,
        /// Tendons.
        Tendon = mjLABEL_TENDON,
        /// Actuators, where they are shown.
        Actuator = mjLABEL_ACTUATOR,
        /// Equality constraints, where they are shown.
        Constraint = mjLABEL_CONSTRAINT,
        /// Skins.
        Skin = mjLABEL_SKIN,
        /// The selected body.
        Selection = mjLABEL_SELECTION,
        /// The coordinates of the selected point, where it is shown.
        SelectionPoint = mjLABEL_SELPNT,
        /// The magnitudes of contact forces, where they are shown.
        ContactForce = mjLABEL_CONTACTFORCE,
    }
}

engine_enum! {
    /// Of what the frames are shown, as three cylinders: x red, y green, z blue.
    #[doc(alias = "mjtFrame")]
    FrameMode {
        /// Of nothing.
        None = mjFRAME_NONE,
        /// Of bodies.
        Body = mjFRAME_BODY,
        /// Of geoms.
        Geom = mjFRAME_GEOM,
        /// Of sites.
        Site = mjFRAME_SITE,
        /// Of cameras, where they are shown.
        Camera = mjFRAME_CAMERA,
        /// Of lights, where they are shown.
        Light = mjFRAME_LIGHT,
        /// Of contacts.
        Contact = mjFRAME_CONTACT,
        /// Of the world.
        World = mjFRAME_WORLD,
    }
}

bitflags! {
    /// Which parts of a model and its simulation are shown.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    #[doc(alias = "mjtVisFlag")]
    pub struct VisualFlags: u32 {
        /// The convex hulls of meshes in place of the meshes.
        const CONVEXHULL = 1 << sys::mjVIS_CONVEXHULL;
        /// Textures.
        const TEXTURE = 1 << sys::mjVIS_TEXTURE;
        /// Joints.
        const JOINT = 1 << sys::mjVIS_JOINT;
        /// Cameras.
        const CAMERA = 1 << sys::mjVIS_CAMERA;
        /// Actuators.
        const ACTUATOR = 1 << sys::mjVIS_ACTUATOR;
        /// Activations in place of controls, in the shades of actuators.
        const ACTIVATION = 1 << sys::mjVIS_ACTIVATION;
        /// Lights.
        const LIGHT = 1 << sys::mjVIS_LIGHT;
        /// Spatial tendons.
        const TENDON = 1 << sys::mjVIS_TENDON;
        /// The rays of rangefinders.
        const RANGEFINDER = 1 << sys::mjVIS_RANGEFINDER;
        /// The points of equality constraints.
        const CONSTRAINT = 1 << sys::mjVIS_CONSTRAINT;
        /// Boxes with the inertia of the bodies.
        const INERTIA = 1 << sys::mjVIS_INERTIA;
        /// Those boxes, in the size that they have at the density of water.
        const SCLINERTIA = 1 << sys::mjVIS_SCLINERTIA;
        /// Applied forces.
        const PERTFORCE = 1 << sys::mjVIS_PERTFORCE;
        /// Where a perturbation pulls to.
        const PERTOBJ = 1 << sys::mjVIS_PERTOBJ;
        /// Contact points.
        const CONTACTPOINT = 1 << sys::mjVIS_CONTACTPOINT;
        /// Contact forces.
        const CONTACTFORCE = 1 << sys::mjVIS_CONTACTFORCE;
        /// Contact forces split into normal and friction.
        const CONTACTSPLIT = 1 << sys::mjVIS_CONTACTSPLIT;
        /// Geoms of moving bodies are more transparent.
        const TRANSPARENT = 1 << sys::mjVIS_TRANSPARENT;
        /// Lines from bodies to their joints and parents.
        const AUTOCONNECT = 1 << sys::mjVIS_AUTOCONNECT;
        /// Centres of mass of whole kinematic trees.
        const COM = 1 << sys::mjVIS_COM;
        /// The selected point.
        const SELECT = 1 << sys::mjVIS_SELECT;
        /// What does not move.
        const STATIC = 1 << sys::mjVIS_STATIC;
        /// Skins.
        const SKIN = 1 << sys::mjVIS_SKIN;
    }
}

bitflags! {
    /// Which effects a renderer draws. The engine keeps them in the scene.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    #[doc(alias = "mjtRndFlag")]
    pub struct RenderFlags: u32 {
        /// Shadows.
        const SHADOW = 1 << sys::mjRND_SHADOW;
        /// Edges only.
        const WIREFRAME = 1 << sys::mjRND_WIREFRAME;
        /// Reflections.
        const REFLECTION = 1 << sys::mjRND_REFLECTION;
        /// What is transparent adds its light.
        const ADDITIVE = 1 << sys::mjRND_ADDITIVE;
        /// The sky.
        const SKYBOX = 1 << sys::mjRND_SKYBOX;
        /// Fog.
        const FOG = 1 << sys::mjRND_FOG;
        /// Haze at the horizon of infinite planes.
        const HAZE = 1 << sys::mjRND_HAZE;
        /// Each geom in a random flat shade.
        const SEGMENT = 1 << sys::mjRND_SEGMENT;
        /// With [`SEGMENT`](Self::SEGMENT): the shade is the geom's [`segid`](super::SceneGeom::segid) and 1.
        const IDCOLOR = 1 << sys::mjRND_IDCOLOR;
        /// Faces are seen from outside only.
        const CULL_FACE = 1 << sys::mjRND_CULL_FACE;
    }
}

bitflags! {
    /// Categories of geoms in a scene.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[doc(alias = "mjtCatBit")]
    pub struct Categories: u32 {
        /// Geoms and sites that do not move.
        const STATIC = sys::mjCAT_STATIC;
        /// Geoms and sites of bodies that move, tendons, skins.
        const DYNAMIC = sys::mjCAT_DYNAMIC;
        /// Everything that is no part of the model: frames, contacts, joints, …
        const DECOR = sys::mjCAT_DECOR;
    }
}

/// What of a simulation a [`Scene`](super::Scene) shows.
///
/// Elements are shown by group: `geomgroup[2]` is whether geoms of group 2 are. As in the engine a group below 0 counts as 0,
/// and one beyond 5 as 5.
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
#[doc(alias = "mjvOption")]
pub struct SceneOptions {
    /// What is labelled.
    pub label: LabelMode,
    /// Of what frames are shown.
    pub frame: FrameMode,
    /// Groups of geoms.
    pub geomgroup: [bool; 6],
    /// Groups of sites.
    pub sitegroup: [bool; 6],
    /// Groups of joints.
    pub jointgroup: [bool; 6],
    /// Groups of tendons.
    pub tendongroup: [bool; 6],
    /// Groups of actuators.
    pub actuatorgroup: [bool; 6],
    /// Groups of skins. A skin of a group that is not shown has a geom in the scene all the same; its vertices are all zero.
    pub skingroup: [bool; 6],
    /// Which parts are shown.
    pub flags: VisualFlags,
}

impl Default for SceneOptions {
    /// As in the engine: groups 0 to 2, no labels, no frames; textures, tendons, rangefinders, the object of a perturbation, what
    /// does not move, skins.
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
            flags: VisualFlags::TEXTURE
                | VisualFlags::TENDON
                | VisualFlags::RANGEFINDER
                | VisualFlags::PERTOBJ
                | VisualFlags::STATIC
                | VisualFlags::SKIN,
        }
    }
}

impl SceneOptions {
    pub(super) fn raw(&self) -> mjvOption {
        let group = |group: [bool; 6]| group.map(u8::from);
        mjvOption {
            label: self.label.raw(),
            frame: self.frame.raw(),
            geomgroup: group(self.geomgroup),
            sitegroup: group(self.sitegroup),
            jointgroup: group(self.jointgroup),
            tendongroup: group(self.tendongroup),
            actuatorgroup: group(self.actuatorgroup),
            skingroup: group(self.skingroup),
            flags: bytes(self.flags.bits()),
        }
    }

    /// Whether something of the contacts is shown, for which the engine reads their forces.
    pub(crate) fn shows_contacts(&self) -> bool {
        const FLAGS: VisualFlags =
            VisualFlags::CONTACTPOINT.union(VisualFlags::CONTACTFORCE).union(VisualFlags::CONSTRAINT);
        self.flags.intersects(FLAGS) || self.frame == FrameMode::Contact
    }
}

/// Bits as the engine keeps them: a byte each.
pub(super) fn bytes<const N: usize>(bits: u32) -> [u8; N] {
    std::array::from_fn(|bit| u8::from((bits >> bit) & 1 == 1))
}

/// And back.
pub(super) fn bits(bytes: &[u8]) -> u32 {
    bytes.iter().enumerate().fold(0, |bits, (bit, &byte)| bits | (u32::from(byte != 0) << bit))
}
