//! Engine plugins and signed distance fields, with the plugins of the wheel that contains the engine. The independent source is the C API of
//! the same engine.

use std::path::PathBuf;

use mujoco_safe::enums::GeomType;
use mujoco_safe::sys;
use mujoco_safe::{Data, Error, Model, StateSpec, load_plugins};

use crate::Raw;

/// A bolt as a signed distance field of the plugin library for such fields.
const BOLT: &str = r#"<mujoco>
  <extension><plugin plugin="mujoco.sdf.bolt"><instance name="bolt"><config key="radius" value="0.26"/></instance></plugin></extension>
  <asset><mesh name="bolt"><plugin instance="bolt"/></mesh></asset>
  <option sdf_iterations="10" sdf_initpoints="20"/>
  <worldbody>
    <light pos="0 0 3"/>
    <geom name="bolt" type="sdf" mesh="bolt"><plugin instance="bolt"/></geom>
    <body pos="0 0 2"><freejoint/><geom name="ball" size="0.2"/></body>
  </worldbody>
</mujoco>"#;

/// A motor with a PID controller of the plugin library for actuators, which keeps the integral of the error as its state.
const PID: &str = r#"<mujoco>
  <extension>
    <plugin plugin="mujoco.pid">
      <instance name="pid"><config key="kp" value="40"/><config key="ki" value="40"/><config key="kd" value="4"/></instance>
    </plugin>
  </extension>
  <worldbody><body><joint name="hinge" axis="0 1 0"/><geom size="0.05" pos="0.3 0 0"/></body></worldbody>
  <actuator><plugin joint="hinge" plugin="mujoco.pid" instance="pid" actdim="1"/></actuator>
</mujoco>"#;

/// Directory of the engine that the tests are built for.
pub fn directory() -> Option<PathBuf> {
    Some(PathBuf::from(option_env!("MUJOCO_DIR")?).join("plugin")).filter(|directory| directory.is_dir())
}

fn loaded(text: &str) -> Option<Model> {
    // SAFETY: the plugins of the wheel that contains the engine.
    unsafe { load_plugins(directory()?) }.unwrap();
    Some(Model::from_xml_str(text).unwrap())
}

#[test]
fn missing_and_foreign_libraries_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    // SAFETY: none of the paths is a library.
    unsafe {
        assert!(matches!(load_plugins(folder.path().join("none")), Err(Error::File { .. })));
        load_plugins(folder.path()).unwrap();
        std::fs::write(folder.path().join("wrong.so"), "no library").unwrap();
        assert!(matches!(load_plugins(folder.path()), Err(Error::Engine { .. })));
    }
    let error = Model::from_xml_str(&BOLT.replace("bolt", "unknown")).unwrap_err().to_string();
    assert!(error.contains("mujoco.sdf.unknown"), "{error}");
}

#[test]
fn contacts_with_a_field_equal_those_of_c() {
    let Some(model) = loaded(BOLT) else { return };
    let bolt = model.geom("bolt").unwrap();
    assert_eq!((bolt.geom_type(), bolt.mesh().is_some()), (GeomType::Sdf, true));
    let mut data = Data::new(model).unwrap();
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    let mut contacts = 0;
    for step in 0..400 {
        data.step().unwrap();
        c!(mj_step(data.model().as_ptr(), raw.0));
        contacts += data.ncon();
        // SAFETY: the array has nq numbers.
        let qpos = unsafe { std::slice::from_raw_parts((*raw.0).qpos, data.model().nq()) };
        assert_eq!(data.qpos(), qpos, "step {step}");
    }
    assert!(contacts > 0);
    assert!(matches!(data.geom_distance("bolt", "ball", 1.0), Err(Error::Unsupported(_))));
}

#[test]
fn a_field_whose_contacts_exceed_their_array_is_an_error() {
    if loaded(BOLT).is_none() {
        return;
    }
    for points in ["0", "51", "-1", "1000000"] {
        let text = BOLT.replace("sdf_initpoints=\"20\"", &format!("sdf_initpoints=\"{points}\""));
        let error = Model::from_xml_str(&text).unwrap_err().to_string();
        assert!(error.contains("sdf_initpoints"), "{error}");
    }
}

#[test]
fn states_copies_and_resets_include_those_of_plugins() {
    let Some(model) = loaded(PID) else { return };
    let mut data = Data::new(model).unwrap();
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    let start = data.state(StateSpec::INTEGRATION);
    let advance = |data: &mut Data| {
        data.ctrl_mut()[0] = 0.5;
        data.step_n(100).unwrap();
        data.qpos()[0]
    };
    let once = advance(&mut data);
    for _ in 0..100 {
        // SAFETY: the array has one number.
        unsafe { *(*raw.0).ctrl = 0.5 };
        c!(mj_step(data.model().as_ptr(), raw.0));
    }
    // SAFETY: as above.
    assert_eq!(once, unsafe { *(*raw.0).qpos });
    let size = c!(mj_stateSize(data.model().as_ptr(), sys::mjSTATE_PLUGIN as _));
    assert_eq!(data.model().state_size(StateSpec::PLUGIN), usize::try_from(size).unwrap());
    let saved = data.state(StateSpec::INTEGRATION);
    let mut copy = data.clone();
    let twice = advance(&mut data);
    assert_eq!(advance(&mut copy), twice);
    data.set_state(StateSpec::INTEGRATION, &saved).unwrap();
    assert_eq!(advance(&mut data), twice);
    data.reset().unwrap();
    assert_eq!(data.state(StateSpec::INTEGRATION), start);
    assert_eq!(advance(&mut data), once);
}

#[cfg(feature = "renderer")]
#[test]
fn a_field_is_drawn_as_its_mesh() {
    use mujoco_safe::render::Renderer;
    use mujoco_safe::scene::{Camera, SceneObject};

    let Some(model) = loaded(BOLT) else { return };
    let bolt = model.geom("bolt").unwrap().id();
    let mut data = Data::new(model).unwrap();
    data.forward().unwrap();
    let mut renderer = Renderer::new(data.model(), 64, 64).unwrap();
    let mut camera = Camera::free(data.model());
    let segments = renderer.snapshot(&mut data, &mut camera).unwrap().segmentation().unwrap().segments();
    let pixels = segments.iter().find(|(segment, _)| segment.object == Some(SceneObject::Geom(bolt)));
    assert!(pixels.is_some_and(|(_, count)| *count > 50), "{segments:?}");
}
