//! Several simulations: ghosts beside a simulation, and batches.

use super::state::BATCH;
use super::{LivePage, Tick};
use crate::data::StateSpec;
use crate::error::{Error, InvalidKind, Result};
use crate::matrix::MatrixView;
use crate::rollout::Batch;

/// # Several simulations
impl LivePage {
    /// Sets the states that the page shows beside the simulation as ghosts, until the next call:
    /// for example those of a batch, or at the end of the plans of a controller. A row of `states`
    /// is a state vector of `spec`. [`LiveOptions::ghosts`](super::LiveOptions::ghosts) limits the
    /// number of rows that are shown.
    ///
    /// The states are copied, and their poses are computed in a tick in which a browser waits for
    /// them. A state without poses, such as one with NaN, is not drawn. A call with the same number
    /// of rows as the one before does not allocate.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for rows of another length, and [`Error::Invalid`] for a specification
    /// without [`StateSpec::QPOS`].
    ///
    /// ```
    /// use mujoco_safe::live::{LiveOptions, LivePage};
    /// use mujoco_safe::rollout::Rollout;
    /// use mujoco_safe::{Data, MatrixView, StateSpec, ZeroController, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut page = LivePage::bind(data.model(), &LiveOptions::default())?;
    /// // Half a second ahead without control, in five places.
    /// let ahead = Rollout::new(data.model(), 1, 50)
    ///     .with_initial_state(StateSpec::INTEGRATION, &data.state(StateSpec::INTEGRATION))
    ///     .with_recorded_states(StateSpec::QPOS)
    ///     .run()?;
    /// let places = (1..=5).flat_map(|place| ahead.state(0, 10 * place));
    /// let places: Vec<f64> = places.copied().collect();
    /// let places = MatrixView::from_row_major(5, data.model().nq(), &places);
    /// page.set_ghosts(StateSpec::QPOS, places)?;
    /// page.step(&mut data, &mut ZeroController)?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn set_ghosts(&mut self, spec: StateSpec, states: MatrixView<'_>) -> Result<()> {
        if !spec.contains(StateSpec::QPOS) {
            let expected = "one with StateSpec::QPOS";
            return Err(Error::invalid(InvalidKind::Unsuitable, "the states of ghosts", format!("{spec:?}"), expected));
        }
        let width = self.states.model.state_size(spec);
        Error::check_shape("the states of ghosts", states.shape(), (states.nrows(), width))?;
        self.states.set_ghosts(spec, states);
        Ok(())
    }

    /// Shows the simulations of a batch, and carries out the users' requests. Call it before each
    /// step of the batch, and step only if [`Tick::advance`] is set. The first simulation is drawn
    /// in full and the next [`LiveOptions::ghosts`](super::LiveOptions::ghosts) as ghosts; a user
    /// can choose another one, see them side by side, or hide the ghosts.
    ///
    /// A reset restores the states of the first call as a new episode, and [`Tick::reset`] lets the
    /// program change them. The page neither pulls nor holds controls. Poses are computed only in a
    /// tick in which a browser waits for a state, in the calling thread.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a batch of another model, and the errors of
    /// [`Batch::reset_where`].
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use mujoco_safe::live::{LiveOptions, LivePage};
    /// use mujoco_safe::{Batch, sample};
    ///
    /// let mut batch = Batch::new(sample::cartpole(), 16)?;
    /// let mut page = LivePage::bind(batch.model(), &LiveOptions::default())?;
    /// println!("open {}", page.url());
    /// for _ in 0..100 {
    ///     if page.exchange_batch(&mut batch)?.advance {
    ///         batch.step(|_, controls| controls.as_mut_slice().fill(0.1))?;
    ///     } else {
    ///         page.wait(Duration::from_millis(20));
    ///     }
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn exchange_batch(&mut self, batch: &mut Batch<'_>) -> Result<Tick> {
        if !self.states.model.is_same_structure(batch.model()) {
            return Err(Error::OtherModel { what: "the batch of a live page" });
        }
        if self.start.nrows() != batch.len() {
            self.start = batch.states().to_matrix();
        }
        self.site.slots.take(&mut self.requests);
        self.requests.let_go();
        self.pause_and_step();
        if self.requests.reset {
            let start = &self.start;
            batch.reset_where(|_| true, |index, _, data| data.set_state(StateSpec::INTEGRATION, start.row(index)))?;
        }
        let advance = self.advances(true);
        if self.site.slots.is_wanted(self.published) {
            let shown = self.states.collect_batch(batch);
            let failure = batch.failures().next().map(|(index, error)| format!("simulation {index}: {error}"));
            self.publish(BATCH, failure.or(shown.err().map(|error| error.to_string())));
        }
        Ok(Tick { advance, reset: self.requests.reset })
    }
}
