//! Single steps in each mode, and recovery from steps that fail.

use std::time::{Duration, Instant};

use super::{History, NoiseSource, Simulation};
use crate::data::Data;
use crate::error::{Result, catch_panic};
use crate::viewer::endpoint::SimulationEndpoint;
use crate::viewer::instruments::{InstrumentedController, Instruments};
use crate::viewer::link::{InfoLine, InfoLines, Mode};

/// Weight of the newest step in the moving averages.
const WEIGHT: f64 = 0.1;

/// Exponential moving averages of the computing time of a step, s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepTiming {
    controller: f64,
    step: f64,
}

impl StepTiming {
    fn record(&mut self, controller: Duration, step: Duration) {
        for (mean, new) in [(&mut self.controller, controller), (&mut self.step, step)] {
            let new = new.as_secs_f64();
            *mean = if *mean == 0.0 { new } else { *mean + WEIGHT * (new - *mean) };
        }
    }

    /// Writes the lines of the controller mode in the info panel.
    pub fn describe(self, timestep: f64, lines: &mut Vec<InfoLine>) {
        let mut lines = InfoLines::new(lines);
        let total = self.controller + self.step;
        if total > 0.0 {
            lines.push("Max Speed", format_args!("{:.2}x", timestep / total));
            lines.push("Controller Time", format_args!("{:.3} ms", 1e3 * self.controller));
            lines.push("Step Time", format_args!("{:.3} ms", 1e3 * self.step));
        } else {
            lines.push("Max Speed", format_args!("-"));
        }
        lines.finish();
    }
}

impl Simulation {
    /// Takes a step forward in time, or plays a record. Returns the simulated duration, s. After an
    /// error it returns `None`, and the simulation is paused in the state before the step.
    pub(super) fn step(&mut self) -> Option<f64> {
        let timestep = self.data.model().timestep();
        if self.mode == Mode::Trajectory {
            let player = self.player.as_mut().expect("Bug: trajectory mode without a player");
            let duration = player.play(timestep);
            self.step_pending = false;
            self.show_record();
            return (!self.paused).then_some(duration);
        }
        if self.stale {
            self.refresh();
            if self.stale {
                return None;
            }
        }
        self.history.record(&self.data);
        let controller = self.controller.as_deref_mut().filter(|_| self.mode == Mode::Controller);
        match Self::take_step(&mut self.data, &mut self.endpoint, controller, &mut self.noise, &mut self.timing) {
            Ok(()) => {
                if !self.endpoint.is_for(&self.data) {
                    // The controller may replace the data by data of another model.
                    self.endpoint.adopt(&self.data);
                    self.history = History::new(self.data.model());
                }
                (self.unpublished, self.step_pending) = (true, false);
                Some(timestep)
            }
            Err(problem) => {
                self.recover();
                self.fail(problem);
                None
            }
        }
    }

    /// Takes steps forward while paused.
    pub(super) fn step_while_paused(&mut self, steps: u32) {
        self.problem.clear();
        for _ in 0..steps {
            if self.step().is_none() || self.endpoint.link.is_closed() {
                return;
            }
        }
        // After a step, derived quantities refer to the state before it.
        self.stale = true;
    }

    /// Goes back by this number of steps while paused.
    pub(super) fn step_back(&mut self, steps: u32) {
        if self.data.check_usable().is_err() {
            return;
        }
        if self.history.back(steps as usize, &mut self.data) {
            self.problem.clear();
            (self.stale, self.unpublished) = (true, true);
        }
    }

    /// Recomputes the quantities that depend on the state.
    pub(super) fn refresh(&mut self) {
        let refreshed = self.endpoint.refresh(&mut self.data);
        self.unpublished = true;
        if self.check(refreshed).is_some() {
            self.stale = false;
        }
    }

    /// Lets the controller declare its instruments, and receive the parameters that the user has
    /// changed.
    pub(super) fn declare_instruments(&mut self) {
        let Self { data, endpoint, controller, mode, .. } = self;
        let controller = controller.as_deref_mut().filter(|_| *mode == Mode::Controller);
        let (Some(controller), Ok(())) = (controller, data.check_usable()) else {
            return endpoint.instruments.clear();
        };
        let declared = endpoint.instruments.declare(|instruments| declare(controller, data, instruments));
        if let Err(problem) = declared {
            endpoint.instruments.clear();
            self.fail_once(problem);
        }
    }

    fn take_step(
        data: &mut Data,
        endpoint: &mut SimulationEndpoint,
        controller: Option<&mut (dyn InstrumentedController + 'static)>,
        noise: &mut NoiseSource,
        timing: &mut StepTiming,
    ) -> Result<(), String> {
        let start = Instant::now();
        if let Some(controller) = controller {
            catch("the controller", || controller.control(data))?;
            endpoint.instruments.sample(|instruments| declare(controller, data, instruments))?;
        }
        let controlled = Instant::now();
        let stepped = catch("the step", || {
            // After the controller, because it may overwrite all applied forces.
            endpoint.apply_perturbation(data)?;
            noise.apply(data);
            data.step()
        });
        noise.remove(data);
        endpoint.remove_perturbation(data);
        stepped?;
        endpoint.sample(data);
        timing.record(controlled - start, controlled.elapsed());
        Ok(())
    }

    /// Restores the state before a step that failed.
    fn recover(&mut self) {
        if self.data.check_usable().is_err() && self.data.reset().is_err() {
            return;
        }
        self.history.undo(&mut self.data);
        self.stale = self.endpoint.refresh(&mut self.data).is_err();
    }
}

/// Lets a controller declare its instruments.
fn declare(
    controller: &mut dyn InstrumentedController,
    data: &Data,
    instruments: &mut Instruments,
) -> Result<(), String> {
    catch("the closure for instruments", || controller.declare(data, instruments))
}

/// Calls a closure, and converts an error or a panic into a message. The caller must restore what
/// the closure has modified.
fn catch<T>(what: &str, call: impl FnOnce() -> Result<T>) -> Result<T, String> {
    match catch_panic(call) {
        Ok(result) => result.map_err(|error| error.to_string()),
        Err(message) => Err(format!("{what} panicked: {message}")),
    }
}
