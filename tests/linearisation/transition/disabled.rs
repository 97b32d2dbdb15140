//! Sensors of actuators, joints and tendons with each stage of the engine disabled.

use mujoco_safe::derivative::{TransitionMethod, TransitionOptions, TransitionOutputs};
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Differences, Lineariser, Matrix, StateSpec};

use super::analytic::model;
use super::{assert_near, oracle};

const MODEL: &str = r#"<mujoco>
    <option timestep="0.002"/>
    <worldbody>
      <site name="anchor"/>
      <body>
        <joint name="j" axis="0 1 0" damping="0.1" stiffness="1" limited="true" range="-60 10"/>
        <joint name="s" type="slide" axis="0 0 1" frictionloss="0.1"/>
        <geom size="0.05" pos="0.2 0 0"/>
        <site name="tip" pos="0.2 0 0.3"/>
      </body>
    </worldbody>
    <tendon>
      <fixed name="sum"><joint joint="j" coef="2"/><joint joint="s" coef="0.3"/></fixed>
      <spatial name="rope" limited="true" range="0 0.1"><site site="anchor"/><site site="tip"/></spatial>
    </tendon>
    <actuator>
      <motor name="motor" joint="j"/><position name="servo" joint="j" kp="3"/>
      <motor name="winch" tendon="rope"/><velocity name="brake" tendon="sum" kv="0.4"/>
      FILTER
    </actuator>
    <sensor>
      <actuatorpos actuator="motor"/><actuatorvel actuator="motor"/><actuatorfrc actuator="motor"/>
      <actuatorpos actuator="servo"/><actuatorvel actuator="servo"/><actuatorfrc actuator="servo"/>
      <actuatorpos actuator="winch"/><actuatorvel actuator="winch"/><actuatorfrc actuator="winch"/>
      <actuatorpos actuator="brake"/><actuatorvel actuator="brake"/><actuatorfrc actuator="brake"/>
      <jointpos joint="j"/><jointvel joint="j"/><tendonpos tendon="rope"/><tendonvel tendon="rope"/>
      <jointlimitpos joint="j"/><jointlimitvel joint="j"/><jointlimitfrc joint="j"/>
      <tendonlimitpos tendon="rope"/><tendonlimitvel tendon="rope"/><tendonlimitfrc tendon="rope"/>
      <accelerometer site="tip"/><gyro site="tip"/><velocimeter site="tip"/><force site="tip"/><torque site="tip"/>
    </sensor>
  </mujoco>"#;

#[test]
fn sensors_follow_each_disabled_stage() {
    for filter in ["", r#"<general joint="s" dyntype="filter" dynprm="0.1" actlimited="true" actrange="-1 0.5"/>"#] {
        for flag in DisableFlags::all().iter() {
            let mut data = model(&MODEL.replace("FILTER", filter));
            if data.edit_model(|model| model.edit_options(|options| options.disable |= flag)).is_err() {
                continue;
            }
            data.qpos_mut().copy_from_slice(&[0.3, 0.1]);
            data.qvel_mut().copy_from_slice(&[0.5, -0.2]);
            data.ctrl_mut().iter_mut().enumerate().for_each(|(i, ctrl)| *ctrl = 0.3 - 0.1 * i as f64);
            data.act_mut().fill(0.3);
            let truth = oracle::linear_system(&data);
            for method in [TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic] {
                let options = TransitionOptions::default().with_method(method);
                let (system, report) =
                    Lineariser::new(data.model(), options).unwrap().linear_system(&mut data).unwrap();
                assert_near(&format!("{flag:?} {filter} {method:?} {report:?}"), &system, &truth, 2e-5);
            }
        }
    }
}

#[test]
fn actuators_of_disabled_groups_keep_their_activations() {
    if cfg!(not(engine_since = "3.5.0")) {
        return;
    }
    let xml = MODEL.replace("FILTER", r#"<general joint="s" dyntype="filter" dynprm="0.1" group="3" gainprm="2"/>"#);
    let mut data = model(&xml);
    data.edit_model(|model| model.edit_options(|options| options.disableactuator = 1 << 3)).unwrap();
    data.qpos_mut().copy_from_slice(&[0.3, 0.1]);
    data.ctrl_mut().fill(0.4);
    let truth = oracle::linear_system(&data);
    for method in [TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic] {
        let options = TransitionOptions::default().with_method(method);
        let (system, report) = Lineariser::new(data.model(), options).unwrap().linear_system(&mut data).unwrap();
        assert_near(&format!("{method:?} {report:?}"), &system, &truth, 2e-5);
    }
}

#[test]
#[cfg_attr(not(engine_since = "3.3.0"), ignore = "the engine has no sensors of energy")]
fn a_disabled_sensor_of_energy_has_no_derivative() {
    let mut data = model(
        "<mujoco><option><flag sensor='disable'/></option><worldbody><body><joint axis='0 1 0'/><geom size='.1' pos='.3 0 0'/></body></worldbody>
           <sensor><e_kinetic/></sensor></mujoco>",
    );
    data.qvel_mut()[0] = 2.0;
    assert!(data.transition_fd(1e-6, Differences::Central).unwrap().c.as_slice().iter().all(|&value| value == 0.0));
}

/// In engines that have noise, it would be divided by the step of the differences.
#[test]
#[cfg_attr(engine_since = "3.1.3", ignore = "the engine has no noise")]
fn noise_of_sensors_is_no_derivative() {
    let mut data = model(
        "<mujoco><option><flag sensornoise='enable'/></option><worldbody><body><joint name='j' axis='0 1 0'/><geom size='.1' pos='.3 0 0'/></body></worldbody>
           <sensor><jointpos joint='j' noise='0.1'/></sensor></mujoco>",
    );
    let c = data.transition_fd(1e-6, Differences::Central).unwrap().c;
    assert!((c[(0, 0)] - 1.0).abs() < 1e-6, "{c:?}");
    for method in [TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic] {
        let options = TransitionOptions::default().with_method(method);
        let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
        let error = lineariser.linear_system(&mut data).unwrap_err().to_string();
        assert!(error.contains("noise"), "{method:?}: {error}");
        let along = lineariser.along(&data, &Matrix::zeros(1, 2), &Matrix::zeros(1, 0));
        assert!(along.unwrap_err().to_string().contains("noise"), "{method:?}");
        let mut a = Matrix::zeros(2, 2);
        let outputs = TransitionOutputs { a: Some(&mut a), ..Default::default() };
        lineariser.linear_system_into(&mut data, outputs).unwrap();
    }
}

#[test]
fn the_state_is_unchanged_with_a_disabled_warm_start_and_mocap_bodies() {
    let mut data = model(
        "<mujoco><option><flag warmstart='disable'/></option><worldbody><body name='m' mocap='true'><geom size='.1'/></body>
           <body pos='1 0 0'><joint axis='0 1 0'/><geom size='.1' pos='.3 0 0'/></body></worldbody></mujoco>",
    );
    data.qacc_warmstart_mut()[0] = 7.0;
    data.mocap_quat_mut()[0] = [2.0, 1.0, 0.0, 1.0];
    let before = data.state(StateSpec::INTEGRATION);
    data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!(data.state(StateSpec::INTEGRATION), before);
}
