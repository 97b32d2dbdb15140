//! The engine's differences of a step, column by column, so that they can be shared among threads.
//!
//! Each column begins at the same saved state and the same warm start, so it does not matter which thread computes it, and
//! skips the stages that its input has no influence on. The engine's `mjd_transitionFD` does the same with functions that it
//! does not give out; here the second half of a step, `mj_step2`, takes their place. It computes the sensors of accelerations
//! whether they are wanted or not, and the factorisation of the integrator anew, with the same result.

use super::method::Step;
use super::worker::{Input, Wanted, Worker, sides};

use crate::data::{PipelineFlags, Stage};
use crate::enums::Integrator;
use crate::error::Result;
use crate::model::Model;

/// Where in [`Worker::samples`] what is.
const BASE: usize = 0;
const RIGHT: usize = 1;
const LEFT: usize = 2;

impl Worker {
    /// Takes the step from the base point that was set.
    pub(super) fn step_from_base(&mut self, wanted: Wanted) -> Result<()> {
        self.advance(Stage::Nothing, wanted.sensors)?;
        self.sample(BASE);
        self.restore()
    }

    /// Computes a column. They have to come in the order of [`inputs`](super::worker::inputs).
    pub(super) fn column(
        &mut self,
        model: &Model,
        input: Input,
        wanted: Wanted,
        step: Step,
        row: &mut [f64],
    ) -> Result<()> {
        let (right, left) = sides(&self.data, input, step);
        if right {
            self.step_aside(model, input, step.eps, RIGHT, wanted)?;
        }
        if left {
            self.step_aside(model, input, -step.eps, LEFT, wanted)?;
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

    /// A step from beside the base point, and back.
    fn step_aside(&mut self, model: &Model, input: Input, by: f64, sample: usize, wanted: Wanted) -> Result<()> {
        self.nudge(model, input, by)?;
        self.advance(
            match input {
                Input::Control(_) | Input::Activation(_) => Stage::Velocity,
                Input::Velocity(_) => Stage::Position,
                Input::Position(_) => Stage::Nothing,
            },
            wanted.sensors,
        )?;
        self.sample(sample);
        self.restore()
    }

    /// A step that takes the stages up to `skip` from the one before.
    fn advance(&mut self, skip: Stage, sensors: bool) -> Result<()> {
        let data = &mut self.data;
        // The stages of a Runge–Kutta step leave quantities of states in between.
        if data.model().options().integrator == Integrator::Rk4 || (skip == Stage::Nothing && sensors) {
            return data.step();
        }
        if skip == Stage::Nothing {
            data.fwd_position()?;
        } else {
            // The state was put back to the one that the positions and velocities of the step before belong to.
            data.set_computed(PipelineFlags::FIRST_HALF);
        }
        if skip != Stage::Velocity {
            data.fwd_velocity()?;
            if sensors {
                data.sensor_vel()?;
            }
        }
        data.step2()
    }

    fn sample(&mut self, sample: usize) {
        let (nq, nv, na) = (self.data.model().nq(), self.data.model().nv(), self.data.model().na());
        let (qpos, rest) = self.samples[sample].split_at_mut(nq);
        let (qvel, rest) = rest.split_at_mut(nv);
        let (act, sensors) = rest.split_at_mut(na);
        qpos.copy_from_slice(self.data.qpos());
        qvel.copy_from_slice(self.data.qvel());
        act.copy_from_slice(self.data.act());
        sensors.copy_from_slice(self.data.sensordata());
    }
}

/// The difference of two samples, with the engine's arithmetic.
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
    model.differentiate_pos(&mut row[..nv], width, &from[..nq], &to[..nq])?;
    plain(&mut row[nv..], &from[nq..], &to[nq..]);
    Ok(())
}
