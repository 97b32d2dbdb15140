//! Forward differences of inverse dynamics.

use std::ffi::c_int;
use std::ops::Range;
use std::ptr;

use mujoco_sys::guard;

use super::{InverseForce, InverseOutputs};
use crate::data::{Data, SensorUpdate, Stage};
use crate::derivative::transition::has_kinetic_energy;
use crate::error::{Error, Result};
use crate::ffi;
use crate::matrix::Matrix;

impl Data {
    /// Returns the differentiated forces.
    fn inverse_force(&self, force: InverseForce) -> impl Iterator<Item = f64> {
        self.qfrc_inverse().iter().zip(self.qfrc_actuator()).map(move |(total, actuator)| match force {
            InverseForce::Total => *total,
            InverseForce::WithoutActuators => total - actuator,
        })
    }
}

/// A simulation whose positions, velocities and accelerations are perturbed. Restores them after
/// each perturbation, and when dropped.
pub(super) struct InversePerturbation<'a> {
    data: &'a mut Data,
    eps: f64,
    force: InverseForce,
    /// Memory on the engine's stack: the saved values, and a direction in the tangent space of
    /// positions.
    saved: &'a mut [f64],
    /// Top of the stack to restore.
    stack: guard::StackMark,
}

/// Layout of the saved values.
struct Layout {
    qpos: Range<usize>,
    /// Saved because the engine normalises it.
    mocap_quat: Range<usize>,
    qvel: Range<usize>,
    qacc: Range<usize>,
    actuator_force: Range<usize>,
    direction: Range<usize>,
}

impl Layout {
    fn of(data: &Data) -> Self {
        let model = data.model();
        let mut end = 0;
        let mut next = |length| {
            let start = end;
            end += length;
            start..end
        };
        let (nq, nv, nmocap) = (model.nq(), model.nv(), model.nmocap());
        Self {
            qpos: next(nq),
            mocap_quat: next(4 * nmocap),
            qvel: next(nv),
            qacc: next(nv),
            actuator_force: next(data.actuator_force().len()),
            direction: next(nv),
        }
    }
}

impl<'a> InversePerturbation<'a> {
    pub(super) fn new(data: &'a mut Data, eps: f64, force: InverseForce) -> Result<Self> {
        let layout = Layout::of(data);
        let length = layout.direction.end;
        let size = c_int::try_from(length)
            .map_err(|_| Error::Unsupported(format!("inverse_fd of {} degrees of freedom", data.model().nv())))?;
        let (mut stack, mut start) = (guard::StackMark::default(), ptr::null_mut());
        // SAFETY: a valid data, and a valid pointer for the result.
        unsafe { guard::stack_mark(data.as_ptr(), &raw mut stack) };
        data.call_mut("mj_stackAlloc", |_, d| {
            // SAFETY: a valid data, and a valid pointer for the result.
            unsafe { guard::mj_stack_alloc(d, size, &raw mut start) }
        })?;
        // SAFETY: the engine has reserved `length` numbers (NULL for none). It uses only the stack
        // above them until `drop` restores the stack.
        let saved = unsafe {
            if length > 0 {
                start.write_bytes(0, length);
            }
            ffi::array_mut(start, length)
        };
        saved[layout.qpos].copy_from_slice(data.qpos());
        saved[layout.mocap_quat].copy_from_slice(data.mocap_quat().as_flattened());
        saved[layout.qvel].copy_from_slice(data.qvel());
        saved[layout.qacc].copy_from_slice(data.qacc());
        saved[layout.actuator_force].copy_from_slice(data.actuator_force());
        Ok(Self { data, eps, force, saved, stack })
    }

    /// Restores the positions, and the mocap orientations, which the engine normalises.
    fn restore_positions(&mut self) {
        let Layout { qpos, mocap_quat, .. } = Layout::of(self.data);
        self.data.qpos_mut().copy_from_slice(&self.saved[qpos]);
        self.data.mocap_quat_mut().as_flattened_mut().copy_from_slice(&self.saved[mocap_quat]);
    }

    /// Computes inverse dynamics, except for the stages up to `skip`.
    fn evaluate(&mut self, skip: Stage, sensors: SensorUpdate) -> Result<()> {
        match self.force {
            InverseForce::Total => self.data.inverse_skip(skip, sensors),
            InverseForce::WithoutActuators => {
                // Inverse dynamics does not compute the forces of actuators, but sensors read them.
                // Without this copy, they would read the forces of the previous perturbation.
                let saved = &self.saved[Layout::of(self.data).actuator_force];
                // SAFETY: the engine allocated the array with this length, and the data is borrowed
                // exclusively.
                let forces = unsafe { ffi::array_mut(self.data.raw_mut().actuator_force, saved.len()) };
                forces.copy_from_slice(saved);
                self.data.inverse_skip(skip, sensors)?;
                self.data.fwd_actuation()
            }
        }
    }

