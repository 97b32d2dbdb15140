//! Keys of the window: sizes, screenshots, recordings and files.

use std::fs;
use std::path::Path;

use mujoco_safe::record::RecorderOptions;
use mujoco_safe::scene::CameraView;
use mujoco_safe::viewer::{Viewer, ViewerOptions, test_hooks};
use mujoco_safe::{Data, sample};

use crate::harness::{SIZE, press, settle, show, show_with, state};
use crate::input::wait_until;
use crate::queued_events::during_a_frame;

pub fn keys() {
    let data = Data::new(sample::cartpole()).unwrap();
    show(data, |input| {
        for (key, size) in [
            ("F8", [1024, 768]),
            ("shift+F8", [1280, 1024]),
            ("F9", [1280, 720]),
            ("shift+F9", [1920, 1080]),
            ("F10", SIZE),
        ] {
            press(input, key, "the window is resized", |state| state.size == size);
        }
        // Without a window manager the size does not change, so the test checks the requested state
        // only.
        press(input, "F11", "the window fills the screen", |state| state.full_screen);
        press(input, "F5", "full screen is off", |state| !state.full_screen);
        input.resize([300, 200]);
        wait_until("the frame has the size of the window", || state().size == [300, 200]);
    });
    show(Data::new(sample::cartpole()).unwrap(), |input| input.key("ctrl+q"));
}

/// Returns the duration of a GIF, s.
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
    let options = ViewerOptions::default()
        .with_file(model.clone())
        .with_watch(false)
        .with_screenshots(path("screenshot.png"))
        .with_recordings(path("recording.gif"))
        .with_recording(RecorderOptions::default().with_frames_per_second(10.0));
    show_with(options, Viewer::new(), data, |input| {
        input.key("ctrl+p");
        wait_until("a screenshot is saved", || path("screenshot.png").exists());
        input.key("ctrl+p");
        wait_until("a second screenshot has another name", || path("screenshot-2.png").exists());
        let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path("screenshot.png")).unwrap()));
        let image = decoder.read_info().unwrap();
        assert_eq!([image.info().width, image.info().height], state().picture[1], "the part above the timeline");

        // The window is blocked when the recording starts and while the simulation runs.
        let before = state();
        during_a_frame(input, || {
            input.key("ctrl+v");
            (0..10).for_each(|_| input.key("shift+Right"));
        });
        settle(input);
        let simulated = state().time - before.time;
        assert!(simulated > 0.9, "500 steps were taken");
        press(input, "ctrl+v", "the recording is finished", |state| state.recording.is_none());
        let clip = seconds(&path("recording.gif"));
        assert!(
            (simulated..simulated + 0.2).contains(&clip),
            "a recording of {clip} s for {simulated} s of simulation"
        );
        fs::remove_file(path("recording.gif")).unwrap();

        press(input, "space", "the simulation runs", |state| state.time > simulated);
        press(input, "ctrl+v", "the recording has three frames", |state| {
            state.recording.is_some_and(|frames| frames >= 3)
        });
        input.key("F9");
        press(input, "ctrl+v", "the recording is finished", |state| state.recording.is_none());
        assert_eq!(state().size, SIZE, "the size cannot change during a recording");
        assert!(fs::read(path("recording.gif")).unwrap().starts_with(b"GIF89a"));

        // Reloads a modified file.
        let two = "<mujoco><worldbody><body><geom size='.1'/></body><body pos='1 0 0'><geom size='.1'/></body></worldbody></mujoco>";
        fs::write(&model, two).unwrap();
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        // Keys work while the model is being loaded.
        test_hooks::hold_loading(true);
        press(input, "ctrl+l", "the model is being loaded", |state| state.loading.is_some());
        press(input, "Right", "the previous model takes a step", |state| state.nbody == 2 && state.time > 0.0);
        input.drag([240, 160], [30, 0], 1, &[]);
        wait_until("the view is rotated", || state().camera.azimuth != before.camera.azimuth);
        settle(input);
        let camera = state().camera;
        assert!(state().loading.is_some());
        test_hooks::hold_loading(false);
        wait_until("the model is reloaded", || state().nbody == 3 && state().loading.is_none());
        assert_eq!((state().time, state().camera), (0.0, camera), "the camera stays");
        fs::write(&model, "<mujoco><nonsense/></mujoco>").unwrap();
        input.key("ctrl+l");
        wait_until("the parse error is shown", || state().messages.iter().any(|text| text.contains("nonsense")));
        assert_eq!(state().nbody, 3, "the model is unchanged");
    });
}

