//! Signed distance fields, with the plugins of the wheel that contains the engine. The independent
//! source is the C API of the same engine.

use mujoco_safe::enums::GeomType;
use mujoco_safe::{Data, Error, Model, sys};

use crate::Raw;
use crate::plugin::loaded;

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

#[cfg(feature = "renderer")]
#[test]
fn a_field_is_drawn_as_its_mesh() {
    use mujoco_safe::element::Object;
    use mujoco_safe::render::Renderer;
    use mujoco_safe::scene::Camera;

    let Some(model) = loaded(BOLT) else { return };
    let bolt = model.geom("bolt").unwrap().id();
    let mut data = Data::new(model).unwrap();
    data.forward().unwrap();
    let mut renderer = Renderer::new(data.model(), 64, 64).unwrap();
    let mut camera = Camera::free(data.model());
    let segments = renderer.snapshot(&mut data, &mut camera).unwrap().segmentation().unwrap().segments();
    let pixels = segments.iter().find(|(segment, _)| segment.object == Some(Object::Geom(bolt)));
    assert!(pixels.is_some_and(|(_, count)| *count > 50), "{segments:?}");
}
