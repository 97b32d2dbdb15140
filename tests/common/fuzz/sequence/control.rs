//! Linearisation, controllers and trajectories.

use std::hint::black_box;

use mujoco_safe::derivative::{InverseForce, InverseJacobians, InverseOutputs, TransitionOutputs};
use mujoco_safe::{
    Controller, Differences, Lqr, LqrWeights, Matrix, PdController, RandomController, Trajectory, ZeroController,
};

use super::Call;
use super::linearise::is_small;

pub(super) const CALLS: &[(&str, Call)] = &[
    ("transition_fd", |scene, bytes| {
        let differences = [Differences::Forward, Differences::Central][bytes.below(2)];
        let eps = if bytes.once_in(3) { bytes.number() } else { 1e-6 };
        if is_small(scene.data.model(), bytes) || bytes.once_in(64) {
            scene.data.transition_fd(eps, differences).map(drop)
        } else {
            Ok(())
        }
    }),
    ("transition_fd_into", |scene, bytes| {
        let model = scene.data.model();
        let (nx, nu, ny) = (2 * model.nv() + model.na(), model.nu(), model.nsensordata());
        let wrong = usize::from(bytes.once_in(8));
        let (mut a, mut b) = (Matrix::zeros(nx, nx), Matrix::zeros(nx + wrong, nu));
        let (mut c, mut d) = (Matrix::zeros(ny, nx), Matrix::zeros(ny, nu));
        let outputs = TransitionOutputs {
            a: bytes.once_in(2).then_some(&mut a),
            b: bytes.once_in(2).then_some(&mut b),
            c: bytes.once_in(2).then_some(&mut c),
            d: bytes.once_in(2).then_some(&mut d),
        };
        if is_small(scene.data.model(), bytes) {
            scene.data.transition_fd_into(1e-6, Differences::Forward, outputs)
        } else {
            Ok(())
        }
    }),
    ("inverse_fd", |scene, bytes| {
        let eps = if bytes.once_in(3) { bytes.number() } else { 1e-6 };
        let force = bytes.either(InverseForce::WithoutActuators, InverseForce::Total);
        if is_small(scene.data.model(), bytes) { scene.data.inverse_fd(eps, force).map(drop) } else { Ok(()) }
    }),
    ("inverse_fd_into", |scene, bytes| {
        let mut jacobians = InverseJacobians::zeros(scene.data.model());
        let wrong = Matrix::zeros(scene.data.model().nv() + 1, 1);
        if bytes.once_in(4) {
            jacobians.ds_dv = wrong;
        }
        let InverseJacobians { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq, .. } = &mut jacobians;
        let wanted = bytes.word();
        let outputs = InverseOutputs {
            df_dq: (wanted & 1 != 0).then_some(df_dq),
            df_dv: (wanted & 2 != 0).then_some(df_dv),
            df_da: (wanted & 4 != 0).then_some(df_da),
            ds_dq: (wanted & 8 != 0).then_some(ds_dq),
            ds_dv: (wanted & 16 != 0).then_some(ds_dv),
            ds_da: (wanted & 32 != 0).then_some(ds_da),
            dm_dq: (wanted & 64 != 0).then_some(dm_dq),
        };
        let force = bytes.either(InverseForce::WithoutActuators, InverseForce::Total);
        if is_small(scene.data.model(), bytes) { scene.data.inverse_fd_into(1e-6, force, outputs) } else { Ok(()) }
    }),
    ("Lqr", |scene, bytes| {
        let model = scene.data.model();
        let (nx, nu) = (2 * model.nv() + model.na(), model.nu());
        if nx > 12 {
            return Ok(());
        }
        let weights = LqrWeights::diagonal(&vec![bytes.number(); nx], &vec![bytes.number(); nu]);
        Lqr::at_present_state(&mut scene.data, &weights)?.control(&mut scene.data)
    }),
    ("Lqr::with_gain", |scene, bytes| {
        let model = scene.data.model();
        let (nx, nu) = (2 * model.nv() + model.na(), model.nu());
        let gain = Matrix::from_row_major(nu, nx, vec![bytes.number(); nu * nx]);
        Lqr::with_gain(&scene.data, gain)?.control(&mut scene.data)
    }),
    ("controllers", |scene, bytes| {
        let mut pd = PdController::new(scene.data.model(), bytes.number(), bytes.number());
        if let Ok(actuator) = scene.data.model().actuator(0) {
            pd.set_target(actuator, bytes.number());
        }
        pd.control(&mut scene.data)?;
        RandomController::new(bytes.word()).control(&mut scene.data)?;
        ZeroController.control(&mut scene.data)
    }),
    ("Trajectory", |scene, bytes| {
        let mut trajectory = Trajectory::new(scene.data.model());
        trajectory.record(&mut scene.data, &mut RandomController::new(1), bytes.below(4))?;
        trajectory.push(&scene.data)?;
        if let Some(other) = &scene.other {
            trajectory.push(other)?;
        }
        black_box((trajectory.len(), trajectory.qpos(0), trajectory.states().len()));
        trajectory.apply(bytes.below(trajectory.len()), &mut scene.data)
    }),
];
