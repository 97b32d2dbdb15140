//! The balance of forces at a given acceleration, which is what is differenced.

use std::ffi::c_int;

use mujoco_sys::{self as sys, guard};

use super::worker::{Input, Wanted, Worker};
use crate::data::PipelineFlags;
use crate::error::Result;
use crate::id::{Id, kind};

/// What forces need of positions; adhesion acts through the constraints, so transmission comes after these.
const POSITIONS: [guard::Part; 7] = [
    sys::mj_kinematics,
    sys::mj_comPos,
    sys::mj_tendon,
    sys::mj_crb,
    sys::mj_collision,
    sys::mj_makeConstraint,
    sys::mj_transmission,
];
/// What they need of velocities, without those of tendons.
const VELOCITIES: [guard::Part; 3] = [sys::mj_comVel, sys::mj_passive, sys::mj_referenceConstraint];
const FORCES: [guard::Part; 2] = [sys::mj_fwdActuation, sys::mj_invConstraint];

impl Worker {
    /// All forces, at the acceleration that is set: of positions only what has changed since.
    pub(super) fn evaluate(&mut self, input: Input, wanted: Wanted) -> Result<()> {
        let moved = matches!(input, Input::Position(_));
        if wanted.sensors || self.base.pushed {
            let data = &mut self.data;
            if moved {
                data.fwd_position()?;
                data.sensor_pos()?;
            }
            data.fwd_velocity()?;
            data.sensor_vel()?;
            data.fwd_actuation()?;
            return data.inv_constraint();
        }
        // Without what nothing of this reads: cameras, the factor of the inertia matrix, the bias without acceleration.
        self.data.run("mj_inverse", PipelineFlags::empty(), |model, data| {
            // SAFETY: `run` passes a model and a data that go together.
            let (tendons, nu, nv) = unsafe { ((*model).ntendon, (*model).nu, (*model).nv) };
            let positions: &[guard::Part] = if moved { &POSITIONS } else { &[] };
            let velocities: &[guard::Part] = if tendons > 0 { &[sys::mj_fwdVelocity] } else { &VELOCITIES };
            let all = |parts: &[guard::Part]| {
                // SAFETY: as above, and each part reads what those before it compute, or what was computed of the base point:
                // `prepare` has seen to that, and positions are moved last.
                unsafe { guard::parts(model, data, parts.as_ptr(), parts.len() as c_int) }
            };
            let status = all(positions);
            if status != guard::OK {
                return status;
            }
            // SAFETY: the engine's own arrays: nu numbers, nu × nv, nv.
            unsafe { sys::mju_mulMatVec((*data).actuator_velocity, (*data).actuator_moment, (*data).qvel, nu, nv) };
            match all(velocities) {
                guard::OK => all(&FORCES),
                status => status,
            }
        })
    }

    /// g, what is left of the balance of forces.
    pub(super) fn balance(&mut self, side: usize) -> Result<()> {
        let force = &mut self.base.forces[side];
        self.data.call_mut("mj_rne", |m, d| {
            // SAFETY: the result has nv values, and the motion axes and their velocities were computed for this model.
            unsafe { guard::mj_rne(m, d, 1, force.as_mut_ptr()) }
        })?;
        if self.base.pushed {
            negate(force);
            for body in 1..self.data.model().nbody() {
                let [fx, fy, fz, tx, ty, tz] = self.data.xfrc_applied()[body];
                if [fx, fy, fz, tx, ty, tz] != [0.0; 6] {
                    let point = self.data.xipos()[body];
                    let body = Id::<kind::Body>::new(body, self.data.model().lineage());
                    self.data.apply_ft([fx, fy, fz], [tx, ty, tz], point, body, force)?;
                }
            }
            negate(force);
        }
        let data = &self.data;
        let (armature, qacc) = (data.model().dof_armature(), data.qacc());
        let (passive, constraint) = (data.qfrc_passive(), data.qfrc_constraint());
        let (actuator, applied) = (data.qfrc_actuator(), data.qfrc_applied());
        for (dof, force) in force.iter_mut().enumerate() {
            *force += armature[dof] * qacc[dof] - passive[dof] - constraint[dof] - actuator[dof] - applied[dof];
        }
        Ok(())
    }

    /// `M (a − s)`.
    pub(super) fn inertia(&mut self, side: usize) {
        if self.base.damped {
            let (result, vector) = (self.base.inertias[side].as_mut_ptr(), self.base.spread.as_ptr());
            // SAFETY: both have nv values, and the inertia matrix was computed for this model.
            unsafe { sys::mj_mulM(self.data.model().as_ptr(), self.data.as_ptr(), result, vector) };
        }
    }
}

fn negate(vector: &mut [f64]) {
    for value in vector {
        *value = -*value;
    }
}
