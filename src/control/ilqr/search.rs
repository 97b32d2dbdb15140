//! State of a search: the nominal trajectory, its expansion, and the regularisation.

use std::time::{Duration, Instant};

use super::backward::Backward;
use super::cost::TrajectoryCost;
use super::forward::{Forward, Trial};
use super::policy::AffinePolicy;
use super::{IlqrOptions, IlqrStatus};
use crate::data::{Data, StateSpec};
use crate::derivative::{LinearisationReport, Lineariser, StateSpace, TransitionMethod, sizes};
use crate::error::Result;
use crate::matrix::Matrix;
use crate::memory;
use crate::model::Model;

/// Smallest non-zero regularisation.
const MIN_REGULARISATION: f64 = 1e-6;
/// Regularisation above which the search ends.
const MAX_REGULARISATION: f64 = 1e10;
/// Initial factor by which the regularisation grows and shrinks.
const REGULARISATION_FACTOR: f64 = 1.6;

/// Wall-clock time of the parts of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct IlqrTimes {
    /// Simulation of the initial trajectory.
    pub initial: Duration,
    /// Linearisation of the steps, and expansion of the cost.
    pub derivatives: Duration,
    /// Backward passes.
    pub backward_pass: Duration,
    /// Simulations of the line search, with their costs.
    pub line_search: Duration,
}

impl IlqrTimes {
    /// Returns the sum of all parts.
    pub fn total(&self) -> Duration {
        self.initial + self.derivatives + self.backward_pass + self.line_search
    }
}

/// Runs `work` and adds its time to a sum.
fn timed<T>(sum: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *sum += start.elapsed();
    result
}

/// State of a search, with its buffers. A search over a receding horizon keeps it from one plan to
/// the next.
pub(in crate::control) struct Search {
    pub(in crate::control) nominal: Trial,
    pub(in crate::control) policy: AffinePolicy,
    /// Sums since they were last set to zero.
    pub(in crate::control) times: IlqrTimes,
    backward: Backward,
    /// States in which the steps start.
    starts: Matrix,
    systems: Vec<(StateSpace, LinearisationReport)>,
    regularisation: Regularisation,
}

impl Search {
    /// Creates a search over `steps` steps, which starts from zero controls and gains. Returns an
    /// error for more than there is memory for.
    pub(in crate::control) fn new(model: &Model, steps: usize, method: TransitionMethod) -> Result<Self> {
        let (nx, nu, ny) = sizes(model);
        // The linear system, the gain, and two states and controls.
        let numbers = (nx + ny) * (nx + nu) + nx * nu + 2 * (model.state_size(StateSpec::PHYSICS) + nu);
        let structs = size_of::<(StateSpace, LinearisationReport)>() + size_of::<Matrix>();
        memory::check("steps", steps, numbers * size_of::<f64>() + structs)?;
        Ok(Self {
            nominal: Trial::zeros(model, steps),
            policy: AffinePolicy::zeros(model, steps),
            times: IlqrTimes::default(),
            backward: Backward::new(model, steps),
            starts: Matrix::zeros(steps, model.state_size(StateSpec::PHYSICS)),
            systems: vec![(StateSpace::zeros(model), LinearisationReport::new(method, None)); steps],
            regularisation: Regularisation::default(),
        })
    }

    /// Moves the nominal trajectory and the gains forward by some steps. The last controls and
    /// gains are repeated.
    pub(in crate::control) fn shift(&mut self, steps: usize) {
        let shift_rows = |matrix: &mut Matrix| {
            let (rows, width) = matrix.shape();
            let (count, values) = (steps.min(rows - 1), matrix.as_mut_slice());
            values.copy_within(count * width.., 0);
            for row in rows - count..rows {
                values.copy_within((rows - count - 1) * width..(rows - count) * width, row * width);
            }
        };
        shift_rows(&mut self.nominal.states);
        shift_rows(&mut self.nominal.controls);
        shift_rows(&mut self.policy.feedforward);
        let gains = &mut self.policy.gains;
        let count = steps.min(gains.len() - 1);
        let kept = gains.len() - count;
        gains.rotate_left(count);
        let (kept, repeated) = gains.split_at_mut(kept);
        if let Some(last) = kept.last() {
            for gain in repeated {
                gain.as_mut_slice().copy_from_slice(last.as_slice());
            }
        }
    }

    /// Takes the control ranges of an edited model.
    pub(in crate::control) fn adopt_ranges(&mut self, model: &Model) {
        self.backward.adopt_ranges(model);
    }

