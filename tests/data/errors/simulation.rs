//! NaN, missing pipeline stages, and errors of the engine.

use std::sync::{Arc, Barrier};

use mujoco_safe::data::UnstableField;
use mujoco_safe::enums::Integrator;
use mujoco_safe::model::EnableFlags;
use mujoco_safe::{Data, Differences, Error, Model, Result, Stage, StateSpec, sample};

use super::text_of;
use crate::trouble::{self, STACK_OVERFLOW};

/// Steps until the engine's stack overflows.
fn overflow(data: &mut Data) -> Error {
    (0..200).find_map(|_| data.step().err()).expect("a stack overflow")
}

#[test]
fn a_nan_control_is_an_error_that_changes_nothing() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.step().unwrap();
    for value in [f64::NAN, f64::INFINITY, -1e11] {
        data.ctrl_mut()[0] = value;
        let before = data.state(StateSpec::FULL_PHYSICS);
        for result in [
            data.step(),
            data.step1(),
            data.forward(),
            data.inverse(),
            data.transition_fd(1e-6, Differences::Forward).map(drop),
        ] {
            text_of(
                result,
                &["a control is out of range at time 0.01 s", "ctrl[0] of actuator 'slide'", &format!("{value}")],
            );
        }
        assert_eq!(data.state(StateSpec::FULL_PHYSICS), before);
        assert!(data.ctrl()[0].to_bits() == value.to_bits());
    }
    data.ctrl_mut()[0] = 0.0;
    data.step().unwrap();
}

#[test]
fn a_nan_position_or_velocity_is_an_error_that_changes_nothing() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    for value in [f64::NAN, f64::NEG_INFINITY, 1e11] {
        data.reset().unwrap();
        data.qpos_mut()[3] = value;
        text_of(
            data.step(),
            &[
                "the simulation is unstable at time 0 s",
                "qpos[3] of joint 'root'",
                &value.to_string(),
                "between -1e10 and 1e10",
            ],
        );
        let Err(Error::Unstable(found)) = data.step() else { panic!("the error must persist") };
        assert_eq!((found.field, found.index, found.time), (UnstableField::Position, 3, 0.0));
        data.reset().unwrap();
        let knee = data.model().joint("left_knee").unwrap().dofs().start;
        data.qvel_mut()[knee] = value;
        text_of(data.step(), &[&format!("qvel[{knee}] of joint 'left_knee'")]);
        data.qvel_mut()[knee] = 0.0;
        data.step().unwrap();
    }
}

#[test]
fn divergence_in_a_step_is_an_error_until_a_reset() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    for _ in 0..10 {
        data.step().unwrap();
    }
    let time = data.time();
    data.qfrc_applied_mut()[7] = 1e300;
    let text = text_of(data.step(), &["the simulation is unstable", "qacc[", "of joint", "smaller timestep"]);
    assert!(text.contains(&format!("at time {time} s")), "the time of the step, not of the reset: {text}");
    text_of(data.step(), &["unusable since", "qacc[", "reset it first"]);
    data.reset().unwrap();
    data.step().unwrap();

    data.xfrc_applied_mut()[1] = [f64::NAN; 6];
    assert!(matches!(data.step(), Err(Error::Unstable(found)) if found.field == UnstableField::Acceleration));
    data.reset().unwrap();
    assert_eq!(data.xfrc_applied()[1], [0.0; 6], "a reset clears applied forces");
    data.step().unwrap();
}

#[test]
fn a_stack_overflow_poisons_the_simulation_until_a_reset() {
    // The compiler takes a step, too.
    text_of(trouble::with_stack(10), &["cannot load the given XML", STACK_OVERFLOW]);
    let mut data = Data::new(trouble::overflowing()).unwrap();
    let error = overflow(&mut data);
    let Error::Engine { function: "mj_step", message } = &error else { panic!("{error}") };
    assert!(message.contains(STACK_OVERFLOW), "{message}");
    assert_eq!(error.to_string(), format!("the engine failed in mj_step: {message}"));

    let body = data.model().body(1).unwrap().id();
    let nv = data.model().nv();
    let (mut result, vector) = (vec![0.0; nv], vec![0.0; nv]);
    let rejected: [Result<()>; 14] = [
        data.step(),
        data.step1(),
        data.step2(),
        data.forward(),
        data.inverse(),
        data.transition_fd(1e-6, Differences::Forward).map(drop),
        data.jac_body(body).map(drop),
        data.jac_body_com(body).map(drop),
        data.jac([0.0; 3], body).map(drop),
        data.jac_subtree_com(body).map(drop),
        data.full_m().map(drop),
        data.mul_m_into(&vector, &mut result),
        data.solve_m_into(&vector, &mut result),
        data.clone().step(),
    ];
    for result in rejected {
        assert!(matches!(result, Err(Error::Poisoned { .. })));
        text_of(result, &[&format!("unusable since {error}"), "reset it first"]);
    }
    assert!(data.contacts().all(|contact| matches!(contact.force(), Err(Error::Poisoned { .. }))));
    let mut copy = Data::new(data.model().clone()).unwrap();
    copy.copy_from(&data).unwrap();
    assert!(matches!(copy.step(), Err(Error::Poisoned { .. })));
    assert!(format!("{data:?}").contains("unusable since"));

    // The engine's stack is restored after every overflow.
    for _ in 0..20 {
        data.reset().unwrap();
        data.step().unwrap();
        assert!(matches!(overflow(&mut data), Error::Engine { .. }));
    }
    copy.reset().unwrap();
    data.copy_from(&copy).unwrap();
    data.step().unwrap();
}

