//! The engine's finite differences of a step, column by column, so that several threads can share
//! them.
//!
//! Each column starts from the same saved state and warm start, so the result does not depend on
//! the thread that computes it. A column skips the stages that its input does not influence. The
//! engine's `mjd_transitionFD` skips them with functions that it does not export; here `mj_step2`,
//! the second half of a step, replaces them. It always computes the acceleration sensors and
//! repeats the factorisation of the integrator. The result is the same, unless an input changes
//! that factor.

use std::ops::Range;

use super::actuation::next_activations;
use super::convergence::{SolverCheck, is_solver_at_limit};
use super::kinks::{self, Trials, disagreement, has_contact_that_jumps, sides};
use super::method::Kinks;
use super::perturbation::{Input, PerturbedData, Settings};
use super::sizes;
use super::transition::has_kinetic_energy;
use crate::data::{Data, PipelineFlags, Stage};
use crate::enums::Integrator;
use crate::error::Result;
use crate::model::Model;

/// Indices of samples at the base point, to its right and to its left.
const BASE: usize = 0;
const RIGHT: usize = 1;
const LEFT: usize = 2;

/// Finite differences of a step of the simulation.
#[derive(Debug)]
pub(super) struct StepDifferences {
    /// `[qpos; qvel; act; sensordata]` after a step from `BASE`, `RIGHT` and `LEFT`.
    samples: [Vec<f64>; 3],
    /// `(na)`: activations after a step from the base point, before clamping.
    next_activations: Vec<f64>,
    trials: Trials,
    /// `true` if the collision functions of the present contacts can jump.
    may_jump: bool,
    solver: SolverCheck,
}

impl StepDifferences {
    pub(super) fn new(model: &Model) -> Self {
        let sample = vec![0.0; model.nq() + model.nv() + model.na() + model.nsensordata()];
        let (nx, _, ny) = sizes(model);
        Self {
            samples: [sample.clone(), sample.clone(), sample],
            next_activations: vec![0.0; model.na()],
            trials: Trials::new(nx + ny),
            may_jump: false,
            solver: SolverCheck::new(model.nv()),
        }
    }

    /// Samples the step from the base point, which all columns need. Returns the kinks in controls
    /// and activations.
    pub(super) fn prepare(&mut self, point: &mut PerturbedData, settings: Settings<'_>) -> Result<Kinks> {
        let mut kinks = Kinks::empty();
        advance(&mut point.data, Stage::None, settings.wanted.sensors)?;
        if is_solver_at_limit(&point.data) {
            point.restore()?;
            if self.solver.depends_on_iterations(point, settings.step.eps)? {
                kinks |= Kinks::DIFFERENCES;
            }
            advance(&mut point.data, Stage::None, settings.wanted.sensors)?;
        }
        sample(&point.data, &mut self.samples[BASE]);
        self.may_jump = has_contact_that_jumps(&point.data);
        point.restore()?;
        next_activations(settings.model, &point.data, &mut self.next_activations);
        Ok(kinks | kinks::of_inputs(&point.data, Some(&self.next_activations)))
    }

    /// Computes a column of the linear system, and returns its kinks. Columns must be computed in
    /// the order of [`inputs`](super::perturbation::inputs).
    pub(super) fn column(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        input: Input,
        row: &mut [f64],
    ) -> Result<Kinks> {
        let mut trials = std::mem::take(&mut self.trials);
        let may_jump = self.may_jump && matches!(input, Input::Position(_));
        let kinks = trials.run(settings, may_jump, row, |settings, row| self.difference(point, settings, input, row));
        self.trials = trials;
        kinks
    }

