//! Elements that a change of the model removes or adds.

use std::fmt;

use super::Model;
use super::parts::Parts;
use super::survivors::{KINDS, Survivors};
use crate::kind::Kind;

/// Element that a change of the model by [`Data::adopt`](crate::Data::adopt) has removed or added.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ChangedElement {
    /// Kind of the element.
    pub kind: Kind,
    /// Index of the element: in the old model if it was removed, in the new one if it was added.
    pub index: usize,
    /// Name of the element in this model, if it has one.
    pub name: Option<String>,
}

impl fmt::Display for ChangedElement {
    /// Writes the kind, and the name or the index: `joint 'knee'`, `joint 3`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{} '{name}'", self.kind),
            None => write!(f, "{} {}", self.kind, self.index),
        }
    }
}

/// Elements with a state of their own that are in one of two models only. Result of
/// [`Data::adopt`](crate::Data::adopt).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Adoption {
    /// Elements of the old model whose state is lost.
    pub lost: Vec<ChangedElement>,
    /// Elements of the new model that start in their initial state.
    pub new: Vec<ChangedElement>,
    /// Elements in both models whose number of values has changed, by their indices in the new
    /// model. These values start anew, or are lost: controls, activations, samples of delays,
    /// plastic deformation, or the state of a plugin.
    pub reset: Vec<ChangedElement>,
}

impl Adoption {
    pub(crate) fn of(survivors: &Survivors<'_>, old: &Model, new: &Model) -> Self {
        let mut adoption = Self::default();
        let [old_parts, new_parts] = [old, new].map(parts);
        for kind in KINDS {
            let mut is_lost = vec![true; old.count(kind)];
            survivors.pairs(kind).for_each(|(_, origin)| is_lost[origin] = false);
            let lost = (0..old.count(kind)).filter(|&index| is_lost[index] && has_state(&old_parts, kind, index));
            adoption.lost.extend(lost.map(|index| element(old, kind, index)));
            let is_new = |&index: &usize| survivors.origin(kind, index).is_none() && has_state(&new_parts, kind, index);
            adoption.new.extend((0..new.count(kind)).filter(is_new).map(|index| element(new, kind, index)));

            let has_other_values = |&(new_one, origin): &(usize, usize)| {
                let is_another = |(new, old): (&Parts, &Parts)| {
                    let form =
                        |parts: &Parts, index| parts.get(&(kind, index)).map(|(place, form)| (place.len(), *form));
                    form(new, new_one) != form(old, origin)
                };
                kind == Kind::Actuator
                    && (new.controls_of(new_one).len() != old.controls_of(origin).len()
                        || new.activations_of(new_one).len() != old.activations_of(origin).len())
                    || new_parts.iter().zip(&old_parts).any(is_another)
            };
            let changed = survivors.pairs(kind).filter(has_other_values);
            adoption.reset.extend(changed.map(|(index, _)| element(new, kind, index)));
        }
        adoption
    }
}

/// Returns the places of the values of elements in arrays with parts of different lengths.
fn parts(model: &Model) -> [Parts; 3] {
    [model.history_parts(), model.plastic_parts(), model.plugin_parts()]
}

fn element(model: &Model, kind: Kind, index: usize) -> ChangedElement {
    ChangedElement { kind, index, name: model.name_at(kind, index).map(str::to_owned) }
}

/// Returns `true` if an element has a state of its own.
fn has_state(parts: &[Parts], kind: Kind, index: usize) -> bool {
    matches!(kind, Kind::Body | Kind::Joint | Kind::Actuator | Kind::Equality)
        || parts.iter().any(|parts| parts.contains_key(&(kind, index)))
}
