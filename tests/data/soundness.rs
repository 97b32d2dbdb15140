//! Misuse that crashes the engine or silently gives wrong results in C. From safe code, each case
//! is an error, a panic with a message, or gives the right result. The documentation of `Data`,
//! `ModelMut` and `Callbacks` has the cases that do not compile; the chapter `promises` of the
//! documentation lists the tests of longer cases.

#![forbid(unsafe_code)]

use mujoco_safe::callback::Callbacks;
use mujoco_safe::data::{FrameId, RayOptions, UnstableField};
use mujoco_safe::enums::{Cone, Integrator, JacobianStorage, Solver};
use mujoco_safe::{Data, Error, Model, Stage, sample};

use crate::trouble;

/// Returns the humanoid in a squat, with everything computed.
fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    assert!(data.ncon() > 0);
    data
}

fn change(data: &mut Data, change: impl FnOnce(&mut mujoco_safe::Options)) {
    data.edit_model(|model| model.edit_options(change)).unwrap();
}

fn is_not_computed<T: std::fmt::Debug>(result: &Result<T, Error>) {
    assert!(matches!(result, Err(Error::NotComputed { .. })), "{result:?}");
}

mod memory {
    use super::*;

    #[test]
    fn step2_is_rejected_after_a_change_of_solver_or_layout() {
        let changes: [fn(&mut mujoco_safe::Options); 5] = [
            |options| options.solver = Solver::Pgs,
            |options| options.noslip_iterations = 5,
            |options| options.jacobian = JacobianStorage::Sparse,
            |options| options.cone = Cone::Elliptic,
            |options| options.integrator = Integrator::Implicit,
        ];
        for option in changes {
            let mut data = squatting();
            data.step1().unwrap();
            change(&mut data, option);
            is_not_computed(&data.step2());
            data.step().unwrap();
        }
    }

    #[test]
    fn contact_forces_are_not_decoded_with_another_cone() {
        let mut data = squatting();
        change(&mut data, |options| options.cone = Cone::Elliptic);
        data.forward().unwrap();
        let elliptic = data.contacts().next().unwrap().force().unwrap();
        change(&mut data, |options| options.cone = Cone::Pyramidal);
        is_not_computed(&data.contacts().next().unwrap().force());
        data.forward().unwrap();
        let pyramidal = data.contacts().next().unwrap().force().unwrap();
        assert!(
            (pyramidal.force[0] - elliptic.force[0]).abs() < 0.2 * elliptic.force[0],
            "{pyramidal:?}, {elliptic:?}"
        );
    }

    #[test]
    fn a_pipeline_stage_without_its_predecessor_is_an_error() {
        let mut data = squatting();
        change(&mut data, |options| options.solver = Solver::Pgs);
        data.forward().unwrap();
        data.make_constraint().unwrap();
        // The dual matrix belongs to the earlier constraints.
        is_not_computed(&data.fwd_constraint());
        let mut fresh = Data::new(sample::humanoid()).unwrap();
        is_not_computed(&fresh.make_constraint());
        is_not_computed(&fresh.fwd_velocity());
    }

    #[test]
    fn copying_between_simulations_with_other_options_discards_results() {
        let source = squatting();
        let mut target = source.clone();
        change(&mut target, |options| (options.cone, options.jacobian) = (Cone::Elliptic, JacobianStorage::Sparse));
        target.copy_from(&source).unwrap();
        is_not_computed(&target.step2());
        is_not_computed(&target.contacts().next().unwrap().force());
        target.step().unwrap();
    }

    #[test]
    fn a_simulation_of_another_model_is_not_copied() {
        let mut data = squatting();
        let other = Data::new(sample::cartpole()).unwrap();
        assert!(matches!(data.copy_from(&other), Err(Error::OtherModel { .. })));
        // The same text loaded again is another model, although the engine's signature would be the
        // same.
        let again = Data::new(sample::humanoid()).unwrap();
        assert!(matches!(data.copy_from(&again), Err(Error::OtherModel { .. })));
    }

    #[test]
    fn a_stack_overflow_poisons_the_simulation() {
        let mut data = Data::new(trouble::overflowing()).unwrap();
        let error = (0..200).find_map(|_| data.step().err()).unwrap();
        assert!(
            matches!(&error, Error::Engine { message, .. } if message.contains(trouble::STACK_OVERFLOW)),
            "{error}"
        );
        assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
        data.reset().unwrap();
        data.step().unwrap();
    }

    #[test]
    fn a_ray_on_a_geom_of_another_type_is_an_error() {
        let data = squatting();
        let floor = data.model().geom("floor").unwrap().id();
        let down = [0.0, 0.0, -1.0];
        assert!(matches!(data.ray_mesh(floor, [0.0, 0.0, 1.0], down), Err(Error::Invalid { .. })));
        assert!(matches!(data.ray_hfield(floor, [0.0, 0.0, 1.0], down), Err(Error::Invalid { .. })));
        assert!(matches!(data.ray([0.0, 0.0, 1.0], [0.0; 3], &RayOptions::default()), Err(Error::Invalid { .. })));
    }

