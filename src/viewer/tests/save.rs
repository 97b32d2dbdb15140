//! Files that the user saves, control noise and the appearance.

use std::path::Path;

use super::Bench;
use crate::viewer::link::{Appearance, ControlNoise, EndpointRequest, Event, Request, SavedFile, SimulationRequest};
use crate::{Data, Model, sample};

fn notice(bench: &mut Bench) -> String {
    let events = bench.events();
    let [Event::Notice(text)] = &events[..] else { panic!("{events:?}") };
    text.clone()
}

#[test]
fn model_and_listings_are_saved_without_overwriting_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::humanoid();
    let save = |bench: &mut Bench, file, folder: &Path| {
        bench.send(EndpointRequest::Save(file, folder.into()));
    };
    for file in [SavedFile::Binary, SavedFile::ModelText, SavedFile::DataText] {
        save(&mut bench, file, folder.path());
        let path = folder.path().join(file.name());
        assert_eq!(notice(&mut bench), format!("saved {}", path.display()));
        assert!(path.exists());
    }
    let model = bench.snapshot().model.clone();
    let saved = |name: &str| folder.path().join(name);
    assert_eq!(std::fs::read(saved("model.mjb")).unwrap(), model.to_binary().unwrap());
    // Binary models load with 2.2.2 and 3.5.0 only.
    if cfg!(validates_binaries) {
        let binary = Model::from_binary_path(saved("model.mjb")).unwrap();
        assert_eq!(binary.to_binary().unwrap(), model.to_binary().unwrap());
    }
    let text = |name: &str| std::fs::read_to_string(saved(name)).unwrap();
    assert!(text("model.txt").contains("left_knee"));
    assert!(text("data.txt").contains("QPOS"));

    std::fs::write(saved("model.mjb"), "other").unwrap();
    save(&mut bench, SavedFile::Binary, folder.path());
    assert!(notice(&mut bench).ends_with("model-2.mjb"));
    assert_eq!(text("model.mjb"), "other");
    save(&mut bench, SavedFile::DataText, &folder.path().join("missing"));
    assert!(notice(&mut bench).contains("missing"), "the path of a file that cannot be written");
}

#[test]
fn model_is_saved_as_xml() {
    let folder = tempfile::tempdir().unwrap();
    // The engine keeps the XML of the last model only, and other tests load models at the same
    // time.
    let model = (0..10_000).find_map(|_| {
        let mut bench = Bench::humanoid();
        bench.send(EndpointRequest::Save(SavedFile::Xml, folder.path().into()));
        notice(&mut bench).starts_with("saved").then(|| bench.snapshot().model.clone())
    });
    let loaded = Model::from_xml_path(folder.path().join("model.xml")).unwrap();
    assert_eq!(loaded.body_mass(), model.expect("no load between loading and saving").body_mass());
}

#[test]
fn control_noise_acts_on_steps_and_leaves_the_controls_unchanged() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.ctrl_mut()[0] = 0.5;
    let mut bench = Bench::new(data);
    let run = |bench: &mut Bench, deviation| {
        bench.send(SimulationRequest::SetNoise(ControlNoise { deviation, correlation_time: 0.1 }));
        bench.send(Request::Reset);
        bench.send(SimulationRequest::Step(100));
        assert_eq!(bench.snapshot().ctrl, [0.5]);
        bench.snapshot().qpos.clone()
    };
    let quiet = run(&mut bench, 0.0);
    let noisy = run(&mut bench, 0.2);
    assert_ne!(noisy, quiet);
    assert_eq!(run(&mut bench, 0.2), noisy, "a reset repeats the noise");
    assert_ne!(run(&mut bench, 0.1), noisy);
    assert_eq!(run(&mut bench, 0.0), quiet);
    bench.send(SimulationRequest::Step(-50));
    assert_eq!(bench.snapshot().ctrl, [0.5]);
}

#[test]
fn appearance_of_the_model_is_set_and_invalid_settings_are_rejected() {
    let mut bench = Bench::humanoid();
    let before = bench.snapshot().model.clone();
    let qpos = bench.snapshot().qpos.clone();
    let mut appearance = Appearance::of(&before);
    appearance.visual.rgba.force = [0.0, 1.0, 0.0, 1.0];
    appearance.statistics.extent = 7.0;
    bench.send(EndpointRequest::SetAppearance(Box::new(appearance)));
    let model = bench.snapshot().model.clone();
    assert_eq!((model.visual(), model.statistics()), (appearance.visual, appearance.statistics));
    let snapshot = bench.snapshot();
    assert_eq!((&snapshot.qpos, snapshot.generation), (&qpos, 0), "the simulation continues");
    assert_eq!(before.visual().rgba.force, [1.0, 0.5, 0.5, 1.0], "the program's model is unchanged");
    appearance.visual.map.znear = 0.0;
    bench.send(EndpointRequest::SetAppearance(Box::new(appearance)));
    assert!(notice(&mut bench).contains("znear"));
    assert_eq!(bench.snapshot().model.visual().map.znear, model.visual().map.znear);
}
