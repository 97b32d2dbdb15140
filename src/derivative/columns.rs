//! The engine's finite differences of a step, column by column, so that several threads can share them.
//!
//! Each column starts from the same saved state and warm start, so the result does not depend on the thread that computes it.
//! A column skips the stages that its input does not influence. The engine's `mjd_transitionFD` skips them with functions that
//! it does not export; here `mj_step2`, the second half of a step, replaces them. It always computes the acceleration sensors
//! and repeats the factorisation of the integrator, with the same result.

use super::implicit::has_kinetic_energy;
use super::perturbation::{Input, PerturbedData, Settings, sides};
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
}

impl StepDifferences {
    pub(super) fn new(model: &Model) -> Self {
        let sample = vec![0.0; model.nq() + model.nv() + model.na() + model.nsensordata()];
        Self { samples: [sample.clone(), sample.clone(), sample] }
    }

    /// Samples the step from the base point, which all columns need.
    pub(super) fn prepare(&mut self, point: &mut PerturbedData, settings: Settings<'_>) -> Result<()> {
        advance(&mut point.data, Stage::Nothing, settings.wanted.sensors)?;
        sample(&point.data, &mut self.samples[BASE]);
        point.restore()
    }

    /// Computes a column of the linear system. Columns must be computed in the order of
    /// [`inputs`](super::perturbation::inputs).
    pub(super) fn column(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        input: Input,
        row: &mut [f64],
    ) -> Result<()> {
        let Settings { model, step, .. } = settings;
        let (right, left) = sides(&point.data, input, step);
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
                return Ok(());
            }
        };
        let width = if left && right { 2.0 * step.eps } else { step.eps };
        let [from, to] = [from, to].map(|sample| &self.samples[sample][..]);
        difference(model, row, from, to, width)
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
            Input::Position(_) => Stage::Nothing,
        };
        advance(&mut point.data, skip, settings.wanted.sensors)?;
        sample(&point.data, &mut self.samples[index]);
        point.restore()
    }
}

/// Takes a step that reuses the results of the stages up to `skip`.
fn advance(data: &mut Data, skip: Stage, sensors: bool) -> Result<()> {
    // A Runge–Kutta step leaves results of intermediate states, which cannot be reused.
    if data.model().options().integrator == Integrator::Rk4 || (skip == Stage::Nothing && sensors) {
        return data.step();
    }
    if skip == Stage::Nothing {
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
    data.step2()
}

fn sample(data: &Data, sample: &mut [f64]) {
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
fn difference(model: &Model, row: &mut [f64], from: &[f64], to: &[f64], width: f64) -> Result<()> {
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
