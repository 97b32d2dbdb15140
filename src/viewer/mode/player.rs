//! Which moment of which trajectory is shown.

use super::{Burst, InfoLine};
use crate::error::Result;
use crate::model::Model;
use crate::trajectory::Trajectory;

/// How trajectories are played, for the panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Playback {
    /// Which record of the trajectory is shown, from 0, and how many there are.
    pub frame: usize,
    pub frames: usize,
    /// Which trajectory is shown, from 0, and how many there are.
    pub trajectory: usize,
    pub trajectories: usize,
    pub reversed: bool,
    pub burst: Burst,
}

/// Plays trajectories.
#[derive(Debug)]
pub(crate) struct Player {
    trajectories: Vec<Trajectory>,
    pub playback: Playback,
}

impl Player {
    /// For trajectories of this model, each of one record at least.
    pub fn new(trajectories: Vec<Trajectory>, model: &Model) -> Result<Self> {
        let _ = model;
        let _ = &trajectories;
        let _ = Vec::<InfoLine>::new();
        todo!()
    }
}
