//! Keys of the window itself: sizes, pictures, recordings, files.

use std::fs;
use std::path::Path;

use mujoco_safe::record::RecorderOptions;
use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, sample};

use crate::busy::during_a_frame;
use crate::case::{SIZE, press, settle, show, state};
use crate::hand::wait_until;

pub fn keys() {
    let data = Data::new(sample::cartpole()).unwrap();
    show(Viewer::new(), data, |hand| {
        for (key, size) in [
            ("F8", [1024, 768]),
            ("shift+F8", [1280, 1024]),
            ("F9", [1280, 720]),
            ("shift+F9", [1920, 1080]),
            ("F10", SIZE),
        ] {
            press(hand, key, "another size", |state| state.size == size);
        }
        // There is no window manager that would make it larger: that it asks for it is what can be seen.
        press(hand, "F11", "full screen", |state| state.full_screen);
        press(hand, "F5", "and back", |state| !state.full_screen);
        hand.resize([300, 200]);
        wait_until("it follows its window", || state().size == [300, 200]);
    });
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |hand| hand.key("ctrl+q"));
}

/// How long a GIF is played, s.
fn seconds(path: &Path) -> f64 {
    let mut decoder = gif::Decoder::new(fs::File::open(path).unwrap()).unwrap();
    let mut hundredths = 0.0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        hundredths += f64::from(frame.delay);
    }
    hundredths / 100.0
}

pub fn outputs() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let model = path("model.xml");
    fs::write(&model, "<mujoco><worldbody><body><geom size='.1'/></body></worldbody></mujoco>").unwrap();
    let data = Data::new(mujoco_safe::Model::from_xml_path(&model).unwrap()).unwrap();
    let options = ViewerOptions {
        file: Some(model.clone()),
        screenshots: path("picture.png"),
        recordings: Some(path("film.gif")),
        recording: RecorderOptions { frames_per_second: 10.0, ..RecorderOptions::default() },
        ..ViewerOptions::default()
    };
    show(Viewer::new().options(options), data, |hand| {
        hand.key("ctrl+p");
        wait_until("a picture", || path("picture.png").exists());
        hand.key("ctrl+p");
        wait_until("another, beside it", || path("picture-2.png").exists());
        let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path("picture.png")).unwrap()));
        let picture = decoder.read_info().unwrap();
        assert_eq!([picture.info().width, picture.info().height], SIZE);

        // The window is busy when the recording begins and while the simulation goes on.
        let before = state();
        during_a_frame(hand, || {
            hand.key("ctrl+v");
            (0..10).for_each(|_| hand.key("shift+Right"));
        });
        settle(hand);
        let simulated = state().time - before.time;
        assert!(simulated > 0.9, "500 steps");
        press(hand, "ctrl+v", "it has recorded", |state| state.recording.is_none());
        let clip = seconds(&path("film.gif"));
        assert!((simulated..simulated + 0.2).contains(&clip), "{clip} s of {simulated} s");
        fs::remove_file(path("film.gif")).unwrap();

        press(hand, "space", "it runs", |state| state.time > simulated);
        press(hand, "ctrl+v", "it records", |state| state.recording.is_some_and(|frames| frames >= 3));
        hand.key("F9");
        press(hand, "ctrl+v", "it has recorded", |state| state.recording.is_none());
        assert_eq!(state().size, SIZE, "a recording keeps its size");
        assert!(fs::read(path("film.gif")).unwrap().starts_with(b"GIF89a"));

        // The file has changed in the meantime.
        let two = "<mujoco><worldbody><body><geom size='.1'/></body><body pos='1 0 0'><geom size='.1'/></body></worldbody></mujoco>";
        fs::write(&model, two).unwrap();
        press(hand, "space", "it rests", |state| state.status == "Paused");
        press(hand, "ctrl+l", "the model is loaded anew", |state| state.nbody == 3);
        assert_eq!(state().time, 0.0);
        fs::write(&model, "<mujoco><nonsense/></mujoco>").unwrap();
        hand.key("ctrl+l");
        wait_until("what is wrong with a file is said", || {
            state().messages.iter().any(|text| text.contains("nonsense"))
        });
        assert_eq!(state().nbody, 3, "and the model stays");
    });
}
