//! Callbacks: their effect on a step, and their scope.

#![forbid(unsafe_code)]

use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_safe::callback::Callbacks;
use mujoco_safe::data::UnstableField;
use mujoco_safe::enums::Integrator;
use mujoco_safe::{Data, Differences, Error, Model, Stage, StateSpec, sample};

/// A sliding mass with a motor and a user actuator of each kind.
const SLIDER: &str = r#"<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="mass"><joint name="slide" type="slide" axis="1 0 0" damping="0"/><geom size=".1" mass="1" contype="0"/></body>
  </worldbody>
  <actuator>
    <motor name="motor" joint="slide"/>
    <general name="gain" joint="slide" gaintype="user"/>
    <general name="bias" joint="slide" biastype="user" gainprm="0"/>
    <general name="dynamics" joint="slide" dyntype="user"/>
  </actuator>
  <sensor>
    <user name="position" objtype="body" objname="mass" datatype="real" dim="2" needstage="pos"/>
    <user name="velocity" objtype="body" objname="mass" datatype="real" dim="1" needstage="vel"/>
    <user name="acceleration" objtype="body" objname="mass" datatype="real" dim="1" needstage="acc"/>
  </sensor>
</mujoco>"#;

fn slider() -> Data {
    Data::new(Model::from_xml_str(SLIDER).unwrap()).unwrap()
}

/// Asserts that 300 steps of a cart-pole with a control callback, which `step` performs, equal
/// those with the same control law between the halves of each step, bit for bit.
pub(super) fn assert_equals_controller(step: impl FnOnce(&mut Data, Callbacks<'static>, usize)) {
    let push = |data: &Data| 30.0 * data.qpos()[1] + 5.0 * data.qvel()[1];
    let mut with_callback = Data::new(sample::cartpole()).unwrap();
    with_callback.qpos_mut()[1] = 0.2;
    let mut by_hand = with_callback.clone();
    let callbacks = Callbacks::new().with_control(move |context| context.ctrl_mut()[0] = push(context));
    step(&mut with_callback, callbacks, 300);
    for _ in 0..300 {
        by_hand.step1().unwrap();
        by_hand.ctrl_mut()[0] = push(&by_hand);
        by_hand.step2().unwrap();
    }
    assert_eq!(with_callback.physics_state(), by_hand.physics_state());
    assert!(with_callback.ctrl()[0] != 0.0);
}

#[test]
fn a_control_callback_equals_a_controller_bit_for_bit() {
    assert_equals_controller(|data, callbacks, steps| {
        data.with_callbacks(callbacks, |data| data.step_n(steps)).unwrap();
    });
}

#[test]
fn runge_kutta_calls_the_control_callback_four_times_per_step() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Rk4)).unwrap();
    let mut calls = 0;
    data.with_callbacks(Callbacks::new().with_control(|_| calls += 1), |data| data.step()).unwrap();
    assert_eq!(calls, 4);
}

#[test]
fn forces_applied_in_a_control_callback_act_in_the_same_step() {
    let mut data = slider();
    let callbacks = Callbacks::new().with_control(|context| {
        context.qfrc_applied_mut()[0] = 2.0;
        context.xfrc_applied_mut()[1][0] = 3.0;
    });
    data.with_callbacks(callbacks, |data| data.forward()).unwrap();
    assert!((data.qacc()[0] - 5.0).abs() < 1e-12);
}

#[test]
fn passive_forces_are_added_to_the_engines_forces() {
    let mut data = slider();
    data.edit_model(|model| model.dof_damping_mut()[0] = 4.0).unwrap();
    data.qvel_mut()[0] = 1.0;
    let callbacks = Callbacks::new().with_passive(|context| context.qfrc_passive_mut()[0] += 1.0);
    data.with_callbacks(callbacks, |data| data.forward()).unwrap();
    assert_eq!(data.qfrc_passive(), [-3.0]);
}

