//! Hostile numbers, other models and empty problems end with an error or a status.

use mujoco_safe::control::residual::{Frame, FramePose, FramePosition, JointPosition, SensorReading};
use mujoco_safe::ik::{Ik, IkStatus, SearchOptions, Task};
use mujoco_safe::{Data, Error, Model, sample};

use crate::{arm, humanoid};

const DT: f64 = 0.01;

#[test]
fn wrong_arguments_are_errors() {
    let (mut data, mut ik, tasks) = humanoid();
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(ik.solve(&mut data, dt), Err(Error::Invalid { .. })), "{dt}");
    }
    assert!(ik.integrate(&mut data, f64::NAN).is_err());
    assert!(ik.set_target(tasks[0], &[0.0; 3]).is_err());
    assert!(ik.set_target(tasks[0], &[f64::NAN; 7]).is_err());
    for value in [f64::NAN, -1.0] {
        assert!(ik.set_velocity_limits(value).is_err());
        assert!(ik.set_velocity_limit("left_knee", value).is_err());
        assert!(ik.set_acceleration_limit("left_knee", value).is_err());
        assert!(ik.set_position_margin(value).is_err());
        assert!(ik.set_regularisation(value).is_err());
        assert!(ik.prescribe_velocity("left_knee", Some(&[f64::NAN])).is_err());
    }
    assert!(ik.prescribe_velocity("root", Some(&[0.0; 3])).is_err());
    assert!(ik.set_velocity_limit("knee", 1.0).is_err());
    for (weight, gain, damping) in [(f64::NAN, 1.0, 0.0), (-1.0, 1.0, 0.0), (1.0, f64::INFINITY, 0.0), (1.0, 1.0, -1.0)]
    {
        let task = ik.task_mut(tasks[0]).unwrap();
        (task.weight, task.gain, task.damping) = (weight, gain, damping);
        let error = ik.solve(&mut data, DT).unwrap_err();
        assert!(error.to_string().contains("of task 0"), "{error}");
    }
    // The id of a task that this one does not have.
    let mut other = Ik::new(data.model());
    assert!(other.task(tasks[0]).is_err() && other.set_target(tasks[0], &[0.0; 7]).is_err());
    let model = data.model().clone();
    other.add_task(Task::new(FramePosition::body(&model, "torso").unwrap()).with_weights([1.0, 1.0]));
    assert!(matches!(other.solve(&mut data, DT), Err(Error::Shape { .. })));
}

#[test]
fn simulations_of_other_models_are_errors() {
    let (_, mut ik, _) = humanoid();
    let mut other = Data::new(sample::humanoid()).unwrap();
    assert!(matches!(ik.solve(&mut other, DT), Err(Error::OtherModel { .. })));
    assert!(matches!(ik.step(&mut other, DT), Err(Error::OtherModel { .. })));
    assert!(matches!(ik.integrate(&mut other, DT), Err(Error::OtherModel { .. })));
    assert!(matches!(ik.search(&mut other, &SearchOptions::default()), Err(Error::OtherModel { .. })));
}

#[test]
fn targets_and_positions_that_are_not_finite_are_errors() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    for target in [[f64::NAN, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        let mut ik = Ik::new(&model);
        ik.add_task(Task::new(FramePosition::body(&model, "link6").unwrap().with_target(target)));
        let error = ik.solve(&mut data, DT).unwrap_err();
        assert!(matches!(&error, Error::Invalid { .. }) && error.to_string().contains("task 0"), "{error}");
        assert!(ik.search(&mut data, &SearchOptions::default()).is_err());
    }
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(FramePosition::body(&model, "link6").unwrap()));
    data.qpos_mut()[3] = f64::NAN;
    assert!(ik.solve(&mut data, DT).is_err());
    let mut data = Data::new(&model).unwrap();
    assert!(ik.solve(&mut data, DT).is_ok());
    data.edit_model(|model| model.jnt_range_mut()[2] = [-1.0, f64::NAN]).unwrap();
    let error = ik.solve(&mut data, DT).unwrap_err();
    assert!(error.to_string().contains("joint 2"), "{error}");

    let tendon = r#"<mujoco><worldbody><body><joint name="a"/><geom size=".1"/></body></worldbody>
        <tendon><fixed limited="true" range="-1 1"><joint joint="a" coef="1"/></fixed></tendon></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(tendon).unwrap()).unwrap();
    let mut ik = Ik::new(data.model());
    assert!(ik.solve(&mut data, DT).is_ok());
    for range in [[f64::NAN, 1.0], [-1.0, f64::NAN]] {
        data.edit_model(|model| model.tendon_range_mut()[0] = range).unwrap();
        let error = ik.solve(&mut data, DT).unwrap_err();
        assert!(error.to_string().contains("tendon 0"), "{error}");
    }
    // A range without a length in it.
    for range in [[1.0, -1.0], [f64::INFINITY, f64::NEG_INFINITY], [1e308, -1e308]] {
        data.edit_model(|model| model.tendon_range_mut()[0] = range).unwrap();
        let _ = ik.solve(&mut data, DT);
    }
}

