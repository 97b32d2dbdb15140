//! Recording, CSV files and replay.

use mujoco_safe::{Data, Error, StateSpec, Trajectory};
use proptest::prelude::*;

use crate::arbitrary::{BALL, CARTPOLE, any_model, any_number, bits};

/// Returns the path of a temporary file, which is removed on drop.
fn csv_path() -> tempfile::TempPath {
    tempfile::NamedTempFile::new().unwrap().into_temp_path()
}

/// Returns the bits that a file preserves: all, except for the sign and the payload of a NaN.
fn kept(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_trajectory_round_trips_through_csv_bit_for_bit(
        model in any_model(),
        records in 0..4_usize,
        numbers in prop::collection::vec(any_number(), 300),
    ) {
        let mut data = Data::new(model.clone()).unwrap();
        let mut trajectory = Trajectory::new(&model);
        let mut numbers = numbers.iter().copied().cycle();
        let spec = StateSpec::FULL_PHYSICS | StateSpec::CTRL;
        for _ in 0..records {
            let state: Vec<f64> = numbers.by_ref().take(model.state_size(spec)).collect();
            data.set_state(spec, &state).unwrap();
            trajectory.push(&data).unwrap();
        }
        let path = csv_path();
        trajectory.save_csv(&path).unwrap();
        let again = Trajectory::load_csv(&model, &path).unwrap();
        prop_assert_eq!(again.len(), records);
        prop_assert_eq!(kept(again.times()), kept(trajectory.times()));
        prop_assert_eq!(kept(again.states()), kept(trajectory.states()));
        prop_assert_eq!(kept(again.controls()), kept(trajectory.controls()));
    }
}

#[test]
fn a_csv_file_has_a_header_and_a_line_per_record() {
    let mut data = Data::new(CARTPOLE.clone()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.25;
    trajectory.record(&mut data, &mut push, 2).unwrap();
    let path = csv_path();
    trajectory.save_csv(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "time,qpos0,qpos1,qvel0,qvel1,ctrl0");
    assert_eq!(lines[1], "0,0,0,0,0,0.25");
    assert_eq!((lines.len(), lines[2].split(',').count()), (3, 6));
}

#[test]
fn each_nan_is_nan_in_csv() {
    let mut data = Data::new(CARTPOLE.clone()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    let patterns = [0x7ff8_0000_0000_0000, 0xfff8_0000_0000_0000, 0x7ff8_0000_0000_1234, 0x7ff0_0000_0000_0001];
    for bits in patterns {
        data.qpos_mut()[0] = f64::from_bits(bits);
        trajectory.push(&data).unwrap();
    }
    let path = csv_path();
    trajectory.save_csv(&path).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap().matches(",NaN,").count(), patterns.len());
    let again = Trajectory::load_csv(data.model(), &path).unwrap();
    for record in 0..patterns.len() {
        assert!(again.qpos(record)[0].to_bits() == f64::NAN.to_bits() && again.qpos(record)[1] == 0.0);
    }
}

#[test]
fn a_malformed_csv_file_is_an_error_that_names_the_line() {
    let header = "time,qpos0,qpos1,qvel0,qvel1,ctrl0\n";
    for (text, expected) in [
        (String::new(), "line 1 is not the header"),
        ("time,qpos0\n0,0\n".to_owned(), "line 1 is not the header"),
        (format!("{header}0,0,0,0,0,0\n0,0,zero,0,0,0\n"), "line 3: 'zero' is not a number"),
        (format!("{header}0,0,0,0,0\n"), "line 2 has 5 columns, not 6"),
        (format!("{header}0,0,0,0,0,0,0\n"), "line 2 has 7 columns, not 6"),
    ] {
        let path = csv_path();
        std::fs::write(&path, text).unwrap();
        let error = Trajectory::load_csv(&CARTPOLE, &path).unwrap_err();
        assert!(matches!(error, Error::File { .. }) && error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn a_line_without_end_is_an_error_before_it_fills_the_memory() {
    let path = csv_path();
    Trajectory::new(&CARTPOLE).save_csv(&path).unwrap();
    let header = std::fs::read(&path).unwrap();
    for (number, text) in [(1, &[][..]), (2, &header)] {
        std::fs::write(&path, text).unwrap();
        // A sparse file, whose zeros are a line without end.
        std::fs::File::options().write(true).open(&path).unwrap().set_len(1 << 40).unwrap();
        let error = Trajectory::load_csv(&CARTPOLE, &path).unwrap_err().to_string();
        assert!(error.contains(&format!("line {number} has more than")), "{error}");
    }
}

#[test]
fn a_simulation_continues_from_an_applied_record() {
    let mut data = Data::new(CARTPOLE.clone()).unwrap();
    data.qpos_mut()[1] = 0.2;
    let mut trajectory = Trajectory::with_capacity(data.model(), 20);
    let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.1 * data.time();
    trajectory.record(&mut data, &mut push, 20).unwrap();
    let mut other = Data::new(CARTPOLE.clone()).unwrap();
    trajectory.apply(7, &mut other).unwrap();
    assert_eq!(bits(&other.physics_state()), bits(trajectory.state(7)));
    assert_eq!(bits(other.ctrl()), bits(trajectory.ctrl(7)));
    assert_eq!(other.time().to_bits(), trajectory.times()[7].to_bits());
    other.step().unwrap();
    assert_eq!(bits(&other.physics_state()), bits(trajectory.state(8)));
    assert!(trajectory.apply(0, &mut Data::new(BALL.clone()).unwrap()).is_err());
    assert!(trajectory.push(&Data::new(BALL.clone()).unwrap()).is_err());
    assert_eq!(trajectory.len(), 20);
}

#[test]
fn without_actuators_a_trajectory_has_no_controls() {
    let mut data = Data::new(BALL.clone()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    let mut nothing = |_: &mut Data| ();
    trajectory.record(&mut data, &mut nothing, 3).unwrap();
    assert_eq!((trajectory.len(), trajectory.states().len(), trajectory.controls().len()), (3, 39, 0));
    assert!(trajectory.ctrl(2).is_empty());
}
