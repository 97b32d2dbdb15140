//! Damaged and hostile files.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::change::Checksum;
use super::origin::Origin;
use super::parts::{self, VERSION};
use super::recording::{Contents, MAGIC, Segment};
use super::{FlightRecorder, Recording};
use crate::{Data, Error, sample};

/// Returns a file with an edit of the model and an error.
fn file() -> Vec<u8> {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_note("a note").with_memory(0);
    for step in 0..6 {
        data.ctrl_mut()[0] = f64::from(step);
        recorder.step(&mut data).unwrap();
    }
    data.edit_model(|model| model.body_mass_mut()[1] = 3.0).unwrap();
    recorder.step(&mut data).unwrap();
    data.qpos_mut()[0] = f64::NAN;
    recorder.step(&mut data).unwrap_err();
    let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    recorder.write(&path).unwrap();
    std::fs::read(path).unwrap()
}

/// Bytes before the contents: the begin and the length.
const BEGIN: usize = 8 + 4 + 8;

/// Corrects the length and the checksum of the contents.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 8;
    bytes[BEGIN - 8..BEGIN].copy_from_slice(&((end - BEGIN) as u64).to_le_bytes());
    let checksum = Checksum::of_bytes(&bytes[BEGIN..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

#[test]
fn damage_anywhere_is_detected() {
    let file = file();
    assert!(Recording::from_bytes(&file).is_ok());
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for _ in 0..200 {
        let mut damaged = file.clone();
        damaged[random.random_range(0..file.len())] ^= 1 << random.random_range(0..8);
        assert!(matches!(Recording::from_bytes(&damaged), Err(Error::InvalidRecording { .. })));
    }
    let lengths = (0..200).chain((0..200).map(|_| random.random_range(0..file.len())));
    for length in lengths {
        assert!(
            matches!(Recording::from_bytes(&file[..length]), Err(Error::InvalidRecording { .. })),
            "{length} bytes"
        );
    }
}

/// An engine whose binary models are not loaded compiles the text.
#[test]
fn a_recording_with_the_text_of_the_model_is_repeated_by_every_engine() {
    let text = "<mujoco><worldbody><body><joint name='j'/><geom size='.1' pos='.3 0 0'/></body></worldbody>
                <actuator><motor joint='j'/></actuator></mujoco>";
    let mut data = Data::new(crate::Model::from_xml_str(text).unwrap()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_xml(text);
    for step in 0..20 {
        data.ctrl_mut()[0] = f64::from(step);
        recorder.step(&mut data).unwrap();
    }
    let repeat = recorder.recording().repeat().unwrap();
    assert_eq!((repeat.calls, repeat.difference), (20, None));
    assert_eq!(recorder.recording().data_after(19).unwrap().qpos(), data.qpos());
}

/// A stranger can compute the checksum. Everything that is accepted is repeated, and either has
/// the recorded results or differs with a reason.
#[test]
#[cfg_attr(not(validates_binaries), ignore = "binary models load with 2.2.2 and 3.5.0 only")]
fn hostile_files_are_errors_or_are_repeated() {
    let file = file();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    let model = file.len() - usize::min(file.len(), 6000)..file.len() - 8;
    let (mut rejected, mut differing) = (0, 0);
    for case in 0..400 {
        let mut hostile = file.clone();
        // The ends of the file have its structure; the models are in the middle.
        let range = if case % 4 == 0 {
            0..file.len() - 8
        } else if case % 4 == 1 {
            0..200
        } else {
            model.clone()
        };
        for _ in 0..=case % 3 {
            let place = random.random_range(range.clone());
            match random.random_range(0..3) {
                0 => hostile[place] = random.random(),
                1 => hostile[place] = u8::MAX,
                _ => {
                    let end = (place + 8).min(file.len() - 8);
                    hostile[place..end].fill([0, u8::MAX][case % 2]);
                }
            }
        }
        if case % 5 == 0 {
            let start = random.random_range(range);
            hostile.drain(start..(start + random.random_range(1..50)).min(file.len() - 8));
        }
        match Recording::from_bytes(&sealed(hostile)) {
            Err(error) => {
                assert!(matches!(error, Error::InvalidRecording { .. }), "{error}");
                rejected += 1;
            }
            Ok(recording) => {
                let _ = recording.first(|_| false);
                match recording.repeat() {
                    Ok(repeat) => differing += u32::from(repeat.difference.is_some()),
                    Err(_) => rejected += 1,
                }
            }
        }
    }
    assert!(rejected > 50 && differing > 5, "{rejected} rejected, {differing} differ");
}

#[test]
fn errors_name_the_place() {
    let reason = |bytes: Vec<u8>| match Recording::from_bytes(&bytes) {
        Err(Error::InvalidRecording { reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    assert!(reason(b"not a recording".to_vec()).contains("MJFLIGHT"));
    let mut newer = file();
    newer[8] = 99;
    assert!(reason(newer).contains("format 99"));
    let begin = [&MAGIC[..], &VERSION.to_le_bytes(), &[0; 8]].concat();
    let text = [&begin[..], &[0x7f, b'2', b'.'], &[0; 8]].concat();
    let reason = reason(sealed(text));
    assert!(reason.contains("at byte 1 of a part"), "{reason}");
}

#[test]
fn large_numbers_allocate_nothing() {
    // A segment with four billion values and no call.
    let contents = Contents {
        origin: Origin::here(),
        reason: String::new(),
        note: String::new(),
        xml: String::new(),
        models: vec![Vec::new()],
        segments: vec![Segment { values: 1 << 32, ..Segment::default() }],
    };
    let mut bytes = Vec::new();
    parts::put_begin(&mut bytes, MAGIC).unwrap();
    parts::put(&mut bytes, &contents).unwrap();
    let recording = Recording::from_bytes(&bytes).unwrap();
    assert_eq!(recording.calls(), 0..0);
    recording.repeat().unwrap_err(); // there is no model
    // Half of the bytes of a length.
    let place = bytes.len() - 8 - 10;
    for _ in 0..9 {
        bytes.insert(place, 0xff);
    }
    Recording::from_bytes(&sealed(bytes)).unwrap_err();
}
