//! The state that browsers receive: times, poses, controls, and vertices of deformable shapes.

use std::sync::Arc;

use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::html::Sampler;
use crate::matrix::{Matrix, MatrixView};
use crate::model::Model;
use crate::replay::{self, Frame};
use crate::rollout::Batch;
use crate::scene::compute_poses;

/// Longest text of a problem in a state, bytes.
const LONGEST_PROBLEM: usize = 500;

/// Flag of a paused simulation.
pub(super) const PAUSED: u32 = 1;

/// Flag of a batch, of which users can neither pull the bodies nor hold the controls.
pub(super) const BATCH: u32 = 2;

/// Collects the parts of a state, which `html/src/live.js` reads.
#[derive(Debug)]
pub(super) struct StateWriter {
    pub(super) model: Arc<Model>,
    frames: Vec<Frame>,
    /// Deformable shapes of the first simulation. `None` if the model has none.
    sampler: Option<Sampler>,
    /// Largest number of ghosts.
    most_ghosts: usize,
    /// States of ghosts, a row each.
    ghosts: Matrix,
    ghost_spec: StateSpec,
    /// Simulation in which the poses of ghosts are computed.
    memory: Data,
    shown: Shown,
}

/// Simulations that the page shows.
#[derive(Debug, Default)]
struct Shown {
    /// Times, s.
    times: Vec<f64>,
    /// For each simulation the poses of all frames.
    poses: Vec<f32>,
    /// Controls of the first simulation.
    controls: Vec<f32>,
}

impl Shown {
    /// Removes all simulations, and sets the controls.
    fn clear(&mut self, controls: &[f64]) {
        self.times.clear();
        self.poses.clear();
        self.controls.clear();
        self.controls.extend(controls.iter().map(|&ctrl| ctrl as f32));
    }

    /// Adds a simulation. If it has no poses, for example because of NaN, they are NaN, and the
    /// page does not draw it.
    fn add(&mut self, has_poses: bool, data: &Data, frames: &[Frame]) {
        self.times.push(data.time());
        for &frame in frames {
            let numbers = replay::pose(data, frame).numbers();
            self.poses.extend(numbers.map(|number| if has_poses { number as f32 } else { f32::NAN }));
        }
    }
}

impl StateWriter {
    /// `memory` is a simulation of the model.
    pub(super) fn new(memory: Data, sampler: Option<Sampler>, most_ghosts: usize) -> Self {
        let (model, frames) = (memory.model().clone(), replay::all(memory.model()));
        let (ghosts, ghost_spec, shown) = (Matrix::default(), StateSpec::QPOS, Shown::default());
        Self { model, frames, sampler, most_ghosts, ghosts, ghost_spec, memory, shown }
    }

    /// Returns the largest size of a state without ghosts and deformable shapes, bytes.
    pub(super) fn smallest(&self) -> usize {
        8 + 8 + 28 * self.frames.len() + 5 * self.model.nu() + LONGEST_PROBLEM
    }

    /// Copies the states of ghosts, whose poses are computed when a browser waits for them.
    pub(super) fn set_ghosts(&mut self, spec: StateSpec, states: MatrixView<'_>) {
        let (nrows, ncols) = (states.nrows().min(self.most_ghosts), states.ncols());
        if self.ghosts.shape() != (nrows, ncols) {
            self.ghosts = Matrix::zeros(nrows, ncols);
        }
        self.ghosts.as_mut_slice().copy_from_slice(&states.as_slice()[..nrows * ncols]);
        self.ghost_spec = spec;
    }

    /// Collects a simulation, and the ghosts. `is_computed`: the simulation has positions.
    pub(super) fn collect(&mut self, data: &mut Data, is_computed: bool) -> Result<()> {
        let Self { frames, memory, shown, .. } = self;
        shown.clear(data.ctrl());
        shown.add(true, data, frames);
        // A batch may have left an edited model.
        memory.swap_model(&mut self.model.clone());
        for state in self.ghosts.rows() {
            let computed = memory.set_state(self.ghost_spec, state).and_then(|()| compute_poses(memory));
            shown.add(computed.is_ok(), memory, frames);
        }
        match &mut self.sampler {
            Some(sampler) if is_computed => sampler.update(data),
            _ => Ok(()),
        }
    }

    /// Collects the first simulations of a batch.
    pub(super) fn collect_batch(&mut self, batch: &Batch<'_>) -> Result<()> {
        let Self { frames, memory, shown, sampler, .. } = self;
        // An empty batch has no controls.
        shown.clear(batch.controls().rows().next().unwrap_or(memory.ctrl()));
        let mut first = Ok(());
        for index in 0..batch.len().min(1 + self.most_ghosts) {
            let computed = batch.load(index, memory).and_then(|()| match sampler {
                Some(sampler) if index == 0 => sampler.compute(memory),
                _ => compute_poses(memory),
            });
            shown.add(computed.is_ok(), memory, frames);
            if let Some(sampler) = sampler.as_mut().filter(|_| index == 0) {
                first = computed.and_then(|()| sampler.update(memory));
            }
        }
        first
    }

    /// Writes the flags, the number of simulations, their times and poses, the controls, the
    /// vertices of each deformable shape with their number, which controls are held, and the text
    /// of a problem.
    pub(super) fn write(&self, flags: u32, held: &[Option<f64>], problem: &str, bytes: &mut Vec<u8>) {
        bytes.clear();
        bytes.extend_from_slice(&flags.to_le_bytes());
        bytes.extend_from_slice(&(self.shown.times.len() as u32).to_le_bytes());
        bytes.extend(self.shown.times.iter().flat_map(|time| time.to_le_bytes()));
        bytes.extend(self.shown.poses.iter().chain(&self.shown.controls).flat_map(|number| number.to_le_bytes()));
        for vertices in self.sampler.iter().flat_map(Sampler::vertices) {
            bytes.extend_from_slice(&(vertices.len() as u32).to_le_bytes());
            bytes.extend(vertices.as_flattened().iter().flat_map(|number| number.to_le_bytes()));
        }
        bytes.extend(held.iter().map(|held| u8::from(held.is_some())));
        let end = (0..=LONGEST_PROBLEM).rev().find(|&at| problem.is_char_boundary(at)).unwrap_or(0);
        bytes.extend_from_slice(&problem.as_bytes()[..end]);
    }
}
