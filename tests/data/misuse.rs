//! Misuse without `unsafe`: the result is an error or a panic with a message, never a crash, a hang
//! or a wrong number.

#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::derivative::TransitionOutputs;
use mujoco_safe::enums::{Integrator, JacobianStorage, Solver};
use mujoco_safe::{
    Controller, Data, Differences, Error, Lqr, Matrix, Model, PdController, RandomController, StateSpec, Trajectory,
    sample,
};

/// Returns the message with which `action` must panic.
fn panic_text<T>(action: impl FnOnce() -> T) -> String {
    let payload = catch_unwind(AssertUnwindSafe(action)).err().expect("no panic");
    payload.downcast_ref::<String>().cloned().or_else(|| payload.downcast_ref::<&str>().map(|&s| s.to_owned())).unwrap()
}

fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data
}

/// A model of all geoms that the general collision algorithm handles, and a mocap body.
const COLLIDERS: &str = include_str!("../models/colliders.xml");

// The engine clears nq + nv + na numbers in a row of 2 nv + na when the last control cannot be
// perturbed in either direction.
#[test]
fn a_clamped_control_does_not_corrupt_the_linearisation() {
    let mut data = squatting();
    let nu = data.model().nu();
    for differences in [Differences::Forward, Differences::Central] {
        data.reset_to_key("squat").unwrap();
        data.qpos_mut()[0] = 0.5;
        data.ctrl_mut()[nu - 1] = 1.0; // the limit, which has the same effect as a control beyond it
        data.set_time(3.0);
        let before = data.state(StateSpec::INTEGRATION);
        let good = data.transition_fd(1e-6, Differences::Central).unwrap();

        data.set_state(StateSpec::INTEGRATION, &before).unwrap();
        data.ctrl_mut()[nu - 1] = 2.0;
        let before = data.state(StateSpec::INTEGRATION);
        let system = data.transition_fd(1e-6, differences).unwrap();
        assert_eq!(data.state(StateSpec::FULL_PHYSICS), before[..data.state(StateSpec::FULL_PHYSICS).len()]);
        assert_eq!(data.state(StateSpec::USER), {
            data.set_state(StateSpec::INTEGRATION, &before).unwrap();
            data.state(StateSpec::USER)
        });
        if differences == Differences::Central {
            let worst = (0..system.a.nrows() * system.a.ncols())
                .map(|at| (system.a.as_slice()[at] - good.a.as_slice()[at]).abs())
                .fold(0.0, f64::max);
            assert!(worst < 1e-5, "{worst}");
        }
        let last = |row: usize| system.b[(row, nu - 1)];
        assert!((0..system.b.nrows()).all(|row| last(row) == 0.0), "a clamped control has no effect");
    }
}

#[test]
fn a_clamped_control_does_not_depend_on_the_requested_matrices() {
    let mut model = Model::from_xml_str(COLLIDERS).unwrap();
    model.edit().edit_options(|options| options.tolerance = 0.0).unwrap();
    let mut data = Data::new(model).unwrap();
    data.ctrl_mut()[0] = 5.0;
    let system = data.transition_fd(1e-6, Differences::Forward).unwrap();
    let mut d = Matrix::zeros(system.d.nrows(), system.d.ncols());
    let outputs = TransitionOutputs { d: Some(&mut d), ..Default::default() };
    data.transition_fd_into(1e-6, Differences::Forward, outputs).unwrap();
    assert_eq!(d, system.d);
    let mut a = Matrix::zeros(system.a.nrows(), system.a.ncols());
    let outputs = TransitionOutputs { a: Some(&mut a), ..Default::default() };
    data.transition_fd_into(1e-6, Differences::Forward, outputs).unwrap();
    assert_eq!(a, system.a);
}

#[test]
fn linearising_keeps_the_time() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.set_time(1.5);
    data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!(data.time(), 1.5);
}

#[test]
fn step2_requires_its_own_step1() {
    for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
        let mut model = sample::humanoid();
        model.edit().edit_options(|options| options.solver = solver).unwrap();
        let mut data = Data::new(model).unwrap();
        let assert_rejected = |data: &mut Data| {
            let error = data.step2().unwrap_err();
            assert!(matches!(error, Error::NotComputed { call: "step2", .. }), "{error}");
            assert!(error.to_string().contains("call step1 first"), "{error}");
        };
        assert_rejected(&mut data);
        data.reset_to_key("squat").unwrap();
        assert_rejected(&mut data);
        data.step().unwrap();
        assert_rejected(&mut data);
        data.inverse().unwrap();
        assert_rejected(&mut data);
        data.step1().unwrap();
        data.step2().unwrap();
        assert_rejected(&mut data);
        data.forward().unwrap();
        let mut copy = data.clone();
        data.step2().unwrap();
        assert_rejected(&mut data);
        copy.step2().unwrap();
        assert_eq!(copy.qpos(), data.qpos());
        data.step1().unwrap();
        data.edit_model(|_| ()).unwrap();
        assert_rejected(&mut data);
        data.step1().unwrap();
        data.transition_fd(1e-6, Differences::Forward).unwrap();
        assert_rejected(&mut data);
    }
}

