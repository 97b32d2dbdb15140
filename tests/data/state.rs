//! States and positions as vectors, and models without joints, actuators or sensors.
//!
//! Properties that hold for all inputs are tested on random ones.

use mujoco_safe::derivative::TransitionOutputs;
use mujoco_safe::{Data, Differences, Error, StateSpace, StateSpec};
use proptest::prelude::*;

use crate::arbitrary::{BALL, ROCK, ZOO, any_model, any_number, bits};

#[test]
fn without_actuators_b_and_d_have_rows_and_no_columns() {
    let mut data = Data::new(BALL.clone()).unwrap();
    let StateSpace { a, b, c, d } = data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!([a.shape(), b.shape(), c.shape(), d.shape()], [(12, 12), (12, 0), (0, 12), (0, 0)]);
    // The velocity of a free body is constant, and changes its position in proportion to the time
    // step.
    assert!((a[(0, 6)] - 0.002).abs() < 1e-9 && (a[(6, 6)] - 1.0).abs() < 1e-9, "{a:?}");
    assert_eq!(b.to_nalgebra().shape(), (12, 0));
}

#[test]
fn without_joints_every_call_succeeds_with_empty_results() {
    let mut data = Data::new(ROCK.clone()).unwrap();
    let model = data.model().clone();
    data.step().unwrap();
    data.forward().unwrap();
    data.inverse().unwrap();
    assert_eq!((model.nq(), model.nv(), model.nu()), (0, 0, 0));
    assert!(data.qpos().is_empty() && data.qvel_mut().is_empty() && data.physics_state().is_empty());
    assert_eq!(data.full_m().unwrap().shape(), (0, 0));
    data.mul_m_into(&[], &mut []).unwrap();
    data.solve_m_into(&[], &mut []).unwrap();
    model.integrate_pos(&mut [], &[], 1.0).unwrap();
    model.differentiate_pos_into(1.0, &[], &[], &mut []).unwrap();
    let jacobian = data.jac_body(model.body("world").unwrap()).unwrap();
    assert_eq!(jacobian.linear.shape(), (3, 0));
    assert_eq!(data.contacts().len(), 0);
    assert_eq!((model.joints().len(), model.keyframes().len()), (0, 0));
}

#[test]
fn without_joints_a_linearisation_has_no_states() {
    let mut data = Data::new(ROCK.clone()).unwrap();
    let StateSpace { a, b, c, d } = data.transition_fd(1e-6, Differences::Forward).unwrap();
    assert_eq!([a.shape(), b.shape(), c.shape(), d.shape()], [(0, 0); 4]);
}

#[test]
fn a_linearisation_without_outputs_succeeds() {
    let mut data = Data::new(ZOO.clone()).unwrap();
    data.transition_fd_into(1e-6, Differences::Forward, TransitionOutputs::default()).unwrap();
}

fn all_parts() -> impl Strategy<Value = StateSpec> {
    any::<u32>().prop_map(StateSpec::from_bits_truncate)
}

/// Numbers for the whole state of any model.
fn any_numbers() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(any_number(), 300)
}

/// Returns each array of the whole state, in the order of the engine's documentation.
fn parts(data: &Data) -> Vec<(StateSpec, Vec<f64>)> {
    vec![
        (StateSpec::TIME, vec![data.time()]),
        (StateSpec::QPOS, data.qpos().to_vec()),
        (StateSpec::QVEL, data.qvel().to_vec()),
        (StateSpec::ACT, data.act().to_vec()),
        (StateSpec::WARMSTART, data.qacc_warmstart().to_vec()),
        (StateSpec::CTRL, data.ctrl().to_vec()),
        (StateSpec::QFRC_APPLIED, data.qfrc_applied().to_vec()),
        (StateSpec::XFRC_APPLIED, data.xfrc_applied().concat()),
        (StateSpec::MOCAP_POS, data.mocap_pos().concat()),
        (StateSpec::MOCAP_QUAT, data.mocap_quat().concat()),
        (StateSpec::USERDATA, data.userdata().to_vec()),
    ]
}

