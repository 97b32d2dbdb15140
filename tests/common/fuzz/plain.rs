//! Damaged plain data: settings, trajectories and matrices in JSON, and trajectories in CSV.

use mujoco_safe::{Data, Trajectory};

use super::archive::{trajectory, use_trajectory};
use super::{Bytes, Verdict, models};

pub(super) fn mutated_plain(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    if cfg!(not(feature = "serde")) || bytes.once_in(4) {
        return mutated_csv(bytes, log);
    }
    #[cfg(feature = "serde")]
    return json::mutated_json(bytes, log);
    #[cfg(not(feature = "serde"))]
    Verdict::Rejected
}

/// Unexpected words.
const WORDS: [&str; 24] = [
    "",
    " ",
    "0",
    "-1",
    "1e400",
    "-1e400",
    "1e-400",
    "NaN",
    "nan",
    "inf",
    "-inf",
    "null",
    "true",
    "18446744073709551615",
    "18446744073709551616",
    "9223372036854775807",
    "4611686018427387904",
    "2147483648",
    "0.1",
    "[",
    "{",
    "\"",
    ",",
    "\n",
];

/// Damages a part of a text.
fn damage(text: &mut String, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) {
    let boundary =
        |text: &str, at: usize| (at..=text.len()).find(|&at| text.is_char_boundary(at)).unwrap_or(text.len());
    let at = boundary(text, bytes.below(text.len() + 1));
    let end = boundary(text, (at + bytes.below(24)).min(text.len()));
    let kind = bytes.below(6);
    log(&format!("damage {kind} of bytes {at} to {end}"));
    match kind {
        0 => text.truncate(at),
        1 => text.replace_range(at..end, ""),
        2 => {
            let copy = text[at..end].to_owned();
            text.insert_str(at, &copy);
        }
        3 => text.insert_str(at, &bytes.choose(&WORDS).repeat(1 + bytes.below(3))),
        4 => text.insert_str(at, &"[".repeat(1 << bytes.below(12))),
        _ => {
            // Replaces a number by another word.
            let is_number = |byte: u8| byte.is_ascii_digit() || b".-+e".contains(&byte);
            let start = text.as_bytes()[at..].iter().position(|&byte| is_number(byte)).map_or(at, |length| at + length);
            let length = text.as_bytes()[start..].iter().take_while(|&&byte| is_number(byte)).count();
            text.replace_range(start..start + length, bytes.choose(&WORDS));
        }
    }
}

fn mutated_csv(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let model = models::model(models::choose(bytes));
    let Ok(mut data) = Data::new(model.clone()) else { return Verdict::Rejected };
    let folder = tempfile::tempdir().expect("no temporary folder");
    let path = folder.path().join("trajectory.csv");
    trajectory(&mut data, bytes).save_csv(&path).expect("a file is written");
    let mut text = std::fs::read_to_string(&path).expect("a written file");
    for _ in 0..bytes.below(3) {
        damage(&mut text, bytes, log);
    }
    std::fs::write(&path, text).expect("a file is written");
    log("load_csv");
    let Ok(loaded) = Trajectory::load_csv(model, &path) else { return Verdict::Rejected };
    let _ = data.reset();
    use_trajectory(&loaded, &mut data, log);
    Verdict::Worked
}

#[cfg(feature = "serde")]
mod json {
    use std::hint::black_box;

    use mujoco_safe::data::WarningCount;
    use mujoco_safe::model::{Statistics, Visual};
    use mujoco_safe::{Data, Differences, Matrix, Options, StateSpace, StateSpec, Trajectory};
    use serde::Serialize;
    use serde::de::DeserializeOwned;
    use serde_json::{Value, json};

    use super::{Bytes, Verdict, damage, models, trajectory, use_trajectory};

    /// Largest number of solver iterations. Larger values are valid, but slow.
    const MOST_ITERATIONS: usize = 50;

