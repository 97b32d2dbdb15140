//! Cached flags by which the engine skips computations: the flags of coinciding frames
//! (`*_sameframe`), and the flags of bodies that move independently, whose part of the inertia
//! matrix is diagonal and constant (`body_simple`, `dof_simplenum`, `dof_M0`).
//!
//! The compiler computes the flags, and the engine trusts them even if the values that they depend
//! on have changed. It would then keep a geom at its old pose, or combine the old inertia of a body
//! with its new weight. Mutable access to such values therefore clears the flags that depend on
//! them, which is always correct and a little slower.
//! [`update_constants`](ModelMut::update_constants) recomputes the flags.

use mujoco_sys::{mjJNT_BALL, mjJNT_FREE, mjJNT_HINGE, mjJNT_SLIDE, mjSAMEFRAME_INERTIAROT};

use super::{Model, ModelMut};
use crate::ffi;
#[cfg(engine_since = "2.3.0")]
use crate::{error::Error, kind::Kind, version::built_against};

/// Values of the `*_sameframe` flags.
const NEITHER: u8 = 0;
const BODY: u8 = 1;
const INERTIA: u8 = 2;
/// Flags of frames that follow the inertial frame, or with newer engines only its orientation.
const INERTIAL: [u8; 2] = [INERTIA, mjSAMEFRAME_INERTIAROT as u8];

/// Differences below which the compiler takes two frames for equal, and components of an axis for
/// zero. It has done so since 3.2.3; with those from 2.3 on the rule only decides which edits are
/// rejected.
const TOLERANT: bool = cfg!(engine_since = "2.3.0");
const FRAME_TOLERANCE: f64 = if TOLERANT { 1e-6 } else { 0.0 };
const AXIS_TOLERANCE: f64 = if TOLERANT { 1e-14 } else { 0.0 };

/// Expands to a mutable slice of an array of flags.
macro_rules! flags {
    ($edit:ident.$array:ident) => {{
        let length = $edit.$array().len();
        let array = $edit.raw_mut().$array;
        // SAFETY: the engine allocated the array with this length, and the model is borrowed
        // exclusively.
        unsafe { ffi::array_mut(array, length) }
    }};
}

impl ModelMut<'_> {
    /// Clears the flags that depend on the frames of geoms, and loosens the bounds that do.
    pub(crate) fn clear_geom_frame_flags(&mut self) {
        self.loosen_boxes();
        flags!(self.geom_sameframe).fill(NEITHER);
    }

    /// Clears the flags that depend on the frames of sites.
    pub(crate) fn clear_site_frame_flags(&mut self) {
        flags!(self.site_sameframe).fill(NEITHER);
    }

    /// Clears the flags that depend on the inertial frames of bodies.
    pub(crate) fn clear_inertial_frame_flags(&mut self) {
        // The bounding boxes of a body are in its inertial frame.
        self.loosen_boxes();
        // No engine computes the inertial frame of the world, and newer ones do not restore its
        // flag.
        flags!(self.body_sameframe)[1..].fill(NEITHER);
        for frames in [flags!(self.geom_sameframe), flags!(self.site_sameframe)] {
            for frame in frames.iter_mut().filter(|frame| INERTIAL.contains(frame)) {
                *frame = NEITHER;
            }
        }
        self.clear_simple_body_flags();
    }

    /// Clears the flags that depend on the inertia matrix. In newer engines the sparsity of the
    /// matrix depends on them, so they stay, and an edit of a body that moves independently takes
    /// effect with [`update_constants`](Self::update_constants).
    pub(crate) fn clear_simple_body_flags(&mut self) {
        if cfg!(engine_since = "2.3.0") {
            return;
        }
        flags!(self.body_simple).fill(0);
        flags!(self.dof_simplenum).fill(0);
    }

    /// Computes all flags by the compiler's rules. The caller must then update `dof_M0`, the
    /// inertias of simple bodies.
    pub(super) fn compute_flags(&mut self) {
        // Engines since 3.11 compute the flags of frames themselves. With those between, cleared
        // flags stay cleared. The other flags determine the sparsity of matrices.
        if cfg!(engine_since = "2.3.0") {
            return;
        }
        for body in 0..self.nbody() {
            let same = is_identity(&self.body_ipos()[body], &self.body_iquat()[body]);
            flags!(self.body_sameframe)[body] = same.into();
        }
        for geom in 0..self.ngeom() {
            let body = ffi::size(self.geom_bodyid()[geom]);
            let frame = self.same_frame(&self.geom_pos()[geom], &self.geom_quat()[geom], body);
            flags!(self.geom_sameframe)[geom] = frame;
        }
        for site in 0..self.nsite() {
            let body = ffi::size(self.site_bodyid()[site]);
            let frame = self.same_frame(&self.site_pos()[site], &self.site_quat()[site], body);
            flags!(self.site_sameframe)[site] = frame;
        }
        let simple: Vec<bool> = (0..self.nbody()).map(|body| self.is_simple(body)).collect();
        for (body, simple) in simple.into_iter().enumerate() {
            flags!(self.body_simple)[body] = simple.into();
            // A body with children is not simple, unless it is the world.
            let parent = ffi::size(self.body_parentid()[body]);
            if parent > 0 {
                flags!(self.body_simple)[parent] = 0;
            }
        }
        self.count_simple_dofs();
    }

    /// Corrects an error of the compiler, which marks a body with two slides along one axis as
    /// simple.
    pub(super) fn clear_wrong_simple_bodies(&mut self) {
        // In newer engines the matrix has no space for the other elements: such a model is
        // rejected.
        if cfg!(engine_since = "2.3.0") {
            return;
        }
        let wrong = |&body: &usize| self.body_simple()[body] != 0 && !self.is_simple(body);
        let wrong: Vec<usize> = (0..self.nbody()).filter(wrong).collect();
        if !wrong.is_empty() {
            for body in wrong {
                flags!(self.body_simple)[body] = 0;
            }
            self.count_simple_dofs();
        }
    }

    /// Clears the flags of bodies that are not simple any more and have at most one degree of
    /// freedom. Their part of the inertia matrix has no other elements in any case. Engines since
    /// 3.11 fail for such a body.
    #[cfg(engine_since = "2.3.0")]
    pub(super) fn clear_flags_of_fixed_bodies(&mut self) {
        let changed =
            |&body: &usize| self.body_simple()[body] != 0 && self.body_dofnum()[body] <= 1 && !self.is_simple(body);
        let changed: Vec<usize> = (1..self.nbody()).filter(changed).collect();
        for body in changed {
            flags!(self.body_simple)[body] = 0;
        }
    }

    /// Rejects a body whose part of the inertia matrix was diagonal and constant when the model was
    /// compiled, but is not any more. In newer engines the matrix has no space for the other
    /// elements.
    #[cfg(engine_since = "2.3.0")]
    pub(super) fn check_simple_bodies(&self) -> crate::Result<()> {
        match self.first_wrong_simple_body() {
            None => Ok(()),
            Some(body) => {
                let body = self.described(Kind::Body, body);
                Err(Error::Unsupported(format!(
                    "{body} was compiled with a diagonal inertia matrix (body_simple), which its joints and its inertial frame do not \
                     have any more; with MuJoCo {} the matrix has no other elements: compile the model with these values",
                    built_against()
                )))
            }
        }
    }

    /// Computes `dof_simplenum`: numbers the degrees of freedom of simple bodies in runs,
    /// backwards.
    fn count_simple_dofs(&mut self) {
        let mut run = 0;
        for dof in (0..self.nv()).rev() {
            run = if self.body_simple()[ffi::size(self.dof_bodyid()[dof])] == 0 { 0 } else { run + 1 };
            flags!(self.dof_simplenum)[dof] = run;
        }
    }
}

