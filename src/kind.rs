//! Kinds of named elements: as values ([`Kind`]), and as types ([`Joint`], [`Body`], …) that
//! distinguish the ids.

use std::fmt;

use mujoco_sys as sys;

/// Kind of element as a type, which prevents the use of a joint's id for a body. Implemented by the
/// types of this module.
pub trait ElementKind: sealed::Sealed + 'static {
    /// The kind as a value.
    const KIND: Kind;
}

/// Restricts the implementation of the traits of ids and keys to this crate.
pub(crate) mod sealed {
    pub trait Sealed {}
}

/// Passes the table of kinds to a macro, one kind per line: the variant of [`Kind`] and the type,
/// the name in messages, the engine's `mjtObj`, and the type of the ids.
macro_rules! for_each_kind {
    ($then:ident) => {
        $then! {
            Body, "body", mjOBJ_BODY, BodyId;
            Joint, "joint", mjOBJ_JOINT, JointId;
            Geom, "geom", mjOBJ_GEOM, GeomId;
            Site, "site", mjOBJ_SITE, SiteId;
            Camera, "camera", mjOBJ_CAMERA, CameraId;
            Light, "light", mjOBJ_LIGHT, LightId;
            Mesh, "mesh", mjOBJ_MESH, MeshId;
            Skin, "skin", mjOBJ_SKIN, SkinId;
            HeightField, "height field", mjOBJ_HFIELD, HeightFieldId;
            Texture, "texture", mjOBJ_TEXTURE, TextureId;
            Material, "material", mjOBJ_MATERIAL, MaterialId;
            Pair, "pair", mjOBJ_PAIR, PairId;
            Exclude, "exclude", mjOBJ_EXCLUDE, ExcludeId;
            Equality, "equality", mjOBJ_EQUALITY, EqualityId;
            Tendon, "tendon", mjOBJ_TENDON, TendonId;
            Actuator, "actuator", mjOBJ_ACTUATOR, ActuatorId;
            Sensor, "sensor", mjOBJ_SENSOR, SensorId;
            Numeric, "numeric", mjOBJ_NUMERIC, NumericId;
            Text, "text", mjOBJ_TEXT, TextId;
            Tuple, "tuple", mjOBJ_TUPLE, TupleId;
            Keyframe, "keyframe", mjOBJ_KEY, KeyframeId;
            Flex, "flex", mjOBJ_FLEX, FlexId;
            Plugin, "plugin instance", mjOBJ_PLUGIN, PluginId;
        }
    };
}
pub(crate) use for_each_kind;

macro_rules! declare_kinds {
    ($($name:ident, $text:literal, $object:ident, $id:ident;)*) => {
        /// Kind of a named element.
        #[doc(alias = "mjtObj")]
        #[doc(alias = "mju_type2Str")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        #[allow(missing_docs, reason = "the variants are the engine's kinds")]
        pub enum Kind {
            $($name,)*
        }

        impl Kind {
            /// All kinds, in the engine's order.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// Returns the engine's `mjtObj`.
            pub(crate) fn object_type(self) -> i32 {
                (match self {
                    $(Self::$name => sys::$object,)*
                }) as i32
            }
        }

        impl fmt::Display for Kind {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self {
                    $(Self::$name => $text,)*
                })
            }
        }

        $(
            #[doc = concat!("[`Kind::", stringify!($name), "`] as a type.")]
            #[derive(Debug)]
            pub enum $name {}
            impl sealed::Sealed for $name {}
            impl ElementKind for $name {
                const KIND: Kind = Kind::$name;
            }
        )*
    };
}
for_each_kind!(declare_kinds);
