//! What the physics thread owns: the simulation, what makes it move, its past.
//!
//! | file | what is in it |
//! |---|---|
//! | `turn.rs` | one turn of the thread's loop: requests, steps that are due, a snapshot |
//! | `step.rs` | one step, in each mode, and what becomes of one that fails |
//! | `request.rs` | requests that are for a simulation |
//! | `caught.rs` | a panic as an error |

mod caught;
mod request;
mod step;
mod turn;

use std::sync::Arc;
use std::time::Duration;

use self::step::Effort;
use super::bridge::Bridge;
use super::clock::Clock;
use super::history::History;
use super::link::Back;
use super::mode::{InfoLine, Mode, Player};
use super::snapshot::{Pace, Status};
use crate::controller::Controller;
use crate::data::Data;
use crate::error::Result;
use crate::trajectory::Trajectory;

/// The factor that a viewer begins with, and the least and the largest.
const FACTOR: f64 = 0.1;
const LEAST_FACTOR: f64 = 1.0 / 1024.0;
const MOST_FACTOR: f64 = 1024.0;

/// What the physics thread owns.
#[allow(clippy::struct_excessive_bools, reason = "independent of each other")]
pub(crate) struct Simulation {
    data: Data,
    bridge: Bridge,
    controller: Option<Box<dyn Controller + Send>>,
    player: Option<Player>,
    modes: Vec<Mode>,
    mode: Mode,
    paused: bool,
    /// The simulation was unpaused or a body was pulled, and no step has been taken since.
    owes_step: bool,
    factor: f64,
    by_factor: bool,
    clock: Clock,
    history: History,
    effort: Effort,
    /// What went wrong, until something goes on.
    problem: String,
    /// Memory for what the mode says.
    lines: Vec<InfoLine>,
    /// The state is not what the quantities were computed from.
    stale: bool,
    /// The window has to see something new.
    unseen: bool,
    published: Duration,
}

impl Simulation {
    /// Of a simulation in the state that a reset is to return to. The modes are those that there is something for; it starts
    /// paused in the first. The first snapshot is there when this returns.
    ///
    /// # Errors
    ///
    /// For a trajectory without records, or of another model; if there is no memory.
    pub fn new(
        data: Data,
        controller: Option<Box<dyn Controller + Send>>,
        trajectories: Vec<Trajectory>,
        back: Back,
    ) -> Result<Self> {
        let player = if trajectories.is_empty() { None } else { Some(Player::new(trajectories, data.model())?) };
        let bridge = Bridge::new(back, &data);
        let history = History::new(data.model());
        let mut simulation = Self {
            data,
            bridge,
            controller,
            player,
            modes: Vec::new(),
            mode: Mode::Passive,
            paused: true,
            owes_step: false,
            factor: FACTOR,
            by_factor: false,
            clock: Clock::default(),
            history,
            effort: Effort::default(),
            problem: String::new(),
            lines: Vec::new(),
            stale: true,
            unseen: true,
            published: Duration::ZERO,
        };
        simulation.find_modes();
        simulation.mode = simulation.modes[0];
        simulation.show_record();
        simulation.turn(&|| Duration::ZERO);
        Ok(simulation)
    }

    /// Ends it.
    pub fn into_data(mut self) -> Data {
        self.bridge.remove_perturbation(&mut self.data);
        self.data
    }

    fn find_modes(&mut self) {
        let there = [self.controller.is_some(), self.player.is_some(), true];
        self.modes.clear();
        let modes = [Mode::Controller, Mode::Trajectory, Mode::Passive];
        self.modes.extend(modes.into_iter().zip(there).filter(|(_, there)| *there).map(|(mode, _)| mode));
    }

    /// In the trajectory mode: the simulation is what the present record says.
    fn show_record(&mut self) {
        if self.mode == Mode::Trajectory
            && let Some(player) = &self.player
        {
            let shown = player.show(&mut self.data);
            (self.stale, self.unseen) = (true, true);
            self.note(shown);
        }
    }

    /// Tells what went wrong, if it did, and pauses.
    fn note<T>(&mut self, result: Result<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(error) => {
                self.fail(error.to_string());
                None
            }
        }
    }

    fn fail(&mut self, problem: String) {
        log::warn!("the viewer pauses: {problem}");
        self.problem = problem;
        (self.paused, self.owes_step) = (true, false);
        self.unseen = true;
    }

    fn speed(&self) -> f64 {
        self.pace().wanted()
    }

    fn pace(&self) -> Pace {
        Pace {
            factor: self.factor,
            by_factor: self.by_factor,
            measured: self.clock.measured(),
            dropped: self.clock.dropped(),
        }
    }

    fn status(&self) -> Status {
        let reversed = self.mode == Mode::Trajectory && self.player.as_ref().is_some_and(|player| player.reversed);
        match (self.paused, reversed) {
            (true, _) => Status::Paused,
            (false, true) => Status::Reversed,
            (false, false) => Status::Running,
        }
    }

    /// Goes on with another model, in its reference position.
    fn reload(&mut self, model: Arc<crate::model::Model>) -> Result<()> {
        let data = Data::new(model)?;
        self.data = data;
        self.bridge.adopt(&self.data);
        self.history = History::new(self.data.model());
        if self.player.as_ref().is_some_and(|player| !player.fits(self.data.model())) {
            self.player = None;
            self.find_modes();
            if !self.modes.contains(&self.mode) {
                self.mode = self.modes[0];
            }
        }
        self.problem.clear();
        self.stale = true;
        self.show_record();
        Ok(())
    }
}
