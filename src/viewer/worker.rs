//! The physics thread.

use std::io;
use std::thread::{Builder, JoinHandle};

use super::simulation::Simulation;
use crate::data::Data;

/// The physics thread. It ends when the window's end of the link is closed or dropped, so that must come before the worker's end.
#[derive(Debug)]
pub(crate) struct Worker {
    thread: JoinHandle<Data>,
}

impl Worker {
    /// Starts it.
    pub fn start(simulation: Simulation) -> io::Result<Self> {
        let thread = Builder::new().name("physics".to_owned()).spawn(move || simulation.run())?;
        Ok(Self { thread })
    }

    /// Waits for its end. `None` if it panicked.
    pub fn join(self) -> Option<Data> {
        self.thread.join().ok()
    }
}
