//! Restored state, optional outputs, and rejected arguments.
#![deny(unsafe_code)]

use mujoco_safe::derivative::{InverseForce, InverseJacobians};
use mujoco_safe::{Data, Error, Matrix, Model, Stage, StateSpec, sample};

use super::{EPS, computed_alone, subjects};

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn state_accelerations_and_inputs_are_restored() {
    for mut data in subjects() {
        // Quaternions that are not normalised, which the engine would normalise.
        data.qpos_mut().iter_mut().for_each(|value| *value *= 1.01);
        data.mocap_quat_mut().as_flattened_mut().iter_mut().for_each(|value| *value *= 0.9);
        let state = StateSpec::all();
        let (before, qacc) = (data.state(state), data.qacc().to_vec());
        data.inverse_fd(EPS, InverseForce::WithoutActuators).unwrap();
        assert_eq!(bits(&data.state(state)), bits(&before));
        assert_eq!(bits(data.qacc()), bits(&qacc));
    }
}

#[test]
fn other_results_are_those_of_inverse() {
    for mut data in subjects() {
        let mut other = data.clone();
        data.inverse_fd(EPS, InverseForce::Total).unwrap();
        other.inverse().unwrap();
        assert_eq!(data.stage(), Stage::Acceleration);
        for (ours, theirs) in [
            (data.qfrc_inverse(), other.qfrc_inverse()),
            (data.sensordata(), other.sensordata()),
            (data.full_m().unwrap().as_slice(), other.full_m().unwrap().as_slice()),
            (data.qfrc_bias(), other.qfrc_bias()),
            (data.efc_force(), other.efc_force()),
        ] {
            assert_eq!(bits(ours), bits(theirs));
        }
        // The next step is the same, so the engine's stack and the state are restored.
        data.step().unwrap();
        other.step().unwrap();
        assert_eq!(bits(&data.physics_state()), bits(&other.physics_state()));
    }
}

#[test]
fn many_calls_do_not_exhaust_the_stack() {
    // Each call releases the engine's stack.
    let mut data = Data::new(sample::cartpole()).unwrap();
    for _ in 0..2000 {
        data.inverse_fd(EPS, InverseForce::WithoutActuators).unwrap();
    }
}

#[test]
fn each_output_is_independent_of_the_other_outputs() {
    for data in subjects() {
        for force in [InverseForce::Total, InverseForce::WithoutActuators] {
            // A call computes the forces of the actuators, which the sensors of the next call would
            // read.
            let all = data.clone().inverse_fd(EPS, force).unwrap();
            let alone = computed_alone(data.model(), |outputs| {
                data.clone().inverse_fd_into(EPS, force, outputs).unwrap();
            });
            for (name, alone, all) in [
                ("df_dq", &alone.df_dq, &all.df_dq),
                ("df_dv", &alone.df_dv, &all.df_dv),
                ("df_da", &alone.df_da, &all.df_da),
                ("ds_dq", &alone.ds_dq, &all.ds_dq),
                ("ds_dv", &alone.ds_dv, &all.ds_dv),
                ("ds_da", &alone.ds_da, &all.ds_da),
                ("dm_dq", &alone.dm_dq, &all.dm_dq),
            ] {
                assert_eq!(alone, all, "{name} of {force:?}, {data:?}");
            }
        }
    }
}

/// Returns a pendulum with a position servo and a sensor of its force.
fn servo() -> Data {
    let model = Model::from_xml_str(
        r#"<mujoco>
             <worldbody><body><joint name="hinge" axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 .3 0 0"/></body></worldbody>
             <actuator><position name="servo" joint="hinge" kp="10"/></actuator>
             <sensor><actuatorfrc actuator="servo"/></sensor>
           </mujoco>"#,
    );
    let mut data = Data::new(model.unwrap()).unwrap();
    data.ctrl_mut()[0] = 0.3;
    data.forward().unwrap();
    data
}

#[test]
fn derivatives_of_sensors_do_not_depend_on_the_differentiated_force() {
    for data in subjects().chain([servo()]) {
        let sensors = |force| {
            let jacobians = data.clone().inverse_fd(EPS, force).unwrap();
            [jacobians.ds_dq, jacobians.ds_dv, jacobians.ds_da]
        };
        assert_eq!(sensors(InverseForce::WithoutActuators), sensors(InverseForce::Total), "{data:?}");
    }
}

