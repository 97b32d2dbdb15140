//! Lineages of the elements of a spec and of its clones.

use super::tree::Index;
use crate::id::Lineage;

/// Lineage of each element: the lineage of the spec in which it was created. A clone has the
/// lineages of the elements that it copies, and a new one for the elements that it creates, so an
/// id never names two elements that were created in different specs.
#[derive(Clone, Debug)]
pub(super) struct Lineages {
    /// First element of each lineage, in ascending order.
    starts: Vec<(Index, Lineage)>,
}

impl Lineages {
    pub(super) fn new() -> Self {
        Self { starts: vec![(0, Lineage::new())] }
    }

    /// Returns the lineages of a clone of a spec, whose next element has the index `next`.
    pub(super) fn of_clone(&self, next: Index) -> Self {
        let mut starts = self.starts.clone();
        // A lineage without elements is not needed, so clones of clones stay small.
        starts.retain(|&(start, _)| start < next);
        starts.push((next, Lineage::new()));
        Self { starts }
    }

    /// Returns the lineage of an element.
    pub(super) fn of(&self, index: Index) -> Lineage {
        let number = self.starts.partition_point(|&(start, _)| start <= index);
        self.starts[number - 1].1
    }
}
