//! Sleeping bodies. The independent sources are the C functions of the same engine, and simulations
//! in which no body has slept.

use std::sync::Arc;

use mujoco_safe::derivative::{InverseForce, TransitionOptions};
use mujoco_safe::enums::Integrator;
use mujoco_safe::{Batch, Data, Differences, Error, Lineariser, Model, StateSpec, sys};

use super::Raw;

/// Boxes and a ball that come to rest on a floor, and an arm, which never sleeps because it has a
/// motor.
const MODEL: &str = r#"<mujoco>
  <option sleep_tolerance=".01"><flag sleep="enable"/></option>
  <worldbody>
    <geom type="plane" size="5 5 .1"/>
    <body name="shelf" pos="2 0 1"><geom name="board" type="box" size=".2 .2 .02"/></body>
    <body name="low" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body name="high" pos="0 0 .3"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body name="far" pos="2 2 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body name="ball" pos="-2 0 .1"><freejoint name="ball"/><geom size=".1" condim="6" friction="1 .01 .01"/></body>
    <body name="hand" mocap="true" pos="2 2 2"><geom type="box" size=".1 .1 .1"/></body>
    <body name="arm" pos="0 3 1"><joint name="elbow" axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 .5 0 0"/></body>
  </worldbody>
  <actuator><motor joint="elbow"/></actuator>
</mujoco>"#;

const SLEEPERS: [&str; 4] = ["low", "high", "far", "ball"];

fn model() -> Arc<Model> {
    Arc::new(Model::from_xml_str(MODEL).unwrap())
}

fn asleep(data: &Data, body: &str) -> bool {
    data.body(body).unwrap().is_asleep()
}

fn count_asleep(data: &Data) -> usize {
    SLEEPERS.iter().filter(|body| asleep(data, body)).count()
}

/// Returns a simulation in which all bodies that can sleep do so.
fn sleeping() -> Data {
    let mut data = Data::new(model()).unwrap();
    for _ in 0..3000 {
        data.step().unwrap();
        if count_asleep(&data) == SLEEPERS.len() {
            assert!(!asleep(&data, "arm") && !asleep(&data, "shelf"));
            return data;
        }
    }
    panic!("only {} bodies sleep", count_asleep(&data));
}

/// Returns a simulation in the state of another one in which no body has slept.
fn awake_in_the_state_of(data: &Data) -> Data {
    let mut awake = Data::new(data.model().clone()).unwrap();
    awake.set_state(StateSpec::INTEGRATION, &data.state(StateSpec::INTEGRATION)).unwrap();
    awake.qacc_mut().copy_from_slice(data.qacc());
    awake
}

#[test]
fn a_trajectory_with_sleeping_bodies_equals_that_of_the_c_functions_bit_for_bit() {
    for integrator in [Integrator::Euler, Integrator::Implicit, Integrator::ImplicitFast] {
        let mut model = Model::from_xml_str(MODEL).unwrap();
        model.edit().edit_options(|options| options.integrator = integrator).unwrap();
        let mut data = Data::new(model).unwrap();
        let model = data.model().clone();
        let raw = Raw(c!(mj_makeData(model.as_ptr())));
        let force = 6 * model.body("far").unwrap().id().index() + 2;
        let height = model.joint("ball").unwrap().qpos_range().start;
        let (mut most, mut changes) = (0, 0);
        for step in 0..2000 {
            let push = if (1000..1020).contains(&step) { 1.0 } else { 0.0 };
            data.xfrc_applied_mut().as_flattened_mut()[force] = push;
            data.ctrl_mut()[0] = f64::sin(0.01 * f64::from(step));
            // SAFETY: the arrays have nbody rows of 6, nu and nq numbers, and nothing else uses the
            // data.
            unsafe {
                *(*raw.0).xfrc_applied.add(force) = push;
                *(*raw.0).ctrl = data.ctrl()[0];
                if step == 1200 {
                    // Above the boxes, so that the ball wakes them when it arrives.
                    for (index, value) in [(height, 0.02), (height + 2, 1.5)] {
                        data.qpos_mut()[index] = value;
                        *(*raw.0).qpos.add(index) = value;
                    }
                }
            }
            let before = count_asleep(&data);
            data.step().unwrap();
            c!(mj_step(model.as_ptr(), raw.0));
            // SAFETY: the arrays have nq and nv numbers.
            let (qpos, qvel) = unsafe {
                (
                    std::slice::from_raw_parts((*raw.0).qpos, model.nq()),
                    std::slice::from_raw_parts((*raw.0).qvel, model.nv()),
                )
            };
            assert_eq!((data.qpos(), data.qvel()), (qpos, qvel), "{integrator:?}, step {step}");
            for body in SLEEPERS {
                let tree = model.body_treeid()[model.body(body).unwrap().id().index()];
                // SAFETY: a tree of the model.
                let expected = unsafe { *(*raw.0).tree_asleep.add(usize::try_from(tree).unwrap()) >= 0 };
                assert_eq!(asleep(&data, body), expected, "{integrator:?}, step {step}, {body}");
            }
            most = most.max(count_asleep(&data));
            changes += usize::from(before != count_asleep(&data));
        }
        assert!(most == SLEEPERS.len() && changes > 4, "{integrator:?}: {most} {changes}");
    }
}

