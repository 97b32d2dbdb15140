//! Keys of the simulation and of the visualisation.

use mujoco_safe::scene::{CameraView, FrameMode, LabelMode, RenderFlags, VisualFlags};
use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, Model, PdController, sample};

use crate::harness::{press, show, state};
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
    show(Viewer::new().controller(controller), data, |input| {
        let first = state();
        assert_eq!((first.mode.as_str(), first.status.as_str(), first.time), ("Controller", "Paused", 0.0));
        let at = |steps: f64| move |time: f64| (time - steps * timestep).abs() < 1e-9;

        press(input, "Right", "a step forward", |state| at(1.0)(state.time));
        press(input, "shift+Right", "fifty more", |state| at(51.0)(state.time));
        press(input, "Left", "a step back", |state| at(50.0)(state.time));
        press(input, "shift+Left", "fifty back", |state| at(0.0)(state.time));

        press(input, "space", "it runs", |state| state.status == "Forward Simulation" && state.time > 0.0);
        press(input, "space", "it is paused", |state| state.status == "Paused");
        let paused = state();
        assert!(paused.ctrl.iter().any(|ctrl| *ctrl != 0.0), "the controller decided on controls");
        press(input, "ctrl+Right", "the next mode", |state| state.mode == "Passive Dynamics");
        assert_eq!(state().time, paused.time, "another mode is no step");
        press(input, "ctrl+Right", "and round again", |state| state.mode == "Controller");
        press(input, "ctrl+Left", "and back", |state| state.mode == "Passive Dynamics");
        press(input, "BackSpace", "the start", |state| state.time == 0.0);
        assert_eq!(state().qpos, first.qpos);

        press(input, "shift+Down", "half the speed that is set", |state| state.target_speed < 1.0);
        let slow = state().target_speed;
        press(input, "shift+Up", "twice that", |state| state.target_speed == 2.0 * slow);
        press(input, "Return", "real time", |state| state.target_speed == 1.0);
        press(input, "Return", "that speed again", |state| state.target_speed == 2.0 * slow);
        press(input, "Return", "real time", |state| state.target_speed == 1.0);

        press(input, "ctrl+s", "a keyframe is kept", |state| state.captured == 1);
        press(input, "ctrl+Right", "the controller", |state| state.mode == "Controller");
        press(input, "shift+Right", "steps", |state| state.ctrl.iter().any(|ctrl| *ctrl != 0.0));
        press(input, "ctrl+BackSpace", "no controls", |state| state.ctrl.iter().all(|ctrl| *ctrl == 0.0));

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

/// Model that renders fast, because each key causes a frame.
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

pub fn shown() {
    let mut data = Data::new(Model::from_xml_str(SMALL).unwrap()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    show(Viewer::new(), data, |input| {
        for (keys, part) in [("F1", 0), ("F2", 1), ("ctrl+1", 2), ("ctrl+2", 3), ("F3", 4), ("F4", 5)] {
            let before = state().panels;
            press(input, keys, "a panel comes or goes", |state| state.panels[part] != before[part]);
            press(input, keys, "and back", |state| state.panels == before);
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
            let wanted = state().options.flags ^ flag;
            press(input, key, "a part of the scene", |state| state.options.flags == wanted);
            press(input, key, "and back", |state| state.options.flags == wanted ^ flag);
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
            let wanted = state().render ^ flag;
            press(input, key, "an effect", |state| state.render == wanted);
            press(input, key, "and back", |state| state.render == wanted ^ flag);
        }
        for group in 0..6 {
            let key = (group + 1).to_string();
            let wanted = !state().options.geomgroup[group];
            press(input, &key, "a group of geoms", |state| state.options.geomgroup[group] == wanted);
            press(input, &key, "and back", |state| state.options.geomgroup[group] != wanted);
            let key = format!("shift+{key}");
            let wanted = !state().options.sitegroup[group];
            press(input, &key, "a group of sites", |state| state.options.sitegroup[group] == wanted);
        }

        // The options reach the scene.
        let before = state().ngeom;
        press(input, "j", "joints are in the scene", |state| state.ngeom > before);

        press(input, "equal", "the next label", |state| state.options.label == LabelMode::Body);
        press(input, "minus", "the label before", |state| state.options.label == LabelMode::None);
        press(input, "minus", "and round", |state| state.options.label == LabelMode::ContactForce);
        press(input, "F7", "and round", |state| state.options.label == LabelMode::None);
        press(input, "bracketright", "the next frame", |state| state.options.frame == FrameMode::Body);
        press(input, "bracketleft", "the frame before", |state| state.options.frame == FrameMode::None);
        press(input, "bracketleft", "and round", |state| state.options.frame == FrameMode::World);
        press(input, "F6", "and round", |state| state.options.frame == FrameMode::None);

        press(input, "Tab", "a camera of the model's", |state| matches!(state.camera.view, CameraView::Fixed(_)));
        press(input, "shift+Tab", "the free camera", |state| state.camera.view == CameraView::Free);
        press(input, "shift+Tab", "and round", |state| matches!(state.camera.view, CameraView::Fixed(_)));
        press(input, "ctrl+a", "free, on the whole model", |state| state.camera.view == CameraView::Free);
        assert_eq!(state().camera.distance, 1.5 * model.statistics().extent);
    });
}
