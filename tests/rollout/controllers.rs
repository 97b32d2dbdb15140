//! Controllers that are chosen at run time, as boxes and references.

use mujoco_safe::{Controller, Data, Error, PdController, Rollout, Trajectory, ZeroController, sample};

/// Returns a controller by its name.
fn controller(name: &str) -> Box<dyn Controller + Send> {
    match name {
        "zero" => Box::new(ZeroController),
        "push" => Box::new(|data: &mut Data| data.ctrl_mut()[0] = 0.5),
        "stop" => Box::new(|data: &mut Data| {
            data.joint("no such joint")?;
            Ok(())
        }),
        _ => panic!("no controller {name}"),
    }
}

#[test]
fn each_rollout_can_have_another_type_of_controller() {
    let result = Rollout::new(sample::cartpole(), 3, 4)
        .with_controllers(|index| controller(["zero", "push", "stop"][index]))
        .with_outputs(1, |data, row| row.copy_from_slice(data.ctrl()))
        .run()
        .unwrap();
    assert_eq!(result.outputs_of(0).as_slice(), [0.0; 4]);
    assert_eq!(result.outputs_of(1).as_slice(), [0.5; 4]);
    assert!(result.outcomes()[2].as_ref().unwrap_err().to_string().contains("no such joint"));
}

#[test]
fn a_box_and_a_reference_to_a_trait_object_control_a_simulation() {
    fn record(controller: impl Controller) -> f64 {
        let mut controller = controller;
        let mut data = Data::new(sample::cartpole()).unwrap();
        Trajectory::new(data.model()).record(&mut data, &mut controller, 3).unwrap();
        data.ctrl()[0]
    }
    let mut push = |data: &mut Data| data.ctrl_mut()[0] += 0.1;
    assert_eq!(record(&mut push as &mut dyn Controller), 0.1 + 0.1 + 0.1);
    assert_eq!(record(Box::new(push) as Box<dyn Controller>), 0.1 + 0.1 + 0.1);
    assert_eq!(record(controller("push")), 0.5);
    assert_eq!(record(Box::new(push)), 0.1 + 0.1 + 0.1);
    // A box that borrows, and one that another thread can share.
    let gain = 0.25;
    assert_eq!(record(Box::new(|data: &mut Data| data.ctrl_mut()[0] = gain) as Box<dyn Controller + '_>), 0.25);
    assert_eq!(record(Box::new(ZeroController) as Box<dyn Controller + Send + Sync>), 0.0);
}

#[test]
fn a_controller_keeps_its_state_behind_a_reference() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut pd = PdController::new(data.model(), 0.02, 0.005);
    pd.set_target(data.model().actuator("slide").unwrap(), 1.0);
    let mut chosen: &mut (dyn Controller + Send) = &mut pd;
    Controller::control(&mut chosen, &mut data).unwrap();
    assert_eq!(data.ctrl()[0], 0.02);
    let error = controller("stop").control(&mut data).unwrap_err();
    assert!(matches!(error, Error::NoSuchName { .. }), "{error}");
}

/// Each actuator has its gains and the target that it had at the keyframe.
#[test]
fn a_pd_controller_holds_a_keyframe_with_gains_by_actuator() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut pd = PdController::new(data.model(), 2.0, 0.1);
    let knee = data.model().actuator("left_knee").unwrap().id();
    pd.set_gains(knee, 10.0, 0.5);
    data.reset_to_key("squat").unwrap();
    pd.hold(&mut data).unwrap();
    pd.control(&mut data).unwrap();
    assert!(data.ctrl().iter().all(|&ctrl| ctrl == 0.0), "{:?}", data.ctrl());
    // Gears turn the joints' positions and velocities into lengths and their rates.
    for (joint, gear, [kp, kd]) in [("left_knee", 80.0, [10.0, 0.5]), ("right_knee", 80.0, [2.0, 0.1])] {
        data.joint_mut(joint).unwrap().qpos_mut()[0] += 0.01;
        data.joint_mut(joint).unwrap().qvel_mut()[0] = 0.2;
        pd.control(&mut data).unwrap();
        let expected = gear * (-0.01 * kp - 0.2 * kd);
        let ctrl = data.actuator(joint).unwrap().ctrl();
        assert!((ctrl - expected).abs() < 1e-12, "{joint}: {ctrl} instead of {expected}");
    }
    let mut cartpole = Data::new(sample::cartpole()).unwrap();
    assert!(matches!(pd.hold(&mut cartpole), Err(Error::Shape { .. })));
}
