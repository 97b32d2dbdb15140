//! The names, indices, ids and views by which elements are looked up.

use super::sealed::Sealed;
use super::{ElementKind, Id};
use crate::error::Result;

/// Selects an element of kind `K`: a name, an index, an id or a view. A name or an index may not
/// exist, so lookups by them return a [`Result`]. Lookups by an id or a view of the same model are
/// infallible. [`Model::id`](crate::Model::id) returns the id in a generic function.
///
/// # Panics
///
/// An id or a view of another model panics, because only a mistake in the program can combine the
/// two.
pub trait IntoId<K: ElementKind>: Sealed + Sized {
    /// `Result<T>` for a name or an index, `T` for an id or a view.
    type Found<T>;

    /// Returns the id of the element in a model.
    #[doc(hidden)]
    fn id_in(self, model: &impl Lookup) -> Result<Id<K>>;

    /// Converts the result of [`id_in`](Self::id_in) into a view or a reference.
    #[doc(hidden)]
    fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> Self::Found<T>;

    /// Looks the element up and converts its id.
    #[doc(hidden)]
    #[inline]
    fn find<T>(self, model: &impl Lookup, make: impl FnOnce(Id<K>) -> T) -> Self::Found<T> {
        Self::found(self.id_in(model), make)
    }
}

/// Lookup of element ids, implemented by the model.
pub trait Lookup: Sealed {
    /// Returns the id of the element with a name.
    fn id_of_name<K: ElementKind>(&self, name: &str) -> Result<Id<K>>;

    /// Returns the id of the element at an index.
    fn id_of_index<K: ElementKind>(&self, index: usize) -> Result<Id<K>>;

    /// Panics if the id belongs to another model.
    #[track_caller]
    fn check_id<K: ElementKind>(&self, id: Id<K>);
}

/// Implements [`IntoId`] for a type whose lookup can fail.
macro_rules! fallible {
    ($key:ty, $lookup:ident) => {
        impl Sealed for $key {}

        impl<K: ElementKind> IntoId<K> for $key {
            type Found<T> = Result<T>;

            fn id_in(self, model: &impl Lookup) -> Result<Id<K>> {
                model.$lookup(self)
            }

            fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> Result<T> {
                id.map(make)
            }
        }
    };
}

fallible!(&str, id_of_name);
fallible!(&String, id_of_name);
fallible!(usize, id_of_index);

impl<K> Sealed for Id<K> {}

impl<K: ElementKind> IntoId<K> for Id<K> {
    type Found<T> = T;

    #[inline]
    #[track_caller]
    fn id_in(self, model: &impl Lookup) -> Result<Id<K>> {
        model.check_id(self);
        Ok(self)
    }

    #[inline]
    fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> T {
        match id {
            Ok(id) => make(id),
            Err(error) => unreachable!("Bug: the lookup of an id failed: {error}"),
        }
    }
}
