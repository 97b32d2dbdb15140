//! Named access to the elements of a model by name, index or id.
//!
//! `model.joint("left_knee")?` looks a name up once and returns a [`Joint`]: an id and a borrow of
//! the model. The view and its [`id`](View::id) are keys too, and lookups with them are infallible:
//! `data.joint(knee)` is the same joint in a simulation. Reading a field through it costs little
//! more than indexing a slice (`cargo bench --bench view`).
//!
//! ```
//! use std::sync::Arc;
//! use mujoco_safe::{Data, sample};
//!
//! let model = Arc::new(sample::humanoid());
//! let mut data = Data::new(model.clone())?;
//!
//! let knee = model.joint("left_knee")?;              // a name may be unknown: Result
//! println!("{} of {:?}", knee.range()[1], knee.name());
//! data.joint_mut(knee).qvel_mut()[0] = 1.0;          // it exists in this model: no Result
//! assert_eq!(data.joint(knee).qvel(), &data.qvel()[knee.dofs()]);
//!
//! let is_left = |name: &str| name.contains("left");
//! let left = model.joints().filter(|joint| joint.name().is_some_and(is_left));
//! assert_eq!(left.count(), 9);
//!
//! let error = data.joint("left_kne").unwrap_err();   // lists the known names
//! assert!(error.to_string().contains("left_knee"));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Each kind has up to four views, which are aliases of two types: [`View`] and [`ViewMut`], on a
//! [`Model`] or on a [`Data`]. A key of another model panics:
//!
//! ```should_panic
//! use mujoco_safe::{Data, sample};
//!
//! let cartpole = sample::cartpole();
//! let data = Data::new(sample::humanoid()).unwrap();
//! data.joint(cartpole.joint("hinge").unwrap());
//! ```
//!
//! Formatting a view with `{}` lists its fields.
//!
//! # Computed fields
//!
//! Fields that [`Data::forward`] and [`Data::step`] compute, such as [`xpos`](BodyData::xpos), are
//! unchecked references into the engine's arrays. If the order of calls is not obvious, call
//! [`Data::require`] once. Fields that programs often read too early return
//! [`Error::NotComputed`](crate::Error::NotComputed): the [`data`](SensorData::data) of a sensor,
//! and the fields of a body that a step does not compute, such as [`cfrc_ext`](BodyData::cfrc_ext).
//!
//! # Kinds
//!
//! Each kind has a lookup method and an iterator on [`Model`]. The kinds in the first table also
//! have both on [`Data`], for their time-dependent fields. The page of each view lists its fields;
//! the views for writing end in `Mut`, such as [`JointMut`] and [`JointDataMut`]. The search of
//! this documentation also finds the kinds by the engine's abbreviations.
//!
//! | lookup | iterator | fields in a model | in a simulation | id | engine's abbreviation |
//! |---|---|---|---|---|---|
//! | [`body`](Model::body) | [`bodies`](Model::bodies) | [`Body`] | [`BodyData`] | [`BodyId`](crate::id::BodyId) | body, xbody |
//! | [`joint`](Model::joint) | [`joints`](Model::joints) | [`Joint`] | [`JointData`] | [`JointId`](crate::id::JointId) | jnt; dof for its degrees of freedom |
//! | [`geom`](Model::geom) | [`geoms`](Model::geoms) | [`Geom`] | [`GeomData`] | [`GeomId`](crate::id::GeomId) | geom |
//! | [`site`](Model::site) | [`sites`](Model::sites) | [`Site`] | [`SiteData`] | [`SiteId`](crate::id::SiteId) | site |
//! | [`camera`](Model::camera) | [`cameras`](Model::cameras) | [`Camera`] | [`CameraData`] | [`CameraId`](crate::id::CameraId) | cam |
//! | [`light`](Model::light) | [`lights`](Model::lights) | [`Light`] | [`LightData`] | [`LightId`](crate::id::LightId) | light |
//! | [`tendon`](Model::tendon) | [`tendons`](Model::tendons) | [`Tendon`] | [`TendonData`] | [`TendonId`](crate::id::TendonId) | ten |
//! | [`actuator`](Model::actuator) | [`actuators`](Model::actuators) | [`Actuator`] | [`ActuatorData`] | [`ActuatorId`](crate::id::ActuatorId) | actuator |
//! | [`equality`](Model::equality) | [`equalities`](Model::equalities) | [`Equality`] | [`EqualityData`] | [`EqualityId`](crate::id::EqualityId) | eq |
//! | [`flex`](Model::flex) | [`flexes`](Model::flexes) | [`Flex`] | [`FlexData`] | [`FlexId`](crate::id::FlexId) | flex |
//! | [`plugin_instance`](Model::plugin_instance) | [`plugin_instances`](Model::plugin_instances) | [`Plugin`] | [`PluginData`] | [`PluginId`](crate::id::PluginId) | plugin |
//! | [`sensor`](Model::sensor) | [`sensors`](Model::sensors) | [`Sensor`] | [`SensorData`] | [`SensorId`](crate::id::SensorId) | sensor |
//!
//! Kinds without time-dependent fields:
//!
//! | lookup | iterator | fields | id | engine's abbreviation |
//! |---|---|---|---|---|
//! | [`mesh`](Model::mesh) | [`meshes`](Model::meshes) | [`Mesh`] | [`MeshId`](crate::id::MeshId) | mesh |
//! | [`skin`](Model::skin) | [`skins`](Model::skins) | [`Skin`] | [`SkinId`](crate::id::SkinId) | skin |
//! | [`height_field`](Model::height_field) | [`height_fields`](Model::height_fields) | [`HeightField`] | [`HeightFieldId`](crate::id::HeightFieldId) | hfield |
//! | [`texture`](Model::texture) | [`textures`](Model::textures) | [`Texture`] | [`TextureId`](crate::id::TextureId) | tex |
//! | [`material`](Model::material) | [`materials`](Model::materials) | [`Material`] | [`MaterialId`](crate::id::MaterialId) | mat |
//! | [`pair`](Model::pair) | [`pairs`](Model::pairs) | [`Pair`] | [`PairId`](crate::id::PairId) | pair |
//! | [`exclude`](Model::exclude) | [`excludes`](Model::excludes) | [`Exclude`] | [`ExcludeId`](crate::id::ExcludeId) | exclude |
//! | [`numeric`](Model::numeric) | [`numerics`](Model::numerics) | [`Numeric`] | [`NumericId`](crate::id::NumericId) | numeric |
//! | [`text`](Model::text) | [`texts`](Model::texts) | [`Text`] | [`TextId`](crate::id::TextId) | text |
//! | [`tuple`](Model::tuple) | [`tuples`](Model::tuples) | [`Tuple`] | [`TupleId`](crate::id::TupleId) | tuple |
//! | [`keyframe`](Model::keyframe) | [`keyframes`](Model::keyframes) | [`Keyframe`] | [`KeyframeId`](crate::id::KeyframeId) | key |
//!
//! # Fields of newer engines
//!
//! These pages have the fields of MuJoCo 2.2.2. With a newer engine, each view has a method for
//! each further array with a value or a row for each element, or for each part of an element, such
//! as a degree of freedom of a joint or a vertex of a flex. The methods are generated from the
//! engine's table of fields when the crate is compiled. Their names are those of the arrays without
//! the abbreviation of the kind: `camera.resolution()` is a row of `cam_resolution`, and
//! `joint.qfrc_damper()` of a simulation a part of `qfrc_damper`. A name that is a word of Rust, or
//! that a view has already, stays complete: `light.light_type()`. They
//! only read. `cargo doc` with `MUJOCO_DIR` set
//! lists the methods, and formatting a view with `{}` their values.
//!
//! # Writing to a model
//!
//! The views of a [`ModelMut`] give write access to floating-point numbers, flags (`set_limited`,
//! `set_active`) and bit masks (`set_contype`). Fields that determine the engine's memory accesses
//! (types, ids, addresses, sizes) are read-only.
//!
//! ```
//! use mujoco_safe::{Error, sample};
//!
//! let mut model = sample::humanoid();
//! let mut edit = model.edit();
//! edit.joint_mut("left_knee")?.set_limited(false);
//! edit.geom_mut("floor")?.set_condim(6)?;
//! let error = edit.geom_mut("floor")?.set_condim(2).unwrap_err();
//! assert!(matches!(error, Error::Invalid { .. }));
//! # Ok::<(), Error>(())
//! ```

