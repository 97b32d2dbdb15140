//! Ids of elements, and the names and ids by which elements are looked up.

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;

use super::Spec;
use super::attributes::Named;
use super::names;
use super::tree::{Index, Tree};
use crate::error::{Error, Result};
use crate::id::Lineage;
use crate::kind::sealed::Sealed;
use crate::kind::{ElementKind, Kind};

/// Any element, also one without a name in the compiled model, such as `option` or `freejoint`. A
/// type for [`ElementId`].
#[derive(Debug)]
pub enum Any {}

impl Sealed for Any {}

/// Kind of the elements of a spec: a type of the module [`kind`](crate::kind), or [`Any`].
pub trait SpecKind: Sealed + 'static {
    /// The kind as a value, or `None` for any.
    #[doc(hidden)]
    const KIND: Option<Kind>;
}

impl SpecKind for Any {
    const KIND: Option<Kind> = None;
}

impl<K: ElementKind> SpecKind for K {
    const KIND: Option<Kind> = Some(K::KIND);
}

/// Id of an element of a [`Spec`], and of its copy in each clone that was made later. It stays
/// valid when other elements are added or removed. For the clone, the id of an element that was
/// added to the original after the clone was made belongs to another spec, and vice versa.
///
/// It is not the id of the element in the compiled model: look that one up by its name.
///
/// ```
/// use mujoco_safe::spec::Spec;
///
/// let mut spec = Spec::new("robot");
/// let (first, second) = (spec.add_body(spec.world()).id(), spec.add_body(spec.world()).id());
/// assert!(first < second && first.to_string().starts_with("body "));
/// ```
pub struct ElementId<K = Any> {
    index: Index,
    lineage: Lineage,
    kind: PhantomData<fn() -> K>,
}

impl<K> ElementId<K> {
    pub(super) fn new(index: Index, lineage: Lineage) -> Self {
        Self { index, lineage, kind: PhantomData }
    }

    pub(super) fn index(self) -> Index {
        self.index
    }

    pub(super) fn lineage(self) -> Lineage {
        self.lineage
    }

    /// Returns the same id without the kind.
    pub fn any(self) -> ElementId<Any> {
        ElementId::new(self.index, self.lineage)
    }
}

// Not derived, because a derive would require the same traits of `K`.
impl<K> Clone for ElementId<K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K> Copy for ElementId<K> {}

impl<K> PartialEq for ElementId<K> {
    fn eq(&self, other: &Self) -> bool {
        (self.index, self.lineage) == (other.index, other.lineage)
    }
}

impl<K> Eq for ElementId<K> {}

impl<K> Hash for ElementId<K> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.index, self.lineage).hash(state);
    }
}

impl<K> PartialOrd for ElementId<K> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K> Ord for ElementId<K> {
    /// Compares the specs, then the order in which the elements were added.
    fn cmp(&self, other: &Self) -> Ordering {
        (self.lineage, self.index).cmp(&(other.lineage, other.index))
    }
}

impl<K: SpecKind> fmt::Debug for ElementId<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl<K: SpecKind> fmt::Display for ElementId<K> {
    /// Writes the kind and the number of the element: `joint 3`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match K::KIND {
            Some(kind) => write!(f, "{kind} {}", self.index),
            None => write!(f, "element {}", self.index),
        }
    }
}

/// Selects an element of a spec: a name or an id. A name may not exist, so its lookup returns a
/// [`Result`].
///
/// # Panics
///
/// An id of another spec, or of a removed element, panics.
pub trait IntoElementId<K: ElementKind>: Sealed {
    /// `Result<T>` for a name, `T` for an id.
    type Found<T>;

    /// Looks the element up and converts its index.
    #[doc(hidden)]
    #[track_caller]
    fn find(self, spec: &Spec) -> Self::Found<Index>;

    /// Converts the result of a lookup.
    #[doc(hidden)]
    fn map<T>(found: Self::Found<Index>, make: impl FnOnce(Index) -> T) -> Self::Found<T>;
}

impl<K: ElementKind> IntoElementId<K> for &str {
    type Found<T> = Result<T>;

    fn find(self, spec: &Spec) -> Result<Index> {
        let class = Named::Kind(K::KIND);
        names::find(&spec.tree, class, self).ok_or_else(|| {
            let known = names::all(&spec.tree, class);
            let known = known.filter_map(|index| names::name(&spec.tree, index).map(str::to_owned)).collect();
            let has = |kind: &Kind| names::find(&spec.tree, Named::Kind(*kind), self).is_some();
            let others = Kind::ALL.iter().copied().filter(has).collect();
            Error::NoSuchName { kind: K::KIND, name: self.to_owned(), known, others }
        })
    }

    fn map<T>(found: Result<Index>, make: impl FnOnce(Index) -> T) -> Result<T> {
        found.map(make)
    }
}

impl<K> Sealed for ElementId<K> {}

impl<K: ElementKind> IntoElementId<K> for ElementId<K> {
    type Found<T> = T;

    #[track_caller]
    fn find(self, spec: &Spec) -> Index {
        spec.index(self)
    }

    fn map<T>(found: Index, make: impl FnOnce(Index) -> T) -> T {
        make(found)
    }
}

/// Reference of an attribute to an element of kind `K`: its name or its id. The name does not need
/// to exist yet; the compiler checks it.
///
/// An element without a name that is referred to by its id gets one, such as `joint_2`.
///
/// # Panics
///
/// An id of another spec, or of a removed element, panics.
pub trait Reference<K: ElementKind>: Sealed {
    /// Returns the name of the element.
    #[doc(hidden)]
    #[track_caller]
    fn name(self, spec: &mut Spec) -> String;
}

impl<K: ElementKind> Reference<K> for &str {
    fn name(self, _: &mut Spec) -> String {
        self.to_owned()
    }
}

impl<K: ElementKind> Reference<K> for ElementId<K> {
    #[track_caller]
    fn name(self, spec: &mut Spec) -> String {
        let index = spec.index(self);
        name_or_create(&mut spec.tree, index, Named::Kind(K::KIND))
    }
}

/// Returns the name of an element, which gets one if it has none.
pub(super) fn name_or_create(tree: &mut Tree, index: Index, class: Named) -> String {
    if let Some(name) = names::name(tree, index) {
        return name.to_owned();
    }
    let base = class.to_string().replace(' ', "_");
    let mut number = index;
    let mut name = format!("{base}_{number}");
    while names::find(tree, class, &name).is_some() {
        number = number.wrapping_add(1);
        name = format!("{base}_{number}");
    }
    tree.node_mut(index).set("name", name.clone());
    name
}
