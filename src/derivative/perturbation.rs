//! A simulation that is perturbed one input at a time and restored to its base point.

use std::sync::Arc;

use super::TransitionOutputs;
use super::method::Step;
use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::model::{Model, Relation};

/// State components that a step or a perturbation changes and [`PerturbedData::restore`] restores.
const SAVED: StateSpec = StateSpec::FULL_PHYSICS.union(StateSpec::WARMSTART).union(StateSpec::CTRL);

/// Input of the linear system, with its index. It determines a column of A and C, or of B and D.
#[derive(Clone, Copy, Debug)]
pub(super) enum Input {
    Control(usize),
    Activation(usize),
    Velocity(usize),
    Position(usize),
}

impl Input {
    /// Returns the index of the column in A, or in B for a control.
    pub(super) fn column(self, model: &Model) -> usize {
        match self {
            Self::Control(control) => control,
            Self::Position(dof) => dof,
            Self::Velocity(dof) => model.nv() + dof,
            Self::Activation(activation) => 2 * model.nv() + activation,
        }
    }
}

/// Parts of the linear system that the caller requested.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Columns of the state: A or C.
    pub(super) states: bool,
    /// Columns of the controls: B or D.
    pub(super) controls: bool,
    /// Rows of the state: A or B.
    pub(super) system: bool,
    /// Rows of the sensors: C or D.
    pub(super) sensors: bool,
}

impl Wanted {
    pub(super) fn by(outputs: &TransitionOutputs<'_>) -> Self {
        Self {
            states: outputs.a.is_some() || outputs.c.is_some(),
            controls: outputs.b.is_some() || outputs.d.is_some(),
            system: outputs.a.is_some() || outputs.b.is_some(),
            sensors: outputs.c.is_some() || outputs.d.is_some(),
        }
    }
}

/// Settings that all columns of a linear system share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings<'m> {
    pub(super) model: &'m Model,
    pub(super) wanted: Wanted,
    pub(super) step: Step,
    /// Marks rows of C and D that the caller has already; the rest is differenced. Empty for none.
    pub(super) keep: &'m [bool],
}

/// Returns the inputs in the order in which columns are computed.
///
/// Each kind of input needs fewer results at the base point than the preceding kinds, and
/// overwrites the others. So controls come first and positions last.
pub(super) fn inputs(model: &Model, wanted: Wanted) -> impl Iterator<Item = Input> + use<> {
    let range = |n: usize, wanted: bool| if wanted { 0..n } else { 0..0 };
    let (nv, na, nu) = (model.nv(), model.na(), model.nu());
    let controls = range(nu, wanted.controls).map(Input::Control);
    let activations = range(na, wanted.states).map(Input::Activation);
    let velocities = range(nv, wanted.states).map(Input::Velocity);
    let positions = range(nv, wanted.states).map(Input::Position);
    controls.chain(activations).chain(velocities).chain(positions)
}

/// Point to linearise about.
#[derive(Clone, Copy, Debug)]
pub(super) struct BasePoint<'a> {
    /// Values of [`StateSpec::INTEGRATION`].
    pub(super) integration: &'a [f64],
    /// `[qpos; qvel; act]` and controls of a knot of a trajectory, which replace the values in
    /// `integration`.
    pub(super) knot: Option<(&'a [f64], &'a [f64])>,
}

/// A simulation with a base point.
#[derive(Debug)]
pub(super) struct PerturbedData {
    pub(super) data: Data,
    /// Values of [`SAVED`] at the base point.
    saved: Vec<f64>,
    /// Buffer for a direction in the tangent space of positions; zeros between calls.
    direction: Vec<f64>,
}

impl PerturbedData {
    pub(super) fn new(model: &Arc<Model>) -> Result<Self> {
        Ok(Self {
            data: Data::new(model.clone())?,
            saved: vec![0.0; model.state_size(SAVED)],
            direction: vec![0.0; model.nv()],
        })
    }

    /// Adopts the model of a simulation of the same structure, unless it is the same model.
    pub(super) fn adopt_model(&mut self, data: &Data) {
        if self.data.model().relation(data.model()) != Relation::Same {
            self.data.clone_from(data);
        }
    }

    /// Moves the simulation to a base point that later calls restore.
    pub(super) fn set_base(&mut self, base: BasePoint<'_>) -> Result<()> {
        self.move_to(base)?;
        self.data.state_into(SAVED, &mut self.saved)
    }

    /// Moves the simulation to a point.
    pub(super) fn move_to(&mut self, base: BasePoint<'_>) -> Result<()> {
        if self.data.check_usable().is_err() {
            self.data.reset()?;
        }
        self.data.set_state(StateSpec::INTEGRATION, base.integration)?;
        if let Some((state, controls)) = base.knot {
            self.data.set_physics_state(state)?;
            self.data.ctrl_mut().copy_from_slice(controls);
            self.data.check_inputs()?;
        }
        Ok(())
    }

    /// Restores the base point after a step or a perturbation.
    pub(super) fn restore(&mut self) -> Result<()> {
        self.data.set_state(SAVED, &self.saved)
    }

    /// Restores the velocities or positions after one of them was perturbed, and nothing else.
    pub(super) fn restore_input(&mut self, input: Input) {
        const TIME: usize = 1;
        let (nq, nv) = (self.data.model().nq(), self.data.model().nv());
        let (qpos, rest) = self.saved[TIME..].split_at(nq);
        match input {
            Input::Velocity(dof) => self.data.qvel_mut()[dof] = rest[..nv][dof],
            _ => self.data.qpos_mut().copy_from_slice(qpos),
        }
    }

    /// Perturbs all positions and velocities by amounts up to `eps`, none of which is zero.
    pub(super) fn perturb_motion(&mut self, eps: f64) -> Result<()> {
        self.direction.iter_mut().zip(1..).for_each(|(by, dof)| *by = f64::from(dof).sin());
        self.data.qvel_mut().iter_mut().zip(&self.direction).for_each(|(value, by)| *value += eps * by);
        let model = self.data.model().clone();
        let moved = model.integrate_pos(self.data.qpos_mut(), &self.direction, eps);
        self.direction.fill(0.0);
        moved
    }

    /// Adds `eps` to one input.
    pub(super) fn perturb(&mut self, model: &Model, input: Input, eps: f64) -> Result<()> {
        match input {
            Input::Control(control) => self.data.ctrl_mut()[control] += eps,
            Input::Activation(activation) => self.data.act_mut()[activation] += eps,
            Input::Velocity(dof) => self.data.qvel_mut()[dof] += eps,
            Input::Position(dof) => {
                self.direction[dof] = 1.0;
                let moved = model.integrate_pos(self.data.qpos_mut(), &self.direction, eps);
                self.direction[dof] = 0.0;
                return moved;
            }
        }
        Ok(())
    }
}