    /// Computes a column with one step. Returns the disagreement of the differences to the right
    /// and to the left.
    fn difference(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        input: Input,
        row: &mut [f64],
    ) -> Result<f64> {
        let Settings { model, step, wanted, keep } = settings;
        let (right, left) = sides(&point.data, input, step, &self.next_activations);
        if right {
            self.step_perturbed(point, settings, input, step.eps, RIGHT)?;
        }
        if left {
            self.step_perturbed(point, settings, input, -step.eps, LEFT)?;
        }
        let (from, to) = match (left, right) {
            (false, true) => (BASE, RIGHT),
            (true, false) => (LEFT, BASE),
            (true, true) => (LEFT, RIGHT),
            (false, false) => {
                row.fill(0.0);
                return Ok(0.0);
            }
        };
        let width = if left && right { 2.0 * step.eps } else { step.eps };
        let [from, to] = [from, to].map(|sample| &self.samples[sample][..]);
        difference(model, row, from, to, width)?;
        if !(left && right) {
            return Ok(0.0);
        }
        // The next positions follow from the next velocities.
        let (start, sensors) = (model.nq(), model.nq() + model.nv() + model.na());
        let part = |range: Range<usize>| [BASE, RIGHT, LEFT].map(|side| &self.samples[side][range.clone()]);
        let mut worst = 0.0;
        if wanted.system {
            worst = disagreement(part(start..sensors), &[], step.eps);
        }
        if wanted.sensors {
            worst = disagreement(part(sensors..self.samples[BASE].len()), keep, step.eps).max(worst);
        }
        Ok(worst)
    }

    /// Samples the step from a perturbed state, and restores the base point.
    fn step_perturbed(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        input: Input,
        eps: f64,
        index: usize,
    ) -> Result<()> {
        point.perturb(settings.model, input, eps)?;
        let skip = match input {
            Input::Control(_) | Input::Activation(_) => Stage::Velocity,
            Input::Velocity(_) => Stage::Position,
            Input::Position(_) => Stage::None,
        };
        advance(&mut point.data, skip, settings.wanted.sensors)?;
        sample(&point.data, &mut self.samples[index]);
        point.restore()
    }
}

/// Takes a step that reuses the results of the stages up to `skip`.
fn advance(data: &mut Data, skip: Stage, sensors: bool) -> Result<()> {
    // A Runge–Kutta step leaves results of intermediate states, which cannot be reused.
    if data.model().options().integrator == Integrator::Rk4 || (skip == Stage::None && sensors) {
        return data.step_for_differences();
    }
    if skip == Stage::None {
        data.fwd_position()?;
    } else {
        // The state was restored to the one that the position and velocity results belong to.
        data.set_computed(PipelineFlags::FIRST_HALF);
    }
    if skip != Stage::Velocity {
        data.fwd_velocity()?;
        if sensors {
            data.sensor_vel()?;
        }
        if sensors && has_kinetic_energy(data.model()) {
            data.sensor_pos()?;
        }
    }
    data.step2_for_differences()
}

/// Copies `[qpos; qvel; act; sensordata]`.
pub(super) fn sample(data: &Data, sample: &mut [f64]) {
    let (nq, nv, na) = (data.model().nq(), data.model().nv(), data.model().na());
    let (qpos, rest) = sample.split_at_mut(nq);
    let (qvel, rest) = rest.split_at_mut(nv);
    let (act, sensors) = rest.split_at_mut(na);
    qpos.copy_from_slice(data.qpos());
    qvel.copy_from_slice(data.qvel());
    act.copy_from_slice(data.act());
    sensors.copy_from_slice(data.sensordata());
}

/// Computes the difference quotient of two samples, with the engine's arithmetic.
pub(super) fn difference(model: &Model, row: &mut [f64], from: &[f64], to: &[f64], width: f64) -> Result<()> {
    let (nq, nv) = (model.nq(), model.nv());
    let inverse = 1.0 / width;
    let plain = |row: &mut [f64], from: &[f64], to: &[f64]| {
        row.iter_mut().zip(from.iter().zip(to)).for_each(|(row, (from, to))| *row = inverse * (to - from));
    };
    if nq == nv {
        plain(row, from, to);
        return Ok(());
    }
    model.differentiate_pos_into(width, &from[..nq], &to[..nq], &mut row[..nv])?;
    plain(&mut row[nv..], &from[nq..], &to[nq..]);
    Ok(())
}
