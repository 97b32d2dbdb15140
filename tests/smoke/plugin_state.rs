//! Plugins with a state. The independent source is the C API of the same engine.

use mujoco_safe::{Data, StateSpec, sys};

use crate::Raw;
use crate::plugin::loaded;

/// A motor with a PID controller of the plugin library for actuators, which keeps the integral of
/// the error as its state.
const PID: &str = r#"<mujoco>
  <extension>
    <plugin plugin="mujoco.pid">
      <instance name="pid"><config key="kp" value="40"/><config key="ki" value="40"/><config key="kd" value="4"/></instance>
    </plugin>
  </extension>
  <worldbody><body><joint name="hinge" axis="0 1 0"/><geom size="0.05" pos="0.3 0 0"/></body></worldbody>
  <actuator><plugin joint="hinge" plugin="mujoco.pid" instance="pid" actdim="1"/></actuator>
</mujoco>"#;

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
