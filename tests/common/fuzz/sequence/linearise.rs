//! Linear systems in a reused workspace, and regulators for them.

use std::hint::black_box;

use mujoco_safe::callback::Callbacks;
use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions, QuadraticCost};
use mujoco_safe::control::riccati::{Riccati, RiccatiRecursion, RiccatiSolution, RiccatiWorkspace};
use mujoco_safe::derivative::{
    CostSlopes, InverseForce, ModelParameter, TransitionMethod, TransitionOptions, TransitionOutputs,
};
use mujoco_safe::nalgebra::DMatrix;
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{
    Controller, Data, Differences, Lineariser, LqrWeights, Matrix, Model, Result, StateSpace, StateSpec,
};

use super::{Bytes, Call, Scene};

const METHODS: [TransitionMethod; 4] =
    [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic];

/// Returns `true` if a linearisation takes less than a millisecond, and in one of four calls for
/// slightly larger models.
pub(super) fn is_small(model: &Model, bytes: &mut Bytes<'_>) -> bool {
    model.nv() < 9 || (model.nv() < 30 && bytes.once_in(4))
}

/// Makes a call with a workspace, often the workspace of an earlier call, with the same model or
/// another.
fn with_transition(
    scene: &mut Scene<'_>,
    bytes: &mut Bytes<'_>,
    call: impl FnOnce(&mut Lineariser, &mut Data, &mut Bytes<'_>) -> Result<()>,
) -> Result<()> {
    if !is_small(scene.data.model(), bytes) {
        return Ok(());
    }
    if scene.transition.is_none() || bytes.once_in(4) {
        let mut options = TransitionOptions::default()
            .with_method(METHODS[bytes.below(METHODS.len())])
            .with_differences([Differences::Forward, Differences::Central][bytes.below(2)])
            .with_threads([1, 1, 1, 1, 1, 2, 3, 0][bytes.below(8)]);
        options.eps = bytes.once_in(3).then(|| bytes.number());
        scene.transition = Some(Lineariser::new(scene.data.model().clone(), options)?);
    }
    let transition = scene.transition.as_mut().expect("just created");
    black_box(transition.options().threads);
    call(transition, &mut scene.data, bytes)
}

/// Returns rows of states, mostly the present state with one number changed.
fn states(data: &Data, bytes: &mut Bytes<'_>, nrows: usize) -> Matrix {
    let state = data.physics_state();
    let mut states = Matrix::zeros(nrows, state.len() + usize::from(bytes.once_in(16)));
    for row in 0..nrows {
        let to = states.row_mut(row);
        to[..state.len()].copy_from_slice(&state);
        if bytes.once_in(2) {
            let (at, number) = (bytes.below(state.len()), bytes.number());
            to.iter_mut().skip(at).take(1).for_each(|value| *value = number);
        }
    }
    states
}

fn controls(data: &Data, bytes: &mut Bytes<'_>, nrows: usize) -> Matrix {
    let nu = data.model().nu();
    Matrix::from_row_major(nrows, nu, vec![bytes.number(); nrows * nu])
}

/// Returns a matrix, mostly of the given shape and of small numbers.
fn matrix(bytes: &mut Bytes<'_>, nrows: usize, ncols: usize) -> DMatrix<f64> {
    let extra = usize::from(bytes.once_in(64));
    let seed = bytes.fraction();
    let mut matrix = DMatrix::from_fn(nrows + extra, ncols, |row, column| (seed * (1 + row + 3 * column) as f64).sin());
    for _ in 0..bytes.below(3) {
        let (at, number) = (bytes.below(matrix.len()), bytes.number());
        matrix.iter_mut().skip(at).take(1).for_each(|value| *value = number);
    }
    if bytes.once_in(4) { matrix * bytes.number() } else { matrix }
}

/// Returns a symmetric matrix.
fn cost(bytes: &mut Bytes<'_>, size: usize) -> DMatrix<f64> {
    let half = matrix(bytes, size, size);
    match bytes.below(6) {
        0 => DMatrix::identity(size, size) * bytes.number(),
        1 | 2 => half.tr_mul(&half),
        3 if half.is_square() => &half + half.transpose(),
        4 => half,
        _ => DMatrix::identity(size, size),
    }
}

fn weights(bytes: &mut Bytes<'_>, nx: usize, nu: usize) -> LqrWeights {
    let (q, r) = (cost(bytes, nx), cost(bytes, nu));
    LqrWeights { s: bytes.once_in(3).then(|| matrix(bytes, nx, nu).into()), ..LqrWeights::new(q, r) }
}

/// Returns parameters of the model: of the inertia of bodies, and numbers of arrays.
pub(super) fn parameters(model: &Model, bytes: &mut Bytes<'_>) -> Vec<ModelParameter> {
    const ARRAYS: [&str; 12] = [
        "dof_damping",
        "dof_frictionloss",
        "qpos_spring",
        "tendon_lengthspring",
        "actuator_gainprm",
        "actuator_biasprm",
        "actuator_dynprm",
        "actuator_gear",
        "geom_friction",
        "geom_solref",
        "jnt_axis",
        "body_iquat",
    ];
    let mut list = Vec::new();
    for _ in 0..bytes.below(4) {
        let body = model.bodies().nth(bytes.below(model.nbody())).expect("there is a world").id();
        let array = ARRAYS[bytes.below(ARRAYS.len())];
        list.push(match bytes.below(8) {
            0 => ModelParameter::Mass(body),
            1 => ModelParameter::Inertia(body, bytes.below(7)),
            2 => ModelParameter::LogCholesky(body, bytes.below(10)),
            3 => Parameter::Gravity(bytes.below(3)).into(),
            _ => match ModelParameter::field(model, array, bytes.below(6), bytes.below(3)) {
                Ok(parameter) => parameter,
                Err(_) => continue,
            },
        });
    }
    list
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("Lineariser::parameter_jacobian", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let parameters = parameters(data.model(), bytes);
            let before = data.state(StateSpec::INTEGRATION);
            let result = transition.parameter_jacobian(data, &parameters);
            let after = data.state(StateSpec::INTEGRATION);
            assert!(before.iter().map(|number| number.to_bits()).eq(after.iter().map(|number| number.to_bits())));
            result.map(|result| drop(black_box(result)))
        })
    }),
    ("Lineariser::inverse_parameter_jacobian", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let parameters = parameters(data.model(), bytes);
            let force = [InverseForce::Total, InverseForce::WithoutActuators][bytes.below(2)];
            transition.inverse_parameter_jacobian(data, &parameters, force).map(|result| drop(black_box(result)))
        })
    }),
    ("Lineariser::cost_gradient", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let parameters = parameters(data.model(), bytes);
            let steps = bytes.below(4);
            let (controls, slope) = (controls(data, bytes, steps), bytes.number());
            let cost = |_: usize, _: &Data, slopes: &mut CostSlopes<'_>| {
                slopes.state.fill(slope);
                slopes.sensors.fill(slope);
                slope
            };
            transition.cost_gradient(data, &controls, &parameters, cost).map(|result| drop(black_box(result)))
        })
    }),
    ("regressors", |scene, _| {
        let body = scene.data.model().bodies().last().expect("there is a world").id();
        black_box(scene.data.body_regressor(body)?);
        scene.data.joint_regressor().map(|regressor| drop(black_box(regressor)))
    }),
    ("Lineariser::linear_system", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, _| {
            let before = data.state(StateSpec::INTEGRATION);
            let result = transition.linear_system(data);
            let after = data.state(StateSpec::INTEGRATION);
            assert!(before.iter().map(|number| number.to_bits()).eq(after.iter().map(|number| number.to_bits())));
            result.map(drop)
        })
    }),
    ("Lineariser::linear_system_into", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let StateSpace { mut a, mut b, mut c, mut d, .. } = StateSpace::zeros(data.model());
            if bytes.once_in(8) {
                d = Matrix::zeros(1, 1000);
            }
            let wanted = bytes.word();
            let outputs = TransitionOutputs {
                a: (wanted & 1 != 0).then_some(&mut a),
                b: (wanted & 2 != 0).then_some(&mut b),
                c: (wanted & 4 != 0).then_some(&mut c),
                d: (wanted & 8 != 0).then_some(&mut d),
            };
            transition.linear_system_into(data, outputs).map(|used| drop(black_box(format!("{used:?}"))))
        })
    }),
    ("Lineariser::linear_system, with a callback", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let number = bytes.number();
            let callbacks = Callbacks::new().with_control(move |context| context.ctrl_mut().fill(number));
            data.with_callbacks(callbacks, |data| transition.linear_system(data).map(drop))
        })
    }),
    ("Lineariser::along", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let rows = bytes.below(4);
            let (states, controls) = (states(data, bytes, rows), controls(data, bytes, rows));
            let mut systems = transition.along(data, &states, &controls)?;
            if bytes.once_in(4) {
                systems.pop();
            }
            transition.along_into(data, &states, &controls, &mut systems)
        })
    }),
    ("TimeVaryingLqr", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let (steps, nu) = (bytes.below(4), data.model().nu());
            let nx = 2 * data.model().nv() + data.model().na();
            let (states, controls) = (states(data, bytes, steps + 1), controls(data, bytes, steps));
            let mut regulator = if bytes.once_in(2) {
                let gain = Matrix::from_row_major(nu, nx, vec![bytes.number(); nu * nx]);
                let gains = vec![gain; steps + usize::from(bytes.once_in(16))];
                TimeVaryingLqr::with_gains(data, states, controls, gains)?
            } else {
                let (weights, terminal) = (weights(bytes, nx, nu), cost(bytes, nx));
                TimeVaryingLqr::along(transition, data, states, controls, &weights, &terminal)?
            };
            if bytes.once_in(2) {
                regulator.set_start(bytes.number());
            }
            black_box((regulator.row(data), regulator.start(), regulator.gains().len(), regulator.states().shape()));
            regulator.control(data)?;
            data.step()?;
            regulator.control(data)
        })
    }),
    ("Ilqr", |scene, bytes| {
        let model = scene.data.model().clone();
        if model.nv() > 6 {
            return Ok(());
        }
        let (nx, nu) = (2 * model.nv() + model.na(), model.nu());
        let (options, number) = (IlqrOptions::default(), bytes.number());
        let options = IlqrOptions::default()
            .with_iterations(bytes.below(5))
            .with_tolerance(if bytes.once_in(8) { number } else { options.tolerance })
            .with_threads(if bytes.once_in(8) { 2 } else { 1 })
            .with_step_sizes(if bytes.once_in(8) { vec![number; bytes.below(3)] } else { options.step_sizes });
        let target = bytes.vector(model.state_size(StateSpec::PHYSICS));
        let cost = QuadraticCost::new(model.clone(), &target, weights(bytes, nx, nu), cost(bytes, nx))?;
        let steps = bytes.below(6);
        let controls = controls(&scene.data, bytes, steps);
        let solution = Ilqr::new(model, options)?.solve(&scene.data, &controls, &cost)?;
        black_box((solution.cost(), solution.status.to_string()));
        solution.controller(&scene.data)?.control(&mut scene.data)
    }),
    ("Riccati::solve_into", |scene, bytes| {
        let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
        for _ in 0..=bytes.below(3) {
            let (n, m) = (bytes.below(7), bytes.below(4));
            let (a, b) = (matrix(bytes, n, n), matrix(bytes, n, m));
            let LqrWeights { q, r, s } = weights(bytes, n, m);
            let mut riccati = Riccati::new(&a, &b, &q, &r);
            if let Some(s) = &s {
                riccati = riccati.with_cross_term(s);
            }
            if bytes.once_in(4) {
                riccati = riccati.with_residual_tolerance(bytes.number());
            }
            (scene.log)(&format!("  A {a:?}, B {b:?}, Q {q:?}, R {r:?}, S {s:?}"));
            let result = riccati.solve_into(&mut workspace, &mut solution);
            black_box(result.err().map(|error| error.to_string()));
        }
        Ok(())
    }),
    ("RiccatiRecursion", |scene, bytes| {
        let (n, m) = (bytes.below(6), bytes.below(4));
        let terminal = cost(bytes, n);
        let Ok(mut recursion) = RiccatiRecursion::new(&terminal, m) else { return Ok(()) };
        for _ in 0..=bytes.below(4) {
            let (a, b, weights) = (matrix(bytes, n, n), matrix(bytes, n, m), weights(bytes, n, m));
            (scene.log)(&format!("  {a:?} {b:?} {weights:?}"));
            let result = recursion.step_back(&a, &b, &weights).map(Matrix::shape);
            black_box(result.err().map(|error| error.to_string()));
        }
        black_box((recursion.k().shape(), recursion.p().shape()));
        Ok(())
    }),
    ("Lineariser::inverse_jacobians", |scene, bytes| {
        with_transition(scene, bytes, |transition, data, bytes| {
            let (row, number) = (bytes.below(data.model().nv().max(1)), bytes.number());
            data.qacc_mut().iter_mut().skip(row).take(1).for_each(|qacc| *qacc = number);
            let force = bytes.either(InverseForce::WithoutActuators, InverseForce::Total);
            let result = transition.inverse_jacobians(data, force);
            result.map(|(_, report)| drop(black_box(format!("{report:?}"))))
        })
    }),
];
