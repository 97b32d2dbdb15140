//! Damaged binary models are rejected or work.

#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::cases::cases;
use crate::mutate::{DAMAGES, Damage, Map};
use crate::print_all::print_all;
use crate::scene_options::with_groups;
use mujoco_safe::scene::{Camera, Categories, FrameMode, LabelMode, Scene, SceneOptions, VisualFlags};
use mujoco_safe::{Data, Error, Model, sample};

/// Loads and simulates a binary model, and returns whether it was accepted.
fn load_and_simulate(bytes: &[u8]) -> bool {
    let model = match Model::from_binary(bytes) {
        Ok(model) => model,
        Err(error) => {
            assert!(matches!(error, Error::InvalidBinary { .. } | Error::Unsupported(_)), "{error}");
            return false;
        }
    };
    // Any number may have changed, so a step may fail, but must return.
    let mut data = match Data::new(model.clone()) {
        Ok(data) => data,
        // The stack may take gigabytes, which not every machine can provide.
        Err(Error::Engine { .. } | Error::OutOfMemory { .. }) => return true,
        Err(error) => panic!("an accepted model has no simulation: {error}"),
    };
    assert!(print_all(&model, &data) > 0);
    for _ in 0..10 {
        if data.step().is_err() {
            data.reset().unwrap();
        }
    }
    assert!(print_all(&model, &data) > 0);
    show(&mut data);
    let _ = data.model().options();
    drop(data.clone());
    drop(model.clone());
    assert!(model.to_binary().is_ok());
    true
}

/// Builds the scene with everything visible, and selects in it.
fn show(data: &mut Data) {
    let model = data.model().clone();
    let mut scene = Scene::new(&model, 5000).unwrap();
    let mut camera = Camera::default();
    for (label, frame) in [(LabelMode::Body, FrameMode::Geom), (LabelMode::ContactForce, FrameMode::Contact)] {
        let options = SceneOptions::default().with_label(label).with_frame(frame).with_flags(VisualFlags::all());
        let options = with_groups(options, [true; 6]);
        match scene.update(data, &options, None, &mut camera, Categories::all()) {
            Ok(()) => assert!(scene.geoms().all(|geom| geom.label().len() < 100)),
            Err(Error::SceneFull { .. } | Error::NotComputed { .. } | Error::Poisoned { .. }) => (),
            Err(error) => panic!("the scene of an accepted model fails: {error}"),
        }
        // The ray may be invalid.
        let _ = scene.select(data, &options, 1.0, [0.5; 2]);
    }
}

fn mutations(model: &Model, seeds: std::ops::Range<u64>) {
    let good = model.to_binary().unwrap();
    assert!(load_and_simulate(&good), "the original model");
    let map = Map::new(&good);
    let mut accepted = 0;
    for damage in DAMAGES {
        for seed in seeds.clone() {
            let mutant = map.mutant(&good, damage, seed);
            let outcome = catch_unwind(AssertUnwindSafe(|| load_and_simulate(&mutant)));
            let is_model = outcome.unwrap_or_else(|_| panic!("{damage:?}, seed {seed}"));
            assert!(!(is_model && matches!(damage, Damage::Truncation | Damage::Extension)), "{damage:?}, seed {seed}");
            accepted += usize::from(is_model);
        }
    }
    println!("{accepted} mutations were accepted");
}

#[test]
fn mutated_binary_models_are_errors_or_work() {
    // Nine kinds of damage, so more than 500 mutations in all cases.
    let seeds = 0..cases(6, 20);
    mutations(&sample::cartpole(), seeds.clone());
    mutations(&sample::humanoid(), seeds.clone());
    let every_element = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    mutations(&Model::from_xml_path(every_element).unwrap(), seeds);
}

#[test]
fn every_truncated_binary_model_is_an_error() {
    let good = sample::cartpole().to_binary().unwrap();
    for length in (0..1000).chain((1000..good.len()).step_by(997)) {
        assert!(!load_and_simulate(&good[..length]), "the first {length} bytes");
    }
    let long = [&good[..], b"x"].concat();
    assert!(!load_and_simulate(&long), "an extra byte");
}