#[test]
fn huge_numbers_end_with_a_status() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    for target in [1e9, 1e100, 1e300, -1e308] {
        for (weight, regularisation) in [(1.0, 1e-9), (1e300, 0.0), (1e-300, 1e300), (1.0, 0.0)] {
            for speed in [f64::INFINITY, 0.0, 1e-300, 1e308] {
                let mut ik = Ik::new(&model);
                let hand = FramePosition::body(&model, "link6").unwrap().with_target([target, 0.0, target]);
                ik.add_task(Task::new(hand).with_weight(weight));
                ik.set_regularisation(regularisation).unwrap();
                ik.set_velocity_limits(speed).unwrap();
                for dt in [0.01, 1e-300, 1e300] {
                    let tick = ik.solve(&mut data, dt).unwrap();
                    assert!(tick.velocity().iter().all(|value| value.abs() <= speed.max(1e-9)), "{tick:?}");
                    assert!(tick.velocity().iter().all(|value| !value.is_nan()), "{tick:?}");
                }
            }
        }
    }
}

#[test]
fn without_tasks_or_joints_nothing_moves() {
    let mut data = Data::new(arm()).unwrap();
    let mut ik = Ik::new(data.model());
    let tick = ik.step(&mut data, DT).unwrap();
    assert!(tick.is_solved() && tick.velocity().iter().all(|value| *value == 0.0));
    let mut data = Data::new(Model::from_xml_str("<mujoco/>").unwrap()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(FramePose::new(Frame::body(&model, 0).unwrap())));
    ik.add_task(Task::new(JointPosition::all(&model)).with_priority(1));
    assert!(ik.step(&mut data, DT).unwrap().is_solved());
    assert!(ik.search(&mut data, &SearchOptions::default()).unwrap().found().is_some());
}

#[test]
fn contradicting_limits_are_reported() {
    let mut data = Data::new(
        Model::from_xml_str(
            r#"<mujoco><worldbody><body name="a"><joint name="a" type="slide"/><geom size=".1"/></body>
                 <body name="b" pos="1 0 0"><joint name="b" type="slide"/><geom size=".1"/></body></worldbody>
               <equality><joint joint1="a" joint2="b"/></equality></mujoco>"#,
        )
        .unwrap(),
    )
    .unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(JointPosition::all(&model)));
    ik.prescribe_velocity("a", Some(&[1.0])).unwrap();
    ik.prescribe_velocity("b", Some(&[-1.0])).unwrap();
    let tick = ik.solve(&mut data, DT).unwrap();
    assert_eq!(tick.status(), IkStatus::Infeasible);
    assert!(!tick.conflicts().is_empty());
    assert_eq!(tick.velocity(), [1.0, -1.0]);
    ik.prescribe_velocity("b", None).unwrap();
    let tick = ik.solve(&mut data, DT).unwrap();
    assert!(tick.is_solved());
    assert!((tick.velocity()[1] - 1.0).abs() < 1e-9);
}

#[test]
fn residuals_of_sensors_are_tasks() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::rate(SensorReading::new(&model, "torso_gyro").unwrap().with_target(&[0.0, 0.0, 0.5]).unwrap()));
    let velocity = ik.solve(&mut data, DT).unwrap().velocity().to_vec();
    data.qvel_mut().copy_from_slice(&velocity);
    data.forward().unwrap();
    assert!((data.sensor("torso_gyro").unwrap().data().unwrap()[2] - 0.5).abs() < 1e-6);
}
