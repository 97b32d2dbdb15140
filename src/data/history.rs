//! Buffers of the delays of actuators and sensors, since 3.5.
//!
//! A buffer with `n` samples of `dim` numbers has the layout
//! `[user, cursor, times (n), values (n × dim)]`. The engine converts the cursor to the index of
//! the newest sample without a check. Safe code therefore changes the buffers only through
//! [`Data::set_state`], which checks the cursors. Any other value is safe: the engine searches the
//! times within the buffer, also if they are not in order.

use mujoco_sys::adapted;

use super::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::model::Model;

/// Kind of elements that have buffers, and for each element the number of samples and the
/// interpolation, and the address.
type Buffers<'a> = (&'static str, &'a [[i32; 2]], &'a [i32]);

impl Data {
    /// Returns the buffers of all delays.
    pub(super) fn history_values(&self) -> &[f64] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::history(self.as_ptr()), self.model().history_len()) }
    }

    /// Returns the buffers of all delays for writing. The caller checks them with
    /// [`Model::check_history`].
    pub(super) fn history_values_mut(&mut self) -> &mut [f64] {
        let length = self.model().history_len();
        // SAFETY: as above, and the data is borrowed exclusively.
        unsafe { ffi::array_mut(adapted::history(self.as_mut_ptr()), length) }
    }
}

impl Model {
    /// Returns the length of the buffers of delays, or 0 before 3.5.
    pub(crate) fn history_len(&self) -> usize {
        // SAFETY: a valid model, of which the function reads a size.
        ffi::size(unsafe { adapted::history_len(self.as_ptr()) })
    }

    /// Returns `true` if a sensor has a buffer of earlier samples.
    pub(crate) fn has_history(&self, sensor: usize) -> bool {
        #[cfg(engine_since = "3.5.0")]
        {
            self.sensor_history()[sensor][0] > 0
        }
        #[cfg(not(engine_since = "3.5.0"))]
        {
            assert!(sensor < self.nsensor(), "Bug: sensor {sensor} of {}", self.nsensor());
            false
        }
    }

    /// Returns [`Error::Unsupported`] for a model with delays, whose states of earlier steps a
    /// linear system of one step does not contain.
    pub(super) fn check_without_delays(&self, call: &str) -> Result<()> {
        if self.history_len() == 0 {
            return Ok(());
        }
        Err(Error::Unsupported(format!(
            "{call} of a model with buffers of samples (nsample) for delays of actuators or sensors"
        )))
    }

    /// Returns the buffers of actuators and sensors.
    #[cfg(engine_since = "3.5.0")]
    fn history_buffers(&self) -> [Buffers<'_>; 2] {
        [
            ("actuator", self.actuator_history(), self.actuator_historyadr()),
            ("sensor", self.sensor_history(), self.sensor_historyadr()),
        ]
    }

    #[cfg(not(engine_since = "3.5.0"))]
    #[allow(clippy::unused_self, reason = "newer engines have buffers")]
    fn history_buffers(&self) -> [Buffers<'_>; 0] {
        []
    }

    /// Checks the cursors of the buffers in `history`, which has the length
    /// [`history_len`](Self::history_len).
    pub(super) fn check_history(&self, history: &[f64]) -> Result<()> {
        for (kind, buffers, addresses) in self.history_buffers() {
            for (element, (&[samples, _], &address)) in buffers.iter().zip(addresses).enumerate() {
                if samples <= 0 {
                    continue;
                }
                let at = ffi::size(address) + 1;
                let cursor = history[at];
                if !((0.0..f64::from(samples)).contains(&cursor) && cursor.fract() == 0.0) {
                    let what = format!("history[{at}], the index of the newest sample of {kind} {element},");
                    return Err(Error::out_of_range(what, cursor, format!("a whole number from 0 to {}", samples - 1)));
                }
            }
        }
        debug_assert_eq!(history.len(), self.history_len(), "Bug: a history has the length of the model's buffers");
        Ok(())
    }
}
