//! A new model for a batch, which keeps the states of its simulations.

use super::Batch;
use super::worker::move_callbacks;
use crate::data::Data;
use crate::error::Result;
use crate::model::{Adoption, IntoModel, Survivors};
use crate::parallel::Pool;

/// # Another model
impl Batch<'_> {
    /// Gives all simulations another model and keeps the state of the elements that are in both, as
    /// [`Data::adopt`] does. Returns the elements that are only in one of the models.
    ///
    /// Simulations that have failed remain failed. Each keeps its episode, its controls and its
    /// [callbacks](Data::set_callbacks), and its equality constraints remain active or not. Other
    /// edits of its model are undone, and the counters of warnings start at zero.
    ///
    /// Observations are the physics state again and there are no parameters, because those of the
    /// old model may have its ids and its sizes. Set them by
    /// [`with_observations`](Self::with_observations) and
    /// [`with_parameters`](Self::with_parameters), as for a new batch.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new). The batch is unchanged then.
    ///
    /// ```
    /// use mujoco_safe::rollout::Batch;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/cartpole.xml");
    /// let mut spec = Spec::from_xml_path(path)?;
    /// let mut batch = Batch::new(spec.compile()?, 8)?;
    /// batch.step(|_, controls| controls.as_mut_slice().fill(1.0))?;
    ///
    /// spec.section_mut("option")?.set("gravity", [0.0, 0.0, -1.62])?;
    /// batch.adopt(spec.compile()?)?;
    /// let mut batch = batch.with_observations(1, |data, row| row[0] = data.qpos()[1]);
    /// batch.step(|_, _| ())?;
    /// assert_eq!(batch.data(7)?.time(), 0.02);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn adopt(&mut self, model: impl IntoModel) -> Result<Adoption> {
        let model = model.into_model();
        let old_model = self.model().clone();
        let survivors = Survivors::of(&old_model, &model);
        let mut new = Self::new(&model, self.len())?;
        new.chunk = self.chunk;
        let simulations = Pool::new(old_model.clone(), |model| Data::new(model));
        let old = &*self;
        new.try_each(|index, member| {
            let mut lease = simulations.lease();
            let source = lease.get()?;
            old.load(index, source)?;
            member.edit(|data| {
                data.keep_state(source, &survivors)?;
                // A batch keeps the activity of constraints as edits of the model.
                let active = data.active_equalities().to_vec();
                for (equality, (&active, &initial)) in active.iter().zip(model.equality_active()).enumerate() {
                    if active != initial {
                        data.set_equality_active(equality, active != 0)?;
                    }
                }
                Ok(())
            })
        })?;
        for (row, old_row) in new.rows.iter_mut().zip(&mut self.rows) {
            (row.failure, row.episode) = (old_row.failure.take(), old_row.episode);
            move_callbacks(&mut old_row.overrides, &mut row.overrides);
        }
        (new.first_index, new.substeps) = (self.first_index, self.substeps);
        new.common.refresh = self.common.refresh;
        new.observe_all();
        *self = new;
        Ok(Adoption::of(&survivors, &old_model, &model))
    }
}
