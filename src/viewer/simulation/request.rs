//! Execution of requests by the simulation.

use super::{MAX_FACTOR, MIN_FACTOR, Player, Simulation};
use crate::viewer::link::{Burst, Event, Mode, PlaybackRequest, Request, SimulationRequest};

/// Maximum number of steps of a single request.
const MAX_STEPS: u32 = 10_000;

impl Simulation {
    /// Executes a request.
    pub(super) fn execute(&mut self, request: Request) {
        self.unpublished = true;
        if self.stale && request.reads_poses() && self.data.check_usable().is_ok() {
            self.refresh();
        }
        // A pull acts during a step. The playback of records applies no forces.
        if request.moves_perturbation() && !self.paused && self.mode != Mode::Trajectory {
            self.step_pending |= self.endpoint.is_perturbing();
        }
        match request {
            Request::Pause(paused) => self.pause(paused),
            Request::TogglePause => self.pause(!self.paused),
            Request::Reset => self.reset(),
            Request::Simulation(request) => self.execute_simulation(request),
            Request::Playback(request) => self.execute_playback(request),
            Request::Endpoint(request) => match self.endpoint.execute(request, &mut self.data) {
                Ok(changed) => self.stale |= changed,
                // Only the request has failed; the simulation is unchanged.
                Err(error) => self.endpoint.link.send(Event::Notice(error.to_string())),
            },
        }
        if self.endpoint.instruments.has_edits() {
            self.declare_instruments();
        }
    }

    fn execute_simulation(&mut self, request: SimulationRequest) {
        match request {
            SimulationRequest::Step(steps) => self.step_by(steps),
            SimulationRequest::ToggleSpeed => self.by_factor = !self.by_factor,
            SimulationRequest::Faster => self.set_factor(self.factor * 2.0),
            SimulationRequest::Slower => self.set_factor(self.factor / 2.0),
            SimulationRequest::SetSpeed(factor) => self.set_factor(factor),
            SimulationRequest::CycleMode(step) => {
                let present = self.modes.iter().position(|&mode| mode == self.mode).unwrap_or(0) as i32;
                let next = (present + step).rem_euclid(self.modes.len() as i32) as usize;
                self.set_mode(self.modes[next]);
            }
            SimulationRequest::SetMode(mode) => {
                if self.modes.contains(&mode) {
                    self.set_mode(mode);
                }
            }
            SimulationRequest::SetNoise(noise) => {
                self.noise.settings = noise;
                self.noise.reset();
            }
            SimulationRequest::Scrub(index) => self.scrub(index),
            SimulationRequest::Load(model, kept) => {
                let loaded = self.load(&model.0, kept);
                self.check(loaded);
            }
        }
    }

    fn execute_playback(&mut self, request: PlaybackRequest) {
        self.with_player(|player| match request {
            PlaybackRequest::ToggleReverse => player.reversed = !player.reversed,
            PlaybackRequest::CycleTrajectory(step) => player.cycle(step),
            PlaybackRequest::SetTrajectory(index) => player.choose(index),
            PlaybackRequest::SetFrame(frame) => player.go_to(frame),
            PlaybackRequest::ToggleBurst => player.burst.on = !player.burst.on,
            PlaybackRequest::ToggleDoppler => player.burst.doppler = !player.burst.doppler,
            PlaybackRequest::ChangeBurstFactor(notches) => {
                player.burst.factor = Burst::adjusted(player.burst.factor, notches);
            }
            PlaybackRequest::ChangeBurstGamma(notches) => {
                player.burst.gamma = Burst::adjusted(player.burst.gamma, notches);
            }
        });
    }

    fn pause(&mut self, paused: bool) {
        if !paused {
            if let Err(error) = self.data.check_usable() {
                return self.fail(error.to_string());
            }
            self.problem.clear();
        } else if !self.paused && self.mode != Mode::Trajectory {
            // After a step, derived quantities refer to the state before it. A paused window must
            // show the current state.
            self.stale = true;
        }
        self.step_pending = !paused && (self.paused || self.step_pending);
        self.paused = paused;
    }

    fn step_by(&mut self, steps: i32) {
        if !self.paused {
            return;
        }
        if self.mode == Mode::Trajectory {
            let timestep = self.data.model().timestep();
            self.with_player(|player| {
                player.advance(steps.into(), timestep);
            });
            return;
        }
        let number = steps.unsigned_abs().min(MAX_STEPS);
        if steps < 0 { self.step_back(number) } else { self.step_while_paused(number) }
    }

    fn set_factor(&mut self, factor: f64) {
        if factor.is_finite() {
            self.factor = factor.clamp(MIN_FACTOR, MAX_FACTOR);
            self.by_factor = true;
        }
    }

    fn set_mode(&mut self, mode: Mode) {
        if mode == self.mode {
            return;
        }
        if self.mode != Mode::Passive {
            // Controls of a controller or a record must not persist.
            let cleared = self.endpoint.clear_inputs(&mut self.data);
            self.check(cleared);
        }
        self.mode = mode;
        self.stale = true;
        self.clock.stop();
        self.show_record();
    }

    fn reset(&mut self) {
        self.problem.clear();
        if self.mode == Mode::Trajectory {
            self.with_player(|player| player.go_to(0));
            return;
        }
        self.noise.reset();
        let reset = self.endpoint.reset(&mut self.data);
        self.stale = false;
        self.check(reset);
    }

    fn scrub(&mut self, index: usize) {
        if self.mode == Mode::Trajectory || self.data.check_usable().is_err() {
            return;
        }
        self.pause(true);
        if self.history.go_to(index, &mut self.data) {
            self.problem.clear();
            self.stale = true;
        }
    }

    /// Modifies the player in the trajectory mode, and shows the current record.
    fn with_player(&mut self, change: impl FnOnce(&mut Player)) {
        if let Some(player) = self.player.as_mut().filter(|_| self.mode == Mode::Trajectory) {
            change(player);
            self.show_record();
        }
    }
}
