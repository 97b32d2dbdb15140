//! Simulation of the physics thread: modes, pause, speed, history and the loop that steps it in
//! real time.

mod clock;
mod history;
mod noise;
mod playback;
mod request;
mod step;
mod tick;

use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use self::clock::RealTimeClock;
pub(super) use self::clock::SpeedMeter;
use self::history::History;
use self::noise::NoiseSource;
use self::playback::Player;
use self::step::StepTiming;
use super::endpoint::SimulationEndpoint;
use super::instruments::InstrumentedController;
use super::link::{InfoLine, Kept, Mode, PhysicsEnd, SimulationSpeed, Status, Timeline};
use crate::data::Data;
use crate::error::Result;
use crate::model::Model;
use crate::trajectory::Trajectory;

/// Initial speed factor and its range.
const INITIAL_FACTOR: f64 = 0.1;
const MIN_FACTOR: f64 = 1.0 / 1024.0;
const MAX_FACTOR: f64 = 1024.0;

/// Simulation that the viewer steps itself.
#[allow(clippy::struct_excessive_bools, reason = "independent of each other")]
pub(crate) struct Simulation {
    data: Data,
    endpoint: SimulationEndpoint,
    controller: Option<Box<dyn InstrumentedController>>,
    player: Option<Player>,
    modes: Vec<Mode>,
    mode: Mode,
    paused: bool,
    /// The simulation was resumed or a body was pulled, and no step has been taken since.
    step_pending: bool,
    /// Speed factor.
    factor: f64,
    /// The speed factor applies instead of real time.
    by_factor: bool,
    clock: RealTimeClock,
    history: History,
    noise: NoiseSource,
    timing: StepTiming,
    /// Message of the last error, until the simulation resumes.
    problem: String,
    /// Buffer of the info lines.
    lines: Vec<InfoLine>,
    /// Buffer of the timeline.
    timeline: Timeline,
    /// The quantities that depend on the state were computed from another state.
    stale: bool,
    /// Something has changed since the last snapshot.
    unpublished: bool,
    /// Time of the last snapshot.
    published: Duration,
}

impl Simulation {
    /// Creates a paused simulation in the first available mode, and publishes the first snapshot. A
    /// reset restores the current state.
    ///
    /// # Errors
    ///
    /// For a trajectory without records or of another model, and if there is no memory.
    pub fn new(
        data: Data,
        controller: Option<Box<dyn InstrumentedController>>,
        trajectories: Vec<(String, Trajectory)>,
        link: PhysicsEnd,
    ) -> Result<Self> {
        let player = if trajectories.is_empty() { None } else { Some(Player::new(trajectories, data.model())?) };
        let endpoint = SimulationEndpoint::new(Arc::new(link), &data);
        let history = History::new(data.model());
        let mut simulation = Self {
            data,
            endpoint,
            controller,
            player,
            modes: Vec::new(),
            mode: Mode::Passive,
            paused: true,
            step_pending: false,
            factor: INITIAL_FACTOR,
            by_factor: false,
            clock: RealTimeClock::default(),
            history,
            noise: NoiseSource::default(),
            timing: StepTiming::default(),
            problem: String::new(),
            lines: Vec::new(),
            timeline: Timeline::default(),
            stale: true,
            unpublished: true,
            published: Duration::ZERO,
        };
        simulation.update_modes();
        simulation.mode = simulation.modes[0];
        simulation.show_record();
        simulation.tick(&|| Duration::ZERO);
        Ok(simulation)
    }

    /// Returns the data without the force of the perturbation.
    pub fn into_data(mut self) -> Data {
        self.endpoint.remove_perturbation(&mut self.data);
        self.data
    }

    fn update_modes(&mut self) {
        let available = [self.controller.is_some(), self.player.is_some(), true];
        self.modes.clear();
        let modes = [Mode::Controller, Mode::Trajectory, Mode::Passive];
        self.modes.extend(modes.into_iter().zip(available).filter(|(_, available)| *available).map(|(mode, _)| mode));
    }

    /// Sets the state to the current record in the trajectory mode.
    fn show_record(&mut self) {
        if self.mode == Mode::Trajectory
            && let Some(player) = &self.player
        {
            let shown = player.show(&mut self.data);
            (self.stale, self.unpublished) = (true, true);
            self.check(shown);
        }
    }

    /// Returns the value of a result. An error pauses the simulation and is shown.
    fn check<T>(&mut self, result: Result<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(error) => {
                self.fail(error.to_string());
                None
            }
        }
    }

    fn fail(&mut self, problem: String) {
        log::warn!("the viewer pauses the simulation: {problem}");
        self.problem = problem;
        (self.paused, self.step_pending) = (true, false);
        self.unpublished = true;
    }

    /// As [`fail`](Self::fail), for a problem that is likely to recur in every snapshot.
    fn fail_once(&mut self, problem: String) {
        if self.problem != problem {
            self.fail(problem);
        }
    }

    fn speed(&self) -> SimulationSpeed {
        SimulationSpeed {
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

    /// Replaces the model.
    fn load(&mut self, model: &Arc<Model>, kept: Kept) -> Result<()> {
        let initial = Data::new(model)?;
        self.endpoint.end_perturbation(&mut self.data);
        match kept {
            Kept::Nothing => {
                self.data = initial;
                self.endpoint.adopt(&self.data);
            }
            Kept::View => {
                self.endpoint.adopt_edited(&initial, &initial);
                self.data = initial;
            }
            Kept::State => {
                self.data.adopt(model)?;
                self.endpoint.adopt_edited(&self.data, &initial);
            }
        }
        self.model_replaced();
        Ok(())
    }

    fn model_replaced(&mut self) {
        self.history = History::new(self.data.model());
        self.noise.reset();
        if self.player.as_ref().is_some_and(|player| !player.fits(self.data.model())) {
            self.player = None;
            self.update_modes();
            if !self.modes.contains(&self.mode) {
                self.mode = self.modes[0];
            }
        }
        self.problem.clear();
        self.stale = true;
        self.show_record();
    }
}

/// Thread that runs a simulation. It ends when the window's end of the link is closed or dropped.
#[derive(Debug)]
pub(crate) struct PhysicsThread {
    thread: JoinHandle<Data>,
}

impl PhysicsThread {
    /// Starts the thread.
    pub fn start(simulation: Simulation) -> io::Result<Self> {
        let thread = thread::Builder::new().name("physics".to_owned()).spawn(move || simulation.run())?;
        Ok(Self { thread })
    }

    /// Waits for the end of the thread. `None` if it has panicked.
    pub fn join(self) -> Option<Data> {
        self.thread.join().ok()
    }
}
