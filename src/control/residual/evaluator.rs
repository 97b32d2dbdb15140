//! Evaluation of terms in simulations.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Needs, ResidualJacobian, Term};
use crate::control::ilqr::CostExpansion;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::model::{Model, Relation};
use crate::numerics::linear_algebra::{add, add_products};
use crate::numerics::vectorised;
use crate::parallel::is_edited;

/// Simulation in which terms are evaluated, with buffers.
struct Evaluator {
    data: Data,
    /// Values of [`StateSpec::WARMSTART`] before an evaluation.
    warmstart: Vec<f64>,
    /// Version of the inputs that the simulation has.
    version: u64,
    /// For the largest residual.
    residual: Vec<f64>,
    jacobian: ResidualJacobian,
}

/// State and controls of a step, or the state at the end.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    pub(super) step: usize,
    pub(super) state: &'a [f64],
    pub(super) controls: Option<&'a [f64]>,
}

impl Evaluator {
    /// Creates an evaluator for residuals of at most `size` components.
    fn new(data: Data, size: usize) -> Self {
        let model = data.model();
        Self {
            warmstart: data.state(StateSpec::WARMSTART),
            version: 0,
            residual: vec![0.0; size],
            jacobian: ResidualJacobian::zeros(model, size),
            data,
        }
    }

    /// Moves the simulation to a point, and computes what the terms need there.
    fn move_to(&mut self, point: Point<'_>, start: f64, needs: Needs) -> Result<()> {
        let Self { data, warmstart, jacobian, .. } = self;
        data.set_physics_state(point.state)?;
        match point.controls {
            Some(controls) => {
                Error::check_length("the controls of a ResidualCost", controls.len(), data.model().nu())?;
                data.ctrl_mut().copy_from_slice(controls);
            }
            None => data.ctrl_mut().fill(0.0),
        }
        let time = start + point.step as f64 * data.model().timestep();
        data.set_time(time);
        // The solver starts from the same accelerations at all points, so the result does not
        // depend on their order.
        data.set_state(StateSpec::WARMSTART, warmstart)?;
        jacobian.move_point();
        needs.compute(data)
    }

    /// Returns the cost of a term.
    fn value(&mut self, term: &Term, weight: f64) -> Result<f64> {
        let residual = &mut self.residual[..term.size()];
        term.residual.evaluate(&mut self.data, residual)?;
        let costs = residual.iter().zip(&term.scales).map(|(value, scale)| term.norm.value(scale * value));
        Ok(weight * costs.sum::<f64>())
    }

    /// Adds the derivatives of a term.
    fn expand(&mut self, term: &Term, weight: f64, expansion: &mut CostExpansion) -> Result<()> {
        let Self { data, residual, jacobian, .. } = self;
        let size = term.size();
        let residual = &mut residual[..size];
        term.residual.evaluate(data, residual)?;
        jacobian.clear(size);
        term.residual.differentiate(data, jacobian)?;
        for (component, (value, scale)) in residual.iter().zip(&term.scales).enumerate() {
            if *scale != 0.0 {
                let slope = weight * scale * term.norm.slope(scale * value);
                let curvature = weight * scale * scale * term.norm.curvature(scale * value);
                add_component(jacobian.row(component), slope, curvature, expansion);
            }
        }
        Ok(())
    }
}

vectorised! {
/// Adds the derivatives of the cost of a component, given the derivatives of the component by the
/// state and the controls.
fn add_component(row: &[f64], slope: f64, curvature: f64, expansion: &mut CostExpansion) {
    let CostExpansion { x, u, xx, uu, xu } = expansion;
    let (nx, nu) = (x.len(), u.len());
    let (states, controls) = row.split_at(nx);
    let by_states = add_products(xx.as_mut_slice(), nx, states, states, curvature);
    add(&mut x[by_states.clone()], &states[by_states], slope);
    let by_controls = add_products(uu.as_mut_slice(), nu, controls, controls, curvature);
    if !by_controls.is_empty() {
        add(&mut u[by_controls.clone()], &controls[by_controls], slope);
        add_products(xu.as_mut_slice(), nu, states, controls, curvature);
    }
}
}