#[macro_use]
mod fields;

// The pages of the views have the methods in the order of the modules.
mod common;

mod kinematics;

mod actuator;
mod asset;
mod attachment;
mod constraint;
mod custom;
mod deformable;
mod display;
mod mesh;
mod newer;
#[cfg(any(feature = "viewer", feature = "html"))]
pub(crate) mod quantity;
mod sensor;
mod tendon;
mod tendon_path;

use std::fmt;

pub use self::asset::{Bone, Bones};
pub use self::constraint::EqualityObjects;
pub use self::custom::Objects;
pub use self::tendon::JacobianRow;
pub use self::tendon_path::{WrapPoint, WrapPoints, Wraps};
use crate::data::Data;
use crate::error::Result;
use crate::ffi;
use crate::id::sealed::Sealed;
use crate::id::{Id, IntoId, Lookup};
use crate::kind::{self, ElementKind};
use crate::macros::with_aliases;
use crate::model::{Model, ModelMut};

with_aliases! {
    pub use self::actuator::{Transmission = "mjtTrn"};
    pub use self::custom::{Object = "mjtObj" "objtype" "objid"};
    pub use self::tendon_path::{Wrap = "mjtWrap"};
}

/// View of one element of a model or a simulation: an id and a borrow. Cheap to copy; the fields of
/// each kind are methods.
///
/// This page has the methods of all kinds. The page of an alias, such as [`JointData`], has the
/// methods of one kind.
pub struct View<'a, Owner, K> {
    owner: &'a Owner,
    id: Id<K>,
}

