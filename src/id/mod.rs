//! Typed ids of elements, and the keys by which elements are looked up.

mod key;

use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;
use std::ops::Range;

use mujoco_sys as sys;

pub use self::key::{Key, Lookup};

/// Kind of element as a type, which prevents the use of a joint's id for a body. Implemented by the types in [`kind`].
pub trait ElementKind: sealed::Sealed + 'static {
    /// The kind as a value.
    const KIND: Kind;
}

/// Restricts the implementation of the traits of this module to this crate.
pub(crate) mod sealed {
    pub trait Sealed {}
}

/// Declares the kinds, one per line: the variant of [`Kind`] and the type in [`kind`], the name in messages, the engine's `mjtObj`,
/// and the type of the ids.
macro_rules! kinds {
    ($($name:ident, $text:literal, $object:ident, $id:ident;)*) => {
        /// Kind of a named element.
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

        /// The kinds as types: one empty enum per kind.
        pub mod kind {
            use super::{ElementKind, Kind, sealed::Sealed};

            $(
                #[doc = concat!("[`Kind::", stringify!($name), "`] as a type.")]
                #[derive(Debug)]
                pub enum $name {}
                impl Sealed for $name {}
                impl ElementKind for $name {
                    const KIND: Kind = Kind::$name;
                }
            )*
        }

        $(
            #[doc = concat!("Id of a ", $text, ".")]
            pub type $id = Id<kind::$name>;
        )*
    };
}

kinds! {
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
}

/// Id of one element of one model, typed by the kind of element. Small and `Copy`: look a name up once and keep the id.
///
/// An id is valid for its model, for the clones of that model and for every [`Data`](crate::Data) created from them. Its use with
/// a separately loaded model panics, even if the index exists there.
///
/// A joint's id is not the index of its first degree of freedom: see `Joint::dofs`.
pub struct Id<K> {
    index: u32,
    lineage: Lineage,
    kind: PhantomData<fn() -> K>,
}

impl<K> Id<K> {
    pub(crate) fn new(index: usize, lineage: Lineage) -> Self {
        Self { index: index as u32, lineage, kind: PhantomData }
    }

    /// Returns the engine's index of the element, counted from 0.
    #[inline]
    pub fn index(self) -> usize {
        self.index as usize
    }

    #[inline]
    pub(crate) fn lineage(self) -> Lineage {
        self.lineage
    }
}

// Not derived, because a derive would require the same traits of `K`.
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

/// Iterator over the ids of consecutive elements, such as the joints of a body.
pub struct Ids<K> {
    range: Range<usize>,
    lineage: Lineage,
    kind: PhantomData<fn() -> K>,
}

impl<K> Ids<K> {
    pub(crate) fn new(range: Range<usize>, lineage: Lineage) -> Self {
        Self { range, lineage, kind: PhantomData }
    }

    /// Returns the engine's indices of the remaining elements.
    #[inline]
    pub fn indices(&self) -> Range<usize> {
        self.range.clone()
    }
}

impl<K> Iterator for Ids<K> {
    type Item = Id<K>;

    #[inline]
    fn next(&mut self) -> Option<Id<K>> {
        self.range.next().map(|index| Id::new(index, self.lineage))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.range.size_hint()
    }
}

impl<K> DoubleEndedIterator for Ids<K> {
    fn next_back(&mut self) -> Option<Id<K>> {
        self.range.next_back().map(|index| Id::new(index, self.lineage))
    }
}

impl<K> ExactSizeIterator for Ids<K> {}

impl<K> Clone for Ids<K> {
    fn clone(&self) -> Self {
        Self::new(self.indices(), self.lineage)
    }
}

impl<K: ElementKind> fmt::Debug for Ids<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.clone()).finish()
    }
}

/// Origin of a model: one load or compilation. A clone has the lineage of its original. No function of this crate changes the set
/// of elements of a model or their layout, so ids and data of one are valid for the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Lineage(u32);

impl Lineage {
    /// Returns a new unique lineage.
    pub(crate) fn new() -> Self {
        use std::sync::atomic::{AtomicU32, Ordering};
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let next = NEXT.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |next| next.checked_add(1));
        Self(next.expect("a process may load four billion models"))
    }
}
