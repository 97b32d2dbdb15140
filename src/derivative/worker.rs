//! A simulation of its own for each thread that linearises, and the columns that it computes.

use std::sync::Arc;

use super::method::Step;
use super::newton::Newton;
use super::sizes;
use super::through_inverse::Base;
use super::{Differences, TransitionOutputs};
use crate::data::Data;
use crate::data::StateSpec;
use crate::error::Result;
use crate::matrix::Matrix;
use crate::model::Model;

/// What a step changes, and is put back after each.
pub(super) const MOVED: StateSpec =
    StateSpec::TIME.union(StateSpec::PHYSICS).union(StateSpec::WARMSTART).union(StateSpec::CTRL);

/// What a column of the linear system belongs to, with its index.
#[derive(Clone, Copy, Debug)]
pub(super) enum Input {
    Control(usize),
    Activation(usize),
    Velocity(usize),
    Position(usize),
}

impl Input {
    /// Its column in A, or in B.
    fn column(self, model: &Model) -> usize {
        match self {
            Self::Control(control) => control,
            Self::Position(dof) => dof,
            Self::Velocity(dof) => model.nv() + dof,
            Self::Activation(activation) => 2 * model.nv() + activation,
        }
    }
}

/// Which columns are wanted, and whether sensors are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) states: bool,
    pub(super) controls: bool,
    pub(super) sensors: bool,
}

impl Wanted {
    pub(super) fn by(outputs: &TransitionOutputs<'_>) -> Self {
        Self {
            states: outputs.a.is_some() || outputs.c.is_some(),
            controls: outputs.b.is_some() || outputs.d.is_some(),
            sensors: outputs.c.is_some() || outputs.d.is_some(),
        }
    }
}

/// The columns, those first that need the least of what is computed at the base point, as each spoils it for the ones before.
pub(super) fn inputs(model: &Model, wanted: Wanted) -> impl Iterator<Item = Input> + use<> {
    let of = |n: usize, wanted: bool| if wanted { 0..n } else { 0..0 };
    let (nv, na, nu) = (model.nv(), model.na(), model.nu());
    let controls = of(nu, wanted.controls).map(Input::Control);
    let activations = of(na, wanted.states).map(Input::Activation);
    let velocities = of(nv, wanted.states).map(Input::Velocity);
    let positions = of(nv, wanted.states).map(Input::Position);
    controls.chain(activations).chain(velocities).chain(positions)
}

#[derive(Debug)]
pub(super) struct Worker {
    pub(super) data: Data,
    /// The base point, as far as it is moved.
    pub(super) moved: Vec<f64>,
    /// `(nx + nu, nx + nsensordata)`: the columns of a system that it computes alone, each as a row, in the order of [`inputs`].
    pub(super) rows: Matrix,
    /// `[qpos; qvel; act; sensordata]` after a step from the base point, and from either side of it.
    pub(super) samples: [Vec<f64>; 3],
    /// A direction in the tangent space of positions.
    pub(super) direction: Vec<f64>,
    pub(super) base: Base,
    pub(super) newton: Newton,
    /// Whether what all columns need of the base point is known. False if the solver has not converged there.
    pub(super) prepared: Option<bool>,
    /// What became of its share.
    pub(super) outcome: Result<()>,
}

impl Worker {
    pub(super) fn new(model: &Arc<Model>) -> Result<Self> {
        let (nx, nu, ny) = sizes(model);
        let sample = vec![0.0; model.nq() + model.nv() + model.na() + ny];
        Ok(Self {
            data: Data::new(model.clone())?,
            moved: vec![0.0; model.state_size(MOVED)],
            rows: Matrix::zeros(nx + nu, nx + ny),
            samples: [sample.clone(), sample.clone(), sample],
            direction: vec![0.0; model.nv()],
            base: Base::new(model),
            newton: Newton::new(model),
            prepared: None,
            outcome: Ok(()),
        })
    }

    /// Takes over the model of a simulation of the same structure, if it is another one by now.
    pub(super) fn follow(&mut self, data: &Data) {
        if !Arc::ptr_eq(self.data.model(), data.model()) {
            self.data.clone_from(data);
        }
    }

    /// Sets the base point.
    pub(super) fn start(&mut self, inputs: &[f64]) -> Result<()> {
        if self.data.check_usable().is_err() {
            self.data.reset()?;
        }
        self.data.set_state(StateSpec::INTEGRATION, inputs)?;
        self.keep()
    }

    /// Makes the present state and controls those of the base point.
    pub(super) fn keep(&mut self) -> Result<()> {
        self.data.state_into(MOVED, &mut self.moved)
    }

    /// Goes back to the base point after a step.
    pub(super) fn restore(&mut self) -> Result<()> {
        self.data.set_state(MOVED, &self.moved)
    }

    /// Moves one input away from the base point.
    pub(super) fn nudge(&mut self, model: &Model, input: Input, by: f64) -> Result<()> {
        match input {
            Input::Control(control) => self.data.ctrl_mut()[control] += by,
            Input::Activation(activation) => self.data.act_mut()[activation] += by,
            Input::Velocity(dof) => self.data.qvel_mut()[dof] += by,
            Input::Position(dof) => {
                self.direction[dof] = 1.0;
                let moved = model.integrate_pos(self.data.qpos_mut(), &self.direction, by);
                self.direction[dof] = 0.0;
                return moved;
            }
        }
        Ok(())
    }

    /// Goes back to the base point from where a velocity or a position was moved, and nothing else.
    pub(super) fn put_back(&mut self, input: Input) {
        const TIME: usize = 1;
        let (nq, nv) = (self.data.model().nq(), self.data.model().nv());
        let (qpos, rest) = self.moved[TIME..].split_at(nq);
        match input {
            Input::Velocity(dof) => self.data.qvel_mut()[dof] = rest[..nv][dof],
            _ => self.data.qpos_mut().copy_from_slice(qpos),
        }
    }
}

/// Writes columns, each of which is a row, to the outputs, the right way round.
pub(super) fn write(model: &Model, rows: &Matrix, wanted: Wanted, outputs: &mut TransitionOutputs<'_>) {
    let (nx, _, _) = sizes(model);
    for (row, input) in inputs(model, wanted).enumerate() {
        let (state, sensors) = rows.row(row).split_at(nx);
        let column = input.column(model);
        let (of_state, of_sensors) = match input {
            Input::Control(_) => (&mut outputs.b, &mut outputs.d),
            _ => (&mut outputs.a, &mut outputs.c),
        };
        for (values, output) in [(state, of_state), (sensors, of_sensors)] {
            if let Some(output) = output {
                values.iter().enumerate().for_each(|(row, value)| output[(row, column)] = *value);
            }
        }
    }
}

/// Whether a column is differenced to the right and to the left: a control only as far as its range goes, as in the engine.
pub(super) fn sides(data: &Data, input: Input, step: Step) -> (bool, bool) {
    let central = step.differences == Differences::Central;
    let Input::Control(control) = input else { return (true, central) };
    let model = data.model();
    if model.actuator_ctrllimited()[control] == 0 {
        return (true, central);
    }
    let [low, high] = model.actuator_ctrlrange()[control];
    let ctrl = data.ctrl()[control];
    let inside = |value: f64| low <= value && value <= high;
    let right = inside(ctrl) && inside(ctrl + step.eps);
    let left = (central || !right) && inside(ctrl) && inside(ctrl - step.eps);
    (right, left)
}
