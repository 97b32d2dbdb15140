//! The states at the starts of segments.

use super::plan::Plan;
use crate::data::StateSpec;
use crate::error::Result;

/// Returns the first guess of the physics state at the start of a segment.
pub(super) fn first_state(plan: &Plan, segment: usize) -> Result<Vec<f64>> {
    let experiment = &plan.experiment;
    let model = &experiment.model;
    let guess = match &experiment.guess {
        Some(guess) if segment > 0 => guess,
        _ => return model.extract_state(&experiment.start, StateSpec::INTEGRATION, StateSpec::PHYSICS),
    };
    let time = plan.time(plan.nodes[segment]);
    let times = guess.times();
    let after = times.partition_point(|&sample| sample <= time);
    let before = after.saturating_sub(1);
    let mut state = guess.values().row(before).to_vec();
    model.normalize_quat(&mut state[..model.nq()])?;
    if after > 0 && after < times.len() {
        let part = (time - times[before]) / (times[after] - times[before]);
        let mut change = vec![0.0; experiment.uncertainty.len()];
        model.differentiate_state_into(&state, guess.values().row(after), &mut change)?;
        for value in &mut change {
            *value *= part;
        }
        model.integrate_state(&mut state, &change)?;
    }
    Ok(state)
}