/// Mutable view of one element.
///
/// This page has the methods of all kinds. The page of an alias, such as [`JointDataMut`], has the
/// methods of one kind.
pub struct ViewMut<'a, Owner, K> {
    owner: &'a mut Owner,
    id: Id<K>,
}

impl<Owner, K> Clone for View<'_, Owner, K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Owner, K> Copy for View<'_, Owner, K> {}

/// Owner of elements: a model or a simulation.
pub(crate) trait Owner {
    fn model_of(&self) -> &Model;
}

impl Owner for Model {
    #[inline]
    fn model_of(&self) -> &Model {
        self
    }
}

impl Owner for ModelMut<'_> {
    #[inline]
    fn model_of(&self) -> &Model {
        self
    }
}

impl Owner for Data {
    #[inline]
    fn model_of(&self) -> &Model {
        self.model()
    }
}

impl<O: Owner, K: ElementKind> fmt::Debug for View<'_, O, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => write!(f, "{:?} '{name}'", self.id),
            None => self.id.fmt(f),
        }
    }
}

impl<O: Owner, K: ElementKind> fmt::Debug for ViewMut<'_, O, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.view().fmt(f)
    }
}

impl<O, K> From<View<'_, O, K>> for Id<K> {
    fn from(view: View<'_, O, K>) -> Self {
        view.id
    }
}

impl<O, K> Sealed for View<'_, O, K> {}

impl<O, K: ElementKind> IntoId<K> for View<'_, O, K> {
    type Found<T> = T;

    #[inline]
    #[track_caller]
    fn id_in(self, model: &impl Lookup) -> Result<Id<K>> {
        self.id.id_in(model)
    }

    #[inline]
    fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> T {
        Id::found(id, make)
    }
}

