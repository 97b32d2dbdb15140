//! Sensor readings in trajectories.

use mujoco_safe::enums::Integrator;
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Controller, Data, Error, Model, RandomController, Trajectory};

use crate::arbitrary::{BALL, CARTPOLE, HUMANOID, bits};

/// A model with sensors of all types.
fn every_element() -> Model {
    Model::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml")).unwrap()
}

fn recorded(model: &Model, steps: usize) -> Trajectory {
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::with_sensordata(model);
    trajectory.record(&mut data, &mut RandomController::new(5), steps).unwrap();
    trajectory
}

#[test]
fn recorded_readings_are_those_that_forward_computes_in_the_recorded_state() {
    for model in [CARTPOLE.as_ref().clone(), every_element()] {
        for integrator in [Integrator::Euler, Integrator::Rk4] {
            let mut model = model.clone();
            model.edit().edit_options(|options| options.integrator = integrator).unwrap();
            let mut random = RandomController::new(2);
            let (mut states, mut readings) = (Vec::new(), Vec::new());
            let mut controller = |data: &mut Data| {
                random.control(data)?;
                let mut copy = data.clone();
                copy.forward()?;
                states.extend(data.physics_state());
                readings.push(copy.sensordata().to_vec());
                Ok(())
            };
            let mut data = Data::new(model).unwrap();
            let mut trajectory = Trajectory::with_sensordata(data.model());
            trajectory.record(&mut data, &mut controller, 5).unwrap();
            assert_eq!(bits(trajectory.states()), bits(&states));
            assert!(readings[4].iter().any(|&value| value != 0.0) && readings[4] != readings[3]);
            for (record, readings) in readings.iter().enumerate() {
                assert_eq!(bits(trajectory.sensordata(record)), bits(readings), "record {record}, {integrator:?}");
            }
        }
    }
}

#[test]
fn push_needs_the_readings_of_the_present_state() {
    let mut data = Data::new(CARTPOLE.clone()).unwrap();
    let mut trajectory = Trajectory::with_sensordata(data.model());
    let rejected = |data: &Data, trajectory: &mut Trajectory| {
        let before = trajectory.clone();
        let error = trajectory.push(data).unwrap_err();
        assert!(matches!(error, Error::NotComputed { call: "Trajectory::push", .. }), "{error}");
        assert_eq!(*trajectory, before);
    };
    rejected(&data, &mut trajectory);
    data.step().unwrap();
    rejected(&data, &mut trajectory);
    data.step1().unwrap();
    rejected(&data, &mut trajectory);
    data.forward().unwrap();
    trajectory.push(&data).unwrap();
    assert_eq!(bits(trajectory.sensordata(0)), bits(data.sensordata()));
    data.kinematics().unwrap();
    rejected(&data, &mut trajectory);
    data.inverse().unwrap();
    trajectory.push(&data).unwrap();
    data.reset().unwrap();
    rejected(&data, &mut trajectory);
    // Other trajectories need no results.
    Trajectory::new(data.model()).push(&data).unwrap();
    assert_eq!(trajectory.len(), 2);
}

#[test]
fn disabled_sensors_and_other_models_are_errors() {
    let mut data = Data::new(CARTPOLE.clone()).unwrap();
    data.edit_model(|model| model.edit_options(|options| options.disable |= DisableFlags::SENSOR)).unwrap();
    data.forward().unwrap();
    let mut trajectory = Trajectory::with_sensordata(data.model());
    assert!(matches!(trajectory.push(&data), Err(Error::Unsupported(_))));
    assert!(trajectory.is_empty());
    assert!(matches!(trajectory.record(&mut data, &mut |_: &mut Data| (), 1), Err(Error::Unsupported(_))));

    // The same state and controls, without sensors.
    let xml = r#"<mujoco><worldbody>
        <body><joint name="a" type="slide"/><geom size=".1"/><body><joint/><geom size=".1" pos=".2 0 0"/></body></body>
        </worldbody><actuator><motor joint="a"/></actuator></mujoco>"#;
    let mut other = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    other.forward().unwrap();
    let mut trajectory = Trajectory::with_sensordata(&CARTPOLE);
    assert!(matches!(trajectory.push(&other), Err(Error::Shape { .. })));
    assert!(matches!(trajectory.record(&mut other, &mut |_: &mut Data| (), 1), Err(Error::Shape { .. })));
    assert!(trajectory.is_empty());
    // Records of another model's simulation apply to it, because readings are not part of the
    // state.
    recorded(&CARTPOLE, 2).apply(1, &mut other).unwrap();
}

