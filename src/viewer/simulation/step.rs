//! One step, in each mode, and what becomes of one that fails.

use std::time::{Duration, Instant};

use super::Simulation;
use super::caught::caught;
use crate::controller::Controller;
use crate::data::Data;
use crate::error::Result;
use crate::viewer::bridge::Bridge;
use crate::viewer::history::History;
use crate::viewer::mode::{InfoLine, InfoLines, Mode};

/// How much of the mean the newest step is.
const NEWEST: f64 = 0.1;

/// How long steps take, s: means in which the newest count most.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    controller: f64,
    step: f64,
}

impl Effort {
    fn take(&mut self, controller: Duration, step: Duration) {
        for (mean, new) in [(&mut self.controller, controller), (&mut self.step, step)] {
            let new = new.as_secs_f64();
            *mean = if *mean == 0.0 { new } else { *mean + NEWEST * (new - *mean) };
        }
    }

    /// What the controller mode says in the info panel.
    pub fn describe(self, timestep: f64, lines: &mut Vec<InfoLine>) {
        let mut lines = InfoLines::new(lines);
        let whole = self.controller + self.step;
        if whole > 0.0 {
            lines.push("Realtime Factor", format_args!("{:.2}x", timestep / whole));
            lines.push("Controller Time", format_args!("{:.3} ms", 1e3 * self.controller));
            lines.push("Step Time", format_args!("{:.3} ms", 1e3 * self.step));
        } else {
            lines.push("Realtime Factor", format_args!("-"));
        }
        lines.finish();
    }
}

impl Simulation {
    /// Takes a step forward in time, or plays a record. How long it lasts in simulated time is returned, s; `None` if it failed:
    /// then it is told, and the simulation stands as it was before.
    pub(super) fn step(&mut self) -> Option<f64> {
        let timestep = self.data.model().timestep();
        if self.mode == Mode::Trajectory {
            let player = self.player.as_mut().expect("Bug: the trajectory mode without trajectories");
            let taken = player.play(timestep);
            self.owes_step = false;
            self.show_record();
            return (!self.paused).then_some(taken);
        }
        if self.stale {
            self.refresh();
            if self.stale {
                return None;
            }
        }
        self.history.record(&self.data);
        let controller = self.controller.as_deref_mut().filter(|_| self.mode == Mode::Controller);
        match Self::take_step(&mut self.data, &mut self.bridge, controller, &mut self.effort) {
            Ok(()) => {
                if !self.bridge.is_for(&self.data) {
                    // The controller may replace the simulation by any other.
                    self.bridge.adopt(&self.data);
                    self.history = History::new(self.data.model());
                }
                (self.unseen, self.owes_step) = (true, false);
                Some(timestep)
            }
            Err(problem) => {
                self.recover();
                self.fail(problem);
                None
            }
        }
    }

    /// Takes so many steps forward while paused.
    pub(super) fn step_while_paused(&mut self, steps: u32) {
        self.problem.clear();
        for _ in 0..steps {
            if self.step().is_none() || self.bridge.back.is_closed() {
                return;
            }
        }
        // The last step has left quantities of the state before it.
        self.stale = true;
    }

    /// Goes so many steps back while paused.
    pub(super) fn step_back(&mut self, steps: u32) {
        if self.data.check_usable().is_err() {
            return;
        }
        if self.history.back(steps as usize, &mut self.data) {
            self.problem.clear();
            (self.stale, self.unseen) = (true, true);
        }
    }

    /// Brings what depends on the state up to date.
    pub(super) fn refresh(&mut self) {
        let refreshed = self.bridge.refresh(&mut self.data);
        // What cannot be computed is told once, not again and again.
        self.unseen = true;
        if self.note(refreshed).is_some() {
            self.stale = false;
        }
    }

    fn take_step(
        data: &mut Data,
        bridge: &mut Bridge,
        controller: Option<&mut (dyn Controller + Send + 'static)>,
        effort: &mut Effort,
    ) -> Result<(), String> {
        let start = Instant::now();
        if let Some(controller) = controller {
            caught("the controller", || controller.control(data))?;
        }
        let controlled = Instant::now();
        let stepped = caught("the step", || {
            // After the controller, which may set all applied forces.
            bridge.apply_perturbation(data)?;
            data.step()
        });
        bridge.remove_perturbation(data);
        stepped?;
        effort.take(controlled - start, controlled.elapsed());
        Ok(())
    }

    /// Puts the simulation where it was before a step that failed.
    fn recover(&mut self) {
        if self.data.check_usable().is_err() && self.data.reset().is_err() {
            return;
        }
        self.history.take_back(&mut self.data);
        self.stale = self.bridge.refresh(&mut self.data).is_err();
    }
}
