//! Trajectories in NumPy files.

use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;

use mujoco_safe::{Data, Model, RandomController, Trajectory, sample};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::numpy;

/// A model with two positions, two velocities, one activation and two controls.
const FILTERED: &str = r#"<mujoco>
  <worldbody>
    <body><joint name="a" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/>
      <body pos=".4 0 0"><joint name="b" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/></body>
    </body>
  </worldbody>
  <actuator><motor joint="a"/><general joint="b" dyntype="filter" dynprm=".1"/></actuator>
</mujoco>"#;

fn recorded(xml: &str) -> (Model, Trajectory) {
    let model = Model::from_xml_str(xml).unwrap();
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(&model);
    trajectory.record(&mut data, &mut RandomController::new(5), 30).unwrap();
    (model, trajectory)
}

/// Returns the header and the values of an array.
fn array(path: &Path, name: &str) -> (String, Vec<f64>) {
    let (header, bytes) = numpy::array(path, name);
    (header, bytes.chunks_exact(8).map(|value| f64::from_le_bytes(value.try_into().unwrap())).collect())
}

/// Returns a file with these arrays.
fn archive(arrays: &[(&str, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        archive.start_file(*name, SimpleFileOptions::default().compression_method(method)).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// Returns an array in version 2 of the format.
fn npy(header: &str, values: &[f64]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x02\x00".to_vec();
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

fn shaped(shape: &str, values: &[f64]) -> Vec<u8> {
    npy(&format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}\n"), values)
}

#[test]
fn the_arrays_follow_the_numpy_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let (_, trajectory) = recorded(FILTERED);
    trajectory.save_npz(&path).unwrap();
    let header = |shape: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    assert_eq!(array(&path, "time"), (header("(30,)"), trajectory.times().to_vec()));
    assert_eq!(array(&path, "ctrl"), (header("(30, 2)"), trajectory.controls().to_vec()));
    for (name, columns) in [("qpos", 0..2), ("qvel", 2..4), ("act", 4..5)] {
        let expected: Vec<f64> =
            trajectory.states().chunks(5).flat_map(|state| state[columns.clone()].to_vec()).collect();
        assert_eq!(array(&path, name), (header(&format!("(30, {})", columns.len())), expected), "{name}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_trajectory_round_trips_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    for xml in [FILTERED, sample::HUMANOID_XML, "<mujoco/>"] {
        let (model, trajectory) = recorded(xml);
        for trajectory in [trajectory, Trajectory::new(&model)] {
            trajectory.save_npz(&path).unwrap();
            let read = Trajectory::load_npz(&model, &path).unwrap();
            assert_eq!(read, trajectory);
            let bits =
                |trajectory: &Trajectory| trajectory.states().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&read), bits(&trajectory));
        }
    }
}

#[test]
fn nan_and_infinity_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    data.qpos_mut().copy_from_slice(&[f64::NAN, -0.0]);
    data.qvel_mut().copy_from_slice(&[f64::NEG_INFINITY, f64::MIN_POSITIVE / 4.0]);
    trajectory.push(&data).unwrap();
    trajectory.save_npz(&path).unwrap();
    let read = Trajectory::load_npz(data.model(), &path).unwrap();
    let bits = |state: &[f64]| state.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(read.state(0)), bits(trajectory.state(0)));
}

#[test]
fn files_written_by_numpy_load_compressed_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let model = sample::cartpole();
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        let file = archive(
            &[
                ("ctrl.npy", shaped("(2, 1)", &[7.0, 8.0])),
                ("note.npy", b"something else".to_vec()),
                ("time.npy", shaped("(2,)", &[0.0, 0.1])),
                ("act.npy", shaped("(2, 0)", &[])),
                ("qvel.npy", shaped("(2, 2)", &[3.0, 4.0, 5.0, 6.0])),
                ("qpos.npy", shaped("(2, 2)", &[-1.0, -2.0, -3.0, -4.0])),
            ],
            method,
        );
        fs::write(&path, file).unwrap();
        let read = Trajectory::load_npz(&model, &path).unwrap();
        assert_eq!(read.times(), [0.0, 0.1]);
        assert_eq!(read.states(), [-1.0, -2.0, 3.0, 4.0, -3.0, -4.0, 5.0, 6.0]);
        assert_eq!(read.controls(), [7.0, 8.0]);
    }
}

