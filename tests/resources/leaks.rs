//! Memory and open files do not grow with repetition.
//!
//! `cargo test` runs 200 or 1000 rounds with small models. The long form runs 10 000 rounds with
//! the humanoid: `cargo test --release --test resources -- --ignored`.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use std::fs;
use std::path::Path;

use mujoco_safe::callback::Callbacks;
use mujoco_safe::enums::Integrator;
use mujoco_safe::{Data, Error, LoadOptions, Model, RandomController, Trajectory, sample};

use crate::allocator::allocated_bytes;
use crate::cases::cases;
use crate::{lock_process, trouble};

/// Returns the number of open files of this process.
fn open_files() -> usize {
    fs::read_dir("/proc/self/fd").unwrap().count()
}

/// Repeats `round` after a warm-up, in which allocators and caches may grow, and asserts that
/// memory and open files stay constant. Memory grows in every attempt if there is a leak, but only
/// in some if the test harness starts a thread.
fn assert_no_growth(what: &str, rounds: usize, mut round: impl FnMut()) {
    const SLACK: usize = 256 << 10;
    const ATTEMPTS: usize = 3;
    (0..=rounds / 4).for_each(|_| round());
    let files = open_files();
    let mut grown = usize::MAX;
    for _ in 0..ATTEMPTS {
        let memory = allocated_bytes();
        (0..rounds).for_each(|_| round());
        grown = grown.min(allocated_bytes().saturating_sub(memory));
        assert_eq!(files, open_files(), "{what}: open files");
        if grown <= SLACK {
            break;
        }
    }
    println!("{what}: {grown} bytes in {rounds} rounds");
    assert!(grown <= SLACK, "{what}: {grown} bytes more after {rounds} rounds, {} each", grown / rounds);
}

#[test]
#[should_panic(expected = "bytes more after 1000 rounds")]
fn a_leak_of_a_kilobyte_per_round_is_detected() {
    let _lock = lock_process();
    assert_no_growth("a leak", 1000, || std::mem::forget(vec![1_u8; 1024]));
}

#[test]
#[should_panic(expected = "open files")]
fn a_leaked_file_is_detected() {
    let _lock = lock_process();
    assert_no_growth("a file", 10, || std::mem::forget(fs::File::open("/dev/null").unwrap()));
}

/// `true` with the engines that load binary models. The others return an error.
const LOADS_BINARIES: bool = cfg!(validates_binaries);

fn loading(xml: &str, rounds: usize) {
    let path = tempfile::Builder::new().suffix(".xml").tempfile().unwrap().into_temp_path();
    fs::write(&path, xml).unwrap();
    let bytes = Model::from_xml_str(xml).unwrap().to_binary().unwrap();
    assert_no_growth("a model from a text", rounds, || drop(Model::from_xml_str(xml).unwrap()));
    assert_no_growth("a model from a path", rounds, || drop(Model::from_xml_path(&path).unwrap()));
    assert_no_growth("a binary model", rounds, || assert_eq!(Model::from_binary(&bytes).is_ok(), LOADS_BINARIES));
}

fn simulating(model: Model, rounds: usize) {
    let mut data = Data::new(model).unwrap();
    let model = data.model().clone();
    assert_no_growth("a clone of a model", rounds, || drop(Model::clone(&model)));
    assert_no_growth("a simulation", rounds, || Data::new(model.clone()).unwrap().step().unwrap());
    assert_no_growth("a clone of a simulation", rounds, || data.clone().step().unwrap());
    assert_no_growth("a reset", rounds, || {
        data.step().unwrap();
        data.reset().unwrap();
    });
    assert_no_growth("an edited model", rounds, || data.edit_model(|model| model.body_mass_mut()[1] += 1e-6).unwrap());
}

#[test]
fn loading_does_not_leak() {
    let _lock = lock_process();
    loading(sample::CARTPOLE_XML, cases(300, 1000));
}

#[test]
fn simulations_do_not_leak() {
    let _lock = lock_process();
    simulating(sample::cartpole(), cases(300, 1000));
}

