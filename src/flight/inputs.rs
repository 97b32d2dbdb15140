//! The values on which a call depends besides the model, and the calls.

use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::model::Model;

/// Method of [`Data`] that a recording repeats.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Call {
    Step,
    Step1,
    Step2,
    Forward,
}

impl Call {
    const ALL: [Self; 4] = [Self::Step, Self::Step1, Self::Step2, Self::Forward];

    /// Returns the number of the call in files.
    pub(super) fn code(self) -> u8 {
        self as u8
    }

    pub(super) fn of_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

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

/// Returns the number of values.
pub(super) fn count(model: &Model) -> usize {
    let equalities = if cfg!(engine_since = "3.0.0") { model.neq() } else { 0 };
    model.state_size(StateSpec::INTEGRATION) + equalities
}

/// Reads the values, into the present memory if it suffices.
#[inline]
pub(super) fn read(data: &Data, values: &mut Vec<f64>) {
    values.resize(count(data.model()), 0.0);
    let (state, _equalities) = values.split_at_mut(data.model().state_size(StateSpec::INTEGRATION));
    data.state_into(StateSpec::INTEGRATION, state).expect("Bug: a state has the length of the model's");
    #[cfg(engine_since = "3.0.0")]
    for (value, &active) in _equalities.iter_mut().zip(data.active_equalities()) {
        *value = active.into();
    }
}

/// Sets the values.
pub(super) fn write(data: &mut Data, values: &[f64]) -> Result<()> {
    let (state, _equalities) = values.split_at(data.model().state_size(StateSpec::INTEGRATION));
    data.set_state(StateSpec::INTEGRATION, state)?;
    #[cfg(engine_since = "3.0.0")]
    data.set_active_equalities(_equalities.iter().map(|&value| value != 0.0));
    Ok(())
}