#[test]
fn a_wrong_shape_is_rejected_before_any_computation() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let before = data.stage();
    // Each output in turn, with one row or column too many, or transposed.
    for output in 0..7 {
        for (rows, columns) in [(1, 0), (0, 1)] {
            let mut jacobians = InverseJacobians::zeros(data.model());
            let InverseJacobians { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq } = &mut jacobians;
            let matrix = [df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq].into_iter().nth(output).unwrap();
            *matrix = Matrix::zeros(matrix.nrows() + rows, matrix.ncols() + columns);
            let error = data.inverse_fd_into(EPS, InverseForce::Total, &mut jacobians).unwrap_err();
            assert!(matches!(error, Error::Shape { .. }), "{error}");
        }
    }
    assert_eq!(data.stage(), before);
}

#[test]
fn invalid_differences_are_rejected() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    for eps in [0.0, -1e-6, 1e-13, 1.5, f64::NAN, f64::INFINITY] {
        let error = data.inverse_fd(eps, InverseForce::Total).unwrap_err();
        assert!(matches!(&error, Error::Invalid { what, .. } if what == "eps of inverse_fd"), "{error}");
    }
    data.qpos_mut()[0] = f64::NAN;
    assert!(matches!(data.inverse_fd(EPS, InverseForce::Total), Err(Error::Unstable(_))));
}

/// Returns the model with another `nstack`, the number of values on the engine's stack.
#[cfg(not(engine_since = "2.3.0"))]
fn with_stack(model: &Model, nstack: i32) -> Model {
    let mut bytes = model.to_binary().unwrap();
    // The header is four integers long; the sizes follow in the order of the engine's list.
    let table = include_str!("../../../mujoco-sys/fields/v2_2_2.tsv");
    let mut sizes = table.lines().filter_map(|line| line.strip_prefix("Model\tsize\tint\t")?.split('\t').next());
    let at = 4 * (4 + sizes.position(|size| size == "nstack").unwrap());
    assert_eq!(bytes[at..at + 4], (model.nstack() as i32).to_ne_bytes());
    bytes[at..at + 4].copy_from_slice(&nstack.to_ne_bytes());
    Model::from_binary(&bytes).unwrap()
}

/// Returns the model with an arena for this number of values, which contains the engine's stack.
#[cfg(engine_since = "2.3.0")]
#[allow(unsafe_code, reason = "no safe call changes the size of the arena")]
fn with_stack(model: &Model, nstack: i32) -> Model {
    let model = model.try_clone().unwrap();
    // SAFETY: nothing else uses the model, and the engine makes a data with an arena of any size.
    unsafe { (*model.as_ptr().cast_mut()).narena = (8 * nstack).into() };
    model
}

#[test]
fn a_small_stack_is_an_error_that_keeps_the_state() {
    let model = sample::humanoid();
    let kept = model.nq() + 3 * model.nv() + 4 * model.nmocap() + model.nu();
    // Too small for the saved state, too small for the engine in addition, and sufficient for both.
    for (nstack, enough) in [(kept - 1, false), (kept, false), (1_000_000, true)] {
        let mut data = Data::new(with_stack(&model, nstack as i32)).unwrap();
        data.qpos_mut().iter_mut().for_each(|value| *value *= 1.01);
        let before = bits(&data.state(StateSpec::all()));
        let found = data.inverse_fd(EPS, InverseForce::Total);
        assert_eq!(found.is_ok(), enough);
        if let Err(error) = found {
            assert!(matches!(error, Error::Engine { .. }), "{error}");
        }
        assert_eq!(bits(&data.state(StateSpec::all())), before);
        assert_eq!(matches!(data.inverse(), Err(Error::Poisoned { .. })), !enough);
        // The stack is released: the same calls succeed again.
        data.reset().unwrap();
        assert_eq!(data.inverse_fd(EPS, InverseForce::Total).is_ok(), enough);
    }
}

#[test]
fn models_without_joints_and_sensors_have_empty_jacobians() {
    let mut data = Data::new(Model::from_xml_str("<mujoco/>").unwrap()).unwrap();
    let jacobians = data.inverse_fd(EPS, InverseForce::WithoutActuators).unwrap();
    assert_eq!((jacobians.df_dq.shape(), jacobians.dm_dq.shape()), ((0, 0), (0, 0)));
}
