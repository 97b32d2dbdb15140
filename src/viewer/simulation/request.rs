//! Requests that are for a simulation.

use super::{LEAST_FACTOR, MOST_FACTOR, Simulation};
use crate::viewer::bridge::Outcome;
use crate::viewer::event::Event;
use crate::viewer::mode::{Burst, Mode, Player};
use crate::viewer::request::Request;

/// How many steps are taken at once at most.
const MOST_STEPS: u32 = 10_000;

impl Simulation {
    /// Executes a request.
    pub(super) fn execute(&mut self, request: Request) {
        self.unseen = true;
        if self.stale && request.reads_poses() && self.data.check_usable().is_ok() {
            self.refresh();
        }
        // The force of a pull acts in a step. Records are played without forces.
        if matches!(request, Request::MovePerturbation(..)) && !self.paused && self.mode != Mode::Trajectory {
            self.owes_step |= self.bridge.is_pulling();
        }
        match request {
            Request::Pause(paused) => self.pause(paused),
            Request::TogglePause => self.pause(!self.paused),
            Request::Step(steps) => self.step_by(steps),
            Request::ToggleSpeed => self.by_factor = !self.by_factor,
            Request::Faster => self.set_factor(self.factor * 2.0),
            Request::Slower => self.set_factor(self.factor / 2.0),
            Request::SetSpeed(factor) => self.set_factor(factor),
            Request::CycleMode(step) => {
                let present = self.modes.iter().position(|&mode| mode == self.mode).unwrap_or(0) as i32;
                let next = (present + step).rem_euclid(self.modes.len() as i32) as usize;
                self.set_mode(self.modes[next]);
            }
            Request::SetMode(mode) if self.modes.contains(&mode) => self.set_mode(mode),
            Request::SetMode(_) => {}
            Request::Scrub(index) => self.scrub(index),
            Request::Reload(model) => {
                let reloaded = self.reload(model);
                self.note(reloaded);
            }
            Request::Reset => self.reset(),
            Request::Reverse => self.play(|player| player.reversed = !player.reversed),
            Request::CycleTrajectory(step) => self.play(|player| player.cycle(step)),
            Request::SetTrajectory(index) => self.play(|player| player.choose(index)),
            Request::SetFrame(frame) => self.play(|player| player.go_to(frame)),
            Request::Burst => self.play(|player| player.burst.on = !player.burst.on),
            Request::Doppler => self.play(|player| player.burst.doppler = !player.burst.doppler),
            Request::BurstFactor(notches) => {
                self.play(|player| player.burst.factor = Burst::turned(player.burst.factor, notches));
            }
            Request::BurstGamma(notches) => {
                self.play(|player| player.burst.gamma = Burst::turned(player.burst.gamma, notches));
            }
            other => match self.bridge.execute(other, &mut self.data) {
                Ok(Outcome::Changed) => self.stale = true,
                Ok(Outcome::Done | Outcome::Left) => {}
                // The simulation goes on as it was; what has failed is what was asked for.
                Err(error) => self.bridge.back.tell(Event::Notice(error.to_string())),
            },
        }
    }

    fn pause(&mut self, paused: bool) {
        if !paused {
            if let Err(error) = self.data.check_usable() {
                return self.fail(error.to_string());
            }
            self.problem.clear();
        } else if !self.paused && self.mode != Mode::Trajectory {
            // A step leaves quantities of the state before it, which is not what is shown standing still.
            self.stale = true;
        }
        self.owes_step = !paused && (self.paused || self.owes_step);
        self.paused = paused;
    }

    fn step_by(&mut self, steps: i32) {
        if !self.paused {
            return;
        }
        if self.mode == Mode::Trajectory {
            let timestep = self.data.model().timestep();
            self.play(|player| {
                player.advance(steps.into(), timestep);
            });
            return;
        }
        let number = steps.unsigned_abs().min(MOST_STEPS);
        if steps < 0 { self.step_back(number) } else { self.step_while_paused(number) }
    }

    fn set_factor(&mut self, factor: f64) {
        if factor.is_finite() {
            self.factor = factor.clamp(LEAST_FACTOR, MOST_FACTOR);
            self.by_factor = true;
        }
    }

    fn set_mode(&mut self, mode: Mode) {
        if mode == self.mode {
            return;
        }
        if self.mode != Mode::Passive {
            // What a controller or a record has set is not to go on by itself.
            let cleared = self.bridge.clear_inputs(&mut self.data);
            self.note(cleared);
        }
        self.mode = mode;
        self.stale = true;
        self.clock.stop();
        self.show_record();
    }

    fn reset(&mut self) {
        self.problem.clear();
        if self.mode == Mode::Trajectory {
            self.play(|player| player.go_to(0));
            return;
        }
        let reset = self.bridge.reset(&mut self.data);
        self.stale = false;
        self.note(reset);
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

    /// Changes how trajectories are played, where they are.
    fn play(&mut self, change: impl FnOnce(&mut Player)) {
        if let Some(player) = self.player.as_mut().filter(|_| self.mode == Mode::Trajectory) {
            change(player);
            self.show_record();
        }
    }
}
