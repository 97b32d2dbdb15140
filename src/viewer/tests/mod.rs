//! The viewer without a window: keys, mouse, requests, modes, failures, threads.

mod batch;
mod expected;
mod failure;
mod handle;
mod key;
mod memory;
mod mode;
mod mouse;
mod request;
mod thread;

use std::cell::Cell;
use std::time::Duration;

use super::event::Event;
use super::input::{Key, KeyPress, Modifiers, action};
use super::link::{Front, link};
use super::mode::Mode;
use super::request::Request;
use super::simulation::Simulation;
use super::snapshot::Snapshot;
use super::view::{Effect, View};
use crate::controller::Controller;
use crate::data::Data;
use crate::{Trajectory, sample};

/// A viewer without a window: the physics takes its turns when the test says, and time passes when the test says.
pub(super) struct Bench {
    pub front: Front,
    pub simulation: Simulation,
    pub view: View,
    pub now: Cell<Duration>,
}

impl Bench {
    pub fn new(data: Data) -> Self {
        Self::with(data, None, Vec::new())
    }

    pub fn with(data: Data, controller: Option<Box<dyn Controller + Send>>, trajectories: Vec<Trajectory>) -> Self {
        let view = View::new(data.model());
        let (front, back) = link(|| ());
        let simulation = Simulation::new(data, controller, trajectories, back).unwrap();
        let mut bench = Self { front, simulation, view, now: Cell::new(Duration::ZERO) };
        bench.shown();
        bench
    }

    /// The humanoid above the ground, and standing still for ever in the air if it is not let go.
    pub fn humanoid() -> Self {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.reset_to_key("squat").unwrap();
        Self::new(data)
    }

    /// Asks, has the physics take its turn, and looks.
    pub fn ask(&mut self, request: Request) -> &Snapshot {
        self.front.look(&self.view.look());
        self.front.ask(request);
        self.turn()
    }

    /// A turn of the physics, and a look at what it shows.
    pub fn turn(&mut self) -> &Snapshot {
        self.front.look(&self.view.look());
        let now = &self.now;
        self.simulation.turn(&|| now.get());
        self.shown()
    }

    /// Lets time pass: the physics takes its turns whenever it wants to, and a step takes no time.
    pub fn pass(&mut self, seconds: f64) -> &Snapshot {
        let end = self.now.get() + Duration::from_secs_f64(seconds);
        self.front.look(&self.view.look());
        loop {
            let now = &self.now;
            // A clock that stands still would have it step for ever, were it not for what is due.
            let until = self.simulation.turn(&|| now.get());
            match until {
                Some(until) if until < end => {
                    self.now.set(until.max(self.now.get() + Duration::from_micros(100)));
                }
                _ => break,
            }
            self.shown();
        }
        self.now.set(end);
        self.turn()
    }

    /// The newest snapshot.
    pub fn shown(&mut self) -> &Snapshot {
        self.front.latest().expect("a snapshot").0
    }

    /// Presses a key, as the window would.
    pub fn press(&mut self, key: Key, modifiers: Modifiers) -> Pressed {
        self.hold(KeyPress { key, modifiers, repeat: false })
    }

    /// Presses a key or holds it.
    pub fn hold(&mut self, press: KeyPress) -> Pressed {
        let mode = self.shown().mode;
        let Some(action) = action(press, mode) else { return Pressed::Unused };
        let model = self.shown().model.clone();
        match self.view.act(action, &model) {
            Effect::Done => {
                self.turn();
                Pressed::Done
            }
            Effect::Ask(request) => {
                self.ask(request);
                Pressed::Done
            }
            Effect::Window(action) => Pressed::Window(action),
        }
    }

    /// What the physics has said once.
    pub fn events(&mut self) -> Vec<Event> {
        let events = self.front.events();
        for event in &events {
            self.view.take(event);
        }
        events
    }

    pub fn mode(&mut self) -> Mode {
        self.shown().mode
    }
}

/// What became of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pressed {
    Unused,
    Done,
    Window(super::input::WindowAction),
}

/// Three trajectories of the cart-pole, of different lengths.
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
