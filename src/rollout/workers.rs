//! The pool of simulations that rollouts run in, and their fast reset.

use std::fmt;
use std::sync::Arc;

use super::Edit;
use crate::callback::Callbacks;
use crate::data::{Data, PipelineFlags};
use crate::error::Result;
use crate::model::{IntoModel, Model, ModelMut, Relation};
use crate::parallel::Pool;

/// Pool of simulations that rollouts run in: one for each active thread, created on demand and kept
/// for the next run.
///
/// Clones share the pool. The result of a rollout does not depend on the simulation that it runs
/// in. A [`Rollout`](super::Rollout) creates its own pool by default; a predictive controller,
/// which runs rollouts repeatedly, keeps one:
///
/// ```
/// use mujoco_safe::rollout::{Rollout, Workers};
/// use mujoco_safe::{StateSpec, sample};
///
/// let workers = Workers::new(sample::cartpole());
/// let mut state = [0.0, 0.1, 0.0, 0.0];
/// for _ in 0..3 {
///     // Try eight constant forces, and apply the one after which the pole is the most upright.
///     let forces: Vec<f64> = (0..8).flat_map(|force| [f64::from(force - 4) / 4.0; 20]).collect();
///     let result = Rollout::on(&workers, 8, 20)
///         .with_initial_state(StateSpec::PHYSICS, &state)
///         .with_controls(&forces)
///         .run()?;
///     let best = (0..8).min_by(|&a, &b| result.state(a, 20)[1].abs().total_cmp(&result.state(b, 20)[1].abs()));
///     state.copy_from_slice(result.state(best.unwrap(), 20));
/// }
/// assert!(state[1].abs() < 0.1);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone)]
pub struct Workers(pub(super) Arc<Pool<Worker>>);

/// Simulation that a thread runs its rollouts in.
pub(super) struct Worker {
    pub(super) data: Data,
    /// Memory for a state.
    pub(super) saved: Vec<f64>,
}

impl Workers {
    /// Creates an empty pool for rollouts of this model. Takes a [`Model`], an `Arc<Model>` or an
    /// `&Arc<Model>`.
    pub fn new(model: impl IntoModel) -> Self {
        let create = |model: &Arc<Model>| Ok(Worker { data: Data::new(model)?, saved: Vec::new() });
        Self(Arc::new(Pool::new(model.into_model(), create)))
    }

    /// Returns the model.
    pub fn model(&self) -> &Arc<Model> {
        self.0.model()
    }
}

/// Resets a simulation to the state of a new one of the edited model, independently of its earlier
/// use.
pub(super) fn prepare(data: &mut Data, model: &Arc<Model>, index: usize, edit: Option<&Edit<'_>>) -> Result<()> {
    match model.relation(data.model()) {
        Relation::Same => {}
        Relation::Copies if edit.is_some() => {}
        // A controller may have replaced the simulation, or an edit of an earlier rollout remains.
        _ => *data = Data::new(model)?,
    }
    // A controller of an earlier rollout may have set callbacks.
    data.set_callbacks(Callbacks::new());
    if let Some(edit) = edit {
        data.edit_model(|copy| {
            restore(copy, model);
            edit(index, copy)
        })?;
    }
    restart(data)
}

impl fmt::Debug for Workers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Workers: {} idle, of {:?}", self.0.idle(), self.model())
    }
}

/// Undoes all edits. Copies only the parts of the model that an edit can change.
pub(crate) fn restore(model: &mut ModelMut<'_>, pristine: &Model) {
    model.restore_arrays(pristine);
    model.forget_loose_bounds();
    let (to, from) = (model.raw_mut(), pristine.raw());
    (to.opt, to.vis, to.stat) = (from.opt, from.vis, from.stat);
}

/// Resets a simulation as [`Data::reset`] does, at about the cost of a step.
///
/// The engine's reset clears all memory of a simulation. Even the smallest model uses megabytes,
/// because of the capacity for hundreds of constraints, so a reset takes as long as some hundred
/// steps of the cart-pole. This function omits the arrays of constraints and contacts. No code
/// reads a row of these arrays that has not been written since: the accessors end at the rows in
/// use, and a step that read more rows would depend on the previous step.
pub(crate) fn restart(data: &mut Data) -> Result<()> {
    // The data of newer engines are small, and hold more state than the arrays that are cleared
    // here.
    if cfg!(engine_since = "2.3.0") || data.check_usable().is_err() {
        return data.reset();
    }
    data.clear_arrays();
    data.set_computed(PipelineFlags::empty());

    let raw = data.raw_mut();
    // SAFETY: counters, times and costs are plain numbers, for which zero bytes are a valid value.
    (raw.warning, raw.timer, raw.solver) = unsafe { std::mem::zeroed() };
    (raw.pstack, raw.maxuse_stack, raw.maxuse_con, raw.maxuse_efc) = (0, 0, 0, 0);
    #[cfg(not(engine_since = "2.3.0"))]
    {
        (raw.solver_iter, raw.solver_nnz) = (0, 0);
    }
    raw.solver_fwdinv = [0.0; 2];
    (raw.ne, raw.nf, raw.nefc, raw.ncon) = (0, 0, 0, 0);
    (raw.time, raw.energy) = (0.0, [0.0; 2]);

    let model = data.model().clone();
    data.qpos_mut().copy_from_slice(model.qpos0());
    for (body, &mocap) in model.body_mocapid().iter().enumerate() {
        if let Ok(mocap) = usize::try_from(mocap) {
            data.mocap_pos_mut()[mocap] = model.body_pos()[body];
            data.mocap_quat_mut()[mocap] = model.body_quat()[body];
        }
    }
    Ok(())
}