/// A saved file replaces the model, and the simulation continues.
pub fn changes_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.xml");
    let text = |cameras: &str, added: &str| {
        format!(
            "<mujoco><worldbody>{cameras}{added}
               <body name='ball' pos='0 0 5'><joint type='slide' axis='0 0 1'/><geom size='.1'/></body></worldbody></mujoco>"
        )
    };
    let [far, near] = ["<camera name='far' pos='0 0 9'/>", "<camera name='near'/>"];
    let block = "<body pos='1 0 0'><joint type='slide'/><geom size='.1'/></body>";
    fs::write(&path, text(far, "")).unwrap();
    let data = Data::new(mujoco_safe::Model::from_xml_path(&path).unwrap()).unwrap();
    show_with(ViewerOptions::default().with_file(path.clone()), Viewer::new(), data, |input| {
        input.key("shift+Right");
        press(input, "bracketright", "the camera of the model is active", |state| {
            matches!(state.camera.view, CameraView::Fixed(_))
        });
        settle(input);
        let before = state();
        assert!(before.qpos[0] < 0.0 && before.time > 0.0);
        fs::write(&path, text(near, block)).unwrap();
        wait_until("the change is shown", || state().nbody == 3);
        // The camera does not exist any more, so the view is free.
        wait_until("the view is free", || state().camera.view == CameraView::Free);
        fs::write(&path, text(&[far, near].concat(), block)).unwrap();
        wait_until("a camera is added", || state().generation == before.generation + 2);
        assert_eq!((state().time, &state().qpos[..]), (before.time, &[0.0, before.qpos[0]][..]));

        press(input, "bracketright", "the first camera is active", |state| {
            matches!(state.camera.view, CameraView::Fixed(_))
        });
        let distance = state().camera.distance;
        fs::write(&path, text(far, "")).unwrap();
        wait_until("the body is removed", || state().nbody == 2);
        let after = state();
        assert!(matches!(after.camera.view, CameraView::Fixed(camera) if camera.index() == 0));
        assert_eq!((after.camera.distance, after.time, &after.qpos), (distance, before.time, &before.qpos));

        // The ball moves to a file of its own, which changes.
        let ball = |added: &str| text("", added);
        fs::write(folder.path().join("parts.xml"), ball("")).unwrap();
        fs::write(&path, "<mujoco><include file='parts.xml'/></mujoco>").unwrap();
        wait_until("the camera is removed", || state().camera.view == CameraView::Free);
        fs::write(folder.path().join("parts.xml"), ball(block)).unwrap();
        wait_until("the change of the included file is shown", || state().nbody == 3);
        fs::write(folder.path().join("parts.xml"), ball("")).unwrap();
        wait_until("the body is removed again", || state().nbody == 2);
        assert_eq!((state().time, &state().qpos), (before.time, &before.qpos));

        fs::write(&path, "<mujoco><nonsense/></mujoco>").unwrap();
        wait_until("the error is shown", || state().messages.iter().any(|text| text.contains("nonsense")));
        press(input, "Right", "the previous model runs on", |state| state.time > before.time);
        press(input, "BackSpace", "the simulation is reset", |state| state.time == 0.0);
        assert_eq!(state().qpos, [0.0]);

        // The panel starts with the directory of the file.
        fs::write(folder.path().join("other.xml"), text("", &[block, block, block].concat())).unwrap();
        press(input, "ctrl+o", "the path of a file is edited", |state| state.editing);
        input.write("oth");
        input.key("Tab");
        input.key("Return");
        wait_until("the file is opened", || state().nbody == 5 && !state().editing);
        press(input, "Right", "the new model takes a step", |state| state.time > 0.0);
    });
}
