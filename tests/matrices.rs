//! Row-major matrices and what is laid out in vectors: matrices against nalgebra, matrices without rows or columns, states,
//! positions, and trajectories written to a file and read back.
//!
//! Properties hold for all inputs, so they are tried on random ones (proptest). "Bit for bit" means what it says: −0, subnormal
//! numbers, infinities and NaN included.

use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

use mujoco_safe::{
    Data, Differences, Error, Matrix, Model, StateSpace, StateSpec, Trajectory, TransitionOutputs, sample,
};
use nalgebra::DMatrix;
use proptest::prelude::*;

static ZOO: LazyLock<Arc<Model>> =
    LazyLock::new(|| Arc::new(Model::from_xml_str(include_str!("models/zoo.xml")).expect("the zoo loads")));
static HUMANOID: LazyLock<Arc<Model>> = LazyLock::new(|| Arc::new(sample::humanoid()));
static CARTPOLE: LazyLock<Arc<Model>> = LazyLock::new(|| Arc::new(sample::cartpole()));
/// Something that moves, without actuators or sensors.
static BALL: LazyLock<Arc<Model>> = LazyLock::new(|| {
    let xml = r#"<mujoco><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>"#;
    Arc::new(Model::from_xml_str(xml).expect("a ball"))
});
/// Nothing that moves.
static ROCK: LazyLock<Arc<Model>> = LazyLock::new(|| {
    let xml = r#"<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>"#;
    Arc::new(Model::from_xml_str(xml).expect("a rock"))
});

fn any_model() -> impl Strategy<Value = Arc<Model>> {
    prop::sample::select(vec![&ZOO, &HUMANOID, &CARTPOLE, &BALL, &ROCK]).prop_map(|model| (**model).clone())
}

/// Any double at all, with the odd ones often.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        prop::num::f64::NORMAL,
        prop::sample::select(vec![0.0, -0.0, f64::MIN_POSITIVE, 5e-324, -5e-324, f64::MAX, f64::MIN, 0.1, 1e23, 9e15]),
    ]
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Rows and columns from none to six, and as many numbers.
fn any_matrix() -> impl Strategy<Value = (usize, usize, Vec<f64>)> {
    (0..7_usize, 0..7_usize).prop_flat_map(|(rows, columns)| {
        (Just(rows), Just(columns), prop::collection::vec(any_number(), rows * columns))
    })
}

proptest! {
    #[test]
    fn a_matrix_has_its_values_row_by_row((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values.clone());
        prop_assert_eq!(matrix.shape(), (rows, columns));
        prop_assert_eq!(bits(matrix.as_slice()), bits(&values));
        for row in 0..rows {
            prop_assert_eq!(bits(matrix.row(row)), bits(&values[row * columns..(row + 1) * columns]));
            for column in 0..columns {
                prop_assert_eq!(matrix[(row, column)].to_bits(), values[row * columns + column].to_bits());
                prop_assert_eq!(matrix.view()[(row, column)].to_bits(), values[row * columns + column].to_bits());
            }
        }
    }

    #[test]
    fn nalgebra_sees_each_value_in_its_place((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values);
        let (copy, transposed) = (matrix.to_nalgebra(), matrix.transposed());
        prop_assert_eq!((copy.shape(), transposed.shape()), ((rows, columns), (columns, rows)));
        for row in 0..rows {
            for column in 0..columns {
                prop_assert_eq!(copy[(row, column)].to_bits(), matrix[(row, column)].to_bits());
                prop_assert_eq!(transposed[(column, row)].to_bits(), matrix[(row, column)].to_bits());
            }
        }
    }

    #[test]
    fn to_nalgebra_and_back_is_the_same_matrix((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values.clone());
        prop_assert_eq!(bits(Matrix::from(&matrix.to_nalgebra()).as_slice()), bits(&values));
        prop_assert_eq!(Matrix::from(&matrix.to_nalgebra()).shape(), (rows, columns));
        prop_assert_eq!(bits(matrix.view().to_matrix().as_slice()), bits(&values));
        let again = Matrix::from_transposed(matrix.into_transposed());
        prop_assert_eq!((again.shape(), bits(again.as_slice())), ((rows, columns), bits(&values)));
    }

    #[test]
    fn writing_through_the_transpose_writes_to_the_matrix((rows, columns, values) in any_matrix()) {
        let mut matrix = Matrix::zeros(rows, columns);
        matrix.transposed_mut().copy_from(&DMatrix::from_column_slice(columns, rows, &values));
        prop_assert_eq!(bits(matrix.as_slice()), bits(&values));
    }

    #[test]
    fn the_transpose_multiplies_as_the_matrix_without_a_copy(
        (rows, columns, values) in any_matrix(),
        vector in prop::collection::vec(-1e3..1e3_f64, 7),
    ) {
        // Moderate numbers, so that the order of a sum does not matter.
        let values: Vec<f64> = values.iter().map(|value| if value.abs() < 1e3 { *value } else { 1.0 }).collect();
        let matrix = Matrix::from_row_major(rows, columns, values);
        let vector = nalgebra::DVector::from_column_slice(&vector[..columns]);
        let product = matrix.transposed().tr_mul(&vector);
        prop_assert_eq!(product.len(), rows);
        for row in 0..rows {
            let expected: f64 = matrix.row(row).iter().zip(vector.iter()).map(|(a, b)| a * b).sum();
            prop_assert!((product[row] - expected).abs() <= 1e-6, "{} and {}", product[row], expected);
        }
    }
}

