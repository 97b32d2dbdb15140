//! Damaged files are errors or trajectories, and never panics.

use std::fs;

use mujoco_safe::mcap::Log;
use mujoco_safe::{Data, Model, Trajectory, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::chunk_crc::{chunk_crc, clear_chunk_crc};

/// Returns a model and a log of some steps.
fn log() -> (Model, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut log = Log::create(&path, data.model()).unwrap();
    for _ in 0..5 {
        log.step(&mut data).unwrap();
    }
    log.finish().unwrap();
    (data.model().as_ref().clone(), fs::read(path).unwrap())
}

#[test]
fn every_truncated_file_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let (model, bytes) = log();
    for length in (0..bytes.len()).step_by(if cfg!(debug_assertions) { 7 } else { 1 }) {
        fs::write(&path, &bytes[..length]).unwrap();
        let error = Trajectory::load_mcap(&model, &path).unwrap_err().to_string();
        assert!(error.contains("t.mcap"), "{error}");
    }
}

#[test]
fn changed_bytes_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let (model, bytes) = log();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut read, mut rejected) = (0, 0);
    for _ in 0..4000 {
        let mut damaged = bytes.clone();
        for _ in 0..random.random_range(1..4) {
            let place = random.random_range(0..damaged.len());
            damaged[place] = match random.random_range(0..3) {
                0 => random.random(),
                1 => damaged[place] ^ (1 << random.random_range(0..8)),
                _ => [0, 1, 0x7f, 0xff][random.random_range(0..4)],
            };
        }
        clear_chunk_crc(&mut damaged);
        fs::write(&path, &damaged).unwrap();
        match Trajectory::load_mcap(&model, &path) {
            Ok(_) => read += 1,
            Err(_) => rejected += 1,
        }
    }
    // Both occur, so the damage reaches the parsers and is not always detected by the first.
    assert!(read > 100 && rejected > 100, "{read} read, {rejected} rejected");
}

#[test]
fn checksums_find_changed_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let (model, mut bytes) = log();
    let crc = chunk_crc(&bytes).unwrap();
    bytes[crc + 2000] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let error = Trajectory::load_mcap(&model, &path).unwrap_err().to_string();
    assert!(error.contains("CRC"), "{error}");
}

#[test]
fn records_longer_than_their_chunk_huge_texts_and_short_attachments_are_errors() {
    // The parsers of the crate mcap would panic, or allocate 4 GiB.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let model = sample::cartpole();
    let record = |opcode: u8, body: &[u8]| [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat();
    let file = |parts: &[Vec<u8>]| [mcap::MAGIC, &parts.concat(), mcap::MAGIC].concat();
    let chunk = |records: &[u8]| {
        let size = (records.len() as u64).to_le_bytes();
        record(6, &[&[0; 16][..], &size, &[0; 8], &size, records].concat())
    };
    let header = record(1, &[0; 8]);
    let end = [record(15, &[0; 4]), record(2, &[0; 20])].concat();
    let channel = record(4, &[&[1, 0, 0, 0][..], &[0; 8], &[8, 0, 0, 0], &[0, 0, 0, 0], &[0xff; 4]].concat());
    let schema = record(3, &[&[1, 0][..], &[0xff; 4], &[b'a'; 8]].concat());
    let long = [&[5][..], &100_u64.to_le_bytes(), &[0; 10]].concat();
    for (part, expected) in [
        (chunk(&long), Some("a record is longer than its chunk")),
        (chunk(&record(9, &[0; 40])), Some("a chunk has a record of type 0x09")),
        (chunk(&channel), Some("a part of a record of type 0x04 is longer than the record")),
        (channel, Some("a part of a record of type 0x04 is longer than the record")),
        (schema, Some("a part of a record of type 0x03 is longer than the record")),
        (record(6, &[0xff; 40]), Some("a part of a record of type 0x06 is longer than the record")),
        (record(9, &[0; 2]), None),
        (record(9, &[0; 40]), None),
        (record(5, &[0; 22]), Some("a message has the unknown channel 0")),
    ] {
        fs::write(&path, file(&[header.clone(), part, end.clone()])).unwrap();
        let result = Trajectory::load_mcap(&model, &path);
        match expected {
            Some(expected) => {
                let error = result.unwrap_err().to_string();
                assert!(error.contains(expected), "{error}");
            }
            None => assert!(result.unwrap().is_empty()),
        }
    }
}
