//! The state that a plan starts from.

use std::sync::Arc;

use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::model::Model;
use crate::parallel::is_edited;

/// Components of the state that a plan starts from, by default: all except applied forces, which
/// are unknown on a robot.
const FORESEEN: StateSpec = StateSpec::INTEGRATION.difference(StateSpec::QFRC_APPLIED.union(StateSpec::XFRC_APPLIED));

/// Simulation of a planner with the observed part of the state of another simulation.
#[derive(Debug)]
pub(super) struct Observation {
    data: Data,
    foreseen: StateSpec,
    /// Values of the components of the state that are foreseen.
    state: Vec<f64>,
}

impl Observation {
    pub(super) fn new(model: Arc<Model>) -> Result<Self> {
        Ok(Self { foreseen: FORESEEN, state: vec![0.0; model.state_size(FORESEEN)], data: Data::new(model)? })
    }

    /// Sets the components of the state to observe.
    pub(super) fn foresee(&mut self, foreseen: StateSpec) {
        self.state = vec![0.0; self.data.model().state_size(foreseen)];
        self.foreseen = foreseen;
    }

    /// Returns the simulation.
    pub(super) fn data(&self) -> &Data {
        &self.data
    }

    /// Takes the state of a simulation, and its model if it was edited. Returns `true` if the model
    /// is new. `what` names the simulation in an error.
    pub(super) fn observe(&mut self, data: &Data, what: &'static str) -> Result<bool> {
        let is_new = is_edited(self.data.model(), data, what)?;
        if is_new || self.data.check_usable().is_err() {
            self.data = Data::new(data.model().clone())?;
        }
        data.state_into(self.foreseen, &mut self.state)?;
        self.data.set_state(self.foreseen, &self.state)?;
        Ok(is_new)
    }

    /// Returns the number of steps since the start of the previous plan, or `None` if there is
    /// none. A time before that start means that the simulation was reset.
    pub(super) fn steps_since(&self, start: Option<f64>) -> Option<usize> {
        let steps = ((self.data.time() - start?) / self.data.model().timestep()).round();
        (steps >= 0.0).then_some(steps as usize)
    }
}