mod shapes {
    use super::*;

    #[test]
    #[should_panic(expected = "needs 6 values, not 5")]
    fn values_that_do_not_fill_the_shape_panic() {
        let _ = Matrix::from_row_major(2, 3, vec![0.0; 5]);
    }

    #[test]
    #[should_panic(expected = "row 2 of a matrix with 2 rows")]
    fn a_row_beyond_the_last_panics() {
        let _ = Matrix::zeros(2, 3).row(2);
    }

    #[test]
    #[should_panic(expected = "row 0 of a matrix with 0 rows")]
    fn a_matrix_without_rows_has_no_row_0() {
        let _ = Matrix::zeros(0, 3).row(0);
    }

    #[test]
    #[should_panic(expected = "index out of bounds")]
    fn a_column_beyond_the_last_is_not_the_next_row() {
        let _ = Matrix::zeros(2, 3)[(0, 3)];
    }

    #[test]
    fn a_matrix_without_columns_has_rows_without_values() {
        let matrix = Matrix::zeros(3, 0);
        assert_eq!((matrix.row(2), matrix.as_slice(), matrix.shape()), (&[][..], &[][..], (3, 0)));
        assert_eq!(matrix.transposed().shape(), (0, 3));
        assert_eq!(matrix.to_nalgebra().shape(), (3, 0));
        assert_eq!(Matrix::from_rows::<0>(&[[], []]).shape(), (2, 0));
        assert_eq!(Matrix::default().shape(), (0, 0));
    }

    #[test]
    fn a_matrix_is_printed_row_by_row() {
        let matrix = Matrix::from_rows(&[[1.0, 2.5], [-3.0, 0.0]]);
        assert_eq!(format!("{matrix:?}"), "[[1.0, 2.5], [-3.0, 0.0]]");
        assert_eq!(format!("{:?}", matrix.view()), "[[1.0, 2.5], [-3.0, 0.0]]");
        assert_eq!(format!("{:?}", Matrix::zeros(0, 2)), "[]");
    }

    #[test]
    fn matrices_of_another_shape_are_not_written_to() {
        let mut data = Data::new(HUMANOID.clone()).expect("there is memory");
        data.forward().expect("forward dynamics");
        let torso = data.model().body("torso").expect("there is a torso").id();
        let nv = data.model().nv();
        for (rows, columns) in [(nv, 3), (3, nv - 1), (3, nv + 1), (2, nv), (1, 3 * nv), (0, 0)] {
            let mut wrong = Matrix::zeros(rows, columns);
            for result in [
                data.jac_body_into(torso, Some(&mut wrong), None),
                data.jac_body_into(torso, None, Some(&mut wrong)),
                data.jac_subtree_com_into(torso, &mut wrong),
            ] {
                let error = result.expect_err("a wrong shape");
                assert!(
                    matches!(error, Error::Shape { expected, found, .. } if expected == (3, nv) && found == (rows, columns)),
                    "{error}"
                );
            }
            assert!(wrong.as_slice().iter().all(|value| *value == 0.0));
        }
        assert!(matches!(data.full_m_into(&mut Matrix::zeros(nv, nv + 1)), Err(Error::Shape { .. })));
    }
}

