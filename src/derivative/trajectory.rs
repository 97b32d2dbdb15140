//! Buffers and results of gradients along trajectories.

use super::parameter::{ParameterJacobian, Resolved};
use super::{StateSpace, sizes};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// Gradient of a cost along a trajectory, by
/// [`Lineariser::cost_gradient`](super::Lineariser::cost_gradient).
#[derive(Clone, Debug, PartialEq)]
pub struct CostGradient {
    /// Cost of the trajectory.
    pub cost: f64,
    /// `(2 nv + na)`: gradient by the initial state, in the tangent space of positions.
    pub initial_state: Vec<f64>,
    /// `(N, nu)`: gradient by the controls.
    pub controls: Matrix,
    /// Gradient by the parameters.
    pub parameters: Vec<f64>,
}

impl CostGradient {
    /// Creates a gradient of zeros for a number of steps and of parameters.
    pub fn zeros(model: &Model, steps: usize, parameters: usize) -> Self {
        let (nx, nu, _) = sizes(model);
        Self {
            cost: 0.0,
            initial_state: vec![0.0; nx],
            controls: Matrix::zeros(steps, nu),
            parameters: vec![0.0; parameters],
        }
    }
}

/// Partial derivatives of the cost of one step, zero before the call.
#[derive(Debug)]
#[non_exhaustive]
pub struct CostSlopes<'a> {
    /// `(2 nv + na)`: by the state, in the tangent space of positions.
    pub state: &'a mut [f64],
    /// `(nu)`: by the controls. Empty at the end of the trajectory.
    pub controls: &'a mut [f64],
    /// `(nsensordata)`: by the sensors.
    pub sensors: &'a mut [f64],
}

/// Buffers of a trajectory.
#[derive(Debug)]
pub(super) struct Adjoint {
    pub(super) simulation: Data,
    /// States at the checkpoints, and of the present segment.
    pub(super) checkpoints: Vec<f64>,
    pub(super) segment: Vec<f64>,
    pub(super) resolved: Vec<Resolved>,
    pub(super) system: StateSpace,
    /// `(nx)`: λ, and the next one.
    pub(super) present: Vec<f64>,
    pub(super) next: Vec<f64>,
    /// Partial derivatives of a step's cost.
    pub(super) controls: Vec<f64>,
    pub(super) sensors: Vec<f64>,
    /// Indices of parameters that are differenced, and their columns.
    pub(super) others: Vec<usize>,
    pub(super) columns: ParameterJacobian,
}

impl Adjoint {
    pub(super) fn new(data: &Data) -> Result<Self> {
        let model = data.model();
        let (nx, nu, ny) = sizes(model);
        Ok(Self {
            simulation: Data::new(model.clone())?,
            checkpoints: Vec::new(),
            segment: Vec::new(),
            resolved: Vec::new(),
            system: StateSpace::zeros(model),
            present: vec![0.0; nx],
            next: vec![0.0; nx],
            controls: vec![0.0; nu],
            sensors: vec![0.0; ny],
            others: Vec::new(),
            columns: ParameterJacobian::zeros(model, 0),
        })
    }

    /// Takes a step with controls.
    pub(super) fn step(&mut self, controls: &[f64]) -> Result<()> {
        self.simulation.ctrl_mut().copy_from_slice(controls);
        self.simulation.step()
    }

    /// Calls the cost function at the present state, and returns the cost.
    pub(super) fn evaluate(
        &mut self,
        step: usize,
        is_end: bool,
        cost: &mut impl FnMut(usize, &Data, &mut CostSlopes<'_>) -> f64,
    ) -> Result<f64> {
        self.simulation.forward()?;
        for values in [&mut self.next, &mut self.controls, &mut self.sensors] {
            values.fill(0.0);
        }
        let controls = if is_end { &mut [][..] } else { &mut self.controls[..] };
        let mut slopes = CostSlopes { state: &mut self.next, controls, sensors: &mut self.sensors };
        let cost = cost(step, &self.simulation, &mut slopes);
        let all = self.next.iter().chain(&self.controls).chain(&self.sensors);
        if let Some(value) = all.copied().chain([cost]).find(|value| !value.is_finite()) {
            return Err(Error::out_of_range(format!("the cost of step {step} or its slopes"), value, "finite"));
        }
        Ok(cost)
    }
}
