//! The values on which a call depends besides the model, and the calls.

use serde::{Deserialize, Serialize};

use super::change::Checksum;
use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::model::Model;

/// Method of [`Data`] that a recording repeats.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Call {
    Step,
    Step1,
    Step2,
    Forward,
}

impl Call {
    pub(super) const ALL: [Self; 4] = [Self::Step, Self::Step1, Self::Step2, Self::Forward];

    #[inline]
    pub(super) fn make(self, data: &mut Data) -> Result<()> {
        match self {
            Self::Step => data.step(),
            Self::Step1 => data.step1(),
            Self::Step2 => data.step2(),
            Self::Forward => data.forward(),
        }
    }

    /// Returns `true` if [`Step2`](Self::Step2) continues the call.
    pub(super) fn is_first_half(self) -> bool {
        matches!(self, Self::Step1 | Self::Forward)
    }
}

/// Results of earlier calls that a step reads. Before 3.0, it advances the activations with their
/// last derivatives while actuation is disabled. Since 3.5, it puts the last readings into the
/// buffers of delays while sensors are disabled.
macro_rules! earlier_results {
    ($data:expr, $act_dot:ident, $sensordata:ident) => {
        match $data.model() {
            _ if cfg!(not(engine_since = "3.0.0")) => $data.$act_dot(),
            model if model.history_len() > 0 => $data.$sensordata(),
            _ => Default::default(),
        }
    };
}

/// Returns the number of values: of the state, of [`earlier_results`], and of the equalities, which
/// can be active or not since 3.0.
pub(super) fn count(model: &Model) -> usize {
    let others = match model {
        _ if cfg!(not(engine_since = "3.0.0")) => model.na(),
        _ if model.history_len() > 0 => model.nsensordata() + model.neq(),
        _ => model.neq(),
    };
    model.state_size(StateSpec::INTEGRATION) + others
}

/// Number of equalities that are compared at a time.
#[cfg(engine_since = "3.0.0")]
const BLOCK: usize = 16;

/// Calls `each` with the place of the first value, and the values, of each part of all values.
#[inline]
pub(super) fn parts(data: &Data, mut each: impl FnMut(usize, &[f64])) {
    let mut place = 0;
    data.for_each_part(StateSpec::INTEGRATION, |_, values| {
        each(place, values);
        place += values.len();
    });
    let earlier = earlier_results!(data, act_dot, sensordata);
    each(place, earlier);
    #[cfg(engine_since = "3.0.0")]
    for (block, active) in data.active_equalities().chunks(BLOCK).enumerate() {
        let mut values = [0.0; BLOCK];
        values.iter_mut().zip(active).for_each(|(value, &active)| *value = active.into());
        each(place + earlier.len() + block * BLOCK, &values[..active.len()]);
    }
}

/// Reads the values, into the present memory if it suffices.
pub(super) fn read(data: &Data, values: &mut Vec<f64>) {
    values.clear();
    parts(data, |_, part| values.extend_from_slice(part));
}

/// Reads the values that a call has changed, and returns their checksum. `values` has those before
/// the call. Without closures, these are the components that only the engine writes.
#[inline]
pub(super) fn read_results(data: &Data, has_closures: bool, values: &mut Vec<f64>) -> u64 {
    let mut checksum = Checksum::new();
    if has_closures {
        read(data, values);
        checksum.add(values, f64::to_bits);
        return checksum.finish();
    }
    let mut rest = &mut values[..];
    let mut add = |is_result: bool, results: &[f64]| {
        let (target, after) = std::mem::take(&mut rest).split_at_mut(results.len());
        if is_result && !results.is_empty() {
            add_results(results, target, &mut checksum);
        }
        rest = after;
    };
    data.for_each_part(StateSpec::INTEGRATION, |part, results| add(!StateSpec::USER.contains(part), results));
    add(true, earlier_results!(data, act_dot, sensordata));
    checksum.finish()
}

/// One copy of these loops takes less of the processor's cache than one for each component.
#[inline(never)]
fn add_results(results: &[f64], values: &mut [f64], checksum: &mut Checksum) {
    values.copy_from_slice(results);
    checksum.add(results, f64::to_bits);
}

/// Sets the values.
pub(super) fn write(data: &mut Data, values: &[f64]) -> Result<()> {
    let (state, others) = values.split_at(data.model().state_size(StateSpec::INTEGRATION));
    data.set_state(StateSpec::INTEGRATION, state)?;
    let earlier: &mut [f64] = earlier_results!(data, act_dot_mut, sensordata_mut);
    let (results, _equalities) = others.split_at(earlier.len());
    earlier.copy_from_slice(results);
    #[cfg(engine_since = "3.0.0")]
    data.set_active_equalities(_equalities.iter().map(|&value| value != 0.0));
    Ok(())
}