#[test]
fn the_readings_of_a_failed_step_are_nan() {
    let mut data = Data::new(CARTPOLE.clone()).unwrap();
    let mut trajectory = Trajectory::with_sensordata(data.model());
    let mut late_nan = |data: &mut Data| data.ctrl_mut()[0] = if data.time() > 0.025 { f64::NAN } else { 0.1 };
    assert!(matches!(trajectory.record(&mut data, &mut late_nan, 10), Err(Error::Unstable(_))));
    assert_eq!(trajectory.len(), 4);
    assert!(trajectory.sensordata(2).iter().all(|value| value.is_finite()));
    assert!(trajectory.sensordata(3).iter().all(|value| value.is_nan()));
    data.reset().unwrap();
    data.forward().unwrap();
    trajectory.push(&data).unwrap();
    assert_eq!(bits(trajectory.sensordata(4)), bits(data.sensordata()));
}

#[test]
fn models_without_sensors_have_no_readings() {
    let trajectory = recorded(&BALL, 3);
    assert!(trajectory.sensordata(2).is_empty());
    let mut plain = Trajectory::new(&BALL);
    plain.record(&mut Data::new(BALL.clone()).unwrap(), &mut |_: &mut Data| (), 3).unwrap();
    assert_eq!(trajectory, plain);
}

#[test]
fn csv_columns_of_readings_follow_the_controls() {
    let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    let trajectory = recorded(&CARTPOLE, 3);
    trajectory.save_csv(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let mut lines = text.lines();
    let header = "time,qpos0,qpos1,qvel0,qvel1,ctrl0,sensordata0,sensordata1,sensordata2,sensordata3,sensordata4,sensordata5,sensordata6";
    assert_eq!(lines.next(), Some(header));
    for (record, line) in lines.enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(bits(&cells[6..]), bits(trajectory.sensordata(record)));
    }
    let mut wrong = text.clone();
    wrong.truncate(wrong.trim_end().rfind(',').unwrap());
    std::fs::write(&path, wrong).unwrap();
    let error = Trajectory::load_csv(&CARTPOLE, &path).unwrap_err().to_string();
    assert!(error.contains("line 4 has 12 columns, not 13"), "{error}");
    std::fs::write(&path, text.replacen("sensordata6", "sensordata7", 1)).unwrap();
    let error = Trajectory::load_csv(&CARTPOLE, &path).unwrap_err().to_string();
    assert!(
        error.contains("expected 6 columns starting with 'time', or 13 with the sensor readings, found 13"),
        "{error}"
    );
}

/// Asserts that trajectories with and without readings, and with and without records, are restored
/// bit for bit.
fn assert_round_trip(round_trip: impl Fn(&Model, &Trajectory) -> Trajectory) {
    for model in [&CARTPOLE, &HUMANOID, &BALL].map(|model| model.as_ref().clone()).into_iter().chain([every_element()])
    {
        let mut plain = Trajectory::new(&model);
        plain.record(&mut Data::new(model.clone()).unwrap(), &mut RandomController::new(1), 4).unwrap();
        let empty = [Trajectory::new(&model), Trajectory::with_sensordata(&model)];
        for trajectory in empty.into_iter().chain([plain, recorded(&model, 4)]) {
            let again = round_trip(&model, &trajectory);
            assert_eq!(again, trajectory);
            for record in 0..trajectory.len() {
                assert_eq!(bits(again.sensordata(record)), bits(trajectory.sensordata(record)));
            }
        }
    }
}

#[test]
fn csv_files_round_trip_with_and_without_readings() {
    let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    assert_round_trip(|model, trajectory| {
        trajectory.save_csv(&path).unwrap();
        Trajectory::load_csv(model, &path).unwrap()
    });
}

#[cfg(feature = "npz")]
#[test]
fn npz_files_round_trip_with_and_without_readings() {
    let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    assert_round_trip(|model, trajectory| {
        trajectory.save_npz(&path).unwrap();
        Trajectory::load_npz(model, &path).unwrap()
    });
    let trajectory = recorded(&CARTPOLE, 3);
    trajectory.save_npz(&path).unwrap();
    let (header, bytes) = crate::numpy::array(&path, "sensordata");
    assert_eq!(header, "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 7), }");
    let expected = (0..3).flat_map(|record| trajectory.sensordata(record)).flat_map(|value| value.to_le_bytes());
    assert!(expected.eq(bytes));
    let error = Trajectory::load_npz(&every_element(), &path).unwrap_err().to_string();
    assert!(error.contains("to match 'time' and this model"), "{error}");
}

#[cfg(feature = "serde")]
#[test]
fn serde_data_round_trip_with_and_without_readings() {
    assert_round_trip(|_, trajectory| serde_json::from_str(&serde_json::to_string(trajectory).unwrap()).unwrap());
    // Data without the fields is that of a trajectory without readings.
    let mut plain = Trajectory::new(&CARTPOLE);
    plain.record(&mut Data::new(CARTPOLE.clone()).unwrap(), &mut |_: &mut Data| (), 2).unwrap();
    let mut value = serde_json::to_value(&plain).unwrap();
    for field in ["nsensordata", "sensordata"] {
        value.as_object_mut().unwrap().remove(field).unwrap();
    }
    assert_eq!(serde_json::from_value::<Trajectory>(value).unwrap(), plain);
}
