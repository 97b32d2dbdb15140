//! Identities of the elements of a model that was compiled from a spec.

use std::collections::{HashMap, HashSet};

use crate::id::Lineage;
use crate::kind::Kind;

/// Kinds of elements that a spec can identify and whose state a simulation keeps.
pub(crate) const IDENTIFIED: [Kind; 6] =
    [Kind::Body, Kind::Joint, Kind::Equality, Kind::Tendon, Kind::Actuator, Kind::Sensor];

/// Element of a spec and of the clones of the spec.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Identity {
    /// Lineage of the spec in which the element was created.
    pub(crate) lineage: Lineage,
    /// Number of the element in it.
    pub(crate) number: u32,
    /// Number of the copy that each `replicate` around the element makes.
    pub(crate) copies: Vec<usize>,
}

/// Identities of the elements of a compiled model, by their kinds and indices.
#[derive(Debug)]
pub(crate) struct Identities {
    /// Lineage of the spec. Clones have the same.
    pub(crate) spec: Lineage,
    /// Kinds with elements of the spec that are not found in the model.
    pub(crate) incomplete: HashSet<Kind>,
    elements: HashMap<Kind, Vec<Option<Identity>>>,
}

impl Identities {
    pub(crate) fn new(spec: Lineage) -> Self {
        Self { spec, incomplete: HashSet::new(), elements: HashMap::new() }
    }

    /// Sets the identities of all elements of a kind; `None` for elements that are not in the spec.
    pub(crate) fn insert(&mut self, kind: Kind, identities: Vec<Option<Identity>>) {
        self.elements.insert(kind, identities);
    }

    pub(crate) fn get(&self, kind: Kind, index: usize) -> Option<&Identity> {
        self.elements.get(&kind)?.get(index)?.as_ref()
    }
}
