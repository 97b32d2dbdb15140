//! Recordings of random calls, which must repeat bit for bit, and damaged ones.

use mujoco_safe::flight::{FlightRecorder, Recording};
use mujoco_safe::{Data, Error};

use super::sequence::{self, Scene};
use super::{Bytes, Verdict, models};

/// Size of the ring, a few segments of a small model.
const MEMORY: usize = 1 << 15;

const MOST_CALLS: usize = 60;

pub(super) fn recorded_calls(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let which = models::choose(bytes);
    log(&models::all()[which].name);
    let model = models::model(which).clone();
    let data = Data::new(model.clone()).expect("a model of the corpus has no simulation");
    let Ok(recorder) = FlightRecorder::new(&data) else { return Verdict::Rejected };
    let mut recorder = recorder.with_memory(MEMORY);
    let mut scene = Scene::new(model, data, log);
    for _ in 0..10 + bytes.below(MOST_CALLS - 9) {
        if bytes.once_in(3) {
            sequence::change(&mut scene, bytes);
            continue;
        }
        let data = &mut scene.data;
        let (name, result) = match bytes.below(8) {
            0 => ("recorded forward", recorder.forward(data)),
            1 => ("recorded halves", recorder.step1(data).and_then(|()| recorder.step2(data))),
            2 => ("recorded step1", recorder.step1(data)),
            _ => ("recorded step", recorder.step(data)),
        };
        (scene.log)(name);
        if result.is_err() && bytes.once_in(2) {
            let _ = scene.data.reset();
        }
    }
    let folder = tempfile::tempdir().expect("no temporary folder");
    let path = folder.path().join("calls.flight");
    recorder.write(&path).expect("a file is written");
    let mut file = std::fs::read(&path).expect("a written file");
    if bytes.once_in(2) {
        damage(&mut file, bytes, scene.log);
        return match Recording::from_bytes(&file) {
            Ok(recording) => {
                (scene.log)("repeat the damaged calls");
                let _ = recording.repeat();
                Verdict::Worked
            }
            Err(error) => {
                assert!(matches!(error, Error::InvalidRecording { .. }), "{error}");
                Verdict::Rejected
            }
        };
    }
    (scene.log)("repeat");
    match Recording::from_bytes(&file).expect("a file as it was written").repeat() {
        Ok(repeat) => {
            let difference = repeat.difference.map(|difference| difference.reason);
            // After an edit, the check of height fields before a step reads orientations of the
            // model before the edit.
            let difference = difference.filter(|reason| !reason.contains("rays on the height field"));
            assert_eq!(difference, None, "after {} calls", repeat.calls);
        }
        // Not all binary models are loaded with all engines.
        Err(error) if error.to_string().contains("binary model") => (scene.log)(&error.to_string()),
        Err(error) => panic!("{error}"),
    }
    Verdict::Worked
}

/// Bytes before the contents: the begin of the file and the length of the contents.
const BEGIN: usize = 8 + 4 + 8;

/// Changes some bytes of the contents, and corrects their length and checksum, which would reject
/// the file otherwise.
fn damage(file: &mut Vec<u8>, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) {
    let mut contents = file.split_off(BEGIN);
    contents.truncate(contents.len() - size_of::<u64>());
    for _ in 0..=bytes.below(3) {
        // Most of the file is the model. The calls are at its end.
        let places = bytes.either(contents.len(), contents.len().min(2000));
        let place = contents.len() - 1 - bytes.below(places);
        let kind = bytes.below(4);
        log(&format!("damage {kind} of byte {place}"));
        match kind {
            0 => contents[place] = bytes.word() as u8,
            1 => contents[place] = u8::MAX,
            2 => contents[place..].iter_mut().take(8).for_each(|byte| *byte = 0),
            _ => drop(contents.drain(place..(place + 1 + bytes.below(40)).min(contents.len()))),
        }
    }
    file[BEGIN - 8..].copy_from_slice(&(contents.len() as u64).to_le_bytes());
    file.extend(&contents);
    file.extend(checksum(&contents).to_le_bytes());
}

/// The checksum of the format.
fn checksum(file: &[u8]) -> u64 {
    let mix = |lane: u64, word: u64| (lane ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    let (words, rest) = file.as_chunks::<8>();
    let mut lanes = [1, 2, 3, 4];
    let mut add = |index: usize, word: u64| lanes[index % 4] = mix(lanes[index % 4], word);
    words.iter().enumerate().for_each(|(index, word)| add(index, u64::from_le_bytes(*word)));
    rest.iter().enumerate().for_each(|(index, &byte)| add(index, byte.into()));
    let all = lanes.iter().fold((words.len() + rest.len()) as u64, |all, &lane| mix(all, lane));
    all ^ (all >> 32)
}