/// Terms to evaluate at a point, with their weights there.
fn active(terms: &[Term], is_terminal: bool) -> impl Iterator<Item = (usize, &Term, f64)> {
    let weighted = terms.iter().enumerate().map(move |(index, term)| (index, term, term.weight_of(is_terminal)));
    weighted.filter(|&(_, _, weight)| weight != 0.0)
}

fn needs(terms: &[Term], is_terminal: bool) -> Needs {
    active(terms, is_terminal).map(|(_, term, _)| term.residual.needs()).max().unwrap_or(Needs::State)
}

/// Evaluators, one for each active thread, and the start of the trajectory.
pub(super) struct Evaluators(Mutex<Shared>);

struct Shared {
    model: Arc<Model>,
    /// Values of [`StateSpec::INTEGRATION`].
    inputs: Vec<f64>,
    time: f64,
    /// Number of changes of the inputs.
    version: u64,
    /// Evaluators of this model, not of an earlier one.
    idle: Vec<Evaluator>,
}

impl Evaluators {
    pub(super) fn new(data: Data, size: usize) -> Self {
        let (model, inputs) = (data.model().clone(), data.state(StateSpec::INTEGRATION));
        Self(Mutex::new(Shared { model, inputs, time: 0.0, version: 0, idle: vec![Evaluator::new(data, size)] }))
    }

    /// Takes the model, the time and all inputs of a simulation.
    pub(super) fn begin(&self, data: &Data) -> Result<()> {
        let mut shared = self.lock();
        if is_edited(&shared.model, data, "the simulation of a ResidualCost")? {
            shared.model = data.model().clone();
            shared.idle.clear();
        }
        data.state_into(StateSpec::INTEGRATION, &mut shared.inputs)?;
        shared.time = data.time();
        shared.version += 1;
        Ok(())
    }

    /// Writes the cost of each term, or returns their sum.
    pub(super) fn value(&self, terms: &[Term], point: Point<'_>, mut each: Option<&mut [f64]>) -> Result<f64> {
        let is_terminal = point.controls.is_none();
        self.at(terms, point, |evaluator| {
            let mut sum = 0.0;
            for (index, term, weight) in active(terms, is_terminal) {
                let value = evaluator.value(term, weight)?;
                sum += value;
                if let Some(each) = &mut each {
                    each[index] = value;
                }
            }
            Ok(sum)
        })
    }

    pub(super) fn expand(&self, terms: &[Term], point: Point<'_>, expansion: &mut CostExpansion) -> Result<()> {
        self.at(terms, point, |evaluator| {
            active(terms, point.controls.is_none())
                .try_for_each(|(_, term, weight)| evaluator.expand(term, weight, expansion))
        })
    }

    /// Calls `work` with an evaluator at a point.
    fn at<T>(&self, terms: &[Term], point: Point<'_>, work: impl FnOnce(&mut Evaluator) -> Result<T>) -> Result<T> {
        let (mut evaluator, time) = self.take(terms)?;
        evaluator.move_to(point, time, needs(terms, point.controls.is_none()))?;
        // After an error, the simulation may be unusable and is dropped.
        let result = work(&mut evaluator)?;
        let mut shared = self.lock();
        if shared.model.relation(evaluator.data.model()) == Relation::Same {
            shared.idle.push(evaluator);
        }
        Ok(result)
    }

    /// Takes an idle evaluator, or creates one. Returns it with the present inputs, and the time of
    /// the start.
    fn take(&self, terms: &[Term]) -> Result<(Evaluator, f64)> {
        let mut shared = self.lock();
        let mut evaluator = if let Some(evaluator) = shared.idle.pop() {
            evaluator
        } else {
            let model = shared.model.clone();
            // Other threads continue meanwhile.
            drop(shared);
            let size = terms.iter().map(Term::size).max().unwrap_or(0);
            let created = Evaluator::new(Data::new(model)?, size);
            shared = self.lock();
            created
        };
        if evaluator.version != shared.version {
            evaluator.data.set_state(StateSpec::INTEGRATION, &shared.inputs)?;
            evaluator.data.state_into(StateSpec::WARMSTART, &mut evaluator.warmstart)?;
            evaluator.version = shared.version;
        }
        Ok((evaluator, shared.time))
    }

    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Evaluators {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} idle simulations", self.lock().idle.len())
    }
}