#[test]
fn user_actuators_use_the_gain_bias_and_dynamics_callbacks() {
    let mut data = slider();
    let gain = data.model().actuator("gain").unwrap().id();
    let bias = data.model().actuator("bias").unwrap().id();
    let dynamics = data.model().actuator("dynamics").unwrap().id();
    data.ctrl_mut().copy_from_slice(&[0.0, 2.0, 0.0, 0.5]);
    data.qpos_mut()[0] = 3.0;
    let callbacks = Callbacks::new()
        .with_actuator_gain(|data, actuator| {
            assert_eq!(actuator, gain);
            7.0 * data.actuator(actuator).length()
        })
        .with_actuator_bias(|_, actuator| {
            assert_eq!(actuator, bias);
            -1.0
        })
        .with_actuator_dynamics(|data, actuator| {
            assert_eq!(actuator, dynamics);
            10.0 * data.actuator(actuator).ctrl()
        });
    data.with_callbacks(callbacks, |data| data.step()).unwrap();
    assert_eq!(data.actuator(gain).force(), 7.0 * 3.0 * 2.0);
    assert_eq!(data.actuator(bias).force(), -1.0);
    assert_eq!(data.act(), [10.0 * 0.5 * data.model().timestep()]);
    // Without callbacks, the engine's own values apply.
    data.reset().unwrap();
    data.ctrl_mut().fill(1.0);
    data.step().unwrap();
    assert_eq!((data.actuator(gain).force(), data.actuator(bias).force(), data.act()[0]), (1.0, 0.0, 0.0));
}

#[test]
fn user_sensors_are_written_at_their_stage() {
    let mut data = slider();
    data.ctrl_mut()[0] = 2.0;
    data.qvel_mut()[0] = 0.5;
    let mut stages = Vec::new();
    let callbacks = Callbacks::new().with_sensor(|context| {
        stages.push(context.stage());
        match context.stage() {
            Stage::Position => context.data_mut("position").unwrap().copy_from_slice(&[1.0, 2.0]),
            Stage::Velocity => context.data_mut("velocity").unwrap()[0] = 3.0,
            _ => {
                let acceleration = context.qacc()[0];
                context.data_mut("acceleration").unwrap()[0] = acceleration;
            }
        }
        assert!(context.data_mut("no such sensor").is_err());
    });
    data.with_callbacks(callbacks, |data| data.forward()).unwrap();
    assert_eq!(stages, [Stage::Position, Stage::Velocity, Stage::Acceleration]);
    assert_eq!(data.sensordata(), [1.0, 2.0, 3.0, 2.0]);
}

#[test]
fn a_contact_filter_replaces_the_engines_rule() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    data.forward().unwrap();
    let by_rule = data.ncon();
    assert!(by_rule > 0);
    data.with_callbacks(Callbacks::new().with_contact_filter(|_, _, _| false), |data| data.forward()).unwrap();
    assert_eq!(data.ncon(), 0);
    data.with_callbacks(Callbacks::new().with_contact_filter(|_, _, _| true), |data| data.forward()).unwrap();
    if cfg!(engine_since = "3.0.0") {
        // The engine does not pass geoms of one body to the filter.
        assert!(data.ncon() >= by_rule, "{} contacts", data.ncon());
    } else {
        assert!(data.ncon() > 10, "geoms of one body collide: {}", data.ncon());
    }
}

