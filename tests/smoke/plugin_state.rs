//! Plugins with a state. The independent source is the C API of the same engine.

use mujoco_safe::{Data, Model, StateSpec, sys};

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

/// Registers an actuator plugin with two numbers as its state. Those of the wheels keep theirs in
/// the activations.
fn register(name: &'static std::ffi::CStr, has_reset: bool) {
    unsafe extern "C" fn two_states(_: *const sys::mjModel, _: std::ffi::c_int) -> std::ffi::c_int {
        2
    }
    unsafe extern "C" fn nothing(_: *const sys::mjModel, _: *mut sys::mjData, _: std::ffi::c_int, _: std::ffi::c_int) {}
    unsafe extern "C" fn init(_: *const sys::mjModel, _: *mut sys::mjData, _: std::ffi::c_int) -> std::ffi::c_int {
        0
    }
    unsafe extern "C" fn reset(_: *const sys::mjModel, state: *mut f64, _: *mut std::ffi::c_void, _: std::ffi::c_int) {
        // SAFETY: the engine passes the two numbers of an instance.
        unsafe { std::slice::from_raw_parts_mut(state, 2) }.fill(0.0);
    }
    // SAFETY: zeros are null pointers and no capabilities; the engine copies the structure and its
    // texts.
    unsafe {
        let mut plugin: sys::mjpPlugin = std::mem::zeroed();
        plugin.name = name.as_ptr();
        plugin.capabilityflags = sys::mjPLUGIN_ACTUATOR as _;
        plugin.nstate = Some(two_states);
        plugin.init = Some(init);
        // 3.2.0 to 3.2.7 do not compile a plugin without attributes; the next ones were not tried.
        let mut attributes = [c"unused".as_ptr()];
        if cfg!(all(engine_since = "3.2.0", not(engine_since = "3.3.4"))) {
            plugin.nattribute = 1;
            plugin.attributes = attributes.as_mut_ptr();
        }
        plugin.reset = has_reset.then_some(reset as _);
        plugin.compute = Some(nothing);
        sys::mjp_registerPlugin(&raw const plugin);
    }
}

#[test]
fn the_states_of_plugins_follow_their_elements_into_another_model() {
    register(c"test.two_states", true);
    let model = |instances: &str, actuators: &str| {
        let hinge = |name: &str| {
            format!("<body name='{name}'><joint name='{name}' axis='0 1 0'/><geom size='0.05' pos='0.3 0 0'/></body>")
        };
        let hinges = ["a", "b", "c"].map(hinge).concat();
        let text = format!(
            "<mujoco><extension><plugin plugin='test.two_states'>{instances}</plugin></extension>
               <worldbody>{hinges}</worldbody><actuator>{actuators}</actuator></mujoco>"
        );
        Model::from_xml_str(&text).unwrap()
    };
    let own = |joint: &str| format!("<plugin name='{joint}' joint='{joint}' plugin='test.two_states'/>");
    let of = |joint: &str| format!("<plugin joint='{joint}' plugin='test.two_states' instance='named'/>");
    let named = "<instance name='named'/>";
    let states = |data: &Data| data.state(StateSpec::PLUGIN);
    let mut data = Data::new(model(named, &[own("a"), of("b"), own("c")].concat())).unwrap();
    // The named instance comes first.
    data.set_state(StateSpec::PLUGIN, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    data.adopt(model(named, &[own("c"), own("b"), of("a")].concat())).unwrap();
    assert_eq!(states(&data), [1.0, 2.0, 5.0, 6.0, 0.0, 0.0]);
    data.adopt(model("", &own("c"))).unwrap();
    assert_eq!(states(&data), [5.0, 6.0]);
    let adoption = data.adopt(model("", &own("a"))).unwrap();
    assert_eq!(states(&data), [0.0, 0.0]);
    assert!(adoption.lost.iter().any(|element| element.to_string() == "plugin instance 0"));
    data.step().unwrap();
}

/// The engine does not set them.
#[test]
fn the_states_of_plugins_without_a_reset_start_at_zero() {
    register(c"test.without_reset", false);
    let text = "<mujoco><extension><plugin plugin='test.without_reset'/></extension>
                  <worldbody><body><joint name='a'/><geom size='.1'/></body></worldbody>
                  <actuator><plugin joint='a' plugin='test.without_reset'/></actuator></mujoco>";
    let model = std::sync::Arc::new(Model::from_xml_str(text).unwrap());
    for _ in 0..100 {
        // The next simulation may get the memory of this one.
        let mut data = Data::new(&model).unwrap();
        assert_eq!(data.state(StateSpec::PLUGIN), [0.0, 0.0]);
        data.set_state(StateSpec::PLUGIN, &[1.0, 2.0]).unwrap();
    }
}
