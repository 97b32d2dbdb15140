//! Results as plain data: they round-trip, and inconsistent data is rejected.
#![forbid(unsafe_code)]

use mujoco_safe::data::{ContactForce, WarningCount};
use mujoco_safe::{Data, Differences, Matrix, RandomController, StateSpace, StateSpec, Trajectory, sample};
use serde_json::{Value, from_str, from_value, json, to_string, to_value};

fn trajectory() -> (Data, Trajectory) {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    trajectory.record(&mut data, &mut RandomController::new(3), 20).unwrap();
    (data, trajectory)
}

fn error<T: serde::de::DeserializeOwned>(value: Value) -> String {
    from_value::<T>(value).err().unwrap().to_string()
}

#[test]
fn a_trajectory_round_trips_bit_for_bit() {
    let (mut data, trajectory) = trajectory();
    let read: Trajectory = from_str(&to_string(&trajectory).unwrap()).unwrap();
    assert_eq!(read, trajectory);
    read.apply(7, &mut data).unwrap();
    assert_eq!(data.qpos(), trajectory.qpos(7));
    let value = to_value(&trajectory).unwrap();
    assert_eq!((&value["nq"], &value["nu"], value["times"].as_array().unwrap().len()), (&json!(2), &json!(1), 20));
}

#[test]
fn a_trajectory_of_inconsistent_sizes_is_rejected() {
    let (_, trajectory) = trajectory();
    let good = to_value(&trajectory).unwrap();
    for (field, value, expected) in [
        ("nq", json!(3), "has 80 values in 'states'"),
        ("nu", json!(2), "has 20 values in 'controls'"),
        ("nq", json!(u64::MAX), "which no model has"),
        ("nv", json!(u64::MAX - 1), "which no model has"),
        ("nq", json!(u64::MAX / 4), "which no model has"),
        ("nu", json!(u64::MAX / 2), "which no model has"),
        ("na", json!(1 << 20), "has 80 values in 'states'"),
        ("nq", json!(-1), "expected usize"),
        ("times", json!([0.0]), "of 1 records"),
        ("times", json!([]), "of 0 records"),
        ("controls", json!([1.0, 2.0]), "has 2 values in 'controls'"),
        ("states", json!(null), "expected"),
        ("nsensordata", json!(1), "has 0 values in 'sensordata'"),
        ("nsensordata", json!(u64::MAX), "which no model has"),
        ("sensordata", json!([1.0]), "has 1 values in 'sensordata'"),
        ("other", json!(1), "unknown field"),
    ] {
        let mut invalid = good.clone();
        invalid[field] = value.clone();
        let text = error::<Trajectory>(invalid);
        assert!(text.contains(expected), "{field} = {value}: {text}");
    }
}

#[test]
fn a_matrix_of_inconsistent_size_is_rejected() {
    let matrix = Matrix::from_rows(&[[1.0, -0.0, 3.0], [1e-300, 0.1, f64::MAX]]);
    let value = to_value(&matrix).unwrap();
    assert_eq!(value, json!({"nrows": 2, "ncols": 3, "values": [1.0, -0.0, 3.0, 1e-300, 0.1, f64::MAX]}));
    assert_eq!(to_value(matrix.view()).unwrap(), value);
    assert_eq!(from_str::<Matrix>(&to_string(&matrix).unwrap()).unwrap(), matrix);
    assert_eq!(from_value::<Matrix>(json!({"nrows": 0, "ncols": 5, "values": []})).unwrap().shape(), (0, 5));
    for (nrows, ncols) in [(3, 3), (2, 2), (u64::MAX, u64::MAX), (1 << 63, 2), (0, 0)] {
        let text = error::<Matrix>(json!({"nrows": nrows, "ncols": ncols, "values": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]}));
        assert!(text.contains("has 6 values"), "{text}");
    }
}

#[test]
fn sizes_without_values_are_bounded() {
    let empty = to_value(Trajectory::new(&sample::cartpole())).unwrap();
    for (field, size) in [("nq", u64::MAX), ("nu", 1 << 61), ("na", 1 << 27), ("nv", (1 << 20) + 1)] {
        let mut claimed = empty.clone();
        claimed[field] = json!(size);
        assert!(error::<Trajectory>(claimed).contains("which no model has"), "{field}");
    }
    for (nrows, ncols) in [(u64::MAX, 0), (0, u64::MAX), ((1 << 20) + 1, 0)] {
        let text = error::<Matrix>(json!({"nrows": nrows, "ncols": ncols, "values": []}));
        assert!(text.contains("a matrix without values"), "{text}");
    }
    assert_eq!(from_value::<Matrix>(json!({"nrows": 1 << 20, "ncols": 0, "values": []})).unwrap().nrows(), 1 << 20);
}

#[test]
fn structs_with_public_fields_round_trip() {
    let (mut data, _) = trajectory();
    let system = data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!(from_str::<StateSpace>(&to_string(&system).unwrap()).unwrap(), system);
    let force = ContactForce { force: [1.0, 2.0, 3.0], torque: [4.0, 5.0, 6.0] };
    assert_eq!(to_value(force).unwrap(), json!({"force": [1.0, 2.0, 3.0], "torque": [4.0, 5.0, 6.0]}));
    assert_eq!(from_value::<ContactForce>(to_value(force).unwrap()).unwrap(), force);
    let count: WarningCount = from_value(json!({"number": 2, "lastinfo": -1})).unwrap();
    assert_eq!((count.number, count.lastinfo), (2, -1));
}

#[test]
fn state_specs_are_serialised_by_name() {
    let spec = StateSpec::QPOS | StateSpec::CTRL;
    assert_eq!(to_value(spec).unwrap(), json!("QPOS | CTRL"));
    assert_eq!(from_value::<StateSpec>(json!("QPOS | CTRL")).unwrap(), spec);
    assert!(error::<StateSpec>(json!("QPOS | NOTHING")).contains("unrecognized named flag"));
    assert!(error::<StateSpec>(json!("0x80000000")).contains("0x80000000"));
}
