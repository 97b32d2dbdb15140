//! Identities of the elements of a model that was compiled from a spec.

use std::collections::HashMap;

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
    elements: HashMap<Kind, Vec<Option<Identity>>>,
    /// Elements of the spec by which the model may have others without identity, by their kinds and
    /// names, which are empty for those without one.
    sources: HashMap<Kind, HashMap<String, Vec<Identity>>>,
}

impl Identities {
    pub(crate) fn new(spec: Lineage) -> Self {
        Self { spec, elements: HashMap::new(), sources: HashMap::new() }
    }

    /// Sets the identities of all elements of a kind; `None` for elements that are not in the spec.
    pub(crate) fn insert(&mut self, kind: Kind, identities: Vec<Option<Identity>>) {
        self.elements.insert(kind, identities);
    }

    pub(crate) fn get(&self, kind: Kind, index: usize) -> Option<&Identity> {
        self.elements.get(&kind)?.get(index)?.as_ref()
    }

    /// Adds an element of the spec of which the model may have copies, or which is not found in it.
    pub(crate) fn insert_source(&mut self, kind: Kind, name: Option<&str>, identity: Identity) {
        let names = self.sources.entry(kind).or_default();
        names.entry(name.unwrap_or_default().to_owned()).or_default().push(identity);
    }

    /// Returns the elements of the spec of which an element of the model without identity may be
    /// one or a copy: those without a name, or those with whose name its name begins.
    pub(crate) fn sources(&self, kind: Kind, name: Option<&str>) -> Vec<&Identity> {
        let Some(names) = self.sources.get(&kind) else { return Vec::new() };
        let prefixes = name.map_or(vec![""], |name| (1..=name.len()).filter_map(|end| name.get(..end)).collect());
        prefixes.into_iter().filter_map(|prefix| names.get(prefix)).flatten().collect()
    }
}
