//! What an element can be looked up by.

use super::View;
use crate::error::Result;
use crate::id::{ElementKind, Id};
use crate::model::Model;

/// What an element of kind `K` can be looked up by. A name or an index may not exist, so what is found by them comes in a
/// [`Result`]; an id or a [`View`] of the same model always does, so what is found by them comes as it is.
///
/// # Panics
///
/// An id or a view of another model panics: only a mistake in the program can bring the two together.
pub trait Key<K: ElementKind>: sealed::Sealed + Sized {
    /// `Result<T>` for a name or an index, `T` for an id or a view.
    type Found<T>;

    /// The id of the element.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or [`Error::NoSuchIndex`](crate::Error::NoSuchIndex).
    fn id(self, model: &Model) -> Result<Id<K>>;

    /// What is made of the id that was found.
    #[doc(hidden)]
    fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> Self::Found<T>;

    /// Both in one.
    #[doc(hidden)]
    #[inline]
    fn find<T>(self, model: &Model, make: impl FnOnce(Id<K>) -> T) -> Self::Found<T> {
        Self::found(self.id(model), make)
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for &str {}
    impl Sealed for &String {}
    impl Sealed for usize {}
    impl<K> Sealed for super::Id<K> {}
    impl<O, K> Sealed for super::View<'_, O, K> {}
}

/// A key that may not exist.
macro_rules! fallible {
    ($key:ty, |$value:ident, $model:ident| $id:expr) => {
        impl<K: ElementKind> Key<K> for $key {
            type Found<T> = Result<T>;

            fn id(self, $model: &Model) -> Result<Id<K>> {
                let $value = self;
                $id
            }

            fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> Result<T> {
                id.map(make)
            }
        }
    };
}

fallible!(&str, |name, model| model.id(name));
fallible!(&String, |name, model| model.id(name));
fallible!(usize, |index, model| model.id_at(index));

impl<K: ElementKind> Key<K> for Id<K> {
    type Found<T> = T;

    #[inline]
    #[track_caller]
    fn id(self, model: &Model) -> Result<Id<K>> {
        model.check_id(self);
        Ok(self)
    }

    #[inline]
    fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> T {
        match id {
            Ok(id) => make(id),
            Err(error) => unreachable!("Bug: an id that is not found: {error}"),
        }
    }
}

impl<O, K: ElementKind> Key<K> for View<'_, O, K> {
    type Found<T> = T;

    #[inline]
    #[track_caller]
    fn id(self, model: &Model) -> Result<Id<K>> {
        self.id.id(model)
    }

    #[inline]
    fn found<T>(id: Result<Id<K>>, make: impl FnOnce(Id<K>) -> T) -> T {
        Id::found(id, make)
    }
}