#[test]
fn step2_is_rejected_after_a_change_of_options() {
    let mut data = squatting();
    let changes: [fn(&mut mujoco_safe::Options); 5] = [
        |options| options.solver = Solver::Pgs,
        |options| options.noslip_iterations = 5,
        |options| options.jacobian = JacobianStorage::Sparse,
        |options| options.cone = mujoco_safe::enums::Cone::Elliptic,
        |options| options.integrator = Integrator::Implicit,
    ];
    for change in changes {
        data.step1().unwrap();
        data.edit_model(|model| model.edit_options(change)).unwrap();
        assert!(matches!(data.step2(), Err(Error::NotComputed { .. })));
        assert!(matches!(data.jac_body(data.model().body("torso").unwrap().id()), Err(Error::NotComputed { .. })));
        for contact in data.contacts() {
            assert!(matches!(contact.force(), Err(Error::NotComputed { .. })));
        }
        data.step1().unwrap();
        data.step2().unwrap();
    }
}

#[test]
fn every_combination_of_discrete_options_steps() {
    let mut data = squatting();
    for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
        for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
            for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
                for cone in [mujoco_safe::enums::Cone::Elliptic, mujoco_safe::enums::Cone::Pyramidal] {
                    for noslip in [0, 3] {
                        data.edit_model(|model| {
                            model.edit_options(|options| {
                                (options.solver, options.integrator, options.jacobian) = (solver, integrator, jacobian);
                                (options.cone, options.noslip_iterations) = (cone, noslip);
                            })
                        })
                        .unwrap();
                        data.reset_to_key("squat").unwrap();
                        for _ in 0..3 {
                            data.step().unwrap();
                            assert!(data.contacts().all(|contact| contact.force().is_ok()));
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn matrices_whose_size_overflows_panic() {
    let half = 1_usize << (usize::BITS / 2);
    assert!(panic_text(|| Matrix::zeros(half, half)).contains("too large"));
    assert!(panic_text(|| Matrix::from_row_major(half, half, Vec::new())).contains("too large"));
    for shape in [(0, 5), (5, 0), (0, 0)] {
        let mut empty = Matrix::zeros(shape.0, shape.1);
        assert_eq!(empty.transposed().shape(), (shape.1, shape.0));
        assert_eq!(empty.transposed_mut().shape(), (shape.1, shape.0));
        assert_eq!(empty.to_nalgebra().shape(), shape);
    }
}

#[test]
fn an_overflowing_record_index_panics() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    trajectory.push(&data).unwrap();
    let wrapped = 1_usize << (usize::BITS - 2); // times 4 numbers per state: 0
    assert!(panic_text(|| trajectory.state(wrapped).len()).contains("of a trajectory of 1"));
    assert!(panic_text(|| trajectory.ctrl(1).len()).contains("of a trajectory of 1"));
    assert!(panic_text(|| trajectory.apply(wrapped, &mut data)).contains("of a trajectory of 1"));

    let mut other = Data::new(sample::humanoid()).unwrap();
    assert!(matches!(trajectory.push(&other), Err(Error::Shape { .. })));
    assert!(matches!(trajectory.apply(0, &mut other), Err(Error::Shape { .. })));
}

/// Returns two models whose vectors have equal lengths but whose joints differ.
fn models_of_equal_sizes() -> (Model, Model) {
    let model = |joints: &str, actuator: &str| {
        Model::from_xml_str(&format!(
            r#"<mujoco><worldbody><body>{joints}<geom size=".1"/></body></worldbody><actuator>{actuator}</actuator></mujoco>"#
        ))
        .unwrap()
    };
    let first = model(
        r#"<joint type="ball" name="j"/>"#,
        r#"<general joint="j" dyntype="filter"/><general joint="j" dyntype="filter"/>"#,
    );
    let second = model(
        r#"<joint axis="1 0 0" name="j"/><joint axis="0 1 0"/><joint axis="0 0 1"/><joint type="slide"/>"#,
        r#"<general joint="j"/><general joint="j"/>"#,
    );
    assert_eq!((first.nq(), second.nq()), (4, 4));
    assert_eq!(2 * first.nv() + first.na(), 2 * second.nv() + second.na());
    (first, second)
}

#[test]
fn a_regulator_rejects_a_model_of_equal_sizes() {
    let (first, second) = models_of_equal_sizes();
    let first = Data::new(first).unwrap();
    let mut second = Data::new(second).unwrap();
    let mut lqr = Lqr::with_gain(&first, Matrix::zeros(2, 8)).unwrap();
    assert!(matches!(lqr.control(&mut second), Err(Error::Shape { .. })));
    let mut trajectory = Trajectory::new(first.model());
    assert!(trajectory.push(&second).is_err());
}

#[test]
fn a_target_of_another_model_panics() {
    let mut pd = PdController::new(&sample::cartpole(), 1.0, 1.0);
    let other = sample::cartpole();
    let text = panic_text(|| pd.set_target(other.actuator("slide").unwrap(), 1.0));
    assert!(text.contains("another model"), "{text}");
    assert!(matches!(pd.control(&mut Data::new(sample::humanoid()).unwrap()), Err(Error::Shape { .. })));
}

#[test]
fn ids_of_another_model_panic_in_every_function() {
    let other = sample::humanoid();
    let (body, geom, joint) = (other.body(1).unwrap().id(), other.geom(0).unwrap().id(), other.joint(0).unwrap().id());
    let mut data = squatting();
    data.forward().unwrap();
    for text in [
        panic_text(|| data.jac_body(body)),
        panic_text(|| data.jac_geom(geom)),
        panic_text(|| data.jac([0.0; 3], body)),
        panic_text(|| data.jac_subtree_com(body)),
        panic_text(|| data.joint(joint).qpos().len()),
        panic_text(|| data.joint_mut(joint).qpos_mut().len()),
        panic_text(|| data.model().name(joint).map(str::len)),
        panic_text(|| data.edit_model(|model| model.joint_mut(joint).set_stiffness(1.0))),
        panic_text(|| data.reset_to_key(other.keyframe(0).unwrap().id())),
    ] {
        assert!(text.contains("belongs to another model"), "{text}");
    }
    data.forward().unwrap();
    data.step2().unwrap();
}

#[test]
fn copying_between_separately_loaded_models_is_an_error() {
    let (mut a, b) = (squatting(), squatting());
    assert!(matches!(a.copy_from(&b), Err(Error::OtherModel { .. })));
    a.clone_from(&b);
    assert!(Arc::ptr_eq(a.model(), b.model()));

    // A clone with other options: copying transfers the state, but no computed results.
    let mut edited = a.clone();
    edited.edit_model(|model| model.edit_options(|options| options.cone = mujoco_safe::enums::Cone::Elliptic)).unwrap();
    edited.step().unwrap();
    assert!(edited.contacts().len() > 0);
    a.copy_from(&edited).unwrap();
    assert!(a.contacts().all(|contact| matches!(contact.force(), Err(Error::NotComputed { .. }))));
    assert!(matches!(a.step2(), Err(Error::NotComputed { .. })));
    a.step().unwrap();
    a.clone_from(&edited);
    assert!(a.contacts().all(|contact| contact.force().is_ok()));
}

#[test]
fn a_simulation_works_after_a_panic_in_an_edit() {
    let mut data = squatting();
    data.step().unwrap();
    let weak = Arc::downgrade(data.model());
    let shared = data.model().clone();
    assert_eq!(
        panic_text(|| data.edit_model(|model| {
            model.body_mass_mut()[1] = 100.0;
            assert!(model.body_mass()[1] < 100.0, "in the closure");
        })),
        "in the closure"
    );
    assert!(!Arc::ptr_eq(&shared, data.model()), "the shared model is unchanged");
    assert!(shared.body_mass()[1] < 100.0);
    assert_eq!(data.model().body_mass()[1], 100.0);
    drop(shared);
    assert!(weak.upgrade().is_none());
    data.step().unwrap();

    // A weak reference alone causes a copy, too, because it could be upgraded later.
    let weak = Arc::downgrade(data.model());
    data.edit_model(|_| ()).unwrap();
    assert!(weak.upgrade().is_none());
    data.step().unwrap();
}

#[test]
fn empty_models_and_models_without_joints_work_in_every_call() {
    for xml in [
        "<mujoco/>",
        r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/><body mocap="true"><geom size=".1"/></body></worldbody></mujoco>"#,
        r#"<mujoco><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>"#,
        r#"<mujoco><size njmax="0" nconmax="0"/><worldbody><body><joint/><geom size=".1"/></body></worldbody></mujoco>"#,
    ] {
        let model = Model::from_xml_str(xml).unwrap();
        let nv = model.nv();
        let mut data = Data::new(model).unwrap();
        data.step().unwrap();
        data.step1().unwrap();
        data.step2().unwrap();
        data.forward().unwrap();
        data.inverse().unwrap();
        data.forward().unwrap();
        let world = data.model().body(0).unwrap().id();
        assert_eq!(data.jac_body_com(world).unwrap().linear.shape(), (3, nv));
        assert_eq!(data.jac_subtree_com(world).unwrap().shape(), (3, nv));
        assert_eq!(data.full_m().unwrap().shape(), (nv, nv));
        let (mut result, vector) = (vec![0.0; nv], vec![1.0; nv]);
        data.mul_m_into(&vector, &mut result).unwrap();
        data.solve_m_into(&vector, &mut result).unwrap();
        let system = data.transition_fd(1e-6, Differences::Central).unwrap();
        assert_eq!(system.a.shape(), (2 * nv, 2 * nv));
        assert_eq!(data.contacts().len(), data.ncon());
        let state = data.state(StateSpec::INTEGRATION);
        data.set_state(StateSpec::INTEGRATION, &state).unwrap();
        let mut trajectory = Trajectory::new(data.model());
        trajectory.record(&mut data, &mut RandomController::new(1), 3).unwrap();
        PdController::new(data.model(), 1.0, 1.0).control(&mut data).unwrap();
        Lqr::with_gain(&data, Matrix::zeros(0, 2 * nv)).unwrap().control(&mut data).unwrap();
        data.edit_model(|model| model.update_constants()).unwrap();
        drop(data.clone());
        data.reset().unwrap();
    }
}

#[test]
fn unknown_flags_are_rejected() {
    let mut model = sample::cartpole();
    let error = model
        .edit()
        .edit_options(|options| options.enable = mujoco_safe::model::EnableFlags::from_bits_retain(1 << 20));
    assert!(error.unwrap_err().to_string().contains("unknown bits"));
    let spec = StateSpec::from_bits_retain(u32::MAX);
    let mut data = Data::new(model).unwrap();
    let state = data.state(spec);
    assert_eq!(state.len(), data.model().state_size(StateSpec::INTEGRATION));
    data.set_state(spec, &state).unwrap();
}

#[test]
fn untrusted_csv_trajectories_are_errors_or_can_be_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    let model = sample::cartpole();
    let mut data = Data::new(model.clone()).unwrap();
    let header = "time,qpos0,qpos1,qvel0,qvel1,ctrl0";
    let numbers = "9,".repeat(1_000_000);
    for (text, loads) in [
        (String::new(), false),
        ("\0".to_owned(), false),
        (header.to_owned(), true),
        (format!("{header}\n"), true),
        (format!("{header}\r\n0,0,0,0,0,0\r\n"), true),
        (format!("{header}\n\n"), false),
        (format!("{header}\n0,0,0,0,0"), false),
        (format!("{header}\n0,0,0,0,0,0,0"), false),
        (format!("{header}\n0,0,0,0,0,x"), false),
        (format!("{header}\n0,0,0,0,0,0x10"), false),
        (format!("{header}\n{numbers}"), false),
        (format!("{header},{numbers}\n0,0,0,0,0,0"), false),
        (format!("{header}\n-1,0,0,0,0,0\n-1,0,0,0,0,0\n-2,0,0,0,0,0"), true),
        (format!("{header}\nNaN,inf,-inf,1e400,-1e-400,5e-324\n1e308,0,0,0,0,0"), true),
    ] {
        std::fs::write(&path, &text).unwrap();
        let start = &text[..text.len().min(60)];
        let read = Trajectory::load_csv(&model, &path);
        assert_eq!(read.is_ok(), loads, "{start}");
        let Ok(read) = read else { continue };
        for record in 0..read.len() {
            let _ = read.apply(record, &mut data);
            let _ = data.step();
            data.reset().unwrap();
        }
        read.save_csv(&path).unwrap();
        let again = Trajectory::load_csv(&model, &path).unwrap();
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!((bits(again.times()), bits(again.states())), (bits(read.times()), bits(read.states())), "{start}");
    }
    std::fs::write(&path, b"time,\xff\xfe\n").unwrap();
    assert!(Trajectory::load_csv(&model, &path).is_err());
}
