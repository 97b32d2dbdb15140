//! Simulations of a batch, and their division among threads.

use super::Read;
use super::forward::forward_between_steps;
use super::parallel::{Split, split_rows};
use super::result::no_room;
use super::workers::restart;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::matrix::MatrixView;

/// Simulation of a batch.
pub(super) struct Simulation {
    pub(super) data: Data,
    /// Error that stopped the simulation, if any.
    pub(super) failure: Option<Error>,
    /// Number of resets.
    pub(super) episode: u64,
    /// Memory of [`forward_between_steps`].
    saved: Vec<f64>,
}

/// Reader of observations.
#[derive(Clone, Copy)]
pub(super) struct Observer<'o> {
    pub(super) read: &'o Read<'o>,
    /// `true` if forward dynamics is computed first.
    pub(super) forward: bool,
}

impl Simulation {
    pub(super) fn new(data: Data) -> Self {
        Self { data, failure: None, episode: 0, saved: Vec::new() }
    }

    /// Resets the simulation to the reference position, and starts the next episode.
    pub(super) fn restart(&mut self) -> Result<()> {
        self.episode += 1;
        self.failure = None;
        restart(&mut self.data)
    }

    /// Writes the observations, or NaN if the simulation has failed.
    pub(super) fn observe(&mut self, observer: Observer<'_>, row: &mut [f64]) {
        if observer.forward && self.failure.is_none() {
            self.failure = forward_between_steps(&mut self.data, &mut self.saved).err();
        }
        if self.failure.is_some() {
            row.fill(f64::NAN);
        } else {
            row.fill(0.0);
            (observer.read)(&self.data, row);
        }
    }
}

/// Simulation with its controls and its row of observations.
pub(super) struct Member<'m> {
    pub(super) simulation: &'m mut Simulation,
    pub(super) controls: &'m [f64],
    pub(super) row: &'m mut [f64],
    pub(super) observer: Observer<'m>,
}

impl Member<'_> {
    /// Steps the simulation, until an error stops it.
    pub(super) fn advance(&mut self, substeps: usize) {
        let data = &mut self.simulation.data;
        let set = data.set_state(StateSpec::CTRL, self.controls);
        let result = set.and_then(|()| data.step_n(substeps));
        self.simulation.failure = result.err();
    }

    pub(super) fn observe(&mut self) {
        self.simulation.observe(self.observer, self.row);
    }
}

/// Part of the simulations, with all controls.
pub(super) struct Members<'b> {
    pub(super) simulations: &'b mut [Simulation],
    pub(super) controls: MatrixView<'b>,
    pub(super) observations: &'b mut [f64],
    pub(super) width: usize,
}

impl Split for Members<'_> {
    fn count(&self) -> usize {
        self.simulations.len()
    }

    fn split(self, first: usize) -> (Self, Self) {
        let Self { controls, width, .. } = self;
        let (simulations, other_simulations) = self.simulations.split_at_mut(first);
        let (observations, other_observations) = split_rows(self.observations, first, width);
        (
            Self { simulations, controls, observations, width },
            Self { simulations: other_simulations, controls, observations: other_observations, width },
        )
    }
}

/// Checks that there is enough memory for all simulations, before they are allocated.
pub(super) fn check_memory(simulation: &Data, count: usize) -> Result<()> {
    // SAFETY: the pointer is valid, and nothing writes to the simulation while it is borrowed.
    let (buffer, stack) =
        unsafe { ((*simulation.as_ptr()).nbuffer, mujoco_sys::adapted::arena_bytes(simulation.as_ptr())) };
    let bytes = usize::try_from(buffer).ok().and_then(|buffer| {
        let one = stack.checked_add(buffer)?.checked_add(size_of::<Simulation>())?;
        one.checked_mul(count)
    });
    let fits = bytes.is_some_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if fits { Ok(()) } else { Err(no_room("simulations", count)) }
}
