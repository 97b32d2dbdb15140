//! Typed ids of elements, and the trait of all arguments that select an element.

mod into_id;

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;
use std::ops::Range;

pub use self::into_id::IntoId;
pub(crate) use self::into_id::Lookup;
use crate::kind::for_each_kind;
pub(crate) use crate::kind::sealed;
use crate::kind::{self, ElementKind};

/// Declares the id types.
macro_rules! declare_ids {
    ($($name:ident, $text:literal, $object:ident, $id:ident;)*) => {
        $(
            #[doc = concat!("Id of a ", $text, ".")]
            pub type $id = Id<kind::$name>;
        )*
    };
}
for_each_kind!(declare_ids);

/// Id of one element of one model, typed by the kind of element. Small and `Copy`: look a name up
/// once and keep the id.
///
/// An id is valid for its model, for the clones of that model and for every [`Data`](crate::Data)
/// created from them. Its use with a separately loaded model panics, even if the index exists
/// there.
///
/// A joint's id is not the index of its first degree of freedom: see `Joint::dofs`.
///
/// Functions that have a model or a simulation take an [`IntoId`]: a name, an index, an id or a
/// view. Functions without a model, such as
/// [`PdController::set_target`](crate::PdController::set_target) and
/// [`NewGeom::mesh`](crate::scene::NewGeom::mesh), take an id or a view, and public fields hold
/// ids.
///
/// ```
/// use mujoco_safe::sample;
///
/// let model = sample::cartpole();
/// let [slider, hinge] = [model.joint("slider")?.id(), model.joint("hinge")?.id()];
/// assert_eq!(hinge.to_string(), "joint 1");
/// assert!(slider < hinge);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
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

impl<K> PartialOrd for Id<K> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K> Ord for Id<K> {
    /// Compares the models, then the indices: the ids of a model come before the ids of a model
    /// that was loaded later. A clone of a model has the ids of its original.
    fn cmp(&self, other: &Self) -> Ordering {
        (self.lineage, self.index).cmp(&(other.lineage, other.index))
    }
}

impl<K: ElementKind> fmt::Display for Id<K> {
    /// Writes the kind and the index: `joint 3`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", K::KIND, self.index)
    }
}

impl<K: ElementKind> fmt::Debug for Id<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
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

/// Origin of a model: one load or compilation. A clone has the lineage of its original. No function
/// of this crate changes the set of elements of a model or their layout, so ids and data of one are
/// valid for the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Lineage(u32);

impl Lineage {
    /// Returns a new unique lineage.
    pub(crate) fn new() -> Self {
        use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let next = NEXT.fetch_update(Relaxed, Relaxed, |next| next.checked_add(1));
        Self(next.expect("a process may load four billion models"))
    }
}
