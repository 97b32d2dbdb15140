//! States as keyframes.

use std::fmt::Write;

use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::math::cross;
use crate::scene::Head;

/// A state that was kept.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CapturedKey {
    /// Tells it from all others, also from those of the same name.
    pub number: usize,
    pub name: String,
    pub time: f64,
    /// As a `<key>` for a model's XML.
    pub xml: String,
    state: Vec<f64>,
}

impl CapturedKey {
    /// What a keyframe has.
    const SPEC: StateSpec =
        StateSpec::FULL_PHYSICS.union(StateSpec::CTRL).union(StateSpec::MOCAP_POS).union(StateSpec::MOCAP_QUAT);

    /// Keeps the present state.
    pub fn new(data: &Data, number: usize, name: String) -> Self {
        let xml = key_xml(data, Some(&name));
        Self { number, name, time: data.time(), xml, state: data.state(Self::SPEC) }
    }

    /// Resets to it.
    ///
    /// # Errors
    ///
    /// Those of [`Data::reset`], and for a simulation of another model.
    pub fn apply(&self, data: &mut Data) -> Result<()> {
        data.reset()?;
        data.set_state(Self::SPEC, &self.state)
    }
}

/// The present state as a `<key>` for a model's XML, with all digits.
pub(crate) fn key_xml(data: &Data, name: Option<&str>) -> String {
    let mut xml = String::from("<key");
    if let Some(name) = name {
        attribute(&mut xml, "name", &escaped(name));
    }
    attribute(&mut xml, "time", &data.time().to_string());
    for (name, values) in [
        ("qpos", data.qpos()),
        ("qvel", data.qvel()),
        ("act", data.act()),
        ("ctrl", data.ctrl()),
        ("mpos", data.mocap_pos().as_flattened()),
        ("mquat", data.mocap_quat().as_flattened()),
    ] {
        if !values.is_empty() {
            let values: Vec<String> = values.iter().map(f64::to_string).collect();
            attribute(&mut xml, name, &values.join(" "));
        }
    }
    xml.push_str("/>");
    xml
}

/// Where the window looks from as a `<camera>` for a model's XML.
pub(crate) fn camera_xml(head: &Head) -> String {
    let list = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let Head { pos, forward, up } = head;
    let right = cross(forward, up);
    let mut xml = String::from("<camera");
    attribute(&mut xml, "pos", &list(pos));
    attribute(&mut xml, "xyaxes", &format!("{} {}", list(&right), list(up)));
    xml.push_str("/>");
    xml
}

fn attribute(xml: &mut String, name: &str, value: &str) {
    // Writing to a string cannot fail.
    let _ = write!(xml, " {name}=\"{value}\"");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::{CapturedKey, key_xml};
    use crate::{Data, Model};

    const MODEL: &str = r#"<mujoco>
        <worldbody>
          <body name="hand" mocap="true" pos="0.1 0.2 0.3"><geom size="0.1"/></body>
          <body pos="0 0 1"><freejoint/><geom size="0.1"/></body>
          <body pos="1 0 1"><joint name="hinge" axis="0 1 0"/><geom size="0.1" pos="0 0 -0.5"/></body>
        </worldbody>
        <actuator><general joint="hinge" dyntype="filter" dynprm="0.1"/></actuator>
      </mujoco>"#;

    #[test]
    fn a_copied_state_is_the_same_bit_for_bit_when_a_model_has_it_as_its_keyframe() {
        let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
        data.ctrl_mut()[0] = 0.1 + 0.2;
        data.mocap_pos_mut()[0] = [1.0 / 3.0, -2e-17, 1e6];
        data.qvel_mut()[0] = 1e-300;
        for _ in 0..37 {
            data.step().unwrap();
        }
        let key = CapturedKey::new(&data, 0, "a <b> & \"c\"".to_owned());
        let text = MODEL.replace("</mujoco>", &format!("<keyframe>{}</keyframe></mujoco>", key.xml));
        let mut again = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
        again.reset_to_key("a <b> & \"c\"").unwrap();
        assert_eq!(again.state(CapturedKey::SPEC), data.state(CapturedKey::SPEC));
        assert!(data.time() > 0.0 && data.act()[0] != 0.0);
    }

    #[test]
    fn a_captured_state_is_reset_to() {
        let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
        data.step().unwrap();
        let key = CapturedKey::new(&data, 0, "one".to_owned());
        let state = data.state(CapturedKey::SPEC);
        for _ in 0..10 {
            data.step().unwrap();
        }
        data.qfrc_applied_mut()[0] = 1.0;
        key.apply(&mut data).unwrap();
        assert_eq!(data.state(CapturedKey::SPEC), state);
        assert_eq!(data.qfrc_applied()[0], 0.0, "a keyframe resets");
        assert_eq!(key.time, data.time());
    }

    #[test]
    fn what_a_model_does_not_have_is_left_out() {
        let data = Data::new(Model::from_xml_str("<mujoco/>").unwrap()).unwrap();
        assert_eq!(key_xml(&data, None), "<key time=\"0\"/>");
    }
}
