//! Custom data: arrays of numbers, texts and tuples. Also keyframes, and references to elements of
//! any kind.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use mujoco_sys as sys;

use super::{View, ViewMut, range};
use crate::id::{self, Id, Lineage};
use crate::kind;
use crate::model::{Model, ModelMut};

fields!(Numeric on Model {
    /// Range of its values in `numeric_data`.
    #[doc(alias = "adr")]
    #[doc(alias = "size")]
    data_range: {Range<usize>} = |numeric| range(numeric.owner.numeric_adr(), numeric.owner.numeric_size(), numeric.index());
    /// Values.
    data: [f64] = numeric_data at data_range, data_mut in numeric_data_mut;
});

/// # Methods of [`Text`](super::Text)
impl<'a> View<'a, Model, kind::Text> {
    /// Returns the bytes of the text, without the NUL terminator of the engine's array.
    pub fn bytes(&self) -> &'a [u8] {
        let with_end = &self.owner.text_data()[range(self.owner.text_adr(), self.owner.text_size(), self.index())];
        with_end.strip_suffix(&[0]).unwrap_or(with_end)
    }
}

fields!(Text on Model {
    /// Text. Bytes of a file that are not UTF-8 become replacement characters, in a copy.
    #[doc(alias = "text_data")]
    #[doc(alias = "text_adr")]
    #[doc(alias = "text_size")]
    data: {Cow<'a, str>} = |text| String::from_utf8_lossy(text.bytes());
});

fields!(Tuple on Model {
    /// Range of its elements in `tuple_objprm`.
    #[doc(alias = "adr")]
    #[doc(alias = "size")]
    data_range: {Range<usize>} = |tuple| range(tuple.owner.tuple_adr(), tuple.owner.tuple_size(), tuple.index());
    /// Elements, in order.
    ///
    /// ```
    /// use mujoco_safe::{Model, element::Object};
    ///
    /// let model = Model::from_xml_str(
    ///     "<mujoco><worldbody><body name='arm'/></worldbody>
    ///        <custom><tuple name='parts'><element objtype='body' objname='arm' prm='0.5'/></tuple></custom></mujoco>",
    /// )?;
    /// let parts = model.tuple("parts")?;
    /// let arm = model.body("arm")?.id();
    /// assert!(parts.objects().eq([Object::Body(arm)]));
    /// assert_eq!(parts.objprm(), [0.5]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "objtype")]
    #[doc(alias = "objid")]
    objects: {Objects<'a>} = |tuple| {
        let range = tuple.data_range();
        Objects {
            types: &tuple.owner.tuple_objtype()[range.clone()],
            indices: &tuple.owner.tuple_objid()[range],
            lineage: tuple.owner.lineage(),
        }
    };
    /// Parameter of each element.
    objprm: [f64] = tuple_objprm at data_range, objprm_mut in tuple_objprm_mut;
});

fields!(Keyframe on Model {
    /// Time, s.
    time: f64 = key_time, set_time in key_time_mut;
    /// Position. `(nq)`
    qpos: [f64] = key_qpos, qpos_mut in key_qpos_mut;
    /// Velocity. `(nv)`
    qvel: [f64] = key_qvel, qvel_mut in key_qvel_mut;
    /// Activation. `(na)`
    act: [f64] = key_act, act_mut in key_act_mut;
    /// Positions of the mocap bodies, m. `(3 nmocap)`
    mpos: [f64] = key_mpos, mpos_mut in key_mpos_mut;
    /// Orientations of the mocap bodies: unit quaternions `[w, x, y, z]`. `(4 nmocap)`
    mquat: [f64] = key_mquat, mquat_mut in key_mquat_mut;
    /// Control. `(nu)`
    ctrl: [f64] = key_ctrl, ctrl_mut in key_ctrl_mut;
});

/// Declares [`Object`] with one variant per kind of element. A body's own frame and a degree of
/// freedom are not kinds, so their variants are written out.
macro_rules! objects {
    ($($(#[$doc:meta])* $name:ident = $object:ident;)*) => {
        /// Element of any kind: a member of a tuple, the object that a sensor is attached to, or
        /// the element that a geom of a scene represents.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Object {
            $($(#[$doc])* $name(Id<kind::$name>),)*
            /// A body. A sensor measures its body frame instead of the inertial frame.
            XBody(id::BodyId),
            /// A degree of freedom, by its index in `qvel`.
            Dof(usize),
            /// A flex, by its index.
            Flex(usize),
            /// An instance of a plugin, by its index.
            Plugin(usize),
        }

        impl Object {
            /// Converts a type and an index of the engine. Returns `None` for the type "unknown"
            /// and for the index -1.
            pub(crate) fn from_raw(object_type: i32, index: i32, lineage: Lineage) -> Option<Self> {
                let index = usize::try_from(index).ok()?;
                match u32::try_from(object_type).ok()? {
                    $(sys::$object => Some(Self::$name(Id::new(index, lineage))),)*
                    sys::mjOBJ_XBODY => Some(Self::XBody(Id::new(index, lineage))),
                    sys::mjOBJ_DOF => Some(Self::Dof(index)),
                    #[cfg(engine_since = "3.0.0")]
                    sys::mjOBJ_FLEX => Some(Self::Flex(index)),
                    #[cfg(engine_since = "2.3.0")]
                    sys::mjOBJ_PLUGIN => Some(Self::Plugin(index)),
                    _ => None,
                }
            }

            /// Returns the engine's index, counted from 0.
            pub fn index(self) -> usize {
                match self {
                    $(Self::$name(id) => id.index(),)*
                    Self::XBody(id) => id.index(),
                    Self::Dof(index) | Self::Flex(index) | Self::Plugin(index) => index,
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
    /// An explicit contact pair of geoms.
    Pair = mjOBJ_PAIR;
    /// A pair of bodies whose geoms do not collide.
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

/// Iterator over the objects of a tuple.
#[derive(Clone)]
pub struct Objects<'a> {
    types: &'a [i32],
    indices: &'a [i32],
    lineage: Lineage,
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
