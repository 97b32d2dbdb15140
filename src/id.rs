//! Ids: which element, of which kind, of which model.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;
use std::ops::Range;

use mujoco_sys as sys;

/// A kind of element as a type, so that the id of a joint cannot be used for a body. Implemented by the types in [`kind`].
pub trait ElementKind: sealed::Sealed + 'static {
    /// The kind as a value.
    const KIND: Kind;
}

mod sealed {
    pub trait Sealed {}
}

/// The kinds, a line each: the variant of [`Kind`] and the type in [`kind`], what a person calls it, the engine's `mjtObj`, and
/// the type of its ids.
macro_rules! kinds {
    ($($name:ident, $text:literal, $object:ident, $id:ident;)*) => {
        /// The kinds of element that a model has names for.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        #[allow(missing_docs, reason = "the engine's kinds, by their names")]
        pub enum Kind {
            $($name,)*
        }

        impl Kind {
            /// Every kind, in the engine's order.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// The engine's `mjtObj`.
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

        /// One empty type for each kind of element.
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
            #[doc = concat!("The id of one ", $text, ".")]
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

/// The ids of consecutive elements, such as the joints of a body. An iterator over them.
pub struct Ids<K> {
    range: Range<usize>,
    lineage: Lineage,
    kind: PhantomData<fn() -> K>,
}

impl<K> Ids<K> {
    pub(crate) fn new(range: Range<usize>, lineage: Lineage) -> Self {
        Self { range, lineage, kind: PhantomData }
    }

    /// The engine's indices of the elements that are still to come.
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
