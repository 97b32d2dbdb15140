//! Sleeping bodies, since 3.4.
//!
//! With the option `sleep`, the engine leaves out kinematic trees at rest. It wakes a tree before
//! it reads a result that the tree's sleep has left stale, with three exceptions, for which this
//! module wakes all trees:
//!
//! - A state vector does not contain which trees sleep. All are awake after [`Data::set_state`], so
//!   the state determines the next step.
//! - After a change of the model, the results of sleeping trees and of static bodies belong to the
//!   old model.
//! - Inverse dynamics and single parts of the pipeline do not wake a tree for a contact, which is
//!   an error of the engine.
//!
//! No safe code changes the option or the policy of a tree, so a model without the option has no
//! sleeping trees.

use mujoco_sys::{adapted, mjENBL_SLEEP};

use super::{Data, PipelineFlags};
use crate::error::{Error, Result};
use crate::model::Model;

type C = PipelineFlags;

impl Data {
    /// Wakes all bodies. If a body slept, all results count as not computed.
    #[inline]
    pub(super) fn wake(&mut self) {
        if self.model().has_sleep() && self.wake_trees(false) {
            self.computed = C::empty();
        }
    }

    /// Wakes all bodies after a change of the model, which may move static bodies.
    pub(super) fn wake_for_new_model(&mut self) {
        if self.model().has_sleep() {
            self.wake_trees(true);
        }
    }

    /// Wakes all bodies before a call that computes `results`, if the engine does not wake the
    /// bodies that the call needs.
    #[inline]
    pub(super) fn wake_before(&mut self, results: PipelineFlags) {
        // The position stage of forward dynamics wakes them; the position stage of inverse dynamics
        // and its single parts do not.
        let starts_single_parts = results.contains(C::KINEMATICS) && !results.contains(C::PROJECTION);
        if starts_single_parts || results == C::CONSTRAINT {
            self.wake();
        }
    }

    /// Returns `true` if a body slept.
    fn wake_trees(&mut self, recompute_static: bool) -> bool {
        let model = self.model().as_ptr();
        // SAFETY: a model and a data of this model, whose arrays have the sizes of the model.
        unsafe { adapted::wake(model, self.as_mut_ptr(), recompute_static.into()) != 0 }
    }

    /// Returns `true` if a body of the model sleeps.
    pub(crate) fn is_asleep(&self, body: usize) -> bool {
        assert!(body < self.model().nbody(), "Bug: body {body} of {}", self.model().nbody());
        // SAFETY: a model, a data of this model, and a body of the model.
        unsafe { adapted::is_asleep(self.model().as_ptr(), self.as_ptr(), body as i32) != 0 }
    }
}

impl Model {
    /// Returns `true` if the option `sleep` is enabled, which no edit changes.
    #[inline]
    pub(crate) fn has_sleep(&self) -> bool {
        self.raw().opt.enableflags as u32 & mjENBL_SLEEP != 0
    }

    /// Returns [`Error::Unsupported`] for a model with delays or with the option `sleep`: a linear
    /// system of one step does not contain the states of earlier steps, nor which bodies sleep.
    pub(crate) fn check_linearisable(&self, call: &str) -> Result<()> {
        self.check_without_delays(call)?;
        self.check_without_sleep(call)
    }

    /// Returns [`Error::Unsupported`] for a model with the option `sleep`, whose sleeping bodies no
    /// state vector contains.
    pub(crate) fn check_without_sleep(&self, call: &str) -> Result<()> {
        if self.has_sleep() {
            return Err(Error::Unsupported(format!("{call} of a model with the option sleep")));
        }
        Ok(())
    }

    /// Returns the reason why the engine cannot simulate sleeping bodies of this model safely.
    #[cfg(engine_since = "2.3.0")]
    pub(crate) fn unsafe_sleep(&self) -> Option<String> {
        if !self.has_sleep() {
            return None;
        }
        // Newer engines print the trees that they wake to a buffer of 1024 characters, on which
        // this variable decides.
        #[cfg(engine_since = "3.5.0")]
        if self.raw().ntree > 200 && std::env::var_os("MUJOCO_LOG_TOPICS").is_some() {
            return Some(format!(
                "{} kinematic trees can sleep while the variable MUJOCO_LOG_TOPICS is set, for which the engine writes out of bounds",
                self.raw().ntree
            ));
        }
        // SAFETY: a valid model, of which the function reads the policies.
        let body = usize::try_from(unsafe { adapted::initially_asleep(self.as_ptr()) }).ok()?;
        let name = self.name_at(crate::kind::Kind::Body, body).map_or(body.to_string(), |name| format!("'{name}'"));
        Some(format!(
            "body {name} sleeps initially (sleep=\"init\"), for which a reset of the engine frees the simulation if the body is not at rest; use \
             sleep=\"allowed\""
        ))
    }
}