proptest! {
    #[test]
    fn set_state_and_state_round_trip_bit_for_bit(model in any_model(), spec in all_parts(), numbers in any_numbers()) {
        let mut data = Data::new(model.clone()).unwrap();
        let before = parts(&data);
        let state: Vec<f64> = numbers.iter().copied().cycle().take(model.state_size(spec)).collect();
        data.set_state(spec, &state).unwrap();
        prop_assert_eq!(bits(&data.state(spec)), bits(&state));
        let mut again = vec![0.0; state.len()];
        data.state_into(spec, &mut again).unwrap();
        prop_assert_eq!(bits(&again), bits(&state));

        // The selected parts are contiguous; the other parts are unchanged.
        let mut rest = &state[..];
        for ((part, after), (_, before)) in parts(&data).into_iter().zip(before) {
            prop_assert_eq!(model.state_size(part), after.len());
            if spec.contains(part) {
                let (expected, behind) = rest.split_at(after.len());
                prop_assert_eq!(bits(&after), bits(expected), "{:?}", part);
                rest = behind;
            } else {
                prop_assert_eq!(bits(&after), bits(&before), "{:?}", part);
            }
        }
        prop_assert!(rest.is_empty());
    }

    #[test]
    fn a_state_of_a_wrong_length_is_rejected_and_changes_nothing(model in any_model(), spec in all_parts(), more in 1..5_usize) {
        let mut data = Data::new(model.clone()).unwrap();
        let before = data.state(StateSpec::all());
        let size = model.state_size(spec);
        for wrong in [Some(size + more), size.checked_sub(more)].into_iter().flatten() {
            let rejected = matches!(data.set_state(spec, &vec![1.0; wrong]), Err(Error::Shape { .. }));
            prop_assert!(rejected, "{} numbers for {}", wrong, size);
            prop_assert!(data.state_into(spec, &mut vec![1.0; wrong]).is_err());
        }
        prop_assert_eq!(bits(&data.state(StateSpec::all())), bits(&before));
    }

    #[test]
    fn differentiate_pos_inverts_integrate_pos(
        model in any_model(),
        velocities in prop::collection::vec(-1.0..1.0_f64, 40),
        turns in prop::collection::vec(-1.0..1.0_f64, 40),
        dt in prop_oneof![0.01..1.5_f64, -1.5..-0.01_f64],
    ) {
        let nv = model.nv();
        // The start is a rotated position, so that quaternions are general.
        let mut from = model.qpos0().to_vec();
        model.integrate_pos(&mut from, &turns[..nv], 1.0).unwrap();
        let mut to = from.clone();
        model.integrate_pos(&mut to, &velocities[..nv], dt).unwrap();
        let mut found = vec![0.0; nv];
        // Rotations are below half a turn: |velocity| ≤ √3, |dt| ≤ 1.5.
        model.differentiate_pos_into(dt, &from, &to, &mut found).unwrap();
        for (found, expected) in found.iter().zip(&velocities) {
            prop_assert!((found - expected).abs() < 1e-9 / dt.abs(), "{} and {}", found, expected);
        }
    }

    #[test]
    fn integrate_pos_of_a_simulation_equals_that_of_its_model(
        model in any_model(),
        velocity in prop::collection::vec(-1.0..1.0_f64, 40),
        dt in -1.5..1.5_f64,
    ) {
        let velocity = &velocity[..model.nv()];
        let mut data = Data::new(&model).unwrap();
        let mut expected = data.qpos().to_vec();
        for _ in 0..3 {
            data.integrate_pos(velocity, dt).unwrap();
            model.integrate_pos(&mut expected, velocity, dt).unwrap();
        }
        prop_assert_eq!(bits(data.qpos()), bits(&expected));
        let wrong_length = data.integrate_pos(&[0.0; 41], dt);
        prop_assert!(matches!(wrong_length, Err(Error::Shape { .. })), "{:?}", wrong_length);
        prop_assert!(data.integrate_pos(velocity, f64::NAN).is_err());
        prop_assert_eq!(bits(data.qpos()), bits(&expected));
        prop_assert!(data.qvel().iter().all(|value| *value == 0.0));
    }

    #[test]
    fn integrate_pos_inverts_differentiate_pos(
        model in any_model(),
        first in prop::collection::vec(-1.5..1.5_f64, 40),
        second in prop::collection::vec(-1.5..1.5_f64, 40),
    ) {
        let nv = model.nv();
        let [from, to] = [first, second].map(|turns| {
            let mut qpos = model.qpos0().to_vec();
            model.integrate_pos(&mut qpos, &turns[..nv], 1.0).unwrap();
            qpos
        });
        let (mut velocity, mut arrived) = (vec![0.0; nv], from.clone());
        model.differentiate_pos_into(2.0, &from, &to, &mut velocity).unwrap();
        model.integrate_pos(&mut arrived, &velocity, 2.0).unwrap();
        for joint in model.joints() {
            // A quaternion and its negative represent the same orientation.
            let quaternion = match joint.joint_type().nq() {
                7 => joint.qpos_range().start + 3..joint.qpos_range().end,
                4 => joint.qpos_range(),
                _ => 0..0,
            };
            let dot: f64 = arrived[quaternion.clone()].iter().zip(&to[quaternion.clone()]).map(|(a, b)| a * b).sum();
            for index in joint.qpos_range() {
                let sign = if quaternion.contains(&index) && dot < 0.0 { -1.0 } else { 1.0 };
                prop_assert!((arrived[index] - sign * to[index]).abs() < 1e-9, "{:?}: {} and {}", joint, arrived[index], to[index]);
            }
        }
    }
}

#[cfg(engine_since = "4.0.0")]
#[test]
fn a_model_with_a_state_outside_of_the_state_vectors_is_rejected() {
    let xml = r#"<mujoco><option integrator="discrete"><flag ipc="enable"/></option></mujoco>"#;
    let error = mujoco_safe::Model::from_xml_str(xml).unwrap_err().to_string();
    assert!(error.contains("the option ipc is enabled"), "{error}");
}