mod models_that_lack_something {
    use super::*;

    #[test]
    fn without_actuators_b_and_d_have_rows_and_no_columns() {
        let mut data = Data::new(BALL.clone()).expect("there is memory");
        let StateSpace { a, b, c, d } = data.transition_fd(1e-6, Differences::Central).expect("a linearisation");
        assert_eq!([a.shape(), b.shape(), c.shape(), d.shape()], [(12, 12), (12, 0), (0, 12), (0, 0)]);
        // A free body: its velocity stays, and moves it by the time step.
        assert!((a[(0, 6)] - 0.002).abs() < 1e-9 && (a[(6, 6)] - 1.0).abs() < 1e-9, "{a:?}");
        assert_eq!(b.to_nalgebra().shape(), (12, 0));
    }

    #[test]
    fn without_joints_everything_is_empty_and_nothing_fails() {
        let mut data = Data::new(ROCK.clone()).expect("there is memory");
        let model = data.model().clone();
        data.step().expect("a step");
        data.forward().expect("forward dynamics");
        data.inverse().expect("inverse dynamics");
        assert_eq!((model.nq(), model.nv(), model.nu()), (0, 0, 0));
        assert!(data.qpos().is_empty() && data.qvel_mut().is_empty() && data.physics_state().is_empty());
        assert_eq!(data.full_m().expect("computed").shape(), (0, 0));
        data.mul_m(&mut [], &[]).expect("no numbers");
        data.solve_m(&mut [], &[]).expect("no numbers");
        model.integrate_pos(&mut [], &[], 1.0).expect("no numbers");
        model.differentiate_pos(&mut [], 1.0, &[], &[]).expect("no numbers");
        let jacobian = data.jac_body(model.body("world").expect("there is a world")).expect("computed");
        assert_eq!(jacobian.translation.shape(), (3, 0));
        assert_eq!(data.contacts().len(), 0);
        assert_eq!((model.joints().len(), model.keyframes().len()), (0, 0));
    }

    #[test]
    fn without_joints_a_linearisation_has_no_states() {
        let mut data = Data::new(ROCK.clone()).expect("there is memory");
        let StateSpace { a, b, c, d } = data.transition_fd(1e-6, Differences::Forward).expect("a linearisation");
        assert_eq!([a.shape(), b.shape(), c.shape(), d.shape()], [(0, 0); 4]);
    }

    #[test]
    fn without_actuators_a_trajectory_has_no_controls() {
        let mut data = Data::new(BALL.clone()).expect("there is memory");
        let mut trajectory = Trajectory::new(data.model());
        let mut nothing = |_: &mut Data| ();
        trajectory.record(&mut data, &mut nothing, 3).expect("three steps");
        assert_eq!((trajectory.len(), trajectory.states().len(), trajectory.controls().len()), (3, 39, 0));
        assert!(trajectory.ctrl(2).is_empty());
    }

    #[test]
    fn no_output_at_all_is_no_error() {
        let mut data = Data::new(ZOO.clone()).expect("there is memory");
        data.transition_fd_into(1e-6, Differences::Forward, TransitionOutputs::default()).expect("nothing to do");
    }
}

fn all_parts() -> impl Strategy<Value = StateSpec> {
    any::<u32>().prop_map(StateSpec::from_bits_truncate)
}

/// Numbers for a model's whole state.
fn any_numbers() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(any_number(), 300)
}

