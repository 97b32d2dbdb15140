//! The simulations that rollouts run in.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Edit;
use super::restart::restart;
use crate::data::Data;
use crate::error::Result;
use crate::model::{Model, ModelMut};

/// The simulations that rollouts run in: one for each thread that is at work, made when they are first needed and kept for the
/// next run. A clone shares them. Which of them a rollout gets does not show in its result.
///
/// A [`Rollout`](super::Rollout) has workers of its own; who makes one for every decision of a controller keeps them:
///
/// ```
/// use mujoco_safe::rollout::{Rollout, Workers};
/// use mujoco_safe::{StateSpec, sample};
///
/// let workers = Workers::new(sample::cartpole());
/// let mut state = [0.0, 0.1, 0.0, 0.0];
/// for _ in 0..3 {
///     // Eight constant pushes; the one that leaves the pole the straightest is what is done.
///     let pushes: Vec<f64> = (0..8).flat_map(|push| [f64::from(push - 4) / 4.0; 20]).collect();
///     let result = Rollout::on(&workers, 8, 20)
///         .initial_state(StateSpec::PHYSICS, &state)
///         .controls(&pushes)
///         .run()?;
///     let best = (0..8).min_by(|&a, &b| result.state(a, 20)[1].abs().total_cmp(&result.state(b, 20)[1].abs()));
///     state.copy_from_slice(result.state(best.unwrap(), 20));
/// }
/// assert!(state[1].abs() < 0.1);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone)]
pub struct Workers {
    model: Arc<Model>,
    idle: Arc<Mutex<Vec<Data>>>,
}

impl Workers {
    /// For rollouts of this model. Takes a [`Model`] or an `Arc<Model>`.
    pub fn new(model: impl Into<Arc<Model>>) -> Self {
        Self { model: model.into(), idle: Arc::default() }
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// One that is idle, or a new one.
    pub(super) fn take(&self) -> Result<Data> {
        let idle = self.idle().pop();
        match idle {
            Some(data) => Ok(data),
            None => Data::new(self.model.clone()),
        }
    }

    /// Keeps one for the next run.
    pub(super) fn give_back(&self, data: Data) {
        self.idle().push(data);
    }

    /// Makes a simulation what a new one of the edited model is, whatever it was used for and whatever a closure did to it.
    pub(super) fn prepare(&self, data: &mut Data, index: usize, edit: Option<&Edit<'_>>) -> Result<()> {
        let fits = match edit {
            None => Arc::ptr_eq(data.model(), &self.model),
            Some(_) => data.model().is_same_structure(&self.model),
        };
        if !fits {
            *data = Data::new(self.model.clone())?;
        }
        if let Some(edit) = edit {
            data.edit_model(|model| {
                restore(model, &self.model);
                edit(index, model)
            })??;
        }
        restart(data)
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Data>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Workers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Workers: {} idle, of {:?}", self.idle().len(), self.model)
    }
}

/// Undoes all edits, without a copy of what none can have changed.
fn restore(model: &mut ModelMut<'_>, pristine: &Model) {
    model.restore_arrays(pristine);
    let (to, from) = (model.raw_mut(), pristine.raw());
    (to.opt, to.vis, to.stat) = (from.opt, from.vis, from.stat);
}
