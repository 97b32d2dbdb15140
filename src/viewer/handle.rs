//! For programs that have a loop of their own.

use std::sync::Arc;

use super::input::KeyPress;
use super::link::Back;
use crate::data::Data;
use crate::error::Result;
use crate::scene::{Camera, NewGeom, SceneOptions};

/// A window that a program shows its simulation in.
#[derive(Debug)]
pub struct Handle {
    back: Arc<Back>,
}

impl Handle {
    pub(crate) fn new(back: Back) -> Self {
        Self { back: Arc::new(back) }
    }

    /// Whether the window is open.
    pub fn is_running(&self) -> bool {
        !self.back.is_closed()
    }

    /// Closes the window.
    pub fn close(&mut self) {
        self.back.close();
    }

    /// Shows the simulation as it stands, and does to it what was asked for in the window.
    pub fn sync(&mut self, data: &mut Data) -> Result<()> {
        let _ = data;
        Ok(())
    }

    /// Whether the user has paused.
    pub fn is_paused(&self) -> bool {
        false
    }

    /// From where the window looks.
    pub fn camera(&self) -> Option<Camera> {
        None
    }

    /// At what the window looks.
    pub fn options(&self) -> SceneOptions {
        SceneOptions::default()
    }

    /// Geoms of the program's.
    pub fn geoms(&mut self) -> &mut Vec<NewGeom> {
        todo!()
    }

    /// Keys that the viewer has no use for, since the last call.
    pub fn keys(&mut self) -> Vec<KeyPress> {
        Vec::new()
    }
}
