//! Properties of every method.

use std::sync::Arc;

use mujoco_safe::callback::Callbacks;
use mujoco_safe::derivative::{Fallback, TransitionMethod, TransitionOptions, TransitionOutputs};
use mujoco_safe::enums::Integrator;
use mujoco_safe::rayon::ThreadPoolBuilder;
use mujoco_safe::{
    Data, Differences, Error, Lineariser, Matrix, Model, ModelMut, Options, StateSpace, StateSpec, math, sample,
};

use super::{assert_near, deviation, oracle, standing};

const METHODS: [TransitionMethod; 4] =
    [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic];

fn workspace(data: &Data, options: TransitionOptions) -> Lineariser {
    Lineariser::new(data.model().clone(), options).unwrap()
}

fn by(data: &mut Data, method: TransitionMethod, threads: usize) -> StateSpace {
    workspace(data, TransitionOptions::default().with_method(method).with_threads(threads))
        .linear_system(data)
        .unwrap()
        .0
}

fn cartpole() -> Data {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.qpos_mut()[1] = 0.4;
    data.qvel_mut().copy_from_slice(&[0.3, -0.7]);
    data.ctrl_mut()[0] = 0.2;
    data
}

/// Returns the model with most kinds of element, in motion.
fn zoo() -> Data {
    let model = Model::from_xml_str(include_str!("../../models/zoo.xml")).unwrap();
    let mut data = Data::new(model).unwrap();
    data.ctrl_mut().iter_mut().enumerate().for_each(|(i, ctrl)| *ctrl = 0.1 - 0.03 * i as f64);
    (0..20).for_each(|_| data.step().unwrap());
    data
}

