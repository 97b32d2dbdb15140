//! Forward dynamics between two steps.

use crate::data::{Data, StateSpec};
use crate::error::Result;

/// Computes all quantities for the present state, without an effect on later steps. `saved` is
/// memory for the state.
///
/// [`Data::forward`] overwrites the initial guess of the constraint solver and normalises the
/// quaternions in `qpos`. The state is restored because a step that starts from other values
/// differs in the last bits.
pub(super) fn forward_between_steps(data: &mut Data, saved: &mut Vec<f64>) -> Result<()> {
    saved.resize(data.model().state_size(StateSpec::INTEGRATION), 0.0);
    data.state_into(StateSpec::INTEGRATION, saved)?;
    let result = data.forward();
    data.restore_after_forward(StateSpec::INTEGRATION, saved);
    result
}