#[test]
fn mismatched_arrays_are_errors_that_name_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let model = sample::cartpole();
    let good = [
        ("time.npy", shaped("(2,)", &[0.0, 0.1])),
        ("qpos.npy", shaped("(2, 2)", &[0.0; 4])),
        ("qvel.npy", shaped("(2, 2)", &[0.0; 4])),
        ("act.npy", shaped("(2, 0)", &[])),
        ("ctrl.npy", shaped("(2, 1)", &[0.0; 2])),
    ];
    let with = |index: usize, bytes: Vec<u8>| {
        let mut arrays = good.clone();
        arrays[index].1 = bytes;
        archive(&arrays, CompressionMethod::Stored)
    };
    let header = |descr: &str, order: &str| {
        npy(&format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': (2, 2)}}"), &[0.0; 4])
    };
    let cases = [
        (with(0, shaped("(2, 1)", &[0.0; 2])), "'time' has shape (2, 1), but must have (n)"),
        (with(0, shaped("(3,)", &[0.0; 3])), "'qpos' has shape (2, 2), but must have (3, 2)"),
        (with(1, shaped("(2, 3)", &[0.0; 6])), "'qpos' has shape (2, 3), but must have (2, 2)"),
        (with(2, shaped("(1, 2)", &[0.0; 2])), "'qvel' has shape (1, 2)"),
        (with(2, shaped("(4,)", &[0.0; 4])), "'qvel' has shape (4), but must have (2, 2)"),
        (with(3, shaped("(2, 1)", &[0.0; 2])), "'act' has shape (2, 1), but must have (2, 0)"),
        (with(4, shaped("(2, 2)", &[0.0; 4])), "'ctrl' has shape (2, 2), but must have (2, 1)"),
        (with(1, header("<f4", "False")), "'qpos' has the type '<f4'"),
        (with(1, header(">f8", "False")), "'qpos' has the type '>f8'"),
        (with(1, header("<f8", "True")), "'qpos' is in Fortran order"),
        (with(1, shaped("(2, 2)", &[0.0; 3])), "'qpos' has a length that disagrees with its shape"),
        (with(1, shaped("(2, 2)", &[0.0; 5])), "'qpos' has a length that disagrees with its shape"),
        // No memory is allocated for missing numbers.
        (with(0, shaped("(1000000000000000,)", &[0.0; 2])), "'time' has a length that disagrees with its shape"),
        (with(0, shaped("(4611686018427387904,)", &[0.0; 2])), "'time' is too large"),
        (with(1, b"no array at all".to_vec()), "'qpos' is not in the NumPy format"),
        (with(1, npy("{}", &[])), "'qpos' has an unsupported header"),
        (with(1, b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec()), "'qpos' has an unsupported header"),
        (with(1, b"\x93NUM".to_vec()), "t.npz"),
        (archive(&good[..4], CompressionMethod::Stored), "'ctrl' is missing from the file"),
        (b"no archive".to_vec(), "t.npz"),
        (Vec::new(), "t.npz"),
    ];
    // Decompression stops at the size that the shape requires.
    let bomb = shaped("(2,)", &vec![0.0; 1 << 20]);
    let bomb = archive(&[("time.npy", bomb)], CompressionMethod::Deflated);
    assert!(bomb.len() < 1 << 15);
    let twice = [("time.npy", good[0].1.clone()), ("timf.npy", good[0].1.clone())];
    let mut twice = archive(&[&twice[..], &good[1..]].concat(), CompressionMethod::Stored);
    while let Some(at) = twice.windows(4).position(|name| name == b"timf") {
        twice[at + 3] = b'e';
    }
    let more = [(bomb, "'time' has a length that disagrees with its shape"), (twice, "two arrays have the same name")];
    for (file, expected) in cases.into_iter().chain(more) {
        fs::write(&path, file).unwrap();
        let text = Trajectory::load_npz(&model, &path).unwrap_err().to_string();
        assert!(text.contains(expected) && text.contains("t.npz"), "{expected}: {text}");
    }
    let error = Trajectory::load_npz(&model, "/dev/zero").unwrap_err().to_string();
    assert!(error.contains("not a regular file"), "{error}");
    fs::write(&path, archive(&good, CompressionMethod::Stored)).unwrap();
    assert_eq!(Trajectory::load_npz(&model, &path).unwrap().len(), 2);
}