/// Declares the types and lookup methods of the kinds: `Kind` and `KindMut`, and with
/// time-dependent fields `KindData` and `KindDataMut`.
macro_rules! kinds {
    ($(
        $one:ident, $one_mut:ident, $many:ident, $short:literal => $kind:ident, $model_mut:ident
        $(, $data:ident, $data_mut:ident)?;
    )*) => {
        $(
            #[doc = concat!("View of one ", stringify!($one), " in a model.")]
            pub type $kind<'m> = View<'m, Model, kind::$kind>;
            #[doc = concat!("Mutable view of one ", stringify!($one), " in a model.")]
            pub type $model_mut<'m, 'e> = ViewMut<'e, ModelMut<'m>, kind::$kind>;
            $(
                #[doc = concat!("View of one ", stringify!($one), " in a simulation.")]
                pub type $data<'d> = View<'d, Data, kind::$kind>;
                #[doc = concat!("Mutable view of one ", stringify!($one), " in a simulation.")]
                pub type $data_mut<'d> = ViewMut<'d, Data, kind::$kind>;
            )?
        )*

        /// # Elements
        ///
        /// A key is a name, an index, an id or a view: see [`element`](crate::element).
        impl Model {$(
            #[doc = concat!("Returns the ", stringify!($one), " for a key.")]
            #[doc(alias = $short)]
            #[inline]
            pub fn $one<Q: IntoId<kind::$kind>>(&self, key: Q) -> Q::Found<$kind<'_>> {
                key.find(self, |id| View::new(self, id))
            }

            #[doc = concat!("Returns an iterator over all elements of kind ", stringify!($one), ", in the engine's order.")]
            pub fn $many(&self) -> impl ExactSizeIterator<Item = $kind<'_>> + DoubleEndedIterator {
                let lineage = self.lineage();
                (0..self.count(<kind::$kind as ElementKind>::KIND)).map(move |index| View::new(self, Id::new(index, lineage)))
            }
        )*}

        /// # Elements
        ///
        /// A key is a name, an index, an id or a view: see [`element`](crate::element).
        impl<'m> ModelMut<'m> {$(
            #[doc = concat!("Returns a mutable view of the ", stringify!($one), " for a key.")]
            #[inline]
            pub fn $one_mut<'e, Q: IntoId<kind::$kind>>(&'e mut self, key: Q) -> Q::Found<$model_mut<'m, 'e>> {
                let id = key.id_in(&**self);
                Q::found(id, |id| ViewMut::new(self, id))
            }
        )*}

        /// # Elements
        ///
        /// A key is a name, an index, an id or a view: see [`element`](crate::element).
        impl Data {$($(
            #[doc = concat!("Returns the ", stringify!($one), " for a key.")]
            #[doc(alias = $short)]
            #[inline]
            pub fn $one<Q: IntoId<kind::$kind>>(&self, key: Q) -> Q::Found<$data<'_>> {
                key.find(self.model().as_ref(), |id| View::new(self, id))
            }

            #[doc = concat!("Returns a mutable view of the ", stringify!($one), " for a key.")]
            #[inline]
            pub fn $one_mut<Q: IntoId<kind::$kind>>(&mut self, key: Q) -> Q::Found<$data_mut<'_>> {
                let id = key.id_in(self.model().as_ref());
                Q::found(id, |id| ViewMut::new(self, id))
            }

            #[doc = concat!("Returns an iterator over all elements of kind ", stringify!($one), ", in the engine's order.")]
            pub fn $many(&self) -> impl ExactSizeIterator<Item = $data<'_>> + DoubleEndedIterator {
                let model = self.model();
                (0..model.count(<kind::$kind as ElementKind>::KIND)).map(move |index| View::new(self, Id::new(index, model.lineage())))
            }
        )?)*}
    };
}