fn with_options(mut data: Data, change: impl FnOnce(&mut Options)) -> Data {
    data.edit_model(|model: &mut ModelMut<'_>| model.edit_options(change)).unwrap();
    data
}

#[test]
fn columns_equal_the_engine_bit_for_bit() {
    // With the implicit integrator, the engine uses a factor from the previous step, which does not
    // depend on the control.
    let mut moving = with_options(zoo(), |options| options.integrator = Integrator::Euler);
    // The engine averages the sides of a muscle at rest, the last actuator.
    let muscle = moving.model().actuator("biceps").unwrap().id().index();
    moving.ctrl_mut()[muscle] = 0.3;
    *moving.act_mut().last_mut().unwrap() = 0.2;
    for mut data in [cartpole(), standing(), moving] {
        for differences in [Differences::Central, Differences::Forward] {
            let options = TransitionOptions::default()
                .with_differences(differences)
                .with_method(TransitionMethod::Columns)
                .with_eps(1e-6)
                .with_threads(2);
            let (system, used) = workspace(&data, options).linear_system(&mut data).unwrap();
            assert_eq!((used.method, used.fallback), (TransitionMethod::Columns, None));
            let engine = data.clone().transition_fd(1e-6, differences).unwrap();
            assert!(system == engine, "{differences:?} of {data:?}");
        }
    }
}

#[test]
fn inputs_change_the_matrix_of_the_implicit_integrators() {
    let mut data = zoo();
    let truth = oracle::linear_system(&data);
    // An activation changes the derivative of its muscle's force by velocity.
    let muscle = (6, 26);
    for method in [TransitionMethod::Columns, TransitionMethod::Engine] {
        let error = (by(&mut data, method, 1).a[muscle] - truth.a[muscle]).abs();
        assert!(error < 1e-9, "{method:?}: {error:e}");
    }
    // A control changes the damping of a damper: v' = v / (1 + h k u / m).
    let integrators = if cfg!(engine_since = "2.3.6") { &["implicit", "implicitfast"][..] } else { &["implicit"] };
    for integrator in integrators {
        let model = Model::from_xml_str(&format!(
            r#"<mujoco><option integrator="{integrator}" timestep="0.01" gravity="0 0 0"/>
                 <worldbody><body><joint name="j" type="slide"/><geom size=".1" mass="1"/></body></worldbody>
                 <actuator><damper joint="j" kv="50" ctrlrange="0 1"/></actuator></mujoco>"#
        ));
        let mut data = Data::new(model.unwrap()).unwrap();
        (data.qvel_mut()[0], data.ctrl_mut()[0]) = (1.0, 0.5);
        for method in METHODS {
            let b = by(&mut data, method, 1).b;
            assert!((b[(1, 0)] + 0.32).abs() < 1e-6, "{integrator}, {method:?}: {b:?}");
        }
        data.ctrl_mut()[0] = 1.0;
        let b = data.transition_fd(1e-6, Differences::Central).unwrap().b;
        assert!((b[(1, 0)] + 0.5 / 2.25).abs() < 1e-5, "{integrator} at the limit: {b:?}");
    }
}

#[test]
fn all_methods_perturb_a_control_at_its_limit_inwards() {
    let mut data = standing();
    let [low, high] = data.model().actuator_ctrlrange()[0];
    data.ctrl_mut()[0] = high;
    data.ctrl_mut()[1] = low;
    data.ctrl_mut()[2] = high + 1.0;
    let engine = by(&mut data, TransitionMethod::Engine, 1);
    assert!((0..engine.b.nrows()).all(|row| engine.b[(row, 2)] == 0.0));
    // With the step of the engine, which is then not repeated with another.
    let options = TransitionOptions::default().with_method(TransitionMethod::Columns).with_eps(1e-6);
    assert_eq!(workspace(&data, options).linear_system(&mut data).unwrap().0, engine);
    assert_near("inverse", &by(&mut data, TransitionMethod::Implicit, 1), &engine, 1e-5);
}

#[test]
fn the_implicit_method_is_more_accurate_than_the_engine() {
    for mut data in [standing(), cartpole()] {
        let truth = oracle::linear_system(&data);
        let inverse = by(&mut data, TransitionMethod::Implicit, 1);
        let engine = by(&mut data, TransitionMethod::Engine, 1);
        assert_near("engine", &inverse, &engine, 1e-5);
        assert_near("truth", &inverse, &truth, 3e-7);
        assert!(deviation(&inverse.a, &truth.a) <= deviation(&engine.a, &truth.a).max(1e-8));
        assert!(deviation(&inverse.b, &truth.b) <= deviation(&engine.b, &truth.b).max(1e-8));
    }
}

#[test]
fn forward_differences_are_close_to_central_differences() {
    let mut data = standing();
    let central = by(&mut data, TransitionMethod::Implicit, 1);
    let options =
        TransitionOptions::default().with_method(TransitionMethod::Implicit).with_differences(Differences::Forward);
    let (forward, _) = workspace(&data, options).linear_system(&mut data).unwrap();
    assert!(forward != central);
    assert_near("forward", &forward, &central, 1e-3);
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    for mut data in [cartpole(), standing(), zoo()] {
        for method in METHODS {
            let one = by(&mut data, method, 1);
            for threads in [2, 3, 20] {
                assert_eq!(by(&mut data, method, threads), one, "{method:?} in {threads}");
            }
        }
    }
}

#[test]
fn the_result_does_not_depend_on_the_surrounding_pool() {
    // Called within a pool with fewer threads than requested, or with no free threads.
    for mut data in [standing(), zoo()] {
        for method in METHODS {
            let one = by(&mut data, method, 1);
            for threads in [1, 2, 5] {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                assert_eq!(pool.install(|| by(&mut data, method, 3)), one, "{method:?} in {threads}");
            }
        }
    }
}

#[test]
fn a_workspace_is_usable_after_a_failure() {
    let mut data = standing();
    for method in METHODS {
        let options = TransitionOptions::default().with_method(method).with_threads(2);
        let (mut used, mut system) = (workspace(&data, options), StateSpace::zeros(data.model()));
        let one = by(&mut data, method, 1);
        let mut lost = data.clone();
        lost.qfrc_applied_mut().fill(1e300);
        assert!(used.linear_system_into(&mut lost, &mut system).is_err(), "{method:?}");
        used.linear_system_into(&mut data, &mut system).unwrap();
        assert_eq!(system, one, "{method:?}");
    }
}

#[test]
fn omitted_outputs_do_not_affect_other_outputs() {
    let mut data = standing();
    for method in METHODS {
        for threads in [1, 2] {
            // With a fixed step: otherwise the wanted outputs decide which step is suitable.
            let options = TransitionOptions::default().with_method(method).with_threads(threads).with_eps(1e-6);
            let mut transition = workspace(&data, options);
            let whole = transition.linear_system(&mut data).unwrap().0;
            let mut part = StateSpace::zeros(data.model());
            let outputs = TransitionOutputs { a: Some(&mut part.a), ..Default::default() };
            transition.linear_system_into(&mut data, outputs).unwrap();
            let outputs = TransitionOutputs { b: Some(&mut part.b), d: Some(&mut part.d), ..Default::default() };
            transition.linear_system_into(&mut data, outputs).unwrap();
            let outputs = TransitionOutputs { c: Some(&mut part.c), ..Default::default() };
            transition.linear_system_into(&mut data, outputs).unwrap();
            assert_near(&format!("{method:?}"), &part, &whole, 1e-9);
            transition.linear_system_into(&mut data, TransitionOutputs::default()).unwrap();
        }
    }
}

/// Returns all contents of a simulation.
fn everything(data: &Data) -> (Vec<f64>, Vec<f64>, String) {
    (
        data.state(StateSpec::INTEGRATION),
        [data.qacc(), data.qfrc_constraint(), data.xpos().as_flattened()].concat(),
        format!("{data:?}, {:?}", data.stage()),
    )
}

#[test]
fn the_simulation_is_restored_bit_for_bit() {
    for mut data in [cartpole(), standing(), zoo()] {
        for method in METHODS {
            for threads in [1, 2] {
                let before = everything(&data);
                let mut transition =
                    workspace(&data, TransitionOptions::default().with_method(method).with_threads(threads));
                transition.linear_system(&mut data).unwrap();
                assert_eq!(everything(&data), before);

                // Huge accelerations are an error of the step.
                let mut wild = data.clone();
                wild.qfrc_applied_mut().fill(1e300);
                let before = everything(&wild);
                assert!(matches!(transition.linear_system(&mut wild), Err(Error::Unstable(_))), "{method:?}");
                assert_eq!(everything(&wild), before);
                // The next linearisation succeeds.
                transition.linear_system(&mut data).unwrap();
            }
        }
    }
}

#[test]
fn unsupported_models_fall_back_to_differences_with_a_report() {
    for (data, fallback) in [
        (with_options(cartpole(), |options| options.integrator = Integrator::Rk4), Fallback::RungeKutta),
        (with_options(standing(), |options| options.integrator = Integrator::Implicit), Fallback::ImplicitIntegrator),
        (with_options(standing(), |options| options.noslip_iterations = 3), Fallback::NoSlip),
    ] {
        let mut data = data;
        let truth = oracle::linear_system(&data);
        for method in [TransitionMethod::Implicit, TransitionMethod::Analytic] {
            // The analytic method has formulas for the implicit integrator.
            if fallback == Fallback::ImplicitIntegrator && method == TransitionMethod::Analytic {
                continue;
            }
            for threads in [1, 2] {
                let options = TransitionOptions::default().with_method(method).with_threads(threads);
                let (system, used) = workspace(&data, options).linear_system(&mut data).unwrap();
                assert_eq!((used.method, used.fallback), (TransitionMethod::Columns, Some(fallback)));
                assert_near(&fallback.to_string(), &system, &truth, 1e-4);
            }
        }
    }
    let mut data = with_options(standing(), |options| {
        options.iterations = 1;
        options.solver = mujoco_safe::enums::Solver::Pgs;
    });
    for method in [TransitionMethod::Implicit, TransitionMethod::Analytic] {
        for threads in [1, 2] {
            let options = TransitionOptions::default().with_method(method).with_threads(threads);
            let (system, used) = workspace(&data, options).linear_system(&mut data).unwrap();
            assert_eq!((used.method, used.fallback), (TransitionMethod::Columns, Some(Fallback::NotConverged)));
            assert_eq!(system, data.clone().transition_fd(1e-6, Differences::Central).unwrap());
        }
    }
}

#[test]
fn columns_support_runge_kutta_and_the_engine_does_not() {
    let mut data = with_options(cartpole(), |options| options.integrator = Integrator::Rk4);
    let options = TransitionOptions::default().with_method(TransitionMethod::Engine);
    let (system, used) = workspace(&data, options).linear_system(&mut data).unwrap();
    assert_eq!((used.method, used.fallback), (TransitionMethod::Columns, Some(Fallback::RungeKutta)));
    assert_near("Runge–Kutta", &system, &oracle::linear_system(&data), 1e-7);
}

#[test]
fn linearisations_include_callbacks() {
    let mut data = cartpole();
    data.ctrl_mut()[0] = -0.5 * data.qpos()[1];
    let before = data.state(StateSpec::INTEGRATION);
    let feedback = Callbacks::new().with_control(|context| context.ctrl_mut()[0] = -0.5 * context.qpos()[1]);
    let mut transition = workspace(&data, TransitionOptions::default());
    let (system, used) = data.with_callbacks(feedback, |data| transition.linear_system(data)).unwrap();
    assert_eq!((used.method, used.fallback), (TransitionMethod::Engine, Some(Fallback::Callbacks)));
    assert_eq!(data.state(StateSpec::INTEGRATION), before);
    let free = transition.linear_system(&mut data).unwrap().0;
    let gain = (system.a[(2, 1)] - free.a[(2, 1)]) / free.b[(2, 0)];
    assert!((gain + 0.5).abs() < 1e-3, "{gain}");
}

#[test]
fn edits_of_the_model_are_followed() {
    let mut data = cartpole();
    for method in METHODS {
        let mut transition = workspace(&data, TransitionOptions::default().with_method(method));
        let before = transition.linear_system(&mut data).unwrap().0;
        let mut changed = with_options(data.clone(), |options| options.gravity = [0.0; 3]);
        let after = transition.linear_system(&mut changed).unwrap().0;
        assert!(after != before);
        assert_eq!(after, by(&mut changed, method, 1));
    }
}

#[test]
fn linearisations_along_a_trajectory_equal_single_linearisations() {
    let mut data = standing();
    let (mut states, mut controls) = (Vec::new(), Vec::new());
    for knot in 0..5 {
        data.ctrl_mut()[3] = 0.1 * f64::from(knot);
        states.extend_from_slice(&data.physics_state());
        controls.extend_from_slice(data.ctrl());
        data.step().unwrap();
    }
    let states = Matrix::from_row_major(5, states.len() / 5, states);
    let controls = Matrix::from_row_major(5, controls.len() / 5, controls);
    for method in METHODS {
        for threads in [1, 2, 9] {
            let mut transition =
                workspace(&data, TransitionOptions::default().with_method(method).with_threads(threads));
            let systems = transition.along(&data, &states, &controls).unwrap();
            for (knot, (system, used)) in systems.iter().enumerate() {
                let mut alone = data.clone();
                alone.set_physics_state(states.row(knot)).unwrap();
                alone.ctrl_mut().copy_from_slice(controls.row(knot));
                let (expected, how) = transition.linear_system(&mut alone).unwrap();
                assert_eq!((system, *used), (&expected, how), "{method:?} in {threads}, row {knot}");
            }
        }
    }
    let mut invalid = states.clone();
    invalid[(3, 0)] = f64::NAN;
    let mut transition = workspace(&data, TransitionOptions::default().with_threads(2));
    assert!(matches!(transition.along(&data, &invalid, &controls), Err(Error::Unstable(_))));
    assert!(
        transition
            .along(&data, &Matrix::zeros(0, states.ncols()), &Matrix::zeros(0, controls.ncols()))
            .unwrap()
            .is_empty()
    );
}

#[test]
fn wrong_shapes_options_and_models_are_errors() {
    let mut data = cartpole();
    let model: Arc<Model> = data.model().clone();
    for eps in [0.0, 2.0, f64::NAN] {
        let options = TransitionOptions::default().with_eps(eps);
        assert!(matches!(Lineariser::new(model.clone(), options), Err(Error::Invalid { .. })));
    }
    for threads in [0, 1025, usize::MAX] {
        let options = TransitionOptions::default().with_threads(threads);
        assert!(matches!(Lineariser::new(model.clone(), options), Err(Error::Invalid { .. })));
    }

    let mut transition = workspace(&data, TransitionOptions::default());
    for wrong in 0..4 {
        let mut system = StateSpace::zeros(&model);
        let matrix = [&mut system.a, &mut system.b, &mut system.c, &mut system.d].into_iter().nth(wrong).unwrap();
        *matrix = Matrix::zeros(matrix.nrows() + 1, matrix.ncols());
        assert!(matches!(transition.linear_system_into(&mut data, &mut system), Err(Error::Shape { .. })));
        let mut systems = transition.along(&data, &Matrix::zeros(1, 4), &Matrix::zeros(1, 1)).unwrap();
        systems[0].0 = system;
        let result = transition.along_into(&data, &Matrix::zeros(1, 4), &Matrix::zeros(1, 1), &mut systems);
        assert!(matches!(result, Err(Error::Shape { .. })));
    }
    for (states, controls) in [((2, 5), (2, 1)), ((2, 4), (2, 2)), ((2, 4), (3, 1))] {
        let [states, controls] = [states, controls].map(|(rows, columns)| Matrix::zeros(rows, columns));
        assert!(matches!(transition.along(&data, &states, &controls), Err(Error::Shape { .. })));
    }
    let result = transition.along_into(&data, &Matrix::zeros(2, 4), &Matrix::zeros(2, 1), &mut []);
    assert!(matches!(result, Err(Error::Shape { .. })));

    let mut other = Data::new(sample::cartpole()).unwrap();
    assert!(matches!(transition.linear_system(&mut other), Err(Error::OtherModel { .. })));
    data.qvel_mut()[0] = f64::NAN;
    assert!(matches!(transition.linear_system(&mut data), Err(Error::Unstable(_))));
}

#[test]
fn models_without_joints_or_actuators_have_empty_systems() {
    for xml in ["<mujoco/>", r#"<mujoco><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#] {
        let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
        let engine = by(&mut data, TransitionMethod::Engine, 1);
        for threads in [1, 2] {
            assert_eq!(by(&mut data, TransitionMethod::Columns, threads), engine);
            assert_near(xml, &by(&mut data, TransitionMethod::Implicit, threads), &engine, 1e-7);
            assert_near(xml, &by(&mut data, TransitionMethod::Analytic, threads), &engine, 1e-7);
        }
    }
}

#[test]
fn quaternions_of_any_length_forces_and_inactive_constraints_agree_with_differences() {
    let xml = r#"<mujoco><option timestep="0.004"/><worldbody>
        <body name="target" mocap="true" pos="0.3 0.1 0.5"/>
        <body pos="0 0 0.5"><joint type="ball" damping="0.2" stiffness="3"/><geom type="box" size="0.1 0.05 0.07" pos="0.2 0 0"/>
          <body name="hand" pos="0.4 0 0"><joint axis="0 1 0" damping="0.1"/><geom size="0.05" pos="0.1 0 0"/><site name="s" pos="0.1 0 0"/></body></body>
        <body pos="0 1 0.3"><freejoint/><geom type="box" size="0.1 0.2 0.1"/></body></worldbody>
        <equality><weld body1="hand" body2="target" solref="0.1 1"/></equality>
        <actuator><motor site="s" gear="1 0.3 0 0.2 0 0.1"/></actuator>
        <sensor><framequat objtype="site" objname="s"/><accelerometer site="s"/></sensor></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    for integrator in [Integrator::Euler, Integrator::Implicit, Integrator::Rk4] {
        for (is_active, scale) in [(true, 1.0), (true, 0.8), (false, 1.3)] {
            data.edit_model(|model| {
                model.equality_mut(0).unwrap().set_active(is_active);
                model.edit_options(|options| {
                    // The differences of steps have the accuracy of the solver.
                    (options.tolerance, options.iterations) = (0.0, 200);
                    options.integrator = integrator;
                })
            })
            .unwrap();
            data.reset().unwrap();
            let quat = math::axis_angle2quat(&[0.6, 0.0, 0.8], 0.4).map(|value| scale * value);
            data.qpos_mut()[..4].copy_from_slice(&quat);
            data.qpos_mut()[8..].copy_from_slice(&quat);
            data.mocap_quat_mut()[0] = quat;
            data.qvel_mut().iter_mut().enumerate().for_each(|(dof, value)| *value = 0.3 * (dof as f64).cos());
            data.ctrl_mut()[0] = 0.4;
            data.xfrc_applied_mut()[3] = [0.3, -0.2, 0.4, 0.03, 0.02, -0.05];
            data.qfrc_applied_mut().fill(0.1);
            let expected = oracle::linear_system(&data);
            for method in METHODS.into_iter().filter(|&method| method != TransitionMethod::Engine) {
                let what = format!("{integrator:?}, active {is_active}, scale {scale}, {method:?}");
                assert_near(&what, &by(&mut data, method, 1), &expected, 1e-4);
            }
        }
    }
}

/// Newer engines have actuators with several controls.
#[test]
fn models_with_more_controls_than_actuators_agree_with_differences() {
    let xml = r#"<mujoco><worldbody><body><joint name="j" damping="0.1"/><geom size="0.1" pos="0.2 0 0"/></body></worldbody>
        <actuator><pid joint="j" kp="5" kv="0.5" input="pos vel"/><motor joint="j"/></actuator></mujoco>"#;
    let Ok(model) = Model::from_xml_str(xml) else { return };
    assert!(model.nu() > model.nactuator());
    let mut data = Data::new(model).unwrap();
    data.ctrl_mut().copy_from_slice(&[0.3, -0.2, 0.1]);
    for integrator in [Integrator::Euler, Integrator::Implicit, Integrator::Rk4, Integrator::ImplicitFast] {
        data = with_options(data, |options| options.integrator = integrator);
        let expected = oracle::linear_system(&data);
        for method in METHODS.into_iter().filter(|&method| method != TransitionMethod::Engine) {
            assert_near(&format!("{integrator:?} {method:?}"), &by(&mut data, method, 1), &expected, 1e-5);
        }
    }
}
