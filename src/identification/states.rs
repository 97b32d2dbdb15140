//! Physics states and their differences in tangent coordinates.

use super::plan::Plan;
use crate::data::StateSpec;
use crate::error::Result;
use crate::model::Model;

/// Writes the difference between two physics states, `(2 nv + na)`.
pub(super) fn difference(model: &Model, from: &[f64], to: &[f64], result: &mut [f64]) -> Result<()> {
    let (nq, nv) = (model.nq(), model.nv());
    model.differentiate_pos_into(1.0, &from[..nq], &to[..nq], &mut result[..nv])?;
    for (result, (from, to)) in result[nv..].iter_mut().zip(from[nq..].iter().zip(&to[nq..])) {
        *result = to - from;
    }
    Ok(())
}

/// Moves a physics state by a tangent vector.
pub(super) fn move_state(model: &Model, state: &mut [f64], by: &[f64]) -> Result<()> {
    let (nq, nv) = (model.nq(), model.nv());
    model.integrate_pos(&mut state[..nq], &by[..nv], 1.0)?;
    state[nq..].iter_mut().zip(&by[nv..]).for_each(|(value, by)| *value += by);
    Ok(())
}

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
        difference(model, &state, guess.values().row(after), &mut change)?;
        for value in &mut change {
            *value *= part;
        }
        move_state(model, &mut state, &change)?;
    }
    Ok(state)
}

/// Returns the coordinates in which a state at the start is uncertain: the index among them, the
/// difference from the state that was given, and the standard deviation.
pub(super) fn first_errors(plan: &Plan, state: &[f64]) -> Result<impl Iterator<Item = (usize, f64, f64)>> {
    let experiment = &plan.experiment;
    let mut error = vec![0.0; experiment.uncertainty.len()];
    if !plan.free.is_empty() {
        difference(&experiment.model, &first_state(plan, 0)?, state, &mut error)?;
    }
    let deviations = plan.free.iter().map(|&index| (error[index], experiment.uncertainty[index])).collect::<Vec<_>>();
    Ok(deviations.into_iter().enumerate().map(|(place, (error, deviation))| (place, error, deviation)))
}
