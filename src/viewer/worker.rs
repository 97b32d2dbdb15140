//! The physics thread.

use std::thread::JoinHandle;

use super::simulation::Simulation;
use crate::data::Data;

/// The physics thread. It ends when the window's end of the link is closed or dropped; close that before the worker is dropped,
/// which waits for the thread.
#[derive(Debug)]
pub(crate) struct Worker {
    thread: Option<JoinHandle<Data>>,
}

impl Worker {
    /// Starts it.
    pub fn start(simulation: Simulation) -> std::io::Result<Self> {
        let thread = std::thread::Builder::new().name("mujoco-safe physics".to_owned());
        Ok(Self { thread: Some(thread.spawn(move || simulation.into_data())?) })
    }

    /// Waits for its end. The link must have been closed. `None` if it panicked.
    pub fn join(mut self) -> Option<Data> {
        self.thread.take()?.join().ok()
    }
}