#[test]
fn a_failed_load_does_not_leak() {
    let _lock = lock_process();
    let bytes = sample::cartpole().to_binary().unwrap();
    let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    assert_no_growth("a truncated binary model", 1000, || {
        assert!(Model::from_binary(&bytes[..bytes.len() / 2]).is_err());
    });
    assert_no_growth("a truncated file", 1000, || assert!(Model::from_binary_path(&path).is_err()));
    assert_no_growth("a missing file", 1000, || assert!(Model::from_xml_path("no/such/file.xml").is_err()));
    assert_no_growth("an empty text", 1000, || assert!(Model::from_xml_str("").is_err()));
    assert_no_growth("malformed XML", 1000, || assert!(Model::from_xml_str("<mujoco").is_err()));
    assert_no_growth("two files of the same name", 200, || {
        let file = ("a.xml", &b"<mujoco/>"[..]);
        assert!(Model::from_xml_str_with("<mujoco/>", &LoadOptions::default().with_files(&[file, file])).is_err());
    });
}

#[test]
fn a_text_that_the_compiler_rejects_does_not_leak() {
    let _lock = lock_process();
    for (what, xml) in [
        ("an unknown element", "<mujoco><worldbod/></mujoco>"),
        ("a missing size", "<mujoco><worldbody><geom/></worldbody></mujoco>"),
        ("a missing texture", "<mujoco><asset><texture file='aaaa.png' type='2d'/></asset></mujoco>"),
        ("a missing mesh", "<mujoco><asset><mesh file='aaaa.stl'/></asset></mujoco>"),
        ("a missing OBJ mesh", "<mujoco><asset><mesh file='aaaa.obj'/></asset></mujoco>"),
        ("a mesh file without extension", "<mujoco><asset><mesh file='a'/></asset></mujoco>"),
        ("a texture file without extension", "<mujoco><asset><texture file='a' type='2d'/></asset></mujoco>"),
        ("a missing included file", "<mujoco><include file='aaaa.obj'/></mujoco>"),
        ("an unknown name", "<mujoco><actuator><motor joint='j'/></actuator></mujoco>"),
    ] {
        assert_no_growth(what, cases(300, 1000), || assert!(Model::from_xml_str(xml).is_err()));
    }
    assert_no_growth("a stack overflow in the compiler", 1000, || assert!(trouble::with_stack(10).is_err()));
}

#[test]
fn a_failed_step_does_not_leak() {
    let _lock = lock_process();
    let mut data = Data::new(trouble::overflowing()).unwrap();
    assert_no_growth("an engine error", 200, || {
        assert!((0..200).find_map(|_| data.step().err()).is_some());
        drop(data.clone());
        data.reset().unwrap();
    });
    assert_no_growth("a NaN", 1000, || {
        data.qvel_mut()[0] = f64::NAN;
        assert!(matches!(data.step(), Err(Error::Unstable(_))));
        data.reset().unwrap();
    });
    let mut data = Data::new(trouble::crowded()).unwrap();
    assert_no_growth("a warning", 1000, || {
        data.step().unwrap();
        data.reset().unwrap();
    });
}

#[test]
fn saving_and_loading_closes_files() {
    let _lock = lock_process();
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| folder.path().join(name);
    let nowhere = Path::new("/no/such/folder");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let model = data.model().clone();
    let mut trajectory = Trajectory::new(&model);
    trajectory.record(&mut data, &mut RandomController::new(1), 10).unwrap();
    assert_no_growth("files", cases(50, 200), || {
        model.save_binary(in_folder("m.mjb")).unwrap();
        assert_eq!(Model::from_binary_path(in_folder("m.mjb")).is_ok(), LOADS_BINARIES);
        trajectory.save_csv(in_folder("t.csv")).unwrap();
        Trajectory::load_csv(&model, in_folder("t.csv")).unwrap();
        assert!(trajectory.save_csv(nowhere.join("t.csv")).is_err());
        assert!(model.save_binary(nowhere.join("m.mjb")).is_err());
    });
    let model = sample::cartpole();
    assert_no_growth("an XML file", cases(50, 200), || {
        model.save_xml(in_folder("m.xml")).unwrap();
        assert!(model.save_xml(nowhere.join("m.xml")).is_err());
    });
}

#[test]
#[ignore = "takes minutes; for releases"]
fn ten_thousand_rounds_with_the_humanoid_do_not_leak() {
    let _lock = lock_process();
    loading(sample::HUMANOID_XML, 10_000);
    simulating(sample::humanoid(), 10_000);
}

#[test]
fn clones_in_a_callback_do_not_leak() {
    let _lock = lock_process();
    let mut data = Data::new(sample::cartpole()).unwrap();
    // The stages of this integrator use the engine's stack.
    data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Rk4)).unwrap();
    let clones = Callbacks::new().with_control(|context| drop(context.try_clone().unwrap()));
    data.with_callbacks(clones, |data| assert_no_growth("a clone in a callback", 200, || data.step().unwrap()));
}
