//! Elements of any kind: what a tuple holds, and what a sensor is attached to.

use std::fmt;

use mujoco_sys as sys;

use crate::id::{self, Id, Lineage};

/// The variants for the kinds of element, a line each; a body's own frame and a degree of freedom are no kinds.
macro_rules! objects {
    ($($(#[$doc:meta])* $name:ident = $object:ident;)*) => {
        /// An element of whatever kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        #[doc(alias = "mjtObj")]
        #[doc(alias = "objtype")]
        #[doc(alias = "objid")]
        pub enum Object {
            $($(#[$doc])* $name(Id<id::kind::$name>),)*
            /// A body, of which a sensor measures its own frame instead of the inertial one.
            XBody(id::BodyId),
            /// A degree of freedom, by its index in `qvel`.
            Dof(usize),
        }

        impl Object {
            /// What a type and an index of the engine's stand for; `None` for the type "unknown", and for the index -1.
            pub(super) fn from_raw(object_type: i32, index: i32, lineage: Lineage) -> Option<Self> {
                let index = usize::try_from(index).ok()?;
                match u32::try_from(object_type).ok()? {
                    $(sys::$object => Some(Self::$name(Id::new(index, lineage))),)*
                    sys::mjOBJ_XBODY => Some(Self::XBody(Id::new(index, lineage))),
                    sys::mjOBJ_DOF => Some(Self::Dof(index)),
                    _ => None,
                }
            }

            /// The engine's index, counted from 0.
            pub fn index(self) -> usize {
                match self {
                    $(Self::$name(id) => id.index(),)*
                    Self::XBody(id) => id.index(),
                    Self::Dof(index) => index,
                }
            }
        }
    };
}

objects! {
    /// A body. A sensor measures its inertial frame.
    Body = mjOBJ_BODY;
    /// A joint.
    Joint = mjOBJ_JOINT;
    /// A geom.
    Geom = mjOBJ_GEOM;
    /// A site.
    Site = mjOBJ_SITE;
    /// A camera.
    Camera = mjOBJ_CAMERA;
    /// A light.
    Light = mjOBJ_LIGHT;
    /// A mesh.
    Mesh = mjOBJ_MESH;
    /// A skin.
    Skin = mjOBJ_SKIN;
    /// A height field.
    HeightField = mjOBJ_HFIELD;
    /// A texture.
    Texture = mjOBJ_TEXTURE;
    /// A material.
    Material = mjOBJ_MATERIAL;
    /// A pair of geoms.
    Pair = mjOBJ_PAIR;
    /// A pair of bodies that do not collide.
    Exclude = mjOBJ_EXCLUDE;
    /// An equality constraint.
    Equality = mjOBJ_EQUALITY;
    /// A tendon.
    Tendon = mjOBJ_TENDON;
    /// An actuator.
    Actuator = mjOBJ_ACTUATOR;
    /// A sensor.
    Sensor = mjOBJ_SENSOR;
    /// A custom array of numbers.
    Numeric = mjOBJ_NUMERIC;
    /// A custom text.
    Text = mjOBJ_TEXT;
    /// A tuple.
    Tuple = mjOBJ_TUPLE;
    /// A keyframe.
    Keyframe = mjOBJ_KEY;
}

/// The objects of a tuple: an iterator over them.
#[derive(Clone)]
pub struct Objects<'a> {
    types: &'a [i32],
    indices: &'a [i32],
    lineage: Lineage,
}

impl<'a> Objects<'a> {
    pub(super) fn new(types: &'a [i32], indices: &'a [i32], lineage: Lineage) -> Self {
        Self { types, indices, lineage }
    }
}

impl Iterator for Objects<'_> {
    type Item = Object;

    fn next(&mut self) -> Option<Object> {
        let ((object_type, types), (index, indices)) = (self.types.split_first()?, self.indices.split_first()?);
        (self.types, self.indices) = (types, indices);
        let object = Object::from_raw(*object_type, *index, self.lineage);
        Some(object.unwrap_or_else(|| panic!("Bug: a tuple with object {index} of type {object_type}")))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.types.len(), Some(self.types.len()))
    }
}

impl ExactSizeIterator for Objects<'_> {}

impl fmt::Debug for Objects<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.clone()).finish()
    }
}