kinds! {
    body, body_mut, bodies, "xbody" => Body, BodyMut, BodyData, BodyDataMut;
    joint, joint_mut, joints, "jnt" => Joint, JointMut, JointData, JointDataMut;
    geom, geom_mut, geoms, "mjOBJ_GEOM" => Geom, GeomMut, GeomData, GeomDataMut;
    site, site_mut, sites, "mjOBJ_SITE" => Site, SiteMut, SiteData, SiteDataMut;
    camera, camera_mut, cameras, "cam" => Camera, CameraMut, CameraData, CameraDataMut;
    light, light_mut, lights, "mjOBJ_LIGHT" => Light, LightMut, LightData, LightDataMut;
    tendon, tendon_mut, tendons, "ten" => Tendon, TendonMut, TendonData, TendonDataMut;
    actuator, actuator_mut, actuators, "mjOBJ_ACTUATOR" => Actuator, ActuatorMut, ActuatorData, ActuatorDataMut;
    sensor, sensor_mut, sensors, "sensordata" => Sensor, SensorMut, SensorData, SensorDataMut;
    keyframe, keyframe_mut, keyframes, "key" => Keyframe, KeyframeMut;
    mesh, mesh_mut, meshes, "mjOBJ_MESH" => Mesh, MeshMut;
    skin, skin_mut, skins, "mjOBJ_SKIN" => Skin, SkinMut;
    height_field, height_field_mut, height_fields, "hfield" => HeightField, HeightFieldMut;
    texture, texture_mut, textures, "tex" => Texture, TextureMut;
    material, material_mut, materials, "mat" => Material, MaterialMut;
    pair, pair_mut, pairs, "mjOBJ_PAIR" => Pair, PairMut;
    exclude, exclude_mut, excludes, "mjOBJ_EXCLUDE" => Exclude, ExcludeMut;
    equality, equality_mut, equalities, "eq" => Equality, EqualityMut, EqualityData, EqualityDataMut;
    numeric, numeric_mut, numerics, "mjOBJ_NUMERIC" => Numeric, NumericMut;
    text, text_mut, texts, "mjOBJ_TEXT" => Text, TextMut;
    tuple, tuple_mut, tuples, "mjOBJ_TUPLE" => Tuple, TupleMut;
    flex, flex_mut, flexes, "mjOBJ_FLEX" => Flex, FlexMut, FlexData, FlexDataMut;
    plugin_instance, plugin_instance_mut, plugin_instances, "mjOBJ_PLUGIN" => Plugin, PluginMut, PluginData, PluginDataMut;
}

/// Returns the range that starts at an element's address. Empty for an element without entries,
/// whose address is -1.
#[inline]
fn range(addresses: &[i32], counts: &[i32], index: usize) -> std::ops::Range<usize> {
    let start = usize::try_from(addresses[index]).unwrap_or(0);
    start..start + ffi::size(counts[index])
}

/// Returns the range from an element's address to that of the next element. Empty for an element
/// without entries, whose address is -1.
#[cfg(engine_since = "2.3.0")]
fn to_next(addresses: &[i32], index: usize, end: usize) -> std::ops::Range<usize> {
    let Ok(start) = usize::try_from(addresses[index]) else { return 0..0 };
    let next = addresses[index + 1..].iter().find_map(|&address| usize::try_from(address).ok());
    start..next.unwrap_or(end)
}

/// Returns the range of the entries of parts that follow each other.
#[cfg(engine_since = "3.3.0")]
fn of_parts(mut parts: std::ops::Range<usize>, addresses: &[i32], counts: &[i32]) -> std::ops::Range<usize> {
    match (parts.next(), parts.next_back()) {
        (Some(first), last) => {
            let last = last.unwrap_or(first);
            ffi::size(addresses[first])..ffi::size(addresses[last]) + ffi::size(counts[last])
        }
        _ => 0..0,
    }
}
