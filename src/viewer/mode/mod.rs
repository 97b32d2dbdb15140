//! What makes a simulation move: a controller, recorded trajectories, or nothing but the dynamics.
//!
//! | file | what is in it |
//! |---|---|
//! | `player.rs` | which moment of which trajectory is shown |
//! | `burst.rs` | other moments of it in the same picture |
//! | `info.rs` | what a mode says in the info panel |

mod burst;
mod info;
mod player;

use std::fmt;

pub(crate) use self::burst::Burst;
pub(crate) use self::info::{InfoLine, InfoLines};
pub(crate) use self::player::{Playback, Player};

/// What makes a simulation move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Mode {
    /// A controller decides on the controls before each step.
    Controller,
    /// Recorded states are shown.
    Trajectory,
    /// The dynamics alone.
    Passive,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Controller => "Controller",
            Self::Trajectory => "Trajectory",
            Self::Passive => "Passive Dynamics",
        })
    }
}
