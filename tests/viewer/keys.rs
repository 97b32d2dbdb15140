//! Keys of the simulation and of the visualisation.

use mujoco_safe::scene::{CameraView, FrameMode, LabelMode, RenderFlags, VisualFlags};
use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, Model, PdController, sample};

use crate::harness::{SIZE, on_timeline, press, settle, show, show_with, state};
use crate::input::wait_until;

fn humanoid() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    data
}

pub fn simulation() {
    let data = humanoid();
    let controller = PdController::new(data.model(), 10.0, 1.0);
    let timestep = data.model().timestep();
    show_with(ViewerOptions::default(), Viewer::new().with_controller(controller), data, |input| {
        let first = state();
        assert_eq!((first.mode.as_str(), first.status.as_str(), first.time), ("Controller", "Paused", 0.0));
        let at = |steps: f64| move |time: f64| (time - steps * timestep).abs() < 1e-9;

        press(input, "Right", "one step forward", |state| at(1.0)(state.time));
        press(input, "shift+Right", "fifty steps forward", |state| at(51.0)(state.time));
        press(input, "Left", "one step back", |state| at(50.0)(state.time));
        press(input, "shift+Left", "fifty steps back", |state| at(0.0)(state.time));

        // The timeline shows 51 states, and leaves the keyboard to the window.
        input.click(on_timeline(0.8), 1, 1);
        wait_until("a click on the timeline shows a previous state", || {
            (30..50).any(|steps| at(f64::from(steps))(state().time))
        });
        let shown = state().time;
        press(input, "Left", "one step back", |state| (shown - state.time - timestep).abs() < 1e-9);
        input.click(on_timeline(0.0), 1, 1);
        wait_until("a click at the start shows the first state", || at(0.0)(state().time));
        press(input, "shift+F2", "the timeline is closed", |state| state.picture[1] == SIZE);
        press(input, "shift+F2", "the timeline is open", |state| state.picture[1] != SIZE);

        press(input, "space", "the simulation runs", |state| state.status == "Forward Simulation" && state.time > 0.0);
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        let paused = state();
        assert!(paused.ctrl.iter().any(|ctrl| *ctrl != 0.0), "the controller sets the controls");
        press(input, "ctrl+Right", "the next mode is selected", |state| state.mode == "Passive Dynamics");
        assert_eq!(state().time, paused.time, "a change of the mode takes no step");
        press(input, "ctrl+Right", "the modes are cyclic", |state| state.mode == "Controller");
        press(input, "ctrl+Left", "the previous mode is selected", |state| state.mode == "Passive Dynamics");
        press(input, "BackSpace", "the start state is restored", |state| state.time == 0.0);
        assert_eq!(state().qpos, first.qpos);

        press(input, "shift+Down", "the speed factor is halved", |state| state.target_speed < 1.0);
        let slow = state().target_speed;
        press(input, "shift+Up", "the speed factor is doubled", |state| state.target_speed == 2.0 * slow);
        press(input, "minus", "the speed factor is halved", |state| state.target_speed == slow);
        press(input, "equal", "the speed factor is doubled", |state| state.target_speed == 2.0 * slow);
        press(input, "Return", "real time is selected", |state| state.target_speed == 1.0);
        press(input, "Return", "the speed factor applies again", |state| state.target_speed == 2.0 * slow);
        press(input, "Return", "real time is selected", |state| state.target_speed == 1.0);

        press(input, "ctrl+s", "a keyframe is captured", |state| state.captured == 1);
        press(input, "ctrl+Right", "the controller mode is selected", |state| state.mode == "Controller");
        press(input, "shift+Right", "the controls are set", |state| state.ctrl.iter().any(|ctrl| *ctrl != 0.0));
        press(input, "ctrl+BackSpace", "the controls are zero", |state| state.ctrl.iter().all(|ctrl| *ctrl == 0.0));

        let copied = |parts: [&str; 2]| {
            let text = arboard::Clipboard::new().and_then(|mut clipboard| clipboard.get_text());
            text.is_ok_and(|text| parts.iter().all(|part| text.contains(part)))
        };
        input.key("ctrl+c");
        wait_until("the state is in the clipboard", || copied(["<key", "qpos="]));
        input.key("ctrl+shift+c");
        wait_until("the camera is in the clipboard", || copied(["<camera", "pos="]));
    });
}

/// Model that renders fast, because each key press causes a frame.
const SMALL: &str = r#"
<mujoco>
  <visual><quality shadowsize="256"/></visual>
  <worldbody>
    <light pos="0 0 3"/>
    <camera pos="0 -2 1" xyaxes="1 0 0 0 0.4 1"/>
    <geom type="plane" size="2 2 .1"/>
    <body pos="0 0 1"><joint axis="0 1 0"/><geom type="box" size=".2 .2 .2"/></body>
  </worldbody>
</mujoco>"#;