#[test]
fn a_panic_in_a_callback_is_an_error_of_the_call() {
    let callbacks = || -> [(&str, Callbacks<'static>); 7] {
        [
            ("control", Callbacks::new().with_control(|_| panic!("no control"))),
            ("passive", Callbacks::new().with_passive(|_| panic!("no passive"))),
            ("sensor", Callbacks::new().with_sensor(|_| panic!("no sensor"))),
            ("contact_filter", Callbacks::new().with_contact_filter(|_, _, _| panic!("no contact_filter"))),
            ("actuator_gain", Callbacks::new().with_actuator_gain(|_, _| panic!("no actuator_gain"))),
            ("actuator_bias", Callbacks::new().with_actuator_bias(|_, _| panic!("no {}", "actuator_bias"))),
            ("actuator_dynamics", Callbacks::new().with_actuator_dynamics(|_, _| panic!("no actuator_dynamics"))),
        ]
    };
    for (name, callbacks) in callbacks() {
        let text = SLIDER
            .replace("</worldbody>", r#"<body><geom size=".1"/></body><geom size=".1"/></worldbody>"#)
            .replace(r#"contype="0"/></body>"#, "/></body>");
        let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
        let result = data.with_callbacks(callbacks, |data| {
            let result = data.step();
            assert!(matches!(data.step(), Err(Error::Poisoned { .. })), "{name}");
            result
        });
        match result {
            Err(Error::Callback { callback, message }) => {
                assert_eq!((callback, message), (name, format!("no {name}")));
            }
            other => panic!("{name}: {other:?}"),
        }
        // The panic has no lasting effect.
        data.reset().unwrap();
        data.step().unwrap();
    }
}

#[test]
fn a_nan_control_from_a_callback_is_an_error() {
    let mut data = slider();
    let callbacks = Callbacks::new().with_control(|context| context.ctrl_mut()[1] = f64::NAN);
    match data.with_callbacks(callbacks, |data| data.step()) {
        Err(Error::Unstable(instability)) => {
            assert_eq!((instability.field, instability.index), (UnstableField::Control, 1));
            assert_eq!(instability.name.as_deref(), Some("gain"));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn nan_forces_from_a_callback_are_an_error() {
    let mut data = slider();
    let callbacks = Callbacks::new().with_passive(|context| context.qfrc_passive_mut()[0] = f64::NAN);
    assert!(matches!(data.with_callbacks(callbacks, |data| data.step()), Err(Error::Unstable(_))));
}

#[test]
fn results_not_yet_computed_are_rejected_inside_a_callback() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    data.step().unwrap(); // computes everything, for an earlier state
    let foot = data.model().body("foot_left").unwrap().id();
    let (mut filtered, mut controlled) = (0, 0);
    let callbacks = Callbacks::new()
        .with_contact_filter(|data, _, collide| {
            filtered += 1;
            assert!(matches!(data.full_m(), Err(Error::NotComputed { .. })));
            collide
        })
        .with_control(|context| {
            controlled += 1;
            assert!(context.jac_body_com(foot).is_ok());
            assert!(context.full_m().is_ok());
            let contact = context.contacts().next().unwrap();
            assert!(matches!(contact.force(), Err(Error::NotComputed { .. })));
        });
    data.with_callbacks(callbacks, |data| data.step()).unwrap();
    assert!(filtered > 0 && controlled == 1);
    assert!(data.contacts().next().unwrap().force().is_ok());
}

#[test]
fn other_simulations_do_not_call_the_callbacks() {
    let calls = AtomicUsize::new(0);
    let count = || {
        calls.fetch_add(1, Ordering::Relaxed);
    };
    let mut data = slider();
    let mut other = data.clone();
    let callbacks = Callbacks::new().with_control(|context| {
        count();
        // Inside the callback: another simulation, a clone of this one, and a model that the engine
        // simulates while compiling.
        other.step().unwrap();
        assert!(Model::from_xml_str(SLIDER).is_ok());
        assert_eq!(context.stage(), Stage::Velocity);
    });
    data.with_callbacks(callbacks, |data| {
        data.step().unwrap();
        data.clone().step().unwrap_or_else(|error| panic!("{error}"));
        std::thread::scope(|scope| {
            scope.spawn(|| slider().step().unwrap());
        });
    });
    assert_eq!(calls.load(Ordering::Relaxed), 1);
    // After the scope, this simulation has no callbacks either.
    data.step().unwrap();
    assert_eq!(calls.load(Ordering::Relaxed), 1);
}

#[test]
fn callbacks_move_with_the_simulation_to_another_thread() {
    let mut data = slider();
    let mut threads = Vec::new();
    let callbacks = Callbacks::new().with_control(|_| threads.push(std::thread::current().id()));
    data.with_callbacks(callbacks, |data| {
        std::thread::scope(|scope| scope.spawn(|| data.step()).join().unwrap()).unwrap();
    });
    assert!(threads.len() == 1 && threads[0] != std::thread::current().id());
}

#[test]
fn a_simulation_swapped_out_of_the_scope_loses_its_callbacks() {
    let calls = AtomicUsize::new(0);
    let (mut data, mut other) = (slider(), slider());
    let callbacks = Callbacks::new().with_control(|_| {
        calls.fetch_add(1, Ordering::Relaxed);
    });
    data.with_callbacks(callbacks, |data| std::mem::swap(data, &mut other));
    data.step().unwrap();
    other.step().unwrap();
    assert_eq!(calls.load(Ordering::Relaxed), 0);
}

#[test]
fn a_panic_in_the_scope_removes_the_callbacks() {
    let calls = AtomicUsize::new(0);
    let mut data = slider();
    let callbacks = Callbacks::new().with_control(|_| {
        calls.fetch_add(1, Ordering::Relaxed);
    });
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        data.with_callbacks(callbacks, |_| panic!("out of the scope"));
    }));
    assert!(caught.is_err());
    data.step().unwrap();
    assert_eq!(calls.load(Ordering::Relaxed), 0);
}

#[test]
fn a_nested_scope_has_its_own_callbacks() {
    let (outer, inner) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let mut data = slider();
    data.with_callbacks(Callbacks::new().with_control(|_| _ = outer.fetch_add(1, Ordering::Relaxed)), |data| {
        data.with_callbacks(Callbacks::new().with_control(|_| _ = inner.fetch_add(1, Ordering::Relaxed)), |data| {
            data.step()
        })
        .unwrap();
        data.step().unwrap();
    });
    assert_eq!((outer.into_inner(), inner.into_inner()), (1, 1));
}

/// Returns the number of calls to a scope's closure in a step at its end, after running `within` in
/// the scope.
fn calls_after(within: impl FnOnce(&mut Data)) -> usize {
    let calls = AtomicUsize::new(0);
    let callbacks = Callbacks::new().with_control(|_| _ = calls.fetch_add(1, Ordering::Relaxed));
    slider().with_callbacks(callbacks, |data| {
        within(data);
        data.step().unwrap();
    });
    calls.into_inner()
}

#[test]
fn a_panic_in_a_nested_scope_keeps_the_outer_callbacks() {
    let calls = calls_after(|data| {
        // A chain of this many ended scopes would be too long to drop recursively.
        for _ in 0..200_000 {
            let inner = std::panic::AssertUnwindSafe(|| {
                data.with_callbacks(Callbacks::new(), |_| std::panic::resume_unwind(Box::new("out of the scope")));
            });
            assert!(std::panic::catch_unwind(inner).is_err());
        }
    });
    assert_eq!(calls, 1);
}

#[test]
fn a_simulation_swapped_out_of_a_nested_scope_has_the_outer_callbacks() {
    let calls = calls_after(|data| {
        let mut other = slider();
        data.with_callbacks(Callbacks::new(), |data| std::mem::swap(data, &mut other));
        std::mem::swap(data, &mut other);
    });
    assert_eq!(calls, 1);
}

#[test]
fn a_linearisation_includes_a_feedback_callback() {
    // x'' = −k x by a control callback: A[v, x] = −h k.
    let mut data = slider();
    let stiffness = 40.0;
    let callbacks = Callbacks::new().with_control(|context| context.ctrl_mut()[0] = -stiffness * context.qpos()[0]);
    let system = data.with_callbacks(callbacks, |data| data.transition_fd(1e-6, Differences::Central)).unwrap();
    assert!((system.a[(1, 0)] + data.model().timestep() * stiffness).abs() < 1e-8, "{}", system.a[(1, 0)]);
}

#[test]
fn a_linearisation_restores_the_controls_that_a_callback_wrote() {
    let mut data = slider();
    data.ctrl_mut()[0] = 0.25;
    let callbacks = Callbacks::new().with_control(|context| context.ctrl_mut()[0] = -40.0 * context.qpos()[0]);
    data.with_callbacks(callbacks, |data| data.transition_fd(1e-6, Differences::Central)).unwrap();
    assert_eq!(data.ctrl()[0], 0.25);
}

#[test]
fn a_simulation_can_be_cloned_in_every_callback() {
    fn check(data: &Data) {
        let mut clone = data.try_clone().unwrap();
        assert_eq!(
            (clone.state(StateSpec::INTEGRATION), clone.stage()),
            (data.state(StateSpec::INTEGRATION), data.stage())
        );
        clone.step().unwrap();
        clone.copy_from(data).unwrap();
        clone.step().unwrap();
    }
    let calls: [AtomicUsize; 7] = std::array::from_fn(|_| AtomicUsize::new(0));
    let called = |index: usize, data: &Data| {
        check(data);
        calls[index].fetch_add(1, Ordering::Relaxed);
    };
    let callbacks = Callbacks::new()
        .with_control(|context| called(0, context))
        .with_passive(|context| called(1, context))
        .with_sensor(|context| called(2, context))
        .with_contact_filter(|data, _, collides| {
            called(3, data);
            collides
        })
        .with_actuator_dynamics(|data, _| {
            called(4, data);
            0.0
        })
        .with_actuator_gain(|data, _| {
            called(5, data);
            1.0
        })
        .with_actuator_bias(|data, _| {
            called(6, data);
            0.0
        });
    let mut data = Data::new(Model::from_xml_str(&SLIDER.replace("<worldbody>", FLOOR)).unwrap()).unwrap();
    data.with_callbacks(callbacks, |data| data.step()).unwrap();
    assert!(calls.iter().all(|calls| calls.load(Ordering::Relaxed) > 0), "{calls:?}");
}

const FLOOR: &str = r#"<worldbody><geom type="plane" size="1 1 1"/>"#;
