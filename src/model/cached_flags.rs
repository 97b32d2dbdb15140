//! What the compiler has noted so that the engine can leave computations out: which frames coincide (`*_sameframe`), and which
//! bodies move by themselves, so that their part of the inertia matrix is diagonal and never changes (`body_simple`,
//! `dof_simplenum`, `dof_M0`). The engine goes by these notes, whatever the numbers have become since: it would leave a geom
//! where it was, and give a body its old inertia and its new weight.
//!
//! So a note is taken back when the numbers that it is about are lent to be written to, which is always right and a little
//! slower, and made again by [`update_constants`](ModelMut::update_constants) where it holds.

use mujoco_sys::{mjJNT_BALL, mjJNT_FREE, mjJNT_HINGE, mjJNT_SLIDE};

use super::{Model, ModelMut};
use crate::enums::GeomType;
use crate::ffi;

/// The notes on frames.
const NEITHER: u8 = 0;
const BODY: u8 = 1;
const INERTIA: u8 = 2;

/// An array of the model as a slice to be written to.
macro_rules! note {
    ($edit:ident.$array:ident) => {{
        let length = $edit.$array().len();
        let array = $edit.raw_mut().$array;
        // SAFETY: the engine allocated the array with this length, and the model is borrowed exclusively.
        unsafe { ffi::array_mut(array, length) }
    }};
}

impl ModelMut<'_> {
    /// The frames of geoms are about to change.
    pub(crate) fn forget_geom_frames(&mut self) {
        note!(self.geom_sameframe).fill(NEITHER);
    }

    /// The frames of sites are about to change.
    pub(crate) fn forget_site_frames(&mut self) {
        note!(self.site_sameframe).fill(NEITHER);
    }

    /// The inertial frames of bodies are about to change.
    pub(crate) fn forget_inertial_frames(&mut self) {
        note!(self.body_sameframe).fill(NEITHER);
        for frames in [note!(self.geom_sameframe), note!(self.site_sameframe)] {
            for frame in frames.iter_mut().filter(|frame| **frame == INERTIA) {
                *frame = NEITHER;
            }
        }
        self.forget_simple_bodies();
    }

    /// What the inertia matrix is made of is about to change.
    pub(crate) fn forget_simple_bodies(&mut self) {
        note!(self.body_simple).fill(0);
        note!(self.dof_simplenum).fill(0);
    }

    /// Notes what holds now, by the compiler's rules. The inertias of simple bodies, `dof_M0`, are to be computed next.
    pub(super) fn note_shortcuts(&mut self) {
        for body in 0..self.nbody() {
            let same = is_null(&self.body_ipos()[body], &self.body_iquat()[body]);
            note!(self.body_sameframe)[body] = same.into();
        }
        for geom in 0..self.ngeom() {
            let body = ffi::size(self.geom_bodyid()[geom]);
            let frame = self.same_frame(&self.geom_pos()[geom], &self.geom_quat()[geom], body);
            note!(self.geom_sameframe)[geom] = frame;
        }
        for site in 0..self.nsite() {
            let body = ffi::size(self.site_bodyid()[site]);
            let frame = self.same_frame(&self.site_pos()[site], &self.site_quat()[site], body);
            note!(self.site_sameframe)[site] = frame;
        }
        let simple: Vec<bool> = (0..self.nbody()).map(|body| self.is_simple(body)).collect();
        for (body, simple) in simple.into_iter().enumerate() {
            note!(self.body_simple)[body] = simple.into();
            // What carries another is not simple, unless it is the world.
            let parent = ffi::size(self.body_parentid()[body]);
            if parent > 0 {
                note!(self.body_simple)[parent] = 0;
            }
        }
        self.count_simple_dofs();
    }

    /// Takes back what the compiler should not have noted: it also takes a body for simple that has two slides along one axis.
    pub(super) fn forget_wrong_simple_bodies(&mut self) {
        let wrong = |&body: &usize| self.body_simple()[body] != 0 && !self.is_simple(body);
        let wrong: Vec<usize> = (0..self.nbody()).filter(wrong).collect();
        if !wrong.is_empty() {
            for body in wrong {
                note!(self.body_simple)[body] = 0;
            }
            self.count_simple_dofs();
        }
    }

    /// Numbers the degrees of freedom of simple bodies in runs, backwards.
    fn count_simple_dofs(&mut self) {
        let mut run = 0;
        for dof in (0..self.nv()).rev() {
            run = if self.body_simple()[ffi::size(self.dof_bodyid()[dof])] == 0 { 0 } else { run + 1 };
            note!(self.dof_simplenum)[dof] = run;
        }
    }

    /// Makes the sphere around each geom at least as large as the geom. Those without a sphere, and those that are made of data,
    /// stay as they are.
    pub(super) fn widen_bounds(&mut self) {
        for geom in 0..self.ngeom() {
            let [a, b, c] = self.geom_size()[geom];
            let radius = match GeomType::of_field(self.geom_type()[geom]) {
                GeomType::Sphere => a,
                GeomType::Capsule => a + b,
                GeomType::Cylinder => (a * a + b * b).sqrt(),
                GeomType::Ellipsoid => a.max(b).max(c),
                GeomType::Box => (a * a + b * b + c * c).sqrt(),
                _ => continue,
            };
            let bound = &mut self.geom_rbound_mut()[geom];
            if *bound > 0.0 && *bound < radius {
                *bound = radius;
            }
        }
    }
}

impl Model {
    fn same_frame(&self, pos: &[f64; 3], quat: &[f64; 4], body: usize) -> u8 {
        if is_null(pos, quat) {
            BODY
        } else if pos == &self.body_ipos()[body] && quat == &self.body_iquat()[body] {
            INERTIA
        } else {
            NEITHER
        }
    }

    /// Whether a body is not moved by another, and moves along and about the axes of its inertia.
    fn is_simple(&self, body: usize) -> bool {
        let parent = |body: usize| ffi::size(self.body_parentid()[body]);
        let is_fixed = |body: usize| self.body_dofnum()[body] == 0;
        let root = ffi::size(self.body_rootid()[body]) == body;
        let alone = root || (parent(parent(body)) == 0 && is_fixed(parent(body)));
        if self.body_sameframe()[body] == NEITHER || !alone {
            return false;
        }
        let (mut turned, mut slid) = (false, [false; 3]);
        let first = usize::try_from(self.body_jntadr()[body]).unwrap_or(0);
        for joint in first..first + ffi::size(self.body_jntnum()[body]) {
            let joint_type = self.jnt_type()[joint] as u32;
            let slanted = ![mjJNT_FREE, mjJNT_BALL].contains(&joint_type)
                && self.jnt_axis()[joint].iter().filter(|&&value| value != 0.0).count() > 1;
            if turned || slanted || self.jnt_pos()[joint] != [0.0; 3] {
                return false;
            }
            turned |= [mjJNT_BALL, mjJNT_HINGE].contains(&joint_type);
            if joint_type == mjJNT_SLIDE {
                for (slid, along) in slid.iter_mut().zip(self.jnt_axis()[joint]) {
                    if std::mem::replace(slid, *slid || along != 0.0) && along != 0.0 {
                        return false;
                    }
                }
            }
        }
        true
    }
}

/// Whether a pose is that of what it is relative to.
fn is_null(pos: &[f64; 3], quat: &[f64; 4]) -> bool {
    *pos == [0.0; 3] && *quat == [1.0, 0.0, 0.0, 0.0]
}
