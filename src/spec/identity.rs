//! Identities of the elements of a spec in the model that was compiled from it.
//!
//! The compiler keeps the names, and the order of the elements of each kind in a body and in the
//! sections. So an element is found by its name, or else by its order among those without one, as
//! long as the model has as many of them. It does not if the compiler has created or fused others.

use std::collections::{HashMap, HashSet};

use super::tree::{Index, Tree};
use super::{Spec, layout, names};
use crate::kind::Kind;
use crate::model::{IDENTIFIED, Identities, Identity, Model};

/// Element of a spec, and the number of the copy that each `replicate` around it makes.
type Entry = (Index, Vec<usize>);

/// Sections whose elements are in the model in the order of the text, unless the compiler copies
/// some of them.
const SECTIONS: [(Kind, &str); 4] =
    [(Kind::Equality, "equality"), (Kind::Tendon, "tendon"), (Kind::Actuator, "actuator"), (Kind::Sensor, "sensor")];

/// Returns the identities of the elements of a model that was compiled from the spec.
pub(super) fn of(spec: &Spec, model: &Model) -> Identities {
    let fuses = |compiler| spec.tree.attribute(compiler, "fusestatic").is_some_and(|value| value != "false");
    let fuses = spec.tree.sections("compiler").any(fuses);
    let copies = |&index: &Index| matches!(spec.tree.tag(index), "replicate" | "attach");
    let copies = spec.tree.descendants(Tree::ROOT).iter().any(copies);
    let identities = Identities::new(spec.lineages.of(Tree::ROOT));
    let mut found = Found { spec, model, fuses, copies, places: HashMap::new(), missed: HashSet::new(), identities };
    found.bodies();
    for (kind, section) in SECTIONS {
        let sections = spec.tree.sections(section);
        let entries: Vec<Entry> =
            sections.flat_map(|section| spec.tree.children(section)).map(|&index| (index, Vec::new())).collect();
        // An element without a name is known by its order as long as no other one is added or
        // removed.
        entries
            .iter()
            .filter(|(index, _)| names::name(&spec.tree, *index).is_none())
            .for_each(|entry| found.miss(entry.0));
        found.assign(kind, &(0..model.count(kind)).collect::<Vec<_>>(), &entries);
    }
    let Found { places, mut identities, .. } = found;
    for (kind, places) in places {
        identities.insert(kind, places);
    }
    identities
}

struct Found<'s> {
    spec: &'s Spec,
    model: &'s Model,
    /// The compiler fuses bodies without joints with their parents.
    fuses: bool,
    /// The compiler copies elements of sections that refer to copies, and puts the copies last.
    copies: bool,
    places: HashMap<Kind, Vec<Option<Identity>>>,
    /// Elements that may not be found, or of which a copy may not.
    missed: HashSet<Index>,
    identities: Identities,
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
                let Some(found) = layout::elements(tree, place, &copies, &mut left) else {
                    return self.miss(Tree::ROOT);
                };
                elements.extend(found);
            }
            let of = |kind| {
                let is_kind = move |(index, _): &&Entry| names::kind(tree, *index) == Some(kind);
                elements.iter().filter(is_kind).cloned().collect::<Vec<_>>()
            };
            self.assign(Kind::Joint, &joints[body], &of(Kind::Joint));
            for (child, entry) in self.assign(Kind::Body, &children[body], &of(Kind::Body)) {
                open.push((child, vec![entry]));
            }
        }
    }

    /// Assigns elements of the spec to elements of the model, and returns the pairs.
    fn assign(&mut self, kind: Kind, ids: &[usize], entries: &[Entry]) -> Vec<(usize, Entry)> {
        let (tree, model) = (&self.spec.tree, self.model);
        let named: HashMap<&str, usize> = ids.iter().filter_map(|&id| Some((model.name_at(kind, id)?, id))).collect();
        let mut pairs = Vec::new();
        // Elements without names, and copies, to whose names the compiler appends their numbers.
        let mut others = [Vec::new(), Vec::new()];
        for entry in entries {
            match names::name(tree, entry.0) {
                Some(name) if entry.1.is_empty() => pairs.extend(named.get(name).map(|&id| (id, entry))),
                name => others[usize::from(name.is_some())].push(entry),
            }
        }
        let taken: HashSet<usize> = pairs.iter().map(|&(id, _)| id).collect();
        for (has_name, entries) in others.into_iter().enumerate() {
            let is_free =
                |id: &&usize| !taken.contains(id) && usize::from(model.name_at(kind, **id).is_some()) == has_name;
            let free: Vec<usize> = ids.iter().filter(is_free).copied().collect();
            let agrees = |(&id, entry): (&usize, &&Entry)| {
                let [found, name] =
                    [model.name_at(kind, id), names::name(tree, entry.0)].map(Option::unwrap_or_default);
                found.starts_with(name)
            };
            let has_order = match kind {
                Kind::Body => !self.fuses,
                Kind::Joint => true,
                _ => !self.copies,
            };
            if free.len() == entries.len() && has_order && free.iter().zip(&entries).all(agrees) {
                pairs.extend(free.into_iter().zip(entries));
            }
        }
        let found: HashSet<&Entry> = pairs.iter().map(|&(_, entry)| entry).collect();
        entries.iter().filter(|entry| !found.contains(entry)).for_each(|entry| self.miss(entry.0));
        let pairs: Vec<_> = pairs.into_iter().map(|(id, entry)| (id, entry.clone())).collect();
        for (id, entry) in &pairs {
            self.put(kind, *id, entry.clone());
        }
        pairs
    }

    /// Notes an element that may not be found in the model, and all that it contains.
    fn miss(&mut self, index: Index) {
        let tree = &self.spec.tree;
        for element in tree.descendants(index) {
            let kind = names::kind(tree, element).filter(|kind| IDENTIFIED.contains(kind));
            if let Some(kind) = kind.filter(|_| self.missed.insert(element)) {
                let identity = self.identity(element, Vec::new());
                self.identities.insert_source(kind, names::name(tree, element), identity);
            }
        }
    }

    fn identity(&self, index: Index, copies: Vec<usize>) -> Identity {
        Identity { lineage: self.spec.lineages.of(index), number: index, copies }
    }

    fn put(&mut self, kind: Kind, id: usize, (index, copies): Entry) {
        let identity = self.identity(index, copies);
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
