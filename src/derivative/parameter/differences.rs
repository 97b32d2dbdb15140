//! Differences by parameters without a formula.
//!
//! At a fixed state, parameters are varied in a copy of the model. Where the closed form of a step
//! applies, its residual at constant accelerations is differenced, which needs no solver; otherwise
//! complete steps. Two central differences, with steps h and 2h, are extrapolated to an error of
//! order h⁴; next to the end of the valid range three to the right, to an error of order h³.

use std::sync::Arc;

use super::{Effect, Resolved};
use crate::data::{Data, SensorUpdate, Stage, StateSpec};
use crate::derivative::actuation::next_activation;
use crate::derivative::kinks::Scale;
use crate::derivative::method::Kinks;
use crate::derivative::residual::{Residual, multiply_inertia};
use crate::derivative::{InverseForce, columns};
use crate::error::Result;
use crate::model::{Model, ModelMut};
use crate::numerics::linear_algebra::{add, quotient};

/// Step relative to the value, the same for small numbers without a unit, and the factor for
/// complete steps, whose solver has a tolerance.
const STEP: f64 = 1e-4;
const RELATIVE_STEP: f64 = 1e-3;
const FACTOR_OF_STEPS: f64 = 10.0;

/// Least magnitude of a value to which the step is relative, for lengths, masses and the like.
const LEAST: f64 = 0.1;

/// Factors of the step that are tried until differences agree.
const TRIALS: [f64; 3] = [1.0, 0.1, 0.01];

/// Largest disagreement of differences with a step and its double, as a multiple of that of a kink,
/// with which they are not repeated. Those of a smooth function differ by the square of the step. A
/// kink between them makes an error of the size of the disagreement.
const SMOOTH: f64 = 0.005;

/// Differences of a function by one number.
struct Stencil {
    /// Samples, as multiples of the step.
    offsets: &'static [f64],
    /// Pairs of samples between which there are slopes, and the factors of the slopes in the
    /// extrapolated one.
    slopes: [(usize, usize, f64); 3],
}

/// Central differences. The last slope, to the right, is compared with the first, on both sides.
const CENTRAL: Stencil =
    Stencil { offsets: &[-2.0, -1.0, 1.0, 2.0, 0.0], slopes: [(1, 2, 4.0 / 3.0), (0, 3, -1.0 / 3.0), (4, 2, 0.0)] };
const RIGHT: Stencil = Stencil { offsets: &[0.0, 1.0, 2.0, 3.0], slopes: [(0, 1, 3.0), (0, 2, -3.0), (0, 3, 1.0)] };

/// Function that writes a sample of the simulation with the varied model, given the change of the
/// parameter.
type Evaluation<'a> = dyn FnMut(&mut Data, f64, &mut [f64]) -> Result<()> + 'a;

/// Differences at a base point.
#[derive(Debug)]
pub(in crate::derivative) struct ParameterDifferences {
    /// [`StateSpec::INTEGRATION`] and accelerations at the base point.
    state: Vec<f64>,
    accelerations: Vec<f64>,
    varied: Varied,
}

/// A simulation whose model is varied.
#[derive(Debug)]
struct Varied {
    data: Data,
    /// Model to which the numbers of the copy are restored.
    source: Arc<Model>,
    samples: [Vec<f64>; 5],
    slopes: [Vec<f64>; 3],
}

impl ParameterDifferences {
    pub(super) fn new(data: &Data) -> Result<Self> {
        let model = data.model();
        Ok(Self {
            state: vec![0.0; model.state_size(StateSpec::INTEGRATION)],
            accelerations: vec![0.0; model.nv()],
            varied: Varied {
                data: Data::new(model.clone())?,
                source: model.clone(),
                samples: Default::default(),
                slopes: Default::default(),
            },
        })
    }

    /// Moves to the present state and accelerations of a simulation, and adopts its model.
    pub(super) fn set_base(&mut self, data: &Data) -> Result<()> {
        let varied = &mut self.varied;
        if !Arc::ptr_eq(&varied.source, data.model()) {
            varied.data.clone_from(data);
            varied.source = data.model().clone();
        }
        data.state_into(StateSpec::INTEGRATION, &mut self.state)?;
        self.accelerations.copy_from_slice(data.qacc());
        Ok(())
    }

