//! Momenta and inertias of subtrees, and the changes of velocities with the position.

use crate::data::Data;
use crate::enums::JointType;
use crate::ffi;
use crate::model::Model;
use crate::numerics::spatial::{Inertia, Spatial, add_scaled, cross_motion, momentum};

/// Buffers for the derivatives of momenta.
#[derive(Debug)]
pub(super) struct Momenta {
    /// `(nbody)`: inertias and momenta of subtrees, about the reference point of the tree.
    pub(super) inertias: Vec<Inertia>,
    pub(super) sums: Vec<Spatial>,
    /// `(nv)`: change ψ of the velocity of the bodies that a degree of freedom moves, with its
    /// position.
    pub(super) changes: Vec<Spatial>,
}

impl Momenta {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            inertias: vec![[0.0; 10]; model.nbody()],
            sums: vec![[0.0; 6]; model.nbody()],
            changes: vec![[0.0; 6]; model.nv()],
        }
    }

    /// Computes all values of the present state. For the world, only the linear part of the
    /// momentum has a meaning, because trees have different reference points.
    pub(super) fn compute(&mut self, data: &Data) {
        let model = data.model();
        self.inertias.copy_from_slice(data.cinert());
        for ((sum, inertia), velocity) in self.sums.iter_mut().zip(data.cinert()).zip(data.cvel()) {
            *sum = momentum(inertia, velocity);
        }
        for body in (1..model.nbody()).rev() {
            let parent = ffi::size(model.body_parentid()[body]);
            let (inertia, momentum) = (self.inertias[body], self.sums[body]);
            add_scaled(&mut self.inertias[parent], &inertia, 1.0);
            add_scaled(&mut self.sums[parent], &momentum, 1.0);
        }
        for body in 1..model.nbody() {
            let mut velocity = data.cvel()[ffi::size(model.body_parentid()[body])];
            let (first, count) = (model.body_jntadr()[body], ffi::size(model.body_jntnum()[body]));
            for joint in (0..count).map(|offset| ffi::size(first) + offset) {
                let dof = ffi::size(model.jnt_dofadr()[joint]);
                // The axes of a ball turn with the body, so its rotations count together.
                let groups: &[usize] = match JointType::of_field(model.jnt_type()[joint]) {
                    JointType::Free => &[3, 3],
                    JointType::Ball => &[3],
                    JointType::Slide | JointType::Hinge => &[1],
                };
                let mut start = dof;
                for &size in groups {
                    let before = velocity;
                    for dof in start..start + size {
                        let axis = &data.cdof()[dof];
                        self.changes[dof] = cross_motion(&before, axis);
                        add_scaled(&mut velocity, axis, data.qvel()[dof]);
                    }
                    start += size;
                }
            }
        }
    }
}