#[test]
fn a_small_file_does_not_decompress_to_gigabytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let model = Model::from_xml_str("<mujoco/>").unwrap();
    // Zeros, compressed by a factor of a thousand: 72 MB in 72 kB.
    let count = 9_000_000;
    let others =
        ["qpos", "qvel", "act", "ctrl"].map(|name| (format!("{name}.npy"), shaped(&format!("({count}, 0)"), &[])));
    let mut arrays = vec![("time.npy", shaped(&format!("({count},)"), &vec![0.0; count]))];
    arrays.extend(others.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())));
    let mut bomb = archive(&arrays, CompressionMethod::Deflated);
    assert!(bomb.len() < 1 << 18, "{}", bomb.len());
    fs::write(&path, &bomb).unwrap();
    let text = Trajectory::load_npz(&model, &path).unwrap_err().to_string();
    assert!(text.contains("'time' unpacks to 72000000 bytes"), "{text}");
    // The sizes in the archive may be wrong.
    let size = (72_000_000 + arrays[0].1.len() - 8 * count) as u32;
    while let Some(at) = bomb.windows(4).position(|bytes| bytes == size.to_le_bytes()) {
        bomb[at..at + 4].copy_from_slice(&1000_u32.to_le_bytes());
    }
    fs::write(&path, &bomb).unwrap();
    assert!(Trajectory::load_npz(&model, &path).is_err());
    // A smaller file is loaded, however well it is compressed.
    let arrays = arrays.iter().map(|(name, _)| match *name {
        "time.npy" => (*name, shaped("(1000000,)", &vec![0.0; 1_000_000])),
        name => (name, shaped("(1000000, 0)", &[])),
    });
    fs::write(&path, archive(&arrays.collect::<Vec<_>>(), CompressionMethod::Deflated)).unwrap();
    assert_eq!(Trajectory::load_npz(&model, &path).unwrap().len(), 1_000_000);
}

#[test]
fn arrays_without_columns_may_be_missing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let arrays = [
        ("time.npy", shaped("(2,)", &[0.0, 0.1])),
        ("qpos.npy", shaped("(2, 2)", &[1.0, 2.0, 3.0, 4.0])),
        ("qvel.npy", shaped("(2, 2)", &[5.0, 6.0, 7.0, 8.0])),
        ("ctrl.npy", shaped("(2, 1)", &[9.0, 10.0])),
    ];
    let write = |arrays| fs::write(&path, archive(arrays, CompressionMethod::Stored)).unwrap();
    write(&arrays);
    let read = Trajectory::load_npz(&sample::cartpole(), &path).unwrap();
    assert_eq!(read.states(), [1.0, 2.0, 5.0, 6.0, 3.0, 4.0, 7.0, 8.0]);
    // This model has one activation.
    let text = Trajectory::load_npz(&Model::from_xml_str(FILTERED).unwrap(), &path).unwrap_err().to_string();
    assert!(text.contains("'act' is missing from the file"), "{text}");
    write(&arrays[..3]);
    let text = Trajectory::load_npz(&sample::cartpole(), &path).unwrap_err().to_string();
    assert!(text.contains("'ctrl' is missing from the file"), "{text}");
}

#[test]
fn entries_in_folders_are_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let model = sample::cartpole();
    let good = [
        ("../time.npy", b"evil".to_vec()),
        ("/qpos.npy", b"evil".to_vec()),
        ("time.npy", shaped("(1,)", &[0.5])),
        ("qpos.npy", shaped("(1, 2)", &[1.0, 2.0])),
        ("qvel.npy", shaped("(1, 2)", &[3.0, 4.0])),
        ("act.npy", shaped("(1, 0)", &[])),
        ("ctrl.npy", shaped("(1, 1)", &[5.0])),
    ];
    fs::write(&path, archive(&good, CompressionMethod::Stored)).unwrap();
    assert_eq!(Trajectory::load_npz(&model, &path).unwrap().states(), [1.0, 2.0, 3.0, 4.0]);
    fs::write(&path, archive(&[&good[..2], &good[3..]].concat(), CompressionMethod::Stored)).unwrap();
    let text = Trajectory::load_npz(&model, &path).unwrap_err().to_string();
    assert!(text.contains("'time' is missing from the file"), "{text}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn truncated_and_corrupted_files_are_errors_or_load() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.npz");
    let model = sample::cartpole();
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(&model);
    trajectory.record(&mut data, &mut RandomController::new(1), 2).unwrap();
    trajectory.save_npz(&path).unwrap();
    let file = fs::read(&path).unwrap();
    for length in (0..file.len()).step_by(7) {
        fs::write(&path, &file[..length]).unwrap();
        assert!(Trajectory::load_npz(&model, &path).is_err(), "{length} bytes");
    }
    for at in 0..file.len() {
        let mut invalid = file.clone();
        invalid[at] ^= 1 << (at % 8);
        fs::write(&path, invalid).unwrap();
        // Redundant data in the archive may be wrong in one place; the numbers may not.
        if let Ok(read) = Trajectory::load_npz(&model, &path) {
            assert_eq!(read, trajectory, "byte {at}");
        }
    }
}

#[test]
fn an_unwritable_file_is_an_error_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let (_, trajectory) = recorded(FILTERED);
    for path in [folder.path().join("no/such/t.npz"), folder.path().to_owned()] {
        trajectory.save_npz(&path).unwrap_err();
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