#[test]
fn a_contact_a_force_and_a_written_position_wake_a_body() {
    let mut data = sleeping();
    data.body_mut("far").unwrap().xfrc_applied_mut()[2] = 0.1;
    data.step().unwrap();
    assert_eq!(SLEEPERS.map(|body| asleep(&data, body)), [true, true, false, true]);

    let mut data = sleeping();
    let low = data.body("low").unwrap().xpos().to_owned();
    data.joint_mut("ball").unwrap().qpos_mut()[..3].copy_from_slice(&[low[0], low[1], low[2] + 0.6]);
    data.step().unwrap();
    assert_eq!(SLEEPERS.map(|body| asleep(&data, body)), [true, true, true, false]);
    let mut woken = false;
    for _ in 0..300 {
        data.step().unwrap();
        woken |= !asleep(&data, "low") && !asleep(&data, "high");
        assert!(asleep(&data, "far"));
    }
    assert!(woken);
}

// With 3.5.0 the body continues to sleep, as in C.
#[cfg(engine_since = "3.17.0")]
#[test]
fn a_mocap_body_wakes_a_body_that_it_touches() {
    let mut data = sleeping();
    let far = *data.body("far").unwrap().xpos();
    *data.body_mut("hand").unwrap().mocap_pos_mut().unwrap() = [far[0] + 0.15, far[1], far[2] + 0.05];
    for _ in 0..100 {
        data.step().unwrap();
    }
    let moved = data.body("far").unwrap().xpos()[0] - far[0];
    assert!(moved < -0.01, "moved by {moved}");
}

#[test]
fn a_simulation_that_is_set_to_a_state_is_awake_and_continues_bit_for_bit() {
    let mut data = sleeping();
    let mut other = awake_in_the_state_of(&data);
    data.set_state(StateSpec::CTRL, &[0.3]).unwrap();
    other.set_state(StateSpec::CTRL, &[0.3]).unwrap();
    assert_eq!(count_asleep(&data), SLEEPERS.len());
    data.set_state(StateSpec::INTEGRATION, &other.state(StateSpec::INTEGRATION)).unwrap();
    assert_eq!(count_asleep(&data), 0);
    let mut most = 0;
    for step in 0..1000 {
        data.step().unwrap();
        other.step().unwrap();
        assert_eq!(data.state(StateSpec::INTEGRATION), other.state(StateSpec::INTEGRATION), "step {step}");
        assert_eq!(count_asleep(&data), count_asleep(&other));
        most = most.max(count_asleep(&data));
    }
    assert_eq!(most, SLEEPERS.len());
}

#[test]
fn copies_of_a_simulation_keep_the_sleeping_bodies() {
    let mut data = sleeping();
    let mut clone = data.clone();
    let mut copy = Data::new(data.model().clone()).unwrap();
    copy.copy_from(&data).unwrap();
    let mut assigned = Data::new(data.model().as_ref().clone()).unwrap();
    assigned.clone_from(&data);
    for other in [&mut clone, &mut copy, &mut assigned] {
        assert_eq!(count_asleep(other), SLEEPERS.len());
        other.joint_mut("ball").unwrap().qpos_mut()[2] += 0.3;
    }
    data.joint_mut("ball").unwrap().qpos_mut()[2] += 0.3;
    for step in 0..300 {
        data.step().unwrap();
        for other in [&mut clone, &mut copy, &mut assigned] {
            other.step().unwrap();
            assert_eq!(data.state(StateSpec::INTEGRATION), other.state(StateSpec::INTEGRATION), "step {step}");
            assert_eq!(count_asleep(&data), count_asleep(other), "step {step}");
        }
    }
}

