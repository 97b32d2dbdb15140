//! Derivatives of inverse dynamics computed from `mj_inverse` alone: central differences with
//! Richardson extrapolation.

use std::sync::Arc;

use mujoco_safe::derivative::{InverseForce, InverseJacobians};
use mujoco_safe::{Data, Matrix, Model, StateSpec, sys};

/// Returns the stored elements of the inertia matrix.
pub(crate) fn inertia(data: &Data) -> &[f64] {
    #[cfg(not(engine_since = "3.10.0"))]
    return data.qM();
    #[cfg(engine_since = "3.10.0")]
    return data.M();
}

/// Forces, sensor values and elements of the inertia matrix, one after another.
type Outputs = Vec<f64>;

pub(crate) struct Oracle {
    data: Data,
    model: Arc<Model>,
    state: Vec<f64>,
    qacc: Vec<f64>,
    force: InverseForce,
}

impl Oracle {
    pub(crate) fn new(data: &Data, force: InverseForce) -> Self {
        let (state, qacc) = (data.state(StateSpec::INTEGRATION), data.qacc().to_vec());
        let mut data = data.clone();
        // Sensors of actuator forces then have the same values in all evaluations.
        data.forward().unwrap();
        Self { model: data.model().clone(), data, state, qacc, force }
    }

    fn evaluate(&mut self, perturb: &dyn Fn(&Model, &mut Data, f64), by: f64) -> Outputs {
        let Self { data, model, state, qacc, force } = self;
        data.set_state(StateSpec::INTEGRATION, state).unwrap();
        data.qacc_mut().copy_from_slice(qacc);
        perturb(model, data, by);
        let actuator_force = data.actuator_force().to_vec();
        // SAFETY: the data belongs to the model.
        unsafe { sys::mj_inverse(model.as_ptr(), data.as_mut_ptr()) };
        let mut outputs = data.qfrc_inverse().to_vec();
        let sensors = data.sensordata().to_vec();
        if *force == InverseForce::WithoutActuators {
            // SAFETY: as above, after the stages that the forces of actuators need.
            unsafe { sys::mj_fwdActuation(model.as_ptr(), data.as_mut_ptr()) };
            outputs.iter_mut().zip(data.qfrc_actuator()).for_each(|(total, actuator)| *total -= actuator);
            // SAFETY: the array has a number for each actuator, which the sensors of the next
            // evaluation read.
            unsafe {
                let forces = (*data.as_mut_ptr()).actuator_force;
                forces.copy_from_nonoverlapping(actuator_force.as_ptr(), actuator_force.len());
            }
        }
        outputs.extend(sensors);
        outputs.extend_from_slice(inertia(data));
        outputs
    }

    fn extrapolate(&mut self, perturb: &dyn Fn(&Model, &mut Data, f64), width: f64) -> Outputs {
        let [coarse, middle, fine] = [1.0, 0.5, 0.25].map(|part| {
            let step = part * width;
            let (right, left) = (self.evaluate(perturb, step), self.evaluate(perturb, -step));
            right.iter().zip(&left).map(|(right, left)| (right - left) / (2.0 * step)).collect::<Outputs>()
        });
        (0..coarse.len())
            .map(|i| {
                let (first, second) = ((4.0 * middle[i] - coarse[i]) / 3.0, (4.0 * fine[i] - middle[i]) / 3.0);
                (16.0 * second - first) / 15.0
            })
            .collect()
    }

    /// Returns the derivatives by differences whose largest step is `width`, and
    /// `acceleration_width` for accelerations.
    pub(crate) fn jacobians(&mut self, width: f64, acceleration_width: f64) -> InverseJacobians {
        let (nv, ns) = (self.model.nv(), self.model.nsensordata());
        let mut jacobians = InverseJacobians::zeros(&self.model);
        let InverseJacobians { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq } = &mut jacobians;
        let write = |dof: usize, outputs: &[f64], df: &mut Matrix, ds: &mut Matrix| {
            df.row_mut(dof).copy_from_slice(&outputs[..nv]);
            ds.row_mut(dof).copy_from_slice(&outputs[nv..nv + ns]);
        };
        for dof in 0..nv {
            let shift = |model: &Model, data: &mut Data, by: f64| {
                let mut direction = vec![0.0; nv];
                direction[dof] = 1.0;
                model.integrate_pos(data.qpos_mut(), &direction, by).unwrap();
            };
            let outputs = self.extrapolate(&shift, width);
            write(dof, &outputs, df_dq, ds_dq);
            dm_dq.row_mut(dof).copy_from_slice(&outputs[nv + ns..]);
            let outputs = self.extrapolate(&|_, data, by| data.qvel_mut()[dof] += by, width);
            write(dof, &outputs, df_dv, ds_dv);
            let outputs = self.extrapolate(&|_, data, by| data.qacc_mut()[dof] += by, acceleration_width);
            write(dof, &outputs, df_da, ds_da);
        }
        jacobians
    }
}