/// The numbers of the whole state, each array by itself, as the engine's documentation orders them.
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
    fn a_state_that_was_set_is_read_back_bit_for_bit(model in any_model(), spec in all_parts(), numbers in any_numbers()) {
        let mut data = Data::new(model.clone()).expect("there is memory");
        let before = parts(&data);
        let state: Vec<f64> = numbers.iter().copied().cycle().take(model.state_size(spec)).collect();
        data.set_state(spec, &state).expect("the length is right");
        prop_assert_eq!(bits(&data.state(spec)), bits(&state));
        let mut again = vec![0.0; state.len()];
        data.state_into(spec, &mut again).expect("the length is right");
        prop_assert_eq!(bits(&again), bits(&state));

        // The parts that are meant lie one behind another; the others are as they were.
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
    fn a_state_of_another_length_is_refused_and_changes_nothing(model in any_model(), spec in all_parts(), more in 1..5_usize) {
        let mut data = Data::new(model.clone()).expect("there is memory");
        let before = data.state(StateSpec::all());
        let size = model.state_size(spec);
        for wrong in [Some(size + more), size.checked_sub(more)].into_iter().flatten() {
            let refused = matches!(data.set_state(spec, &vec![1.0; wrong]), Err(Error::Shape { .. }));
            prop_assert!(refused, "{} numbers for {}", wrong, size);
            prop_assert!(data.state_into(spec, &mut vec![1.0; wrong]).is_err());
        }
        prop_assert_eq!(bits(&data.state(StateSpec::all())), bits(&before));
    }

    #[test]
    fn the_difference_undoes_the_sum_of_positions(
        model in any_model(),
        velocities in prop::collection::vec(-1.0..1.0_f64, 40),
        turns in prop::collection::vec(-1.0..1.0_f64, 40),
        dt in prop_oneof![0.01..1.5_f64, -1.5..-0.01_f64],
    ) {
        let nv = model.nv();
        // From a position that is turned, so that quaternions are general.
        let mut from = model.qpos0().to_vec();
        model.integrate_pos(&mut from, &turns[..nv], 1.0).expect("the lengths are right");
        let mut to = from.clone();
        model.integrate_pos(&mut to, &velocities[..nv], dt).expect("the lengths are right");
        let mut found = vec![0.0; nv];
        // Rotations stay below half a turn: |velocity| ≤ √3, |dt| ≤ 1.5.
        model.differentiate_pos(&mut found, dt, &from, &to).expect("the lengths are right");
        for (found, expected) in found.iter().zip(&velocities) {
            prop_assert!((found - expected).abs() < 1e-9 / dt.abs(), "{} and {}", found, expected);
        }
    }

    #[test]
    fn the_sum_undoes_the_difference_of_positions(
        model in any_model(),
        first in prop::collection::vec(-1.5..1.5_f64, 40),
        second in prop::collection::vec(-1.5..1.5_f64, 40),
    ) {
        let nv = model.nv();
        let [from, to] = [first, second].map(|turns| {
            let mut qpos = model.qpos0().to_vec();
            model.integrate_pos(&mut qpos, &turns[..nv], 1.0).expect("the lengths are right");
            qpos
        });
        let (mut velocity, mut arrived) = (vec![0.0; nv], from.clone());
        model.differentiate_pos(&mut velocity, 2.0, &from, &to).expect("the lengths are right");
        model.integrate_pos(&mut arrived, &velocity, 2.0).expect("the lengths are right");
        for joint in model.joints() {
            // A quaternion and its negative are the same orientation.
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

/// A file of this test's own, removed at its end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
        Self(folder.join(format!("{name}-{}.csv", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Any number that a file must keep. A NaN is kept as a NaN, but not with its sign and payload, which no text has.
fn any_recorded_number() -> impl Strategy<Value = f64> {
    any_number().prop_filter("a number", |value| !value.is_nan())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_trajectory_is_read_back_from_its_file_bit_for_bit(
        model in any_model(),
        records in 0..4_usize,
        numbers in prop::collection::vec(any_recorded_number(), 300),
    ) {
        let mut data = Data::new(model.clone()).expect("there is memory");
        let mut trajectory = Trajectory::new(&model);
        let mut numbers = numbers.iter().copied().cycle();
        let spec = StateSpec::FULL_PHYSICS | StateSpec::CTRL;
        for _ in 0..records {
            let state: Vec<f64> = numbers.by_ref().take(model.state_size(spec)).collect();
            data.set_state(spec, &state).expect("the length is right");
            trajectory.push(&data).expect("the model is the same");
        }
        let file = Scratch::new("any");
        trajectory.save_csv(&file.0).expect("the file can be written");
        let again = Trajectory::load_csv(&model, &file.0).expect("the file can be read");
        prop_assert_eq!(again.len(), records);
        prop_assert_eq!(bits(again.times()), bits(trajectory.times()));
        prop_assert_eq!(bits(again.states()), bits(trajectory.states()));
        prop_assert_eq!(bits(again.controls()), bits(trajectory.controls()));
    }
}

mod trajectories {
    use super::*;

    #[test]
    fn the_file_has_a_header_and_a_line_for_each_record() {
        let mut data = Data::new(CARTPOLE.clone()).expect("there is memory");
        let mut trajectory = Trajectory::new(data.model());
        let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.25;
        trajectory.record(&mut data, &mut push, 2).expect("two steps");
        let file = Scratch::new("header");
        trajectory.save_csv(&file.0).expect("the file can be written");
        let text = std::fs::read_to_string(&file.0).expect("the file can be read");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "time,qpos0,qpos1,qvel0,qvel1,ctrl0");
        assert_eq!(lines[1], "0,0,0,0,0,0.25");
        assert_eq!((lines.len(), lines[2].split(',').count()), (3, 6));
    }

    #[test]
    fn a_nan_is_read_back_as_one() {
        let mut data = Data::new(CARTPOLE.clone()).expect("there is memory");
        data.qpos_mut()[0] = f64::NAN;
        let mut trajectory = Trajectory::new(data.model());
        trajectory.push(&data).expect("the model is the same");
        let file = Scratch::new("nan");
        trajectory.save_csv(&file.0).expect("the file can be written");
        let again = Trajectory::load_csv(data.model(), &file.0).expect("the file can be read");
        assert!(again.qpos(0)[0].is_nan() && again.qpos(0)[1] == 0.0);
    }

    #[test]
    fn a_file_that_is_none_of_this_model_names_the_line() {
        let header = "time,qpos0,qpos1,qvel0,qvel1,ctrl0\n";
        for (text, expected) in [
            (String::new(), "line 1 is not the header"),
            ("time,qpos0\n0,0\n".to_owned(), "line 1 is not the header"),
            (format!("{header}0,0,0,0,0,0\n0,0,zero,0,0,0\n"), "line 3: 'zero' is not a number"),
            (format!("{header}0,0,0,0,0\n"), "line 2 has 5 columns, not 6"),
            (format!("{header}0,0,0,0,0,0,0\n"), "line 2 has 7 columns, not 6"),
        ] {
            let file = Scratch::new("wrong");
            std::fs::write(&file.0, text).expect("the file can be written");
            let error = Trajectory::load_csv(&CARTPOLE, &file.0).expect_err("a wrong file");
            assert!(matches!(error, Error::File { .. }) && error.to_string().contains(expected), "{error}");
        }
    }

    #[test]
    fn applying_a_record_goes_on_from_there() {
        let mut data = Data::new(CARTPOLE.clone()).expect("there is memory");
        data.qpos_mut()[1] = 0.2;
        let mut trajectory = Trajectory::with_capacity(data.model(), 20);
        let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.1 * data.time();
        trajectory.record(&mut data, &mut push, 20).expect("twenty steps");
        let mut other = Data::new(CARTPOLE.clone()).expect("there is memory");
        trajectory.apply(7, &mut other).expect("the model is the same");
        assert_eq!(bits(&other.physics_state()), bits(trajectory.state(7)));
        assert_eq!(bits(other.ctrl()), bits(trajectory.ctrl(7)));
        assert_eq!(other.time().to_bits(), trajectory.times()[7].to_bits());
        other.step().expect("a step");
        assert_eq!(bits(&other.physics_state()), bits(trajectory.state(8)));
        assert!(trajectory.apply(0, &mut Data::new(BALL.clone()).expect("there is memory")).is_err());
        assert!(trajectory.push(&Data::new(BALL.clone()).expect("there is memory")).is_err());
        assert_eq!(trajectory.len(), 20);
    }
}
