//! Logs and trajectories, read again.

use std::fs;
use std::path::Path;

use mujoco_safe::mcap::Log;
use mujoco_safe::{Controller, Data, Error, Model, RandomController, Trajectory, sample};

use crate::arbitrary::bits;

/// Returns a model with elements and sensors of all types.
fn every_element() -> Model {
    Model::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml")).unwrap()
}

/// Returns all numbers of a trajectory.
fn numbers(trajectory: &Trajectory) -> Vec<u64> {
    let readings = (0..trajectory.len()).flat_map(|record| trajectory.sensordata(record)).copied().collect::<Vec<_>>();
    [trajectory.times(), trajectory.states(), trajectory.controls(), &readings].into_iter().flat_map(bits).collect()
}

#[test]
fn a_trajectory_round_trips_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    for model in [every_element(), sample::humanoid(), Model::from_xml_str("<mujoco/>").unwrap()] {
        let mut data = Data::new(model.clone()).unwrap();
        for mut trajectory in [Trajectory::new(&model), Trajectory::with_sensordata(&model)] {
            trajectory.record(&mut data, &mut RandomController::new(5), 30).unwrap();
            trajectory.save_mcap(data.model(), &path).unwrap();
            let read = Trajectory::load_mcap(&model, &path).unwrap();
            assert_eq!(read, trajectory);
            assert_eq!(numbers(&read), numbers(&trajectory));
        }
        let empty = Trajectory::new(&model);
        empty.save_mcap(data.model(), &path).unwrap();
        assert_eq!(Trajectory::load_mcap(&model, &path).unwrap(), empty);
    }
}

#[test]
fn invalid_numbers_round_trip_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    data.qpos_mut().copy_from_slice(&[f64::from_bits(0x7ff8_0000_0000_1234), -0.0]);
    data.qvel_mut().copy_from_slice(&[f64::NEG_INFINITY, f64::MIN_POSITIVE / 4.0]);
    for time in [f64::NAN, -1.0, f64::INFINITY, 1e300] {
        data.set_time(time);
        trajectory.push(&data).unwrap();
    }
    trajectory.save_mcap(data.model(), &path).unwrap();
    let read = Trajectory::load_mcap(data.model(), &path).unwrap();
    assert_eq!(numbers(&read), numbers(&trajectory));
}

#[test]
fn a_log_has_the_records_of_a_trajectory_and_does_not_change_the_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let model = every_element();
    let (mut logged, mut plain) = (Data::new(model.clone()).unwrap(), Data::new(model).unwrap());
    let mut expected = Trajectory::with_sensordata(plain.model());
    expected.record(&mut plain, &mut RandomController::new(5), 100).unwrap();

    let mut log = Log::create(&path, logged.model()).unwrap().with_display_rate(f64::INFINITY);
    let mut controller = RandomController::new(5);
    for _ in 0..100 {
        controller.control(&mut logged).unwrap();
        log.step(&mut logged).unwrap();
    }
    log.finish().unwrap();
    assert_eq!(bits(&logged.physics_state()), bits(&plain.physics_state()));
    let read = Trajectory::load_mcap(logged.model(), &path).unwrap();
    assert_eq!(numbers(&read), numbers(&expected));
}

#[test]
fn readings_that_were_not_computed_are_nan() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut log = Log::create(&path, data.model()).unwrap();
    log.write(&data).unwrap();
    data.forward().unwrap();
    log.write(&data).unwrap();
    data.step().unwrap();
    log.write(&data).unwrap();
    data.ctrl_mut()[0] = f64::NAN;
    log.step(&mut data).unwrap_err();
    log.finish().unwrap();
    let read = Trajectory::load_mcap(data.model(), &path).unwrap();
    let known: Vec<bool> = (0..4).map(|record| read.sensordata(record).iter().all(|value| !value.is_nan())).collect();
    assert_eq!(known, [false, true, false, false]);
    assert!(read.ctrl(3)[0].is_nan());
}

#[test]
fn a_log_is_for_one_model_and_its_edits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut other = Data::new(sample::cartpole()).unwrap();
    let mut log = Log::create(&path, data.model()).unwrap();
    assert!(matches!(log.step(&mut other), Err(Error::OtherModel { .. })));
    log.step(&mut data).unwrap();
    for _ in 0..2 {
        // The shapes change once.
        data.edit_model(|model| model.geom_size_mut()[0][0] = 0.25).unwrap();
        log.step(&mut data).unwrap();
    }
    log.finish().unwrap();
    assert_eq!(Trajectory::load_mcap(data.model(), &path).unwrap().len(), 3);
    assert_eq!(topics(&path).iter().filter(|topic| *topic == "/scene").count(), 2);
}

#[test]
fn the_rate_of_display_is_that_of_simulated_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    for (rate, expected) in [(0.0, 0), (10.0, 11), (50.0, 51), (f64::INFINITY, 201), (f64::NAN, 0)] {
        let mut data = Data::new(sample::humanoid()).unwrap();
        let mut log = Log::create(&path, data.model()).unwrap().with_display_rate(rate);
        for _ in 0..201 {
            log.step(&mut data).unwrap(); // 5 ms
        }
        drop(log);
        for topic in ["/tf", "/joints", "/contacts"] {
            assert_eq!(topics(&path).iter().filter(|found| *found == topic).count(), expected, "{topic} at {rate} Hz");
        }
    }
}

#[test]
fn errors_name_the_message_and_a_file_of_another_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let data = Data::new(sample::cartpole()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    trajectory.push(&data).unwrap();
    trajectory.save_mcap(data.model(), &path).unwrap();
    let error = Trajectory::load_mcap(&sample::humanoid(), &path).unwrap_err().to_string();
    let expected =
        "message 1 of the topic /state has nq, nv, na, nu = [2, 2, 0, 1], but this model has [28, 27, 0, 21]";
    assert!(error.contains(expected) && error.contains("before byte"), "{error}");
    let missing = folder.path().join("none").join("t.mcap");
    assert!(matches!(trajectory.save_mcap(data.model(), &missing), Err(Error::File { .. })));
    assert!(matches!(Log::create(&missing, data.model()), Err(Error::File { .. })));
    assert!(matches!(trajectory.save_mcap(sample::humanoid(), &path), Err(Error::Shape { .. })));
}

/// Returns the topics of all messages, read by the official crate.
fn topics(path: &Path) -> Vec<String> {
    let bytes = fs::read(path).unwrap();
    let messages = mcap::MessageStream::new(&bytes).unwrap();
    messages.map(|message| message.unwrap().channel.topic.clone()).collect()
}
