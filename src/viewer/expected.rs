//! The state that requests without an answer lead to.

use super::mode::Mode;
use super::request::Request;
use super::snapshot::Snapshot;
use crate::model::Options;

/// The state that requests without an answer lead to. The window interprets keys, buttons and edits by it: a snapshot is older than
/// the last request while the simulation is busy.
///
/// Requests are numbered from 1. A snapshot has the number of the last request that was executed before it was made.
#[derive(Debug, Default)]
pub(crate) struct Expected {
    /// The last request that may select a body.
    selection: u64,
    mode: Option<(u64, Mode)>,
    options: Option<(u64, Options)>,
}

impl Expected {
    /// Notes a request with its number.
    pub fn note(&mut self, request: &Request, number: u64, snapshot: &Snapshot) {
        match request {
            Request::Select(_) | Request::SelectBody(Some(_)) => self.selection = number,
            Request::SelectBody(None) => self.selection = 0,
            Request::SetMode(mode) if snapshot.modes.contains(mode) => self.mode = Some((number, *mode)),
            Request::CycleMode(step) => {
                let modes = &snapshot.modes;
                if let Some(present) = modes.iter().position(|mode| *mode == self.mode(snapshot)) {
                    let next = (present as i32 + step).rem_euclid(modes.len() as i32) as usize;
                    self.mode = Some((number, modes[next]));
                }
            }
            Request::SetOptions(options) => self.options = Some((number, **options)),
            Request::Reload(_) => *self = Self::default(),
            _ => {}
        }
    }

    /// Returns `true` if a body is selected or may be.
    pub fn is_selected(&self, snapshot: &Snapshot) -> bool {
        snapshot.selected.is_some() || self.selection > snapshot.executed
    }

    /// Returns the mode.
    pub fn mode(&self, snapshot: &Snapshot) -> Mode {
        let expected = self.mode.filter(|(number, _)| *number > snapshot.executed);
        expected.map_or(snapshot.mode, |(_, mode)| mode)
    }

    /// Returns the physics options, from which the next edit starts.
    pub fn options(&self, snapshot: &Snapshot) -> Options {
        let expected = self.options.filter(|(number, _)| *number > snapshot.executed);
        expected.map_or_else(|| snapshot.model.options(), |(_, options)| options)
    }
}
