//! Simulations that threads load the rows of a batch into.

use std::sync::Arc;

use crate::data::{Data, OwnCallbacks, PipelineFlags, StateSpec, WarningCounters};
use crate::error::Result;
use crate::model::{EditedModel, Model, ModelDifference, ModelMut, Relation};
use crate::rollout::workers::restart;

/// Results in the arrays of a worker, apart from the state.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Results {
    /// None: the arrays are zero, as after a reset.
    None,
    /// Results of steps of the model that the batch shares, perhaps with other parameters. The next
    /// such step computes the same quantities, so it overwrites them.
    Steps,
    /// Anything that a closure, another model or a failed call can leave.
    Any,
}

/// Simulation of a thread, which steps the rows of a batch one after another.
pub(super) struct Worker {
    data: Data,
    results: Results,
    /// Copy of the model for rows with an edited one.
    edited: Option<EditedModel>,
    /// Memory for a comparison of models.
    difference: ModelDifference,
}

impl Worker {
    pub(super) fn data(&self) -> &Data {
        &self.data
    }

    pub(super) fn new(model: &Arc<Model>) -> Result<Self> {
        Ok(Self {
            data: Data::new(model)?,
            results: Results::None,
            edited: None,
            difference: ModelDifference::default(),
        })
    }

    /// Makes the worker a simulation of the model, with at most these results.
    fn prepare(&mut self, model: &Arc<Model>, allowed: Results) -> Result<()> {
        // A closure may have replaced the simulation, or exchanged it for the one of a scope with
        // callbacks.
        let replaced = self.data.model().relation(model) != Relation::Same || self.data.has_callbacks();
        if self.results == Results::Any && replaced {
            (self.data, self.results) = (Data::new(model.clone())?, Results::None);
        } else if self.results > allowed {
            restart(&mut self.data)?;
            self.results = Results::None;
        }
        Ok(())
    }
}

/// # Edits of the model of a row
impl Worker {
    /// Edits the model of a row, without a simulation of it. The row is unchanged after an error.
    pub(super) fn edit_model(
        &mut self,
        overrides: &mut Option<Box<Overrides>>,
        shared: &Model,
        edit: impl FnOnce(&mut ModelMut<'_>) -> Result<()>,
    ) -> Result<()> {
        let none = ModelDifference::default();
        let edited = EditedModel::set(
            &mut self.edited,
            shared,
            overrides.as_ref().map_or(&none, |overrides| &overrides.difference),
        )?;
        let result = edited.edit(shared, edit, &mut self.difference);
        if result.is_ok() {
            let callbacks =
                overrides.as_deref_mut().map(|overrides| std::mem::take(&mut overrides.callbacks)).unwrap_or_default();
            set_overrides(overrides, &self.difference, callbacks, false);
        }
        result
    }
}

/// Edits of the model and callbacks of one simulation.
#[derive(Default)]
pub(super) struct Overrides {
    pub(super) difference: ModelDifference,
    callbacks: OwnCallbacks,
    /// `true` if a closure has edited the model. A step may then compute other quantities than a
    /// step of the shared model, for example because options differ.
    edited_by_closure: bool,
}

impl Overrides {
    fn computes_other_results(&self) -> bool {
        self.edited_by_closure || !self.callbacks.is_empty()
    }
}

/// Worker with the model and the callbacks of a row. They return to the row when this is dropped,
/// also by a panic of a closure.
pub(super) struct Loaded<'l> {
    worker: &'l mut Worker,
    overrides: &'l mut Option<Box<Overrides>>,
    shared: &'l Arc<Model>,
    /// Results that the worker has afterwards.
    leaves: Results,
    /// `true` unless the model and the callbacks are certainly unchanged.
    changed: bool,
}

impl<'l> Loaded<'l> {
    /// Prepares the worker with at most these results, and loads the row's model and callbacks.
    pub(super) fn new(
        worker: &'l mut Worker,
        overrides: &'l mut Option<Box<Overrides>>,
        shared: &'l Arc<Model>,
        allowed: Results,
    ) -> Result<Self> {
        let other_results = overrides.as_ref().is_some_and(|overrides| overrides.computes_other_results());
        let allowed = if other_results && allowed == Results::Steps { Results::None } else { allowed };
        worker.prepare(shared, allowed)?;
        if let Some(overrides) = overrides {
            if !overrides.difference.is_empty() {
                let edited = EditedModel::set(&mut worker.edited, shared, &overrides.difference)?;
                worker.data.swap_model(edited.model_mut());
            }
            worker.data.swap_own_callbacks(&mut overrides.callbacks);
        }
        Ok(Self { worker, overrides, shared, leaves: Results::Any, changed: true })
    }

    pub(super) fn data(&mut self) -> &mut Data {
        &mut self.worker.data
    }

    /// Ends the use of the worker, which has only these results. Unless they are [`Results::Any`],
    /// no closure has changed the simulation.
    pub(super) fn finish(mut self, leaves: Results) {
        self.changed = leaves == Results::Any;
        if !self.overrides.as_ref().is_some_and(|overrides| overrides.computes_other_results()) {
            self.leaves = leaves.max(self.worker.results);
        }
    }
}

impl Drop for Loaded<'_> {
    fn drop(&mut self) {
        let Worker { data, results, edited, difference } = &mut *self.worker;
        *results = self.leaves;
        if self.overrides.is_none() && !self.changed {
            return;
        }
        let mut callbacks = OwnCallbacks::default();
        data.swap_own_callbacks(&mut callbacks);
        let copy = (data.model().relation(self.shared) == Relation::Copies).then(|| {
            let mut model = self.shared.clone();
            data.swap_model(&mut model);
            model
        });
        if self.changed {
            match &copy {
                Some(copy) => difference.update(self.shared, copy),
                None => difference.clear(),
            }
            set_overrides(self.overrides, difference, callbacks, true);
        } else if let Some(overrides) = &mut *self.overrides {
            overrides.callbacks = callbacks;
        }
        if let Some(copy) = copy {
            EditedModel::put_back(edited, copy, self.overrides.as_deref().map(|overrides| &overrides.difference));
        }
    }
}

/// Stores the edits and the callbacks of a row, and frees their memory if there are none.
fn set_overrides(
    overrides: &mut Option<Box<Overrides>>,
    difference: &ModelDifference,
    callbacks: OwnCallbacks,
    by_closure: bool,
) {
    if difference.is_empty() && callbacks.is_empty() {
        *overrides = None;
        return;
    }
    let overrides = overrides.get_or_insert_default();
    overrides.callbacks = callbacks;
    if overrides.difference != *difference {
        overrides.difference.clone_from(difference);
        overrides.edited_by_closure = (overrides.edited_by_closure || by_closure) && !overrides.difference.is_empty();
    }
}

/// Moves the callbacks of a row to another one, which has none.
pub(super) fn move_callbacks(from: &mut Option<Box<Overrides>>, to: &mut Option<Box<Overrides>>) {
    let callbacks = from.as_deref_mut().map(|overrides| std::mem::take(&mut overrides.callbacks)).unwrap_or_default();
    if !callbacks.is_empty() {
        to.get_or_insert_default().callbacks = callbacks;
    }
}

/// Sets a simulation to a state of [`StateSpec::INTEGRATION`] with these counters of warnings, and
/// no computed results.
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
