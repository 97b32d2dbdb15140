//! Methods of the views of every kind.

use super::{Owner, View, ViewMut, range};
use crate::ffi;
use crate::id::{Id, Ids};
use crate::kind::ElementKind;
use crate::model::Model;

/// # Methods of all kinds
#[allow(private_bounds, reason = "only a model and a simulation own elements")]
impl<'a, O: Owner, K: ElementKind> View<'a, O, K> {
    #[inline]
    pub(super) fn new(owner: &'a O, id: Id<K>) -> Self {
        Self { owner, id }
    }

    /// Returns the id, which is valid for every simulation of the model.
    #[inline]
    pub fn id(&self) -> Id<K> {
        self.id
    }

    /// Returns the engine's index, counted from 0.
    #[inline]
    pub fn index(&self) -> usize {
        self.id.index()
    }

    /// Returns the name; `None` for an unnamed element.
    pub fn name(&self) -> Option<&'a str> {
        self.owner.model_of().name(self.id)
    }

    /// Returns the view of the same element in the model.
    #[inline]
    pub fn in_model(&self) -> View<'a, Model, K> {
        View::new(self.owner.model_of(), self.id)
    }

    /// Returns this element's entry of an array of ids.
    #[inline]
    pub(super) fn id_in<L>(&self, ids: &[i32]) -> Id<L> {
        Id::new(ffi::size(ids[self.index()]), self.owner.model_of().lineage())
    }

    /// Returns this element's entry of an array of ids; `None` for -1.
    #[inline]
    pub(super) fn optional_id_in<L>(&self, ids: &[i32]) -> Option<Id<L>> {
        let index = usize::try_from(ids[self.index()]).ok()?;
        Some(Id::new(index, self.owner.model_of().lineage()))
    }

    /// Returns the ids of the elements of another kind that belong to this element.
    #[inline]
    pub(super) fn ids_in<L>(&self, addresses: &[i32], counts: &[i32]) -> Ids<L> {
        Ids::new(range(addresses, counts, self.index()), self.owner.model_of().lineage())
    }
}

/// # Methods of all kinds
#[allow(private_bounds, reason = "only a model and a simulation own elements")]
impl<'a, O: Owner, K: ElementKind> ViewMut<'a, O, K> {
    #[inline]
    pub(super) fn new(owner: &'a mut O, id: Id<K>) -> Self {
        Self { owner, id }
    }

    /// Returns an immutable view of the same element.
    #[inline]
    pub fn view(&self) -> View<'_, O, K> {
        View::new(self.owner, self.id)
    }
}
