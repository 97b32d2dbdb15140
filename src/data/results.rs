//! Time, energy, and validity of the computed results.

#[cfg(engine_since = "2.3.0")]
use super::PipelineFlags;
use super::{Data, MissingResults, Stage};
use crate::error::{Error, Result};
#[cfg(engine_since = "2.3.0")]
use crate::ffi;

/// # Time, energy and validity of results
impl Data {
    /// Sets the simulated time, s.
    #[inline]
    pub fn set_time(&mut self, time: f64) {
        self.raw_mut().time = time;
    }

    /// Returns the potential and kinetic energy, J. [`forward`](Self::forward),
    /// [`step`](Self::step) and [`inverse`](Self::inverse) compute them while
    /// [`EnableFlags::ENERGY`](crate::model::EnableFlags::ENERGY) is set, and with engines since
    /// 3.3 also for sensors of energy. Without both they are zero after a reset. If the flag is
    /// cleared later, the values are stale.
    pub fn energy(&self) -> [f64; 2] {
        self.raw().energy
    }

    /// Returns the last stage whose results are all valid.
    #[inline]
    pub fn stage(&self) -> Stage {
        self.computed.stage()
    }

    /// Returns an error unless these results have been computed for the present model: the results
    /// of a [`Stage`], or of a constant of [`MissingResults`].
    ///
    /// The getters of plain arrays such as [`xpos`](Self::xpos) and
    /// [`sensordata`](Self::sensordata) return slices of the engine's memory without a check.
    /// Before the first [`forward`](Self::forward) these arrays are zero, and after a change of the
    /// model they hold stale values. Call this method before a loop that reads them, or inside: it
    /// costs a comparison of two integers.
    ///
    /// Results count as computed until a reset, a change of the model, or a new computation of the
    /// quantities that they depend on. After [`step`](Self::step) they belong to the state before
    /// the step. Writes to the arrays, for example through [`qpos_mut`](Self::qpos_mut), are not
    /// tracked: call `forward` after them.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] with the call that computes the results, [`Error::Poisoned`] after an
    /// engine error.
    ///
    /// ```
    /// use mujoco_safe::data::MissingResults;
    /// use mujoco_safe::{Data, Error, Stage, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// assert!(matches!(data.require(Stage::Position), Err(Error::NotComputed { .. })));
    /// data.step()?;
    /// data.require(Stage::Acceleration)?;
    /// data.require(MissingResults::SENSORS)?;
    /// // A step does not compute the forces on bodies.
    /// assert!(data.require(MissingResults::BODY_FORCES).is_err());
    /// data.rne_post_constraint()?;
    /// data.require(MissingResults::BODY_FORCES)?;
    /// println!("{:?}", data.cfrc_ext());
    /// # Ok::<(), Error>(())
    /// ```
    #[inline]
    pub fn require(&self, needs: impl Into<MissingResults>) -> Result<()> {
        self.check_usable()?;
        match needs.into().not_in(self.computed) {
            None => Ok(()),
            Some(missing) => Err(Error::NotComputed { call: "Data::require", missing }),
        }
    }
}

// Since 2.3 the engine allocates the arrays of the constraints again in each computation.
#[cfg(engine_since = "2.3.0")]
impl Data {
    /// Returns the number of rows of an array that the engine has written if these results are
    /// valid, else zero.
    #[inline]
    pub(crate) fn rows_after(&self, results: PipelineFlags, rows: usize) -> usize {
        if self.computed.contains(results) { rows } else { 0 }
    }

    /// Returns the same for an array that the engine writes only if the constraint Jacobian is
    /// sparse.
    pub(crate) fn rows_of_sparse(&self, results: PipelineFlags, rows: usize) -> usize {
        if self.model.is_sparse() { self.rows_after(results, rows) } else { 0 }
    }

    /// Returns the number of stored elements of the constraint Jacobian, if the engine allocates no
    /// more for a sparse one. Allocated dense rows
    /// without elements are not used.
    #[cfg(engine_since = "2.3.3")]
    pub(crate) fn jacobian_len(&self) -> usize {
        if !self.model.is_sparse() {
            return self.nefc() * self.model.nv();
        }
        // SAFETY: a valid simulation, of which the function reads a size.
        ffi::size(unsafe { mujoco_sys::adapted::jacobian_elements(self.as_ptr()) })
    }
}