    /// Differences the residual, `M w`, and the next activations: `[∂g; ∂(M w); ∂act']`.
    pub(in crate::derivative) fn of_residual(
        &mut self,
        resolved: &Resolved,
        spread: &[f64],
        result: &mut Vec<f64>,
    ) -> Result<Kinks> {
        let Self { state, accelerations, varied } = self;
        let (nv, na) = (varied.source.nv(), varied.source.na());
        varied.difference(resolved, false, 2 * nv + na, result, &mut |data, _, sample| {
            compute_forces(data, state, |dof| accelerations[dof])?;
            let (residual, rest) = sample.split_at_mut(nv);
            let (inertial, activations) = rest.split_at_mut(nv);
            Residual::of(data).evaluate(data, residual)?;
            multiply_inertia(data, inertial, spread);
            let model = data.model();
            for actuator in 0..model.nactuator() {
                if let Some(activation) = model.activation_of(actuator) {
                    activations[activation] = next_activation(model, data, actuator, activation);
                }
            }
            Ok(())
        })
    }

    /// Differences the sensors, while the accelerations change by `−X` times the change.
    pub(in crate::derivative) fn of_sensors(
        &mut self,
        resolved: &Resolved,
        deceleration: impl Fn(usize) -> f64,
        result: &mut Vec<f64>,
    ) -> Result<Kinks> {
        let Self { state, accelerations, varied } = self;
        varied.difference(resolved, false, varied.source.nsensordata(), result, &mut |data, change, sample| {
            compute_forces(data, state, |dof| accelerations[dof] - change * deceleration(dof))?;
            data.sensor_acc()?;
            sample.copy_from_slice(data.sensordata());
            Ok(())
        })
    }

    /// Differences a complete step: the next state, and the sensors.
    pub(in crate::derivative) fn of_step(&mut self, resolved: &Resolved, result: &mut Vec<f64>) -> Result<Kinks> {
        let Self { state, varied, .. } = self;
        let model = &varied.source;
        let (nq, nv) = (model.nq(), model.nv());
        let length = nq + nv + model.na() + model.nsensordata();
        let kinks = varied.difference(resolved, true, length, result, &mut |data, _, sample| {
            data.set_state(StateSpec::INTEGRATION, state)?;
            data.step_for_differences()?;
            columns::sample(data, sample);
            Ok(())
        });
        // With quaternions the result is shorter than the samples.
        result.truncate(length - (nq - nv));
        kinks
    }

    /// Differences the forces of inverse dynamics.
    pub(in crate::derivative) fn of_inverse(
        &mut self,
        resolved: &Resolved,
        force: InverseForce,
        result: &mut Vec<f64>,
    ) -> Result<Kinks> {
        let Self { state, accelerations, varied } = self;
        varied.difference(resolved, false, varied.source.nv(), result, &mut |data, _, sample| {
            data.set_state(StateSpec::INTEGRATION, state)?;
            data.qacc_mut().copy_from_slice(accelerations);
            data.inverse_skip(Stage::None, SensorUpdate::Skip)?;
            sample.copy_from_slice(data.qfrc_inverse());
            if force == InverseForce::WithoutActuators {
                data.fwd_actuation()?;
                sample.iter_mut().zip(data.qfrc_actuator()).for_each(|(total, actuator)| *total -= actuator);
            }
            Ok(())
        })
    }
}

impl Varied {
    /// Differences samples of a length by a parameter. Those of a complete step begin with
    /// positions, whose differences are in tangent coordinates.
    fn difference(
        &mut self,
        resolved: &Resolved,
        is_step: bool,
        length: usize,
        result: &mut Vec<f64>,
        evaluate: &mut Evaluation<'_>,
    ) -> Result<Kinks> {
        for buffer in self.samples.iter_mut().chain(&mut self.slopes).chain([&mut *result]) {
            buffer.clear();
            buffer.resize(length, 0.0);
        }
        let outcome = self.try_difference(resolved, is_step, result, evaluate);
        let restored = self.set(resolved, None);
        let kinks = outcome?;
        restored.map(|()| kinks)
    }