    pub(super) fn differentiate(mut self, outputs: &mut InverseOutputs<'_>) -> Result<()> {
        let nv = self.data.model().nv();
        let InverseOutputs { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq } = outputs;

        // First stores the perturbed outputs in each row, from the cheapest stage to the most
        // expensive.
        if df_da.is_some() || ds_da.is_some() || df_dv.is_some() || ds_dv.is_some() {
            self.evaluate(Stage::None, SensorUpdate::Compute)?;
        }
        for dof in 0..nv {
            if df_da.is_some() || ds_da.is_some() {
                let qacc = self.data.qacc()[dof];
                self.data.qacc_mut()[dof] = qacc + self.eps;
                self.evaluate(Stage::Velocity, SensorUpdate::needed(ds_da.is_some()))?;
                self.data.qacc_mut()[dof] = qacc;
                self.record(dof, df_da, ds_da);
            }
        }
        // The engine evaluates the kinetic energy with the sensors of positions.
        let has_energy = ds_dv.is_some() && has_kinetic_energy(self.data.model());
        let of_velocities = if has_energy { Stage::None } else { Stage::Position };
        for dof in 0..nv {
            if df_dv.is_some() || ds_dv.is_some() {
                let qvel = self.data.qvel()[dof];
                self.data.qvel_mut()[dof] = qvel + self.eps;
                self.evaluate(of_velocities, SensorUpdate::needed(ds_dv.is_some()))?;
                self.data.qvel_mut()[dof] = qvel;
                self.record(dof, df_dv, ds_dv);
            }
        }
        for dof in 0..nv {
            if df_dq.is_some() || ds_dq.is_some() || dm_dq.is_some() {
                self.perturb_position(dof)?;
                self.evaluate(Stage::None, SensorUpdate::needed(ds_dq.is_some()))?;
                self.record(dof, df_dq, ds_dq);
                if let Some(dm_dq) = dm_dq {
                    dm_dq.row_mut(dof).copy_from_slice(self.data.inertia_elements());
                }
                self.restore_positions();
            }
        }

        // Then subtracts the unperturbed outputs, which also leaves the data at the unperturbed
        // state.
        self.evaluate(Stage::None, SensorUpdate::Compute)?;
        let Self { data, eps, force, .. } = &self;
        for df in [df_dq, df_dv, df_da].into_iter().flatten() {
            (0..nv).for_each(|dof| difference(df.row_mut(dof), data.inverse_force(*force), *eps));
        }
        for ds in [ds_dq, ds_dv, ds_da].into_iter().flatten() {
            (0..nv).for_each(|dof| difference(ds.row_mut(dof), data.sensordata().iter().copied(), *eps));
        }
        if let Some(dm_dq) = dm_dq {
            (0..nv).for_each(|dof| difference(dm_dq.row_mut(dof), data.inertia_elements().iter().copied(), *eps));
        }
        Ok(())
    }

    /// Adds `eps` to a position, in the tangent space.
    fn perturb_position(&mut self, dof: usize) -> Result<()> {
        let model = self.data.model().clone();
        let direction = &mut self.saved[Layout::of(self.data).direction];
        direction[dof] = 1.0;
        let moved = model.integrate_pos(self.data.qpos_mut(), direction, self.eps);
        direction[dof] = 0.0;
        moved
    }

    /// Stores the outputs after a perturbation.
    fn record(&self, dof: usize, df: &mut Option<&mut Matrix>, ds: &mut Option<&mut Matrix>) {
        if let Some(df) = df {
            let force = self.data.inverse_force(self.force);
            df.row_mut(dof).iter_mut().zip(force).for_each(|(to, from)| *to = from);
        }
        if let Some(ds) = ds {
            ds.row_mut(dof).copy_from_slice(self.data.sensordata());
        }
    }
}

impl Drop for InversePerturbation<'_> {
    fn drop(&mut self) {
        let Layout { qvel, qacc, .. } = Layout::of(self.data);
        self.restore_positions();
        self.data.qvel_mut().copy_from_slice(&self.saved[qvel]);
        self.data.qacc_mut().copy_from_slice(&self.saved[qacc]);
        // SAFETY: the mark of this data, whose memory above the mark is not used after this.
        unsafe { guard::stack_restore(self.data.as_mut_ptr(), &raw const self.stack) };
    }
}

/// Computes `row = (row − before) / eps`.
fn difference(row: &mut [f64], before: impl Iterator<Item = f64>, eps: f64) {
    row.iter_mut().zip(before).for_each(|(value, before)| *value = (*value - before) / eps);
}
