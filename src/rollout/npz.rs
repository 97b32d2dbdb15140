//! Results of rollouts as NumPy archives (`.npz`).

use std::path::Path;

use super::RolloutResult;
use crate::error::Result;
use crate::npz::{self, Array};

impl RolloutResult {
    /// Writes the results as a NumPy archive (`.npz`), which Python reads with `numpy.load`. It
    /// contains the arrays
    ///
    /// | name | shape | values |
    /// |---|---|---|
    /// | `states` | `(nroll, nstep + 1, nstate)` | [`states`](Self::states) |
    /// | `sensordata` | `(nroll, nstep, nsensordata)` | [`sensordata`](Self::sensordata) |
    /// | `outputs` | `(nroll, nstep, noutput)` | [`outputs`](Self::outputs) |
    /// | `completed` | `(nroll)` | `True` if the [outcome](Self::outcomes) of the rollout is `Ok` |
    /// | `steps` | `(nroll)` | number of steps taken: `nstep` if completed, else the number in the [error](super::RolloutError::step) |
    ///
    /// All numbers have double precision, except for `completed` (`bool`) and `steps` (`int64`).
    /// The rows after the last step of a rollout are NaN.
    ///
    /// Requires the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written; an existing file is then
    /// unchanged.
    ///
    /// ```
    /// use mujoco_safe::rollout::Rollout;
    /// use mujoco_safe::{RandomController, sample};
    ///
    /// let result = Rollout::new(sample::cartpole(), 8, 100)
    ///     .with_controllers(|index| RandomController::new(index as u64))
    ///     .run()?;
    /// let path = std::env::temp_dir().join("mujoco_safe_rollouts.npz");
    /// result.save_npz(&path)?;
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// ```python
    /// result = numpy.load("mujoco_safe_rollouts.npz")
    /// states = result["states"][result["completed"]]  # without the failed rollouts
    /// states[:, -1, 1].std()                          # of the final angle of the pole
    /// ```
    #[doc(alias = "savez")]
    pub fn save_npz(&self, path: impl AsRef<Path>) -> Result<()> {
        let (nroll, nstep) = (self.len(), self.steps());
        let completed: Vec<bool> = self.outcomes.iter().map(Result::is_ok).collect();
        let taken = |outcome: &std::result::Result<(), super::RolloutError>| match outcome {
            Ok(()) => nstep as i64,
            Err(error) => error.step() as i64,
        };
        let steps: Vec<i64> = self.outcomes.iter().map(taken).collect();
        npz::save(
            path,
            &[
                Array::new("states", &[nroll, nstep + 1, self.sizes.state], &self.states),
                Array::new("sensordata", &[nroll, nstep, self.sizes.sensordata], &self.sensordata),
                Array::new("outputs", &[nroll, nstep, self.sizes.output], &self.outputs),
                Array::new("completed", &[nroll], &completed),
                Array::new("steps", &[nroll], &steps),
            ],
        )
    }
}