    #[test]
    #[should_panic(expected = "another model")]
    fn an_id_of_another_model_panics_even_if_its_index_exists() {
        let cart = sample::cartpole().body("cart").unwrap().id();
        let _ = squatting().object_velocity(FrameId::Body(cart), mujoco_safe::data::Axes::World);
    }

    #[test]
    fn a_file_with_one_changed_byte_is_an_error_or_can_be_simulated() {
        let good = sample::cartpole().to_binary().unwrap();
        for position in (0..good.len()).step_by(17) {
            let mut bytes = good.clone();
            bytes[position] ^= 0x5a;
            if let Ok(model) = Model::from_binary(&bytes) {
                let mut data = Data::new(model).unwrap();
                let _ = data.step_n(3);
            }
        }
    }
}

mod crashes {
    use super::*;

    #[test]
    fn unknown_flags_are_rejected() {
        let mut data = squatting();
        let result = data.edit_model(|model| {
            model.edit_options(|options| options.enable = mujoco_safe::model::EnableFlags::from_bits_retain(1 << 27))
        });
        assert!(matches!(result, Err(Error::Invalid { .. })));
    }

    #[test]
    fn saving_to_a_missing_directory_is_an_error() {
        let model = sample::cartpole();
        assert!(matches!(model.save_binary("no/such/folder/model.mjb"), Err(Error::File { .. })));
        assert!(matches!(
            model.save_xml("no/such/folder/model.xml"),
            Err(Error::Save { .. } | Error::File { .. } | Error::XmlReplaced)
        ));
    }

    #[test]
    fn a_panic_in_a_callback_is_an_error() {
        let mut data = squatting();
        let result =
            data.with_callbacks(Callbacks::new().with_control(|_| panic!("in a callback")), |data| data.step());
        assert!(matches!(result, Err(Error::Callback { message, .. }) if message == "in a callback"));
        data.reset().unwrap();
        data.step().unwrap();
    }
}

mod silent_errors {
    use super::*;

    #[test]
    fn an_unstable_state_is_an_error_and_not_reset() {
        let mut data = squatting();
        data.set_time(3.0);
        data.qvel_mut()[7] = f64::INFINITY;
        match data.step() {
            Err(Error::Unstable(instability)) => {
                assert_eq!((instability.field, instability.index, instability.time), (UnstableField::Velocity, 7, 3.0));
            }
            other => panic!("{other:?}"),
        }
        assert_eq!(data.time(), 3.0);
    }

    #[test]
    fn a_missing_keyframe_is_an_error_without_a_reset() {
        let mut data = squatting();
        let before = data.qpos().to_vec();
        assert!(matches!(data.reset_to_key(99), Err(Error::NoSuchIndex { index: 99, .. })));
        assert!(matches!(data.reset_to_key("handstand"), Err(Error::NoSuchName { .. })));
        assert_eq!(data.qpos(), before);
    }

    #[test]
    fn contact_forces_of_the_previous_step_are_not_returned() {
        let mut data = squatting();
        assert!(data.contacts().next().unwrap().force().is_ok());
        data.step1().unwrap();
        assert_eq!(data.stage(), Stage::Velocity);
        is_not_computed(&data.contacts().next().unwrap().force());
    }

    #[test]
    fn the_xml_of_another_model_is_not_saved() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.xml");
        let first = sample::cartpole();
        let _second = sample::humanoid();
        assert!(matches!(first.save_xml(&path), Err(Error::XmlReplaced)));
        assert!(!path.exists());
    }

    #[test]
    fn a_nan_control_is_an_error() {
        let mut data = squatting();
        data.ctrl_mut()[3] = f64::NAN;
        match data.step() {
            Err(Error::Unstable(instability)) => {
                assert_eq!((instability.field, instability.index), (UnstableField::Control, 3));
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn error_messages_are_not_truncated() {
        let name = "n".repeat(200);
        let text = format!(r#"<mujoco><worldbody><geom size="1" material="{name}"/></worldbody></mujoco>"#);
        assert!(Model::from_xml_str(&text).unwrap_err().to_string().contains(&name));
    }

    #[test]
    fn a_jacobian_is_row_major_and_has_a_transposed_view() {
        // The inertia matrix is symmetric, so it cannot show the order of the elements; a Jacobian
        // can.
        let data = squatting();
        let jacobian = data.jac_body_com(data.model().body("foot_left").unwrap()).unwrap().linear;
        let point = data.xipos()[data.model().body("foot_left").unwrap().index()];
        for (row, transposed) in jacobian.rows().zip(jacobian.transposed().column_iter()) {
            assert!(row.iter().eq(transposed.iter()));
        }
        // A translation of the root along z moves the point along z only.
        assert_eq!([0, 1, 2].map(|axis| jacobian[(axis, 2)]), [0.0, 0.0, 1.0], "{point:?}");
    }
}