pub fn visualisation() {
    let mut data = Data::new(Model::from_xml_str(SMALL).unwrap()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    show(data, |input| {
        for (keys, part) in [
            ("F1", 0),
            ("F2", 1),
            ("ctrl+1", 2),
            ("ctrl+2", 3),
            ("Tab", 2),
            ("shift+Tab", 3),
            ("F3", 4),
            ("F4", 5),
            ("shift+F3", 6),
        ] {
            let before = state().panels;
            press(input, keys, "a panel is toggled", |state| state.panels[part] != before[part]);
            press(input, keys, "the panel is restored", |state| state.panels == before);
        }

        for (key, flag) in [
            ("h", VisualFlags::CONVEXHULL),
            ("x", VisualFlags::TEXTURE),
            ("j", VisualFlags::JOINT),
            ("q", VisualFlags::CAMERA),
            ("u", VisualFlags::ACTUATOR),
            ("comma", VisualFlags::ACTIVATION),
            ("z", VisualFlags::LIGHT),
            ("v", VisualFlags::TENDON),
            ("y", VisualFlags::RANGEFINDER),
            ("n", VisualFlags::CONSTRAINT),
            ("i", VisualFlags::INERTIA),
            ("apostrophe", VisualFlags::SCLINERTIA),
            ("b", VisualFlags::PERTFORCE),
            ("o", VisualFlags::PERTOBJ),
            ("c", VisualFlags::CONTACTPOINT),
            ("f", VisualFlags::CONTACTFORCE),
            ("p", VisualFlags::CONTACTSPLIT),
            ("t", VisualFlags::TRANSPARENT),
            ("a", VisualFlags::AUTOCONNECT),
            ("m", VisualFlags::COM),
            ("e", VisualFlags::SELECT),
            ("d", VisualFlags::STATIC),
            ("semicolon", VisualFlags::SKIN),
        ] {
            let expected = state().options.flags ^ flag;
            press(input, key, "a visual flag is toggled", |state| state.options.flags == expected);
            press(input, key, "the visual flag is restored", |state| state.options.flags == expected ^ flag);
        }
        for (key, flag) in [
            ("s", RenderFlags::SHADOW),
            ("w", RenderFlags::WIREFRAME),
            ("r", RenderFlags::REFLECTION),
            ("l", RenderFlags::ADDITIVE),
            ("k", RenderFlags::SKYBOX),
            ("g", RenderFlags::FOG),
            ("slash", RenderFlags::HAZE),
            ("shift+comma", RenderFlags::SEGMENT),
            ("period", RenderFlags::IDCOLOR),
        ] {
            let expected = state().render ^ flag;
            press(input, key, "a rendering effect is toggled", |state| state.render == expected);
            press(input, key, "the rendering effect is restored", |state| state.render == expected ^ flag);
        }
        for group in 0..6 {
            let key = group.to_string();
            let expected = !state().options.geomgroup[group];
            press(input, &key, "a group of geoms is toggled", |state| state.options.geomgroup[group] == expected);
            press(input, &key, "the group of geoms is restored", |state| state.options.geomgroup[group] != expected);
            let key = format!("shift+{key}");
            let expected = !state().options.sitegroup[group];
            press(input, &key, "a group of sites is toggled", |state| state.options.sitegroup[group] == expected);
        }

        // The options reach the scene.
        let before = state().ngeom;
        press(input, "j", "joints are in the scene", |state| state.ngeom > before);

        press(input, "F7", "the next kind of label", |state| state.options.label == LabelMode::Body);
        press(input, "shift+F7", "the previous kind of label", |state| state.options.label == LabelMode::None);
        let last = if cfg!(engine_since = "3.0.0") { LabelMode::Island } else { LabelMode::ContactForce };
        press(input, "shift+F7", "the kinds of labels are cyclic", |state| state.options.label == last);
        press(input, "F7", "the kinds of labels are cyclic", |state| state.options.label == LabelMode::None);
        press(input, "F6", "the next kind of frame", |state| state.options.frame == FrameMode::Body);
        press(input, "shift+F6", "the previous kind of frame", |state| state.options.frame == FrameMode::None);
        press(input, "shift+F6", "the kinds of frames are cyclic", |state| state.options.frame == FrameMode::World);
        press(input, "F6", "the kinds of frames are cyclic", |state| state.options.frame == FrameMode::None);

        press(input, "bracketright", "a camera of the model", |state| {
            matches!(state.camera.view, CameraView::Fixed(_))
        });
        press(input, "bracketleft", "the free camera", |state| state.camera.view == CameraView::Free);
        press(input, "bracketright", "a camera of the model", |state| {
            matches!(state.camera.view, CameraView::Fixed(_))
        });
        press(input, "Escape", "the free camera", |state| state.camera.view == CameraView::Free);
        // Esc never closes the window.
        input.keys(&["Escape", "Escape"]);
        settle(input);
        press(input, "bracketleft", "the cameras are cyclic", |state| {
            matches!(state.camera.view, CameraView::Fixed(_))
        });
        press(input, "ctrl+a", "the free camera shows the whole model", |state| state.camera.view == CameraView::Free);
        assert_eq!(state().camera.distance, 1.5 * model.statistics().extent);
    });
}
