//! Damaged NumPy files.

use mujoco_safe::{Data, Trajectory};

#[cfg(feature = "npz")]
use super::models;
use super::{Bytes, Verdict};

/// Largest number of records.
const MOST_RECORDS: usize = 6;

#[cfg(not(feature = "npz"))]
pub(super) fn mutated_archive(_bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    log("built without the feature npz");
    Verdict::Rejected
}

/// Returns a trajectory of arbitrary numbers.
pub(super) fn trajectory(data: &mut Data, bytes: &mut Bytes<'_>) -> Trajectory {
    let mut trajectory = Trajectory::new(data.model());
    for _ in 0..bytes.below(MOST_RECORDS + 1) {
        data.set_time(bytes.number());
        let (first, other) = (bytes.number(), bytes.number());
        data.qpos_mut().fill(first);
        data.qvel_mut().fill(first);
        data.act_mut().fill(first);
        data.ctrl_mut().fill(first);
        if let Some(last) = data.qpos_mut().last_mut() {
            *last = other;
        }
        trajectory.push(data).expect("the trajectory is of this model");
    }
    trajectory
}

/// Uses a loaded trajectory.
pub(super) fn use_trajectory(trajectory: &Trajectory, data: &mut Data, log: &mut dyn FnMut(&str)) {
    log("apply");
    for record in 0..trajectory.len() {
        assert_eq!(trajectory.state(record).len(), trajectory.states().len() / trajectory.len());
        if trajectory.apply(record, data).is_err() {
            break;
        }
        if data.step().is_err() && data.reset().is_err() {
            break;
        }
    }
    log("save_csv, load_csv");
    let folder = tempfile::tempdir().expect("no temporary folder");
    let path = folder.path().join("trajectory.csv");
    if trajectory.save_csv(&path).is_ok() {
        let _ = Trajectory::load_csv(data.model(), &path);
    }
}

#[cfg(feature = "npz")]
pub(super) use damaged::mutated_archive;

#[cfg(feature = "npz")]
mod damaged {
    use std::io::{Cursor, Read as _, Write as _};