    /// Discards the gains and the regularisation of earlier plans.
    pub(in crate::control) fn forget(&mut self) {
        self.policy.feedforward.as_mut_slice().fill(0.0);
        self.policy.gains.iter_mut().for_each(|gain| gain.as_mut_slice().fill(0.0));
        self.regularisation = Regularisation::default();
    }

    /// Simulates the nominal controls from the start of `forward`, with feedback if that lowers the
    /// cost.
    pub(in crate::control) fn restart(&mut self, cost: &dyn TrajectoryCost, forward: &mut Forward) -> Result<()> {
        timed(&mut self.times.initial, || forward.restart(&self.policy, cost, &mut self.nominal))
    }

    /// Linearises the steps and expands the cost along the trajectory.
    pub(in crate::control) fn expand(
        &mut self,
        data: &Data,
        cost: &dyn TrajectoryCost,
        lineariser: &mut Lineariser,
    ) -> Result<()> {
        let values = self.starts.as_mut_slice();
        values.copy_from_slice(&self.nominal.states.as_slice()[..values.len()]);
        timed(&mut self.times.derivatives, || {
            // The cost does not depend on the sensors.
            lineariser.along_without_sensors_into(data, &self.starts, &self.nominal.controls, &mut self.systems)?;
            self.backward.expand(&self.nominal, cost, lineariser.options().threads)
        })
    }

    /// Finds a better trajectory, and increases the regularisation until it succeeds, at most
    /// `attempts` times. If the search ends, returns the reason.
    pub(in crate::control) fn iterate(
        &mut self,
        cost: &dyn TrajectoryCost,
        forward: &mut Forward,
        options: &IlqrOptions,
        attempts: usize,
    ) -> Result<Option<IlqrStatus>> {
        let least = options.tolerance * self.nominal.cost.abs();
        let mut first_decrease = None;
        for _ in 0..attempts {
            let regularisation = self.regularisation.value;
            let decrease = timed(&mut self.times.backward_pass, || {
                self.backward.solve(&self.systems, &self.nominal, regularisation, &mut self.policy)
            })?;
            if let Some(decrease) = decrease {
                let first = *first_decrease.get_or_insert(decrease.at(1.0));
                if decrease.at(1.0) <= least && (first <= least || regularisation > MIN_REGULARISATION) {
                    // A negligible decrease without additional regularisation means convergence.
                    return Ok(Some(if first <= least { IlqrStatus::Converged } else { IlqrStatus::NoDescent }));
                }
                let before = self.nominal.cost;
                let improved = timed(&mut self.times.line_search, || {
                    forward.improve(&self.policy, decrease, options, cost, &mut self.nominal)
                })?;
                if improved {
                    self.regularisation.lower();
                    let converged = before - self.nominal.cost <= least && regularisation <= MIN_REGULARISATION;
                    return Ok(converged.then_some(IlqrStatus::Converged));
                }
            }
            if !self.regularisation.raise() {
                return Ok(Some(IlqrStatus::NoDescent));
            }
        }
        Ok(Some(IlqrStatus::NoDescent))
    }

    /// Computes the gains along the final trajectory, with as little regularisation as possible.
    pub(in crate::control) fn finish(
        &mut self,
        data: &Data,
        cost: &dyn TrajectoryCost,
        lineariser: &mut Lineariser,
    ) -> Result<()> {
        self.expand(data, cost, lineariser)?;
        let mut regularisation = Regularisation::default();
        while self.backward.solve(&self.systems, &self.nominal, regularisation.value, &mut self.policy)?.is_none() {
            if !regularisation.raise() {
                self.policy = AffinePolicy::zeros(data.model(), self.nominal.controls.nrows());
                break;
            }
        }
        Ok(())
    }
}

/// Regularisation weight with its schedule (Tassa, Erez and Todorov, 2012).
#[derive(Default)]
struct Regularisation {
    value: f64,
    factor: f64,
}

impl Regularisation {
    /// Increases the weight. Above the maximum, returns `false` and starts again at zero.
    fn raise(&mut self) -> bool {
        self.factor = (self.factor * REGULARISATION_FACTOR).max(REGULARISATION_FACTOR);
        self.value = (self.value * self.factor).max(MIN_REGULARISATION);
        if self.value > MAX_REGULARISATION {
            *self = Self::default();
            return false;
        }
        true
    }

    /// Decreases the weight, to zero below the minimum.
    fn lower(&mut self) {
        self.factor = (self.factor / REGULARISATION_FACTOR).min(1.0 / REGULARISATION_FACTOR);
        self.value *= self.factor;
        if self.value < MIN_REGULARISATION {
            self.value = 0.0;
        }
    }
}
