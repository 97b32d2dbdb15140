//! Ids: which element, of which kind, of which model.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;

use mujoco_sys as sys;

/// The kinds of element that a model has names for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the engine's kinds, by their names")]
pub enum Kind {
    Body,
    Joint,
    Geom,
    Site,
    Camera,
    Light,
    Tendon,
    Actuator,
    Sensor,
    Keyframe,
}

impl Kind {
    /// The engine's `mjtObj`.
    pub(crate) fn object_type(self) -> i32 {
        (match self {
            Self::Body => sys::mjOBJ_BODY,
            Self::Joint => sys::mjOBJ_JOINT,
            Self::Geom => sys::mjOBJ_GEOM,
            Self::Site => sys::mjOBJ_SITE,
            Self::Camera => sys::mjOBJ_CAMERA,
            Self::Light => sys::mjOBJ_LIGHT,
            Self::Tendon => sys::mjOBJ_TENDON,
            Self::Actuator => sys::mjOBJ_ACTUATOR,
            Self::Sensor => sys::mjOBJ_SENSOR,
            Self::Keyframe => sys::mjOBJ_KEY,
        }) as i32
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Body => "body",
            Self::Joint => "joint",
            Self::Geom => "geom",
            Self::Site => "site",
            Self::Camera => "camera",
            Self::Light => "light",
            Self::Tendon => "tendon",
            Self::Actuator => "actuator",
            Self::Sensor => "sensor",
            Self::Keyframe => "keyframe",
        })
    }
}

/// A kind of element as a type, so that the id of a joint cannot be used for a body. Implemented by the types in [`kind`].
pub trait ElementKind: sealed::Sealed + 'static {
    /// The kind as a value.
    const KIND: Kind;
}

mod sealed {
    pub trait Sealed {}
}

/// One empty type for each kind of element.
pub mod kind {
    use super::{ElementKind, Kind, sealed::Sealed};

    macro_rules! kinds {
        ($($name:ident),*) => {$(
            #[doc = concat!("[`Kind::", stringify!($name), "`] as a type.")]
            #[derive(Debug)]
            pub enum $name {}
            impl Sealed for $name {}
            impl ElementKind for $name {
                const KIND: Kind = Kind::$name;
            }
        )*};
    }
    kinds!(Body, Joint, Geom, Site, Camera, Light, Tendon, Actuator, Sensor, Keyframe);
}

/// Which element, of which kind, of which model. Small and `Copy`: look a name up once and keep the id.
///
/// An id belongs to the model it came from, to its clones and to every [`Data`](crate::Data) made from them. Using it with a
/// model that was loaded separately panics, even where the index happens to exist there.
///
/// A joint's id is not the index of its first degree of freedom: see [`Joint::dofs`](crate::element::Joint::dofs).
pub struct Id<K> {
    index: u32,
    lineage: Lineage,
    kind: PhantomData<fn() -> K>,
}

/// The id of a body.
pub type BodyId = Id<kind::Body>;
/// The id of a joint.
pub type JointId = Id<kind::Joint>;
/// The id of a geom.
pub type GeomId = Id<kind::Geom>;
/// The id of a site.
pub type SiteId = Id<kind::Site>;
/// The id of a camera.
pub type CameraId = Id<kind::Camera>;
/// The id of a light.
pub type LightId = Id<kind::Light>;
/// The id of a tendon.
pub type TendonId = Id<kind::Tendon>;
/// The id of an actuator.
pub type ActuatorId = Id<kind::Actuator>;
/// The id of a sensor.
pub type SensorId = Id<kind::Sensor>;
/// The id of a keyframe.
pub type KeyframeId = Id<kind::Keyframe>;

impl<K> Id<K> {
    pub(crate) fn new(index: usize, lineage: Lineage) -> Self {
        Self { index: index as u32, lineage, kind: PhantomData }
    }

    /// The engine's index of the element, counted from 0.
    #[inline]
    pub fn index(self) -> usize {
        self.index as usize
    }

    #[inline]
    pub(crate) fn lineage(self) -> Lineage {
        self.lineage
    }
}

// By hand, because a derive would ask the same of `K`.
impl<K> Clone for Id<K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K> Copy for Id<K> {}

impl<K> PartialEq for Id<K> {
    fn eq(&self, other: &Self) -> bool {
        (self.index, self.lineage) == (other.index, other.lineage)
    }
}

impl<K> Eq for Id<K> {}

impl<K> Hash for Id<K> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.index, self.lineage).hash(state);
    }
}

impl<K: ElementKind> fmt::Debug for Id<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", K::KIND, self.index)
    }
}

/// Which loading a model comes from. A clone has the lineage of its original: nothing in this crate changes what elements a
/// model has or how they are laid out, so ids and data of one fit the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Lineage(u32);

impl Lineage {
    /// One that no model has yet.
    pub(crate) fn new() -> Self {
        use std::sync::atomic::{AtomicU32, Ordering};
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let next = NEXT.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |next| next.checked_add(1));
        Self(next.expect("a process may load four billion models"))
    }
}
