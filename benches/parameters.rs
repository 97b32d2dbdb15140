//! Derivatives by ten parameters of a humanoid on its left leg, and by ten solver parameters
//! (friction, `solref`, `solimp`), in closed form, against one linearisation of the step. Then the
//! gradient of a cost of 100 steps by all controls, by ten parameters and by 1000 (each of a
//! hundred several times), against the linearisations of the steps alone.
//!
//! ```text
//! cargo bench --bench parameters
//! ```

mod common;

use common::models::Balance;
use mujoco_safe::derivative::{
    CostGradient, ModelParameter, ParameterJacobian, ParameterOutputs, TransitionMethod, TransitionOptions,
    TransitionOutputs,
};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Lineariser, Matrix, Model, Result, StateSpace};

const STEPS: usize = 100;

struct State {
    data: Data,
    lineariser: Lineariser,
    system: StateSpace,
    jacobian: ParameterJacobian,
    controls: Matrix,
    gradient: CostGradient,
}

/// Returns parameters with formulas, of all kinds.
fn parameters(model: &Model, count: usize) -> Vec<ModelParameter> {
    let bodies: Vec<_> = model.bodies().skip(1).map(|body| body.id()).collect();
    let joints: Vec<_> = model.joints().skip(1).map(|joint| joint.id()).collect();
    (0..count)
        .map(|at| {
            let (body, joint) = (bodies[at % bodies.len()], joints[at % joints.len()]);
            match at % 5 {
                0 => ModelParameter::Mass(body),
                1 => ModelParameter::LogCholesky(body, at % 10),
                2 => Parameter::JointDamping(joint).into(),
                3 => Parameter::JointArmature(joint).into(),
                _ => Parameter::JointStiffness(joint).into(),
            }
        })
        .collect()
}

/// Returns solver parameters of contacts and limits.
fn solver_parameters(model: &Model) -> Result<Vec<ModelParameter>> {
    let foot = model.geom("foot_left_inner")?.id().index();
    let mut list = Vec::new();
    for (array, row, column) in [
        ("geom_friction", 0, 0),
        ("geom_friction", foot, 1),
        ("geom_friction", foot, 2),
        ("geom_solref", 0, 0),
        ("geom_solref", foot, 1),
        ("geom_solimp", 0, 0),
        ("geom_solimp", foot, 1),
        ("geom_solimp", foot, 2),
        ("jnt_solref", 7, 0),
        ("jnt_solimp", 7, 1),
    ] {
        list.push(ModelParameter::field(model, array, row, column)?);
    }
    Ok(list)
}

fn main() -> Result<()> {
    let data = Balance::humanoid()?.data;
    let model = data.model().clone();
    let solver = solver_parameters(&model)?;
    let (ten, thousand) = (parameters(&model, 10), parameters(&model, 1000));
    let mut state = State {
        lineariser: Lineariser::new(model.clone(), TransitionOptions::default())?,
        system: StateSpace::zeros(&model),
        jacobian: ParameterJacobian::zeros(&model, 10),
        controls: Matrix::zeros(STEPS, model.nu()),
        gradient: CostGradient::zeros(&model, STEPS, 0),
        data,
    };
    for step in 0..STEPS {
        state.controls.row_mut(step).copy_from_slice(state.data.ctrl());
    }
    let by_parameters = |parameters: &[ModelParameter], state: &mut State| {
        let State { data, lineariser, jacobian, .. } = state;
        let outputs = ParameterOutputs { state: Some(&mut jacobian.state), sensors: None };
        let report = lineariser.parameter_jacobian_into(data, parameters, outputs).expect("the state is stable");
        assert_eq!((report.method, report.differenced.is_empty()), (TransitionMethod::Analytic, true));
    };
    let linearise = |state: &mut State| {
        let State { data, lineariser, system, .. } = state;
        let outputs = TransitionOutputs { a: Some(&mut system.a), b: Some(&mut system.b), ..Default::default() };
        lineariser.linear_system_into(data, outputs).expect("the state is stable");
    };
    common::compare(
        "parameters/humanoid",
        &mut state,
        1,
        &[
            ("10 parameters", &|state: &mut State| by_parameters(&ten, state)),
            ("10 solver parameters", &|state: &mut State| by_parameters(&solver, state)),
            ("linear_system_into", &linearise),
        ],
    );

    let gradient = |parameters: &[ModelParameter], state: &mut State| {
        let State { data, lineariser, controls, gradient, .. } = state;
        gradient.parameters.resize(parameters.len(), 0.0);
        let speed = |_: usize, data: &Data, slopes: &mut mujoco_safe::derivative::CostSlopes<'_>| {
            let nv = data.qvel().len();
            slopes.state[nv..2 * nv].copy_from_slice(data.qvel());
            0.5 * data.qvel().iter().map(|value| value * value).sum::<f64>()
        };
        lineariser.cost_gradient_into(data, controls, parameters, speed, gradient).expect("the states are stable");
    };
    let linearise_all = |state: &mut State| (0..STEPS).for_each(|_| linearise(state));
    common::compare(
        "cost_gradient/humanoid, 100 steps, 2100 controls",
        &mut state,
        1,
        &[
            ("10 parameters", &|state: &mut State| gradient(&ten, state)),
            ("1000 parameters", &|state: &mut State| gradient(&thousand, state)),
            ("no parameters", &|state: &mut State| gradient(&[], state)),
            ("100 linearisations", &linearise_all),
        ],
    );
    Ok(())
}