#[test]
fn a_change_of_the_model_wakes_all_bodies_and_moves_static_ones() {
    let raise = |data: &mut Data| {
        data.edit_model(|model| {
            model.body_mut("shelf")?.pos_mut()[2] = 0.5;
            Ok(())
        })
        .unwrap();
    };
    let mut data = sleeping();
    raise(&mut data);
    assert_eq!(count_asleep(&data), 0);
    let unchanged = sleeping();
    let mut copied = Data::new(unchanged.model().clone()).unwrap();
    raise(&mut copied);
    copied.copy_from(&unchanged).unwrap();
    assert_eq!(count_asleep(&copied), 0);
    for changed in [&mut data, &mut copied] {
        let mut fresh = awake_in_the_state_of(changed);
        changed.forward().unwrap();
        fresh.forward().unwrap();
        assert_eq!(changed.geom("board").unwrap().xpos()[2], 0.5);
        assert_eq!(changed.geom_xpos(), fresh.geom_xpos());
        assert_eq!(changed.qacc(), fresh.qacc());
    }
    // No result depends on a keyframe.
    let model = MODEL.replace("<actuator>", r#"<keyframe><key name="rest"/></keyframe><actuator>"#);
    let mut edited = Data::new(Model::from_xml_str(&model).unwrap()).unwrap();
    while count_asleep(&edited) < SLEEPERS.len() {
        edited.step().unwrap();
    }
    edited.set_keyframe("rest").unwrap();
    assert_eq!(count_asleep(&edited), SLEEPERS.len());
    edited.reset_to_key("rest").unwrap();
    assert_eq!(count_asleep(&edited), 0);
}

#[test]
fn inverse_dynamics_and_single_parts_wake_all_bodies() {
    let touching = || {
        let mut data = sleeping();
        let far = *data.body("far").unwrap().xpos();
        data.joint_mut("ball").unwrap().qpos_mut()[..3].copy_from_slice(&[far[0] + 0.19, far[1], 0.1]);
        data
    };
    let mut data = touching();
    let mut awake = awake_in_the_state_of(&data);
    data.inverse().unwrap();
    awake.inverse().unwrap();
    assert_eq!(count_asleep(&data), 0);
    assert_eq!(data.qfrc_inverse(), awake.qfrc_inverse());

    let mut data = touching();
    data.inv_position().unwrap();
    assert_eq!((count_asleep(&data), data.ncon()), (0, awake.ncon()));

    let mut data = touching();
    for part in [Data::kinematics, Data::com_pos, Data::compute_tendon, Data::collision, Data::make_constraint] {
        part(&mut data).unwrap();
    }
    assert_eq!((count_asleep(&data), data.ncon(), data.nefc()), (0, awake.ncon(), awake.nefc()));

    let mut data = sleeping();
    data.forward().unwrap();
    assert_eq!(count_asleep(&data), SLEEPERS.len());
    data.collision().unwrap();
    assert!(matches!(data.make_constraint(), Err(Error::NotComputed { .. })));
    data.step().unwrap();
}

#[test]
fn linearisations_and_batches_of_a_model_with_sleep_are_unsupported() {
    let unsupported = |error: Error| {
        assert!(matches!(&error, Error::Unsupported(text) if text.contains("sleep")), "{error}");
    };
    let mut data = sleeping();
    unsupported(data.transition_fd(1e-6, Differences::Central).unwrap_err());
    unsupported(data.inverse_fd(1e-6, InverseForce::Total).unwrap_err());
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    unsupported(lineariser.linear_system(&mut data).unwrap_err());
    unsupported(Batch::new(data.model().clone(), 2).err().unwrap());
    data.step().unwrap();
}

#[test]
fn a_body_that_sleeps_initially_is_rejected() {
    let xml = MODEL.replace(r#"<body name="far""#, r#"<body name="far" sleep="init""#);
    let error = Model::from_xml_str(&xml).unwrap_err().to_string();
    assert!(error.contains("'far' sleeps initially"), "{error}");
}

#[test]
fn trees_that_an_edited_tendon_couples_stay_awake() {
    let text = |stiffness: &str, damping: &str| {
        let tendon = format!(
            r#"<tendon><spatial stiffness="{stiffness}" damping="{damping}"><site site="one"/><site site="two"/></spatial></tendon>"#
        );
        let site = |text: &str, body: &str, name: &str| {
            let box_of_body = format!(r#"<body name="{body}""#);
            let (head, rest) = text.split_once(&box_of_body).unwrap();
            let (start, rest) = rest.split_once("<freejoint/>").unwrap();
            format!(r#"{head}{box_of_body}{start}<freejoint/><site name="{name}"/>{rest}"#)
        };
        site(&site(MODEL, "low", "one"), "far", "two").replace("<actuator>", &format!("{tendon}<actuator>"))
    };
    let compiled = |stiffness: &str, damping: &str| Model::from_xml_str(&text(stiffness, damping)).unwrap();
    for (stiffness, damping) in [(3.0, 0.0), (0.0, 2.0)] {
        let mut edited = compiled("0", "0");
        edited.edit().tendon_stiffness_mut()[0] = stiffness;
        edited.edit().tendon_damping_mut()[0] = damping;
        edited.edit().update_constants().unwrap();
        let expected = compiled(&stiffness.to_string(), &damping.to_string());
        assert_ne!(expected.tree_sleep_policy(), compiled("0", "0").tree_sleep_policy());
        assert_eq!(edited.tree_sleep_policy(), expected.tree_sleep_policy());
    }
}
