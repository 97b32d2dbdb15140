//! Captured states as keyframes and MJCF text.

use std::fmt::Write;

use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::math::cross;
use crate::scene::Head;

/// State that the user has captured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CapturedKey {
    /// Unique identifier. Names need not be unique.
    pub number: usize,
    pub name: String,
    pub time: f64,
    /// `<key>` element for an MJCF file.
    pub xml: String,
    state: Vec<f64>,
}

impl CapturedKey {
    /// State that a keyframe of the engine contains.
    const SPEC: StateSpec =
        StateSpec::FULL_PHYSICS.union(StateSpec::CTRL).union(StateSpec::MOCAP_POS).union(StateSpec::MOCAP_QUAT);

    /// Captures the current state.
    pub fn new(data: &Data, number: usize, name: String) -> Self {
        let xml = key_xml(data, Some(&name));
        Self { number, name, time: data.time(), xml, state: data.state(Self::SPEC) }
    }

    /// Resets the simulation to the captured state.
    ///
    /// # Errors
    ///
    /// As for [`Data::reset`], and an error if the simulation has another model.
    pub fn restore(&self, data: &mut Data) -> Result<()> {
        data.reset()?;
        data.set_state(Self::SPEC, &self.state)
    }
}

/// Formats the current state as a `<key>` element for an MJCF file, with all digits.
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
        ("plastic", &data.state(StateSpec::PLASTIC)),
    ] {
        if !values.is_empty() {
            let values: Vec<String> = values.iter().map(f64::to_string).collect();
            attribute(&mut xml, name, &values.join(" "));
        }
    }
    xml.push_str("/>");
    xml
}

/// Formats a viewpoint as a `<camera>` element for an MJCF file.
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
    fn copied_state_is_restored_bit_for_bit_from_the_xml() {
        let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
        data.ctrl_mut()[0] = 0.1 + 0.2;
        data.mocap_pos_mut()[0] = [1.0 / 3.0, -2e-17, 1e6];
        // The compilers of 3.5 and 3.17 reject the subnormal numbers that follow from 1e-300.
        let rejects_subnormal = cfg!(all(engine_since = "3.5.0", not(engine_since = "4.0.0")));
        data.qvel_mut()[0] = if rejects_subnormal { 1e-100 } else { 1e-300 };
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
    fn captured_state_is_restored() {
        let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
        data.step().unwrap();
        let key = CapturedKey::new(&data, 0, "one".to_owned());
        let state = data.state(CapturedKey::SPEC);
        for _ in 0..10 {
            data.step().unwrap();
        }
        data.qfrc_applied_mut()[0] = 1.0;
        key.restore(&mut data).unwrap();
        assert_eq!(data.state(CapturedKey::SPEC), state);
        assert_eq!(data.qfrc_applied()[0], 0.0, "restoring a keyframe resets the simulation");
        assert_eq!(key.time, data.time());
    }

    #[test]
    fn empty_arrays_are_omitted() {
        let data = Data::new(Model::from_xml_str("<mujoco/>").unwrap()).unwrap();
        assert_eq!(key_xml(&data, None), "<key time=\"0\"/>");
    }
}
