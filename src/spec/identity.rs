//! Identities of the elements of a spec in the model that was compiled from it.
//!
//! The compiler keeps the order of the elements of each kind in a body, and of the children of a
//! body. So the elements are found by their order, as long as their number and their names agree
//! with the model. They do not where the compiler creates or fuses elements; there the elements
//! with a name are found by it.

use std::collections::HashMap;

use super::tree::{Index, Tree};
use super::{Spec, layout, names};
use crate::kind::Kind;
use crate::model::{Identities, Identity, Model};

/// Element of a spec, and the number of the copy that each `replicate` around it makes.
type Entry = (Index, Vec<usize>);

/// Sections whose elements are in the model in the order of the text.
const SECTIONS: [(Kind, &str); 4] =
    [(Kind::Equality, "equality"), (Kind::Tendon, "tendon"), (Kind::Actuator, "actuator"), (Kind::Sensor, "sensor")];

/// Returns the identities of the elements of a model that was compiled from the spec.
pub(super) fn of(spec: &Spec, model: &Model) -> Identities {
    let mut found = Found { spec, model, places: HashMap::new() };
    found.bodies();
    for (kind, section) in SECTIONS {
        let sections = spec.tree.sections(section);
        let entries = sections.flat_map(|section| spec.tree.children(section)).map(|&index| (index, Vec::new()));
        found.assign(kind, &(0..model.count(kind)).collect::<Vec<_>>(), entries.collect(), true);
    }
    let mut identities = Identities::new(spec.lineages.of(Tree::ROOT));
    for (kind, places) in found.places {
        identities.insert(kind, places);
    }
    identities
}

struct Found<'s> {
    spec: &'s Spec,
    model: &'s Model,
    places: HashMap<Kind, Vec<Option<Identity>>>,
}

impl Found<'_> {
    fn bodies(&mut self) {
        /// Number of elements and copies beyond which no identities are known.
        const MOST: usize = 1_000_000;
        let (tree, model) = (&self.spec.tree, self.model);
        let children = groups(model.body_parentid().iter().skip(1).copied(), model.nbody(), 1);
        let joints = groups(model.jnt_bodyid().iter().copied(), model.nbody(), 0);
        let mut left = MOST;
        let worlds = tree.sections("worldbody").map(|world| (world, Vec::new()));
        self.put(Kind::Body, 0, (self.spec.world, Vec::new()));
        let mut open: Vec<(usize, Vec<Entry>)> = vec![(0, worlds.collect())];
        while let Some((body, places)) = open.pop() {
            let mut elements = Vec::new();
            for (place, copies) in places {
                let Some(found) = layout::elements(tree, place, &copies, &mut left) else { return };
                elements.extend(found);
            }
            let has = |tags: &[&str]| elements.iter().any(|(index, _)| tags.contains(&tree.tag(*index)));
            let of = |kind| {
                let is_kind = move |(index, _): &&Entry| names::kind(tree, *index) == Some(kind);
                elements.iter().filter(is_kind).cloned().collect::<Vec<_>>()
            };
            self.assign(Kind::Joint, &joints[body], of(Kind::Joint), !has(&["composite"]));
            let is_complete = !has(&["composite", "flexcomp", "attach"]);
            for (child, entry) in self.assign(Kind::Body, &children[body], of(Kind::Body), is_complete) {
                open.push((child, vec![entry]));
            }
        }
    }

    /// Assigns elements of the spec to elements of the model: by their order if it
    /// `is_complete`, which means that the compiler creates no others, else by their names.
    fn assign(&mut self, kind: Kind, ids: &[usize], entries: Vec<Entry>, is_complete: bool) -> Vec<(usize, Entry)> {
        let name = |entry: &Entry| names::name(&self.spec.tree, entry.0);
        let agrees = |(&id, entry): (&usize, &Entry)| match (name(entry), self.model.name_at(kind, id)) {
            (None, None) => true,
            (Some(name), Some(found)) if entry.1.is_empty() => name == found,
            (Some(name), Some(found)) => found.starts_with(name),
            _ => false,
        };
        let is_ordered = is_complete && ids.len() == entries.len() && ids.iter().zip(&entries).all(agrees);
        let pairs: Vec<(usize, Entry)> = if is_ordered {
            ids.iter().copied().zip(entries).collect()
        } else {
            let named = |&id: &usize| Some((self.model.name_at(kind, id)?, id));
            let named: HashMap<&str, usize> = ids.iter().filter_map(named).collect();
            let found = |entry: Entry| {
                let id = named.get(name(&entry).filter(|_| entry.1.is_empty())?)?;
                Some((*id, entry))
            };
            entries.into_iter().filter_map(found).collect()
        };
        for (id, entry) in &pairs {
            self.put(kind, *id, entry.clone());
        }
        pairs
    }

    fn put(&mut self, kind: Kind, id: usize, (index, copies): Entry) {
        let identity = Identity { lineage: self.spec.lineages.of(index), number: index, copies };
        let count = self.model.count(kind);
        self.places.entry(kind).or_insert_with(|| vec![None; count])[id] = Some(identity);
    }
}

/// Returns the indices of elements by the body in which they are. The first one has the index
/// `first`.
fn groups(bodies: impl Iterator<Item = i32>, count: usize, first: usize) -> Vec<Vec<usize>> {
    let mut groups = vec![Vec::new(); count];
    for (number, body) in bodies.enumerate() {
        groups[crate::ffi::size(body)].push(first + number);
    }
    groups
}
