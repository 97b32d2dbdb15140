//! Simulations that threads load the rows of a batch into.

use std::sync::{Arc, Mutex, PoisonError};

use crate::data::{Data, OwnCallbacks, PipelineFlags, StateSpec, WarningCounters};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::rollout::workers::restart;

/// Results in the arrays of a worker, apart from the state.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Results {
    /// None: the arrays are zero, as after a reset.
    None,
    /// Those of steps of the model that the batch shares. The next step of this model computes the same quantities, so it overwrites them.
    Steps,
    /// Anything that a closure, another model or a failed call can leave.
    Any,
}

/// Simulation of a thread, which steps the rows of a batch one after another.
pub(super) struct Worker {
    data: Data,
    results: Results,
}

impl Worker {
    pub(super) fn data(&self) -> &Data {
        &self.data
    }

    fn new(model: Arc<Model>) -> Result<Self> {
        Ok(Self { data: Data::new(model)?, results: Results::None })
    }

    /// Makes the worker a simulation of the model, with at most these results.
    fn prepare(&mut self, model: &Arc<Model>, allowed: Results) -> Result<()> {
        // A closure may have replaced the simulation, or exchanged it for the one of a scope with callbacks.
        let replaced = !Arc::ptr_eq(self.data.model(), model) || self.data.has_callbacks();
        if self.results == Results::Any && replaced {
            *self = Self::new(model.clone())?;
        } else if self.results > allowed {
            restart(&mut self.data)?;
            self.results = Results::None;
        }
        Ok(())
    }
}

/// Idle workers of a batch. There are as many as threads have been active at the same time.
pub(super) struct Pool {
    model: Arc<Model>,
    idle: Mutex<Vec<Worker>>,
}

impl Pool {
    pub(super) fn new(model: Arc<Model>) -> Self {
        Self { model, idle: Mutex::default() }
    }

    #[inline]
    pub(super) fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Returns the worker in `slot`, after filling it with an idle worker or a new one.
    pub(super) fn fill<'s>(&self, slot: &'s mut Option<Worker>) -> Result<&'s mut Worker> {
        if slot.is_none() {
            let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
            *slot = Some(match idle {
                Some(worker) => worker,
                None => Worker::new(self.model.clone())?,
            });
        }
        Ok(slot.as_mut().expect("Bug: the slot has been filled"))
    }

    pub(super) fn give_back(&self, slot: Option<Worker>) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).extend(slot);
    }
}

/// Edited model and callbacks of one simulation.
pub(super) struct Own {
    pub(super) model: Arc<Model>,
    callbacks: OwnCallbacks,
}

/// Worker with the model and the callbacks of a row. They return to the row when this is dropped, also by a panic of a closure.
pub(super) struct Loaded<'l> {
    worker: &'l mut Worker,
    own: &'l mut Option<Box<Own>>,
    shared: &'l Arc<Model>,
    /// Results that the worker has afterwards.
    leaves: Results,
}

impl<'l> Loaded<'l> {
    /// Prepares the worker with at most these results, and loads the row's model and callbacks.
    pub(super) fn new(
        worker: &'l mut Worker,
        own: &'l mut Option<Box<Own>>,
        shared: &'l Arc<Model>,
        allowed: Results,
    ) -> Result<Self> {
        worker.prepare(shared, allowed)?;
        if let Some(own) = own {
            worker.data.swap_model(&mut own.model);
            worker.data.swap_own_callbacks(&mut own.callbacks);
        }
        Ok(Self { worker, own, shared, leaves: Results::Any })
    }

    pub(super) fn data(&mut self) -> &mut Data {
        &mut self.worker.data
    }

    /// Ends the use of the worker, which has only these results.
    pub(super) fn finish(mut self, leaves: Results) {
        if self.own.is_none() {
            self.leaves = leaves.max(self.worker.results);
        }
    }
}

impl Drop for Loaded<'_> {
    fn drop(&mut self) {
        self.worker.results = self.leaves;
        if self.leaves != Results::Any {
            return;
        }
        let data = &mut self.worker.data;
        let mut callbacks = OwnCallbacks::default();
        data.swap_own_callbacks(&mut callbacks);
        let mut model = self.shared.clone();
        if check_model(data, &model).is_ok() {
            data.swap_model(&mut model);
        }
        let is_shared = Arc::ptr_eq(&model, self.shared) && callbacks.is_empty();
        let own = (!is_shared).then_some(Own { model, callbacks });
        match (&mut *self.own, own) {
            (Some(place), Some(own)) => **place = own,
            (place, own) => *place = own.map(Box::new),
        }
    }
}

/// Sets a simulation to a state of [`StateSpec::INTEGRATION`] with these counters of warnings, and no computed results.
pub(super) fn continue_from(data: &mut Data, state: &[f64], warnings: &WarningCounters) -> Result<()> {
    data.set_state(StateSpec::INTEGRATION, state)?;
    data.set_computed(PipelineFlags::empty());
    data.set_warnings(warnings);
    let raw = data.raw_mut();
    // The maxima and times of other simulations.
    (raw.maxuse_stack, raw.maxuse_con, raw.maxuse_efc) = (0, 0, 0);
    // SAFETY: times and numbers of calls, for which zero bytes are a valid value.
    raw.timer = unsafe { std::mem::zeroed() };
    Ok(())
}

/// Checks that a closure has not replaced the simulation by one of another model.
pub(super) fn check_model(data: &Data, model: &Model) -> Result<()> {
    if data.model().is_same_structure(model) {
        Ok(())
    } else {
        Err(Error::OtherModel { what: "the simulation that a closure has put into a batch" })
    }
}