    fn try_difference(
        &mut self,
        resolved: &Resolved,
        is_step: bool,
        result: &mut [f64],
        evaluate: &mut Evaluation<'_>,
    ) -> Result<Kinks> {
        let (mut best_score, mut least) = (f64::INFINITY, f64::INFINITY);
        for trial in TRIALS {
            let step = if is_step { FACTOR_OF_STEPS } else { 1.0 } * trial * resolved.step();
            let is_central = !resolved.is_bounded || resolved.value >= 2.0 * step;
            let Stencil { offsets, slopes } = if is_central { CENTRAL } else { RIGHT };
            for (sample, offset) in offsets.iter().enumerate() {
                let change = offset * step;
                self.set(resolved, Some(resolved.value + change))?;
                evaluate(&mut self.data, change, &mut self.samples[sample])?;
            }
            for (slope, (from, to, _)) in self.slopes.iter_mut().zip(slopes) {
                let width = (offsets[to] - offsets[from]) * step;
                let (from, to) = (&self.samples[from], &self.samples[to]);
                if is_step {
                    columns::difference(&self.source, slope, from, to, width)?;
                } else {
                    quotient(slope, from, to, width);
                }
            }
            let [first, second, third] = &self.slopes;
            let scale = Scale::of(first.iter().copied());
            let worst_of = |one: &[f64], other: &[f64]| {
                let pairs = one.iter().zip(other);
                pairs.map(|(one, other)| scale.disagreement(one - other, *one)).fold(0.0, f64::max)
            };
            let between = worst_of(first, second);
            let mut worst = between;
            if is_central {
                // The derivative to the right differs from the mean of both sides by half as much.
                worst = worst.max(2.0 * worst_of(first, third));
            }
            let score = worst.max(between / SMOOTH);
            if score < best_score || best_score.is_infinite() {
                (best_score, least) = (score, worst);
                result.fill(0.0);
                for (slope, (.., factor)) in self.slopes.iter().zip(slopes) {
                    add(result, slope, factor);
                }
            }
            if score <= 1.0 {
                break;
            }
        }
        Ok(if least <= 1.0 { Kinks::empty() } else { Kinks::DIFFERENCES })
    }

    /// Restores the numbers that a parameter changes, and writes a value.
    fn set(&mut self, resolved: &Resolved, value: Option<f64>) -> Result<()> {
        let source = &self.source;
        self.data.edit_model(|model| {
            resolved.parameter.restore(source, model)?;
            if let Some(value) = value {
                resolved.parameter.write(model, value)?;
            }
            resolved.update_inertia(source, model)
        })
    }
}

impl Resolved {
    /// Updates the masses of subtrees, and the inertias of bodies that move independently, which
    /// engines take from derived constants. Other constants on which a step depends keep their
    /// values.
    fn update_inertia(&self, source: &Model, model: &mut ModelMut<'_>) -> Result<()> {
        let changes_inertia = matches!(self.effect, Effect::Inertial { .. } | Effect::Armature(_));
        if !changes_inertia {
            return Ok(());
        }
        model.update_constants()?;
        model.body_invweight0_mut().copy_from_slice(source.body_invweight0());
        model.dof_invweight0_mut().copy_from_slice(source.dof_invweight0());
        model.tendon_invweight0_mut().copy_from_slice(source.tendon_invweight0());
        model.actuator_acc0_mut().copy_from_slice(source.actuator_acc0());
        Ok(())
    }

    /// Returns the step of the differences.
    fn step(&self) -> f64 {
        let size = self.value.abs();
        if self.is_relative && size > 0.0 { RELATIVE_STEP * size } else { STEP * size.max(LEAST) }
    }
}

/// Computes all forces at a state and accelerations.
fn compute_forces(data: &mut Data, state: &[f64], acceleration: impl Fn(usize) -> f64) -> Result<()> {
    data.set_state(StateSpec::INTEGRATION, state)?;
    data.qacc_mut().iter_mut().enumerate().for_each(|(dof, value)| *value = acceleration(dof));
    Residual::of(data).update_forces(data, true, true)
}