#[test]
fn results_that_are_not_computed_are_errors() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let body = data.model().body("torso").unwrap().id();
    let needs = ["position-dependent quantities", "call forward or step first"];
    let parts = ["the results of kinematics, com_pos", "call these first, in this order, or forward"];
    text_of(data.jac_body(body), &["jac_body needs", parts[0], parts[1]]);
    text_of(data.jac_subtree_com(body), &["jac_subtree_com needs", parts[0]]);
    text_of(data.full_m(), &["full_m needs", needs[0], needs[1]]);
    let nv = data.model().nv();
    text_of(data.mul_m_into(&vec![0.0; nv], &mut vec![0.0; nv]), &["mul_m_into needs", needs[0]]);
    text_of(data.solve_m_into(&vec![0.0; nv], &mut vec![0.0; nv]), &["solve_m_into needs", needs[0]]);
    text_of(data.step2(), &["step2 needs velocity-dependent quantities", "call step1 first"]);

    data.step().unwrap();
    data.step1().unwrap();
    assert_eq!(data.stage(), Stage::Velocity);
    assert!(data.contacts().len() > 0);
    for contact in data.contacts() {
        text_of(contact.force(), &["contact force needs forces and accelerations", "call forward or step first"]);
        text_of(contact.force_in_world(), &["contact force needs"]);
    }
    data.step2().unwrap();
    assert!(data.contacts().all(|contact| contact.force().is_ok()));
    data.edit_model(|model| model.edit_options(|options| options.cone = mujoco_safe::enums::Cone::Elliptic)).unwrap();
    assert!(data.contacts().all(|contact| contact.force().is_err()));
}

/// Returns a model whose first step is an engine error, and the beginning of the engine's message.
fn rejected_in_a_step() -> (Model, &'static str) {
    if cfg!(engine_since = "3.5.0") {
        // The comparison with inverse dynamics needs a contact.
        let mut model = trouble::crowded();
        let changed = model.edit().edit_options(|options| {
            options.integrator = Integrator::Rk4;
            options.enable |= EnableFlags::FWDINV | EnableFlags::INVDISCRETE;
        });
        changed.unwrap();
        return (model, "mj_discreteAcc: discrete inverse dynamics is not supported by RK4 integrator");
    }
    // Bodies without mass, whose inertia matrix the implicit integrator cannot factorise. Newer
    // engines only warn.
    let mut model = sample::cartpole();
    let mut edit = model.edit();
    edit.edit_options(|options| options.integrator = Integrator::Implicit).unwrap();
    edit.body_mass_mut().fill(0.0);
    edit.body_inertia_mut().as_flattened_mut().fill(0.0);
    edit.dof_armature_mut().fill(0.0);
    edit.dof_damping_mut().fill(0.0);
    (model, "diagonal element too small")
}

#[test]
fn concurrent_errors_keep_their_own_messages() {
    const ROUNDS: usize = 1000;
    let stack = Arc::new(trouble::overflowing());
    let (rejected, message) = rejected_in_a_step();
    let rejected = Arc::new(rejected);

    // A panic between the barriers would block the other threads, so mismatches are reported at the
    // end.
    let barrier = Barrier::new(3);
    let rounds = |wanted: &(dyn Fn(usize) -> String + Sync), mut fail: Box<dyn FnMut(usize) -> String + '_>| {
        let mut wrong = Vec::new();
        for round in 0..ROUNDS {
            barrier.wait();
            let text = fail(round);
            if !text.contains(&wanted(round)) {
                wrong.push(text);
            }
        }
        wrong
    };
    let failing = |model: &Arc<Model>, steps: usize| {
        let mut data = Data::new(model.clone()).unwrap();
        move |_: usize| {
            data.reset().unwrap();
            (0..steps).find_map(|_| data.step().err()).map_or("no error".to_owned(), |error| error.to_string())
        }
    };
    let (stack, rejected) = (failing(&stack, 200), failing(&rejected, 1));
    let load = |round| {
        let result = Model::from_xml_str(&format!("<mujoco><e{round}/></mujoco>"));
        result.map_or_else(|error| error.to_string(), |_| "no error".to_owned())
    };
    let wrong: Vec<String> = std::thread::scope(|scope| {
        [
            scope.spawn(|| rounds(&|_| STACK_OVERFLOW.to_owned(), Box::new(stack))),
            scope.spawn(|| rounds(&|_| format!("the engine failed in mj_step: {message}"), Box::new(rejected))),
            scope.spawn(|| rounds(&|round| format!("'e{round}'"), Box::new(load))),
        ]
        .into_iter()
        .flat_map(|thread| thread.join().unwrap())
        .collect()
    });
    assert_eq!(wrong.first(), None, "{} messages are wrong", wrong.len());
}