    pub(super) fn mutated_json(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
        let model = models::model(models::choose(bytes));
        let Ok(mut data) = Data::new(model.clone()) else { return Verdict::Rejected };
        let worked = match bytes.below(8) {
            0 => loaded(&model.options(), bytes, log).map(|mut options: Options| {
                options.iterations = options.iterations.min(MOST_ITERATIONS);
                options.noslip_iterations = options.noslip_iterations.min(MOST_ITERATIONS);
                options.mpr_iterations = options.mpr_iterations.min(MOST_ITERATIONS);
                let _ = data.edit_model(|model| model.edit_options(|own| *own = options));
            }),
            1 => loaded(&model.visual(), bytes, log).map(|visual: Visual| {
                let _ = data.edit_model(|model| model.edit_visual(|own| *own = visual));
            }),
            2 => loaded(&model.statistics(), bytes, log).map(|statistics: Statistics| {
                let _ = data.edit_model(|model| model.edit_statistics(|own| *own = statistics));
            }),
            3 | 4 => {
                let trajectory = trajectory(&mut data, bytes);
                let _ = data.reset();
                loaded(&trajectory, bytes, log)
                    .map(|trajectory: Trajectory| use_trajectory(&trajectory, &mut data, log))
            }
            5 => {
                let (rows, columns) = (bytes.below(5), bytes.below(5));
                let matrix = Matrix::from_row_major(rows, columns, vec![bytes.number(); rows * columns]);
                loaded(&matrix, bytes, log).map(|matrix: Matrix| use_matrix(&matrix))
            }
            6 => {
                let spec = StateSpec::from_bits_truncate(bytes.word() as _);
                loaded(&spec, bytes, log).map(|spec: StateSpec| {
                    let state = data.state(spec);
                    assert_eq!(state.len(), data.model().state_size(spec));
                    let _ = data.set_state(spec, &state);
                })
            }
            _ if model.nv() <= 4 => {
                let system =
                    data.transition_fd(1e-6, Differences::Forward).unwrap_or_else(|_| StateSpace::zeros(model));
                let _ = loaded::<_, WarningCount>(&json!({"number": 1, "lastinfo": -1}), bytes, log);
                loaded(&system, bytes, log).map(|system: StateSpace| {
                    [&system.a, &system.b, &system.c, &system.d].into_iter().for_each(use_matrix);
                    let weights = mujoco_safe::LqrWeights::diagonal(&[1.0; 4], &[1.0]);
                    let _ = black_box(mujoco_safe::Lqr::solve(&system, &weights));
                })
            }
            _ => None,
        };
        if worked.is_none() {
            return Verdict::Rejected;
        }
        log("steps");
        for _ in 0..2 {
            if data.step().is_err() && data.reset().is_err() {
                break;
            }
        }
        Verdict::Worked
    }

    fn use_matrix(matrix: &Matrix) {
        assert_eq!(matrix.rows().len(), matrix.nrows());
        black_box(matrix.transposed().sum());
        black_box(matrix.to_nalgebra().transpose());
        black_box(matrix.rows().map(|row| row.iter().sum::<f64>()).sum::<f64>());
    }

    /// Writes a value, damages the text, and reads it. An accepted value must round-trip.
    fn loaded<T: Serialize, U: DeserializeOwned + Serialize>(
        value: &T,
        bytes: &mut Bytes<'_>,
        log: &mut dyn FnMut(&str),
    ) -> Option<U> {
        let mut value = serde_json::to_value(value).expect("a value is written");
        if !bytes.once_in(3) {
            for _ in 0..=bytes.below(2) {
                damage_value(&mut value, bytes, log);
            }
        }
        let mut text = value.to_string();
        if bytes.once_in(3) {
            damage(&mut text, bytes, log);
        }
        log(std::any::type_name::<U>());
        let read: U = serde_json::from_str(&text).ok()?;
        let text = serde_json::to_string(&read).expect("a value that was read can be written");
        // JSON cannot represent infinite numbers or NaN.
        if !text.contains("null") {
            let again: U = serde_json::from_str(&text).expect("a value that was written can be read");
            assert_eq!(serde_json::to_string(&again).expect("a serialisable value"), text);
        }
        Some(read)
    }

    /// Changes a value in a tree.
    fn damage_value(value: &mut Value, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) {
        let stop = bytes.once_in(4);
        match value {
            Value::Object(map) if !map.is_empty() && !stop => {
                let key = map.keys().nth(bytes.below(map.len())).expect("a key").clone();
                match bytes.below(12) {
                    0 => drop(map.remove(&key)),
                    1 => drop(map.insert(key + "x", Value::Null)),
                    _ => damage_value(&mut map[&key], bytes, log),
                }
            }
            Value::Array(values) if !values.is_empty() && !stop => match bytes.below(6) {
                0 => values.truncate(bytes.below(values.len())),
                1 => values.extend(std::iter::repeat_n(json!(bytes.number()), 1 + bytes.below(100))),
                _ => {
                    let index = bytes.below(values.len());
                    damage_value(&mut values[index], bytes, log);
                }
            },
            _ => {
                *value = other(bytes);
                log(&format!("a value becomes {value}"));
            }
        }
    }

    fn other(bytes: &mut Bytes<'_>) -> Value {
        match bytes.below(12) {
            0 => Value::Null,
            1 => json!(true),
            2 => json!([]),
            3 => json!({}),
            4 => json!("Newton"),
            5 => json!("QPOS | QVEL"),
            6 => json!(u64::MAX - bytes.below(2) as u64),
            7 => json!(1_u64 << bytes.below(64)),
            8 => json!(bytes.integer()),
            9 => json!([[[]]]),
            _ => json!(bytes.number()),
        }
    }
}