    use mujoco_safe::{Data, Trajectory};
    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipArchive, ZipWriter};

    use super::{Bytes, Verdict, models, trajectory, use_trajectory};

    /// Parts of a header, and their replacements.
    const HEADERS: [(&str, &[&str]); 6] = [
        ("'<f8'", &["'<f4'", "'>f8'", "'|O'", "'<U1000000000'", "\"<f8\"", "'", "[('a', '<f8')]"]),
        ("False", &["True", "0", "None", "false", ""]),
        (
            "(",
            &[
                "",
                "((",
                "(-",
                "(18446744073709551615, ",
                "(4611686018427387904, ",
                "(1, ",
                "[",
                "(99999999999999999999999",
            ],
        ),
        (")", &["", ", 0)", ", 18446744073709551615)", ", 2)", "]", "0)"]),
        ("'shape'", &["'Shape'", "'shape': (0,), 'shape'", "shape", "\"shape\""]),
        ("{", &["", "{{", "'shape': (7,), {"]),
    ];
    const NAMES: [&str; 8] =
        ["../time.npy", "/etc/time.npy", "time.npy", "qpos.npy", "TIME.NPY", "", "time.npy/", "a\\..\\qpos.npy"];

    type Members = Vec<(String, Vec<u8>)>;

    fn members(file: &[u8]) -> Members {
        let mut archive = ZipArchive::new(Cursor::new(file)).expect("an archive");
        (0..archive.len())
            .map(|index| {
                let mut member = archive.by_index(index).expect("a member");
                let mut content = Vec::new();
                member.read_to_end(&mut content).expect("its content");
                (member.name().expect("a name").into_owned(), content)
            })
            .collect()
    }

    /// Makes one change to an archive whose checksums are correct. About half of the changes keep
    /// it valid.
    fn damage(members: &mut Members, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) {
        let which = bytes.below(members.len());
        let Some((name, content)) = members.get_mut(which) else { return };
        let kind = bytes.below(14);
        log(&format!("change {kind} of {name}"));
        match kind {
            0..3 => {
                let (from, to) = HEADERS[bytes.below(HEADERS.len())];
                let to = bytes.choose(to).as_bytes();
                if let Some(at) = content.windows(from.len()).position(|window| window == from.as_bytes()) {
                    content.splice(at..at + from.len(), to.iter().copied());
                    if bytes.once_in(2) && content.len() > 10 {
                        // The length of the header is kept.
                        let length = u16::from_le_bytes([content[8], content[9]]);
                        let changed = usize::from(length) + to.len() - from.len();
                        content[8..10].copy_from_slice(&(changed as u16).to_le_bytes());
                    }
                }
            }
            3 => {
                let length = bytes.below(content.len() + 1);
                content.truncate(length);
            }
            4 => content.extend(std::iter::repeat_n(bytes.word() as u8, bytes.below(100))),
            5 => {
                let at = bytes.below(content.len());
                if let Some(byte) = content.get_mut(at) {
                    *byte ^= 1 << bytes.below(8);
                }
            }
            6 => {
                members.remove(which);
            }
            7 => bytes.choose(&NAMES).clone_into(name),
            // Version 2 of the format has four bytes for the length of the header.
            8 if content.len() >= 10 && content[6] == 1 => {
                content[6] = 2;
                content.splice(10..10, [0, 0]);
            }
            9 => members.insert(which, ("note.txt".to_owned(), vec![b'x'; bytes.below(100)])),
            10 => members.swap(which, 0),
            _ => {
                // The values are at the end.
                let numbers = content.len().saturating_sub(128);
                let number = bytes.word().to_le_bytes();
                content.iter_mut().skip(128 + bytes.below(numbers + 1)).zip(number).for_each(|(byte, new)| *byte = new);
            }
        }
    }

    fn packed(members: &Members, bytes: &mut Bytes<'_>) -> Option<Vec<u8>> {
        let method = if bytes.once_in(2) { CompressionMethod::Deflated } else { CompressionMethod::Stored };
        let options = SimpleFileOptions::default().compression_method(method);
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in members {
            // Names must be unique.
            if archive.start_file(name.as_str(), options).is_ok() {
                archive.write_all(content).ok()?;
            }
        }
        archive.finish().ok().map(Cursor::into_inner)
    }

    /// Changes bytes of the archive file.
    fn damage_bytes(file: &mut Vec<u8>, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) {
        let at = bytes.below(file.len());
        let kind = bytes.below(5);
        log(&format!("damage {kind} at byte {at}"));
        match kind {
            0 => file.truncate(at),
            1 => {
                let end = (at + bytes.below(64)).min(file.len());
                file.drain(at..end);
            }
            2 => {
                let word = [0, 1, u32::MAX, 1 << 31, i32::MAX as u32][bytes.below(5)].to_le_bytes();
                file.iter_mut().skip(at).zip(word).for_each(|(byte, new)| *byte = new);
            }
            3 => {
                let end = (at + bytes.below(200)).min(file.len());
                let copy = file[at..end].to_vec();
                file.splice(at..at, copy);
            }
            _ => {
                if let Some(byte) = file.get_mut(at) {
                    *byte ^= 1 << bytes.below(8);
                }
            }
        }
    }

    pub(crate) fn mutated_archive(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
        let model = models::model(models::choose(bytes));
        let Ok(mut data) = Data::new(model.clone()) else { return Verdict::Rejected };
        let folder = tempfile::tempdir().expect("no temporary folder");
        let path = folder.path().join("trajectory.npz");
        trajectory(&mut data, bytes).save_npz(&path).expect("a file is written");
        let mut file = std::fs::read(&path).expect("a written file");
        if bytes.once_in(3) {
            damage_bytes(&mut file, bytes, log);
        } else {
            let mut members = members(&file);
            for _ in 0..=bytes.below(3) {
                damage(&mut members, bytes, log);
            }
            if let Some(packed) = packed(&members, bytes) {
                file = packed;
            }
        }
        std::fs::write(&path, file).expect("a file is written");
        log("load_npz");
        let Ok(loaded) = Trajectory::load_npz(model, &path) else { return Verdict::Rejected };
        let _ = data.reset();
        use_trajectory(&loaded, &mut data, log);
        log("save_npz, load_npz");
        loaded.save_npz(&path).expect("a file is written");
        let again = Trajectory::load_npz(model, &path).expect("a saved archive loads");
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(again.states()), bits(loaded.states()));
        assert_eq!(bits(again.times()), bits(loaded.times()));
        Verdict::Worked
    }
}