impl Model {
    /// Returns the first body with several degrees of freedom whose part of the inertia matrix the
    /// engine takes for diagonal, although it is not.
    #[cfg(engine_since = "2.3.0")]
    fn first_wrong_simple_body(&self) -> Option<usize> {
        // One degree of freedom has one element, which is constant if the body is independent.
        let was_simple = |&body: &usize| self.body_simple()[body] != 0 && self.body_dofnum()[body] > 1;
        (0..self.nbody()).filter(was_simple).find(|&body| !self.is_simple(body))
    }

    /// Returns the reason why the inertia matrix of a compiled model would be wrong: the compiler
    /// takes two slides of a body along one axis for independent.
    #[cfg(engine_since = "2.3.0")]
    pub(super) fn coupled_slides(&self) -> Option<String> {
        let body = self.described(Kind::Body, self.first_wrong_simple_body()?);
        Some(format!("{body} has two slide joints along one axis, which the engine does not couple: use two bodies"))
    }

    fn same_frame(&self, pos: &[f64; 3], quat: &[f64; 4], body: usize) -> u8 {
        if is_identity(pos, quat) {
            BODY
        } else if pos == &self.body_ipos()[body] && quat == &self.body_iquat()[body] {
            INERTIA
        } else {
            NEITHER
        }
    }

    /// Returns `true` if the body is independent of all other moving bodies, and moves along and
    /// about the axes of its inertia.
    fn is_simple(&self, body: usize) -> bool {
        let parent = |body: usize| ffi::size(self.body_parentid()[body]);
        let is_fixed = |body: usize| self.body_dofnum()[body] == 0;
        let root = ffi::size(self.body_rootid()[body]) == body;
        let is_independent = root || (parent(parent(body)) == 0 && is_fixed(parent(body)));
        if !is_identity(&self.body_ipos()[body], &self.body_iquat()[body]) || !is_independent {
            return false;
        }
        let (mut rotates, mut slides) = (false, [false; 3]);
        let first = usize::try_from(self.body_jntadr()[body]).unwrap_or(0);
        for joint in first..first + ffi::size(self.body_jntnum()[body]) {
            let joint_type = self.jnt_type()[joint] as u32;
            let is_oblique = ![mjJNT_FREE, mjJNT_BALL].contains(&joint_type)
                && self.jnt_axis()[joint].iter().filter(|value| value.abs() > AXIS_TOLERANCE).count() > 1;
            if rotates || is_oblique || !is_zero(&self.jnt_pos()[joint]) {
                return false;
            }
            rotates |= [mjJNT_BALL, mjJNT_HINGE].contains(&joint_type);
            if joint_type == mjJNT_SLIDE {
                for (slides, along) in slides.iter_mut().zip(self.jnt_axis()[joint]) {
                    let along = along.abs() > AXIS_TOLERANCE;
                    if std::mem::replace(slides, *slides || along) && along {
                        return false;
                    }
                }
            }
        }
        true
    }
}

/// Returns `true` if a relative pose is the identity for the compiler.
fn is_identity(pos: &[f64; 3], quat: &[f64; 4]) -> bool {
    is_zero(pos) && (quat[0].abs() - 1.0).abs() <= FRAME_TOLERANCE && is_zero(&quat[1..]) && (quat[0] > 0.0 || TOLERANT)
}

fn is_zero(values: &[f64]) -> bool {
    values.iter().all(|value| value.abs() <= FRAME_TOLERANCE)
}
