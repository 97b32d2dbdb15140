//! Ticks of a simulation: the exchange with the browsers, and loops.

use std::thread;
use std::time::{Duration, Instant};

use super::hand;
use super::state::PAUSED;
use super::{LivePage, Tick};
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::matrix::Matrix;

/// Time of a tick while the simulation is paused.
const PAUSED_TICK: Duration = Duration::from_millis(20);

/// Delay from which a simulation in real time does not catch up.
const LARGEST_DELAY: Duration = Duration::from_millis(100);

/// # One simulation
impl LivePage {
    /// Shows the state of the simulation, and carries out the users' requests. Call it before each
    /// step. It never waits for a browser, and does not allocate after the first call, unless the
    /// simulation fails.
    ///
    /// - A reset restores the state of the first call.
    /// - A held control has the user's value from this call on; call this after the controller.
    /// - A pull adds to [`xfrc_applied`](Data::xfrc_applied) until the next call. It sets the pose
    ///   of a mocap body, and of a free body while paused.
    ///
    /// The poses are those of the last step, as [`Data::step`] leaves them. If the data is
    /// unusable, the page shows the error, and the user can reset the simulation.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for data of another model.
    pub fn exchange(&mut self, data: &mut Data) -> Result<Tick> {
        if !self.states.model.is_same_structure(data.model()) {
            return Err(Error::OtherModel { what: "the data of a live page" });
        }
        if self.start.nrows() == 0 {
            let state = data.state(StateSpec::INTEGRATION);
            self.start = Matrix::from_row_major(1, state.len(), state);
        }
        self.site.slots.take(&mut self.requests);
        let usable = self.carry_out(data);
        self.hold(data);
        let advance = self.advances(usable.is_ok() && self.problem.is_none());
        if self.site.slots.is_wanted(self.published) {
            let refreshed = usable.and_then(|()| hand::refresh(data, &mut self.buffer));
            let shown = self.states.collect(data, refreshed.is_ok());
            let problem = refreshed.and(shown).err().map(|error| error.to_string());
            self.publish(0, problem.or_else(|| self.problem.clone()));
        }
        Ok(Tick { advance, reset: self.requests.reset })
    }

    /// Publishes the collected simulations.
    pub(super) fn publish(&mut self, kind: u32, problem: Option<String>) {
        let flags = if self.is_paused { kind | PAUSED } else { kind };
        let (held, problem) = (&self.requests.held, problem.unwrap_or_default());
        self.site.slots.publish(|bytes| self.states.write(flags, held, &problem, bytes));
        self.published = Instant::now();
    }

    /// Carries out the requests for pauses and steps.
    pub(super) fn pause_and_step(&mut self) {
        self.is_paused = self.requests.pause.unwrap_or(self.is_paused);
        self.steps = self.steps.saturating_add(self.requests.steps);
    }

    /// Decides if a usable simulation takes a step, and counts it.
    pub(super) fn advances(&mut self, is_usable: bool) -> bool {
        let advance = is_usable && (!self.is_paused || self.steps > 0);
        self.steps = if advance && self.is_paused { self.steps - 1 } else { 0 };
        advance
    }

    /// Carries out the requests, except held controls. Applies the pull for the next step, or moves
    /// the body while paused.
    fn carry_out(&mut self, data: &mut Data) -> Result<()> {
        self.pause_and_step();
        if self.requests.reset {
            self.hand.let_go(data);
            self.problem = None;
            data.reset()?;
            data.set_state(StateSpec::INTEGRATION, self.start.row(0))?;
            data.forward_between_steps(&mut self.buffer)?;
        }
        let Some((_, pull)) = self.requests.pull else {
            self.hand.let_go(data);
            return data.check_usable();
        };
        data.check_usable()?;
        hand::refresh(data, &mut self.buffer)?;
        self.hand.pull(data, pull)?;
        if !self.is_paused || self.steps > 0 {
            return self.hand.apply(data);
        }
        if self.hand.drag(data)? { data.forward_between_steps(&mut self.buffer) } else { Ok(()) }
    }

    /// Sets the held controls.
    fn hold(&self, data: &mut Data) {
        for (ctrl, held) in data.ctrl_mut().iter_mut().zip(&self.requests.held) {
            *ctrl = held.unwrap_or(*ctrl);
        }
    }

    /// Ends a pull, removes its force, and releases the held controls, which keep their values.
    /// Call it before a simulation continues without the page.
    ///
    /// # Panics
    ///
    /// If a pull is active and the data belongs to another model.
    pub fn let_go(&mut self, data: &mut Data) {
        self.hand.let_go(data);
        self.requests.let_go();
        self.site.slots.let_go();
    }

    /// Makes a tick of a simulation: exchanges with the browsers, and unless the simulation is
    /// paused, calls the controller, sets the held controls and makes a step. Returns `true` if it
    /// has made a step.
    ///
    /// # Errors
    ///
    /// As for [`exchange`](Self::exchange), those of the controller, and those of [`Data::step`].
    pub fn step(&mut self, data: &mut Data, controller: &mut impl Controller) -> Result<bool> {
        let tick = self.exchange(data)?;
        if tick.advance {
            controller.control(data)?;
            self.hold(data);
            data.step()?;
        }
        Ok(tick.advance)
    }

    /// Runs a simulation in real time for this duration of the wall clock, without an end for
    /// [`Duration::MAX`]. If the simulation cannot keep up, it is slower than real time.
    ///
    /// If the controller or a step fails, the page shows the error, and the simulation stops until
    /// a user resets it. Pulls and held controls last beyond the end: see [`let_go`](Self::let_go).
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for data of another model. The error of the controller or the step, if
    /// there is one at the end.
    pub fn run_for(&mut self, duration: Duration, data: &mut Data, controller: &mut impl Controller) -> Result<()> {
        let end = Instant::now().checked_add(duration);
        // Times of the wall clock and of the simulation.
        let mut origin = (Instant::now(), data.time());
        let mut failure = None;
        while end.is_none_or(|end| Instant::now() < end) {
            match self.step(data, controller) {
                Ok(false) => {
                    self.site.slots.wait(PAUSED_TICK);
                    origin = (Instant::now(), data.time());
                }
                Ok(true) => {
                    let simulated = Duration::try_from_secs_f64(data.time() - origin.1).unwrap_or_default();
                    let real = origin.0.elapsed();
                    thread::sleep(simulated.saturating_sub(real).min(LARGEST_DELAY));
                    if real.saturating_sub(simulated) > LARGEST_DELAY {
                        origin = (Instant::now(), data.time());
                    }
                }
                Err(error @ Error::OtherModel { .. }) => return Err(error),
                Err(error) => {
                    log::warn!("the simulation of a live page stops: {error}");
                    self.problem = Some(error.to_string());
                    failure = Some(error);
                }
            }
        }
        // A reset removes the problem.
        failure.filter(|_| self.problem.is_some()).map_or(Ok(()), Err)
    }

    /// Waits until a user makes a request, or the timeout passes. For loops of programs while the
    /// simulation is paused.
    pub fn wait(&self, timeout: Duration) {
        self.site.slots.wait(timeout);
    }
}
