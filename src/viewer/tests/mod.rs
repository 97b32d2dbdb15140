//! Tests of the viewer without a window: keys, mouse, requests, modes, failures and threads.

mod batch;
mod failure;
mod handle;
mod instruments;
mod key;
mod mode;
mod mouse;
mod panel;
mod request;
mod save;
mod screen;
mod text_field;
mod thread;

use std::cell::Cell;
use std::time::Duration;

use super::input::{Action, Key, KeyPress, Modifiers, WindowAction, find_action};
use super::instruments::InstrumentedController;
use super::link::{Event, Mode, Request, Snapshot, WindowEnd, link};
use super::simulation::Simulation;
use super::view::View;
use crate::controller::Controller;
use crate::data::Data;
use crate::{Trajectory, sample};

/// Viewer without a window. The test controls the ticks of the simulation and the clock.
pub(super) struct Bench {
    pub window: WindowEnd,
    pub simulation: Simulation,
    pub view: View,
    pub now: Cell<Duration>,
}

impl Bench {
    pub fn new(data: Data) -> Self {
        Self::with(data, None, Vec::new())
    }

    pub fn with(data: Data, controller: Option<Box<dyn Controller + Send>>, trajectories: Vec<Trajectory>) -> Self {
        let controller = controller.map(|controller| Box::new(controller) as _);
        Self::start(data, controller, trajectories)
    }

    /// Creates a bench for a controller with instruments.
    pub fn instrumented(data: Data, controller: impl InstrumentedController + 'static) -> Self {
        Self::start(data, Some(Box::new(controller)), Vec::new())
    }

    fn start(data: Data, controller: Option<Box<dyn InstrumentedController>>, trajectories: Vec<Trajectory>) -> Self {
        let view = View::new(data.model());
        let (window, physics) = link(|| ());
        let named = trajectories.into_iter().zip(["one", "two", "three"]);
        let named = named.map(|(trajectory, name)| (name.to_owned(), trajectory)).collect();
        let simulation = Simulation::new(data, controller, named, physics).unwrap();
        let mut bench = Self { window, simulation, view, now: Cell::new(Duration::ZERO) };
        bench.snapshot();
        bench
    }

    /// Creates a bench with the humanoid above the ground.
    pub fn humanoid() -> Self {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.reset_to_key("squat").unwrap();
        Self::new(data)
    }

    /// Sends a request, ticks the simulation and returns the newest snapshot.
    pub fn send(&mut self, request: impl Into<Request>) -> &Snapshot {
        self.window.set_view(&self.view.scene_view());
        self.window.send(request);
        self.tick()
    }

    /// Ticks the simulation and returns the newest snapshot.
    pub fn tick(&mut self) -> &Snapshot {
        self.window.set_view(&self.view.scene_view());
        let now = &self.now;
        self.simulation.tick(&|| now.get());
        self.snapshot()
    }

    /// Advances the clock and ticks the simulation at the times that it requests. A step costs no
    /// time.
    pub fn pass(&mut self, seconds: f64) -> &Snapshot {
        let end = self.now.get() + Duration::from_secs_f64(seconds);
        self.window.set_view(&self.view.scene_view());
        loop {
            let now = &self.now;
            // The clock does not advance during the tick, so the simulation takes only the steps
            // that are due.
            let next = self.simulation.tick(&|| now.get());
            match next {
                Some(next) if next < end => {
                    self.now.set(next.max(self.now.get() + Duration::from_micros(100)));
                }
                _ => break,
            }
            self.snapshot();
        }
        self.now.set(end);
        self.tick()
    }

    /// Returns the newest snapshot.
    pub fn snapshot(&mut self) -> &Snapshot {
        self.window.latest().expect("a snapshot").0
    }

    /// Presses a key as the window does.
    pub fn press(&mut self, key: Key, modifiers: Modifiers) -> Pressed {
        let press = KeyPress { key, modifiers, repeat: false };
        let mode = self.snapshot().mode;
        let Some(action) = find_action(press, mode, &[]) else { return Pressed::Unused };
        let model = self.snapshot().model.clone();
        match action {
            Action::View(action) => {
                let window_action = self.view.apply(*action, &model);
                self.tick();
                window_action.map_or(Pressed::Done, Pressed::Window)
            }
            Action::Send(request) => {
                self.send(request.clone());
                Pressed::Done
            }
            Action::Window(action) => Pressed::Window(*action),
            Action::Open(_) => unreachable!("no key opens a certain file"),
        }
    }

    /// Removes the events and applies them to the view.
    pub fn events(&mut self) -> Vec<Event> {
        let events = self.window.take_events();
        for event in &events {
            self.view.handle_event(event);
        }
        events
    }

    pub fn mode(&mut self) -> Mode {
        self.snapshot().mode
    }
}

/// Effect of a key press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pressed {
    Unused,
    Done,
    /// Action for the window.
    Window(WindowAction),
}

/// Records three trajectories of the cart-pole with different lengths.
pub(super) fn trajectories() -> Vec<Trajectory> {
    [40, 10, 200]
        .into_iter()
        .enumerate()
        .map(|(index, steps)| {
            let mut data = Data::new(sample::cartpole()).unwrap();
            data.qpos_mut()[1] = 0.1 * (index + 1) as f64;
            let mut trajectory = Trajectory::new(data.model());
            trajectory.record(&mut data, &mut crate::ZeroController, steps).unwrap();
            trajectory
        })
        .collect()
}
