//! Columns of controls and activations of `mjd_transitionFD` with an implicit integrator.
//!
//! For these columns the engine before 4.0 keeps the matrix of the integrator. A control or an
//! activation changes it if the gain of its actuator depends on the velocity, as for a damper.

use super::columns::difference;
use super::{Differences, TransitionOutputs, sizes};
use crate::data::{Data, StateSpec};
use crate::enums::{ActuatorGain, Integrator};
use crate::error::Result;
use crate::model::Model;

impl Data {
    /// Replaces columns that the engine computes with a wrong matrix by differences of complete
    /// steps.
    pub(super) fn correct_input_columns(
        &mut self,
        eps: f64,
        differences: Differences,
        outputs: &mut TransitionOutputs<'_>,
    ) -> Result<()> {
        if !inputs_change_matrix(self.model()) {
            return Ok(());
        }
        let model = self.model().clone();
        let (nx, nu, ny) = sizes(&model);
        let start = self.state(StateSpec::INTEGRATION);
        let (base, mut column) = (self.sample(&start, |_| ())?, vec![0.0; nx + ny]);
        for index in 0..nu + model.na() {
            let (state, sensors, at) = match index.checked_sub(nu) {
                None => (&mut outputs.b, &mut outputs.d, index),
                Some(activation) => (&mut outputs.a, &mut outputs.c, 2 * model.nv() + activation),
            };
            if state.is_none() && sensors.is_none() {
                continue;
            }
            let nudge = |by: f64| {
                move |data: &mut Self| match index.checked_sub(nu) {
                    None => data.ctrl_mut()[index] += by,
                    Some(activation) => data.act_mut()[activation] += by,
                }
            };
            let is_inside = |by: f64| index >= nu || self.can_perturb(index, by);
            let right = is_inside(eps);
            let left = (differences == Differences::Central || !right) && is_inside(-eps);
            let to = if right { self.sample(&start, nudge(eps))? } else { base.clone() };
            let from = if left { self.sample(&start, nudge(-eps))? } else { base.clone() };
            difference(&model, &mut column, &from, &to, if left && right { 2.0 * eps } else { eps })?;
            for (output, values) in [(state, &column[..nx]), (sensors, &column[nx..])] {
                if let Some(output) = output {
                    values.iter().enumerate().for_each(|(row, &value)| output[(row, at)] = value);
                }
            }
        }
        self.set_state(StateSpec::INTEGRATION, &start)
    }

    /// Returns `[qpos; qvel; act; sensordata]` after a step from a changed state.
    fn sample(&mut self, start: &[f64], change: impl FnOnce(&mut Self)) -> Result<Vec<f64>> {
        self.set_state(StateSpec::INTEGRATION, start)?;
        change(self);
        self.step_for_differences()?;
        Ok([&self.physics_state(), self.sensordata()].concat())
    }
}

/// Returns `true` if a control or an activation can change the matrix of the integrator, and the
/// engine neglects this.
fn inputs_change_matrix(model: &Model) -> bool {
    let depends_on_velocity = |actuator: usize| match ActuatorGain::of_field(model.actuator_gaintype()[actuator]) {
        ActuatorGain::Fixed => false,
        ActuatorGain::Affine => model.actuator_gainprm()[actuator][2] != 0.0,
        _ => true,
    };
    cfg!(not(engine_since = "4.0.0"))
        && [Integrator::Implicit, Integrator::ImplicitFast].contains(&model.options().integrator)
        && (0..model.actuator_gaintype().len()).any(depends_on_velocity)
}
