//! The residual of the equations of motion at a given acceleration, whose differences implicit
//! differentiation uses.

use std::ffi::c_int;

use mujoco_sys::{self as sys, guard};

use crate::data::{Data, PipelineFlags};
use crate::error::Result;
use crate::id::Id;
use crate::kind;

/// Stages that forces need after positions change. Adhesion acts through the constraints, so
/// transmission comes after them.
const POSITION_STAGES: [guard::Part; 7] = [
    sys::mj_kinematics,
    sys::mj_comPos,
    sys::mj_tendon,
    sys::mj_crb,
    sys::mj_collision,
    sys::mj_makeConstraint,
    sys::mj_transmission,
];
/// Stages that forces need after velocities change, in models without tendons.
const VELOCITY_STAGES: [guard::Part; 3] = [sys::mj_comVel, sys::mj_passive, sys::mj_referenceConstraint];
const FORCE_STAGES: [guard::Part; 2] = [sys::mj_fwdActuation, sys::mj_invConstraint];

/// Quantities that the residual and its evaluation depend on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    /// True unless `xfrc_applied` is zero. Its generalised force depends on positions.
    pub(super) has_external_forces: bool,
}

impl Residual {
    /// Returns the quantities of the present state.
    pub(super) fn of(data: &Data) -> Self {
        Self { has_external_forces: data.xfrc_applied().as_flattened().iter().any(|&value| value != 0.0) }
    }

    /// Computes all forces at the present `qacc`, and the preceding stages that depend on the
    /// changed quantities: positions if `positions_changed`, else velocities.
    pub(super) fn update_forces(self, data: &mut Data, positions_changed: bool, sensors: bool) -> Result<()> {
        if sensors || self.has_external_forces {
            if positions_changed {
                data.fwd_position()?;
                data.sensor_pos()?;
            }
            data.fwd_velocity()?;
            data.sensor_vel()?;
            data.fwd_actuation()?;
            return data.inv_constraint();
        }
        // Skips the stages whose results are not read here: cameras, the factor of the inertia
        // matrix, and the bias force.
        data.run("mj_inverse", PipelineFlags::empty(), |model, data| {
            // SAFETY: `run` passes a valid model.
            let tendons = unsafe { (*model).ntendon };
            let position_stages: &[guard::Part] = if positions_changed { &POSITION_STAGES } else { &[] };
            let velocity_stages: &[guard::Part] = if tendons > 0 { &[sys::mj_fwdVelocity] } else { &VELOCITY_STAGES };
            let run_all = |stages: &[guard::Part]| {
                // SAFETY: as above. Each stage reads results of the stages before it, or results at
                // the base point: the preparation has computed these, and positions are perturbed
                // last.
                unsafe { guard::parts(model, data, stages.as_ptr(), stages.len() as c_int) }
            };
            let status = run_all(position_stages);
            if status != guard::OK {
                return status;
            }
            // SAFETY: a valid model, and the data that belongs to it, whose transmission was
            // computed.
            unsafe { sys::adapted::actuator_velocity(model, data) };
            match run_all(velocity_stages) {
                guard::OK => run_all(&FORCE_STAGES),
                status => status,
            }
        })
    }

    /// Computes the residual g of the equations of motion, `(nv)`, from forces that are up to date.
    pub(super) fn evaluate(self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        assert_eq!(residual.len(), data.model().nv(), "Bug: the residual does not have nv entries");
        data.call_mut("mj_rne", |m, d| {
            // SAFETY: the result has nv entries, and the motion axes and their velocities were
            // computed for this model.
            unsafe { guard::mj_rne(m, d, 1, residual.as_mut_ptr()) }
        })?;
        if self.has_external_forces {
            negate(residual);
            for body in 1..data.model().nbody() {
                let [fx, fy, fz, tx, ty, tz] = data.xfrc_applied()[body];
                if [fx, fy, fz, tx, ty, tz] != [0.0; 6] {
                    let point = data.xipos()[body];
                    let body = Id::<kind::Body>::new(body, data.model().lineage());
                    data.apply_ft([fx, fy, fz], [tx, ty, tz], point, body, residual)?;
                }
            }
            negate(residual);
        }
        let (armature, qacc) = (data.model().dof_armature(), data.qacc());
        let (passive, constraint) = (data.qfrc_passive(), data.qfrc_constraint());
        let (actuator, applied) = (data.qfrc_actuator(), data.qfrc_applied());
        for (dof, residual) in residual.iter_mut().enumerate() {
            *residual += armature[dof] * qacc[dof] - passive[dof] - constraint[dof] - actuator[dof] - applied[dof];
        }
        Ok(())
    }
}

/// Computes `result = M vector`, both `(nv)`, with the inertia matrix of the present position.
pub(super) fn multiply_inertia(data: &Data, result: &mut [f64], vector: &[f64]) {
    let nv = data.model().nv();
    assert_eq!((result.len(), vector.len()), (nv, nv), "Bug: the vectors do not have nv entries");
    // SAFETY: both vectors have nv entries, and the inertia matrix was computed for this model.
    unsafe { sys::mj_mulM(data.model().as_ptr(), data.as_ptr(), result.as_mut_ptr(), vector.as_ptr()) };
}

fn negate(vector: &mut [f64]) {
    for value in vector {
        *value = -*value;
    }
}
