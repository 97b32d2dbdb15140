//! Groups of degrees of freedom that are perturbed together, and the chains of degrees of freedom
//! that move each body.
//!
//! A hinge and a slide are a group of one. A ball is a group of three. A free joint has two groups,
//! translations and rotations. Degree of freedom `j` displaces the axes of `k` if the group of `k`
//! is the group of `j` or comes after it on the way to a leaf. Within a group all pairs count: the
//! axes of a ball are the axes of its body, and turn with it.

use std::iter;
use std::ops::Range;

use crate::enums::JointType;
use crate::ffi;
use crate::model::Model;

/// Group of degrees of freedom.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// First of its degrees of freedom, which are contiguous.
    pub(super) first: usize,
    pub(super) len: usize,
    /// Next group towards the root.
    pub(super) parent: Option<usize>,
}

impl Group {
    /// Returns its degrees of freedom.
    #[inline]
    pub(super) fn dofs(self) -> Range<usize> {
        self.first..self.first + self.len
    }
}

/// Kinematic tree, as degrees of freedom.
#[derive(Debug)]
pub(super) struct Tree {
    /// In the order of their degrees of freedom, so that parents come first.
    pub(super) groups: Vec<Group>,
    /// `(nv)`: index of the group.
    pub(super) group: Vec<usize>,
    /// `(nv)`: next degree of freedom towards the root.
    pub(super) parent: Vec<Option<usize>>,
    /// `(nbody)`: last degree of freedom that moves the body; `None` for a body that is fixed to
    /// the world.
    pub(super) last: Vec<Option<usize>>,
}

impl Tree {
    pub(super) fn new(model: &Model) -> Self {
        let parent: Vec<_> = model.dof_parentid().iter().map(|&dof| usize::try_from(dof).ok()).collect();
        let mut groups: Vec<Group> = Vec::new();
        let mut group = vec![0; model.nv()];
        for (&kind, &first) in model.jnt_type().iter().zip(model.jnt_dofadr()) {
            let first = ffi::size(first);
            let parts: &[(usize, usize)] = match JointType::of_field(kind) {
                JointType::Free => &[(first, 3), (first + 3, 3)],
                JointType::Ball => &[(first, 3)],
                JointType::Slide | JointType::Hinge => &[(first, 1)],
            };
            for &(first, len) in parts {
                group[first..first + len].fill(groups.len());
                groups.push(Group { first, len, parent: parent[first].map(|dof| group[dof]) });
            }
        }
        let mut last: Vec<Option<usize>> = Vec::with_capacity(model.nbody());
        for body in 0..model.nbody() {
            let (first, count) = (model.body_dofadr()[body], ffi::size(model.body_dofnum()[body]));
            // A body without joints moves with its parent, which comes before it.
            let own = count.checked_sub(1).map(|offset| ffi::size(first) + offset);
            last.push(own.or_else(|| last.get(ffi::size(model.body_parentid()[body])).copied().flatten()));
        }
        Self { groups, group, parent, last }
    }

    /// Returns a degree of freedom and all those before it on the way to the root, in this order.
    #[inline]
    pub(super) fn chain(&self, dof: Option<usize>) -> impl Iterator<Item = usize> + '_ {
        iter::successors(dof, |&dof| self.parent[dof])
    }
}
