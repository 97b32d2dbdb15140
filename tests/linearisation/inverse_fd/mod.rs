//! Derivatives of inverse dynamics: against finite differences of the engine's function, the
//! inertia matrix and formulas. The simulation is restored.

mod analytic;
mod contract;
mod numbers;
mod oracle;

use std::sync::{Arc, LazyLock};

use mujoco_safe::derivative::{InverseJacobians, InverseOutputs};
use mujoco_safe::{Data, Model, sample};

static ZOO: LazyLock<Arc<Model>> =
    LazyLock::new(|| Arc::new(Model::from_xml_str(include_str!("../../models/zoo.xml")).unwrap()));

const EPS: f64 = 1e-6;

/// Returns simulations in motion, with nonzero accelerations and controls.
fn subjects() -> impl Iterator<Item = Data> {
    [Arc::new(sample::cartpole()), Arc::new(sample::humanoid()), ZOO.clone()].into_iter().map(|model| {
        let mut data = Data::new(model).unwrap();
        data.ctrl_mut().iter_mut().enumerate().for_each(|(i, ctrl)| *ctrl = 0.1 - 0.03 * i as f64);
        for (i, qvel) in data.qvel_mut().iter_mut().enumerate() {
            *qvel = 0.3 * (i as f64).sin();
        }
        for _ in 0..30 {
            data.step().unwrap();
        }
        for (i, qacc) in data.qacc_mut().iter_mut().enumerate() {
            *qacc = (1.3 * i as f64).cos();
        }
        data
    })
}

/// Returns the results of calls that request one output each. The last call requests none.
fn computed_alone(model: &Model, mut compute: impl FnMut(InverseOutputs<'_>)) -> InverseJacobians {
    let mut alone = InverseJacobians::zeros(model);
    let none = InverseOutputs::default;
    for outputs in [
        InverseOutputs { df_dq: Some(&mut alone.df_dq), ..none() },
        InverseOutputs { df_dv: Some(&mut alone.df_dv), ..none() },
        InverseOutputs { df_da: Some(&mut alone.df_da), ..none() },
        InverseOutputs { ds_dq: Some(&mut alone.ds_dq), ..none() },
        InverseOutputs { ds_dv: Some(&mut alone.ds_dv), ..none() },
        InverseOutputs { ds_da: Some(&mut alone.ds_da), ..none() },
        InverseOutputs { dm_dq: Some(&mut alone.dm_dq), ..none() },
        none(),
    ] {
        compute(outputs);
    }
    alone
}

#[track_caller]
fn assert_near(what: &str, ours: &[f64], theirs: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (i, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{what}, {i}: {a} and {b}");
    }
}
