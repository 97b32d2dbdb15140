//! Sensor readings and forces on bodies: each is current, or is an error that names the missing
//! call.

use mujoco_safe::callback::Callbacks;
use mujoco_safe::data::{MissingResults, SensorUpdate};
use mujoco_safe::enums::Integrator;
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Error, Model, Result, Stage};
use proptest::prelude::*;

/// Returns a ball that swings on a tendon and lands, with a sensor of each stage, and with each
/// sensor that needs a separate computation.
fn model() -> Model {
    Model::from_xml_str(&text()).unwrap()
}

/// Returns the model with the sensors of energies, which newer engines have. They belong to the
/// position stage.
fn model_with_energies() -> Model {
    let has_energies = cfg!(engine_since = "3.5.0");
    let energies = if has_energies {
        r#"<e_kinetic name="kinetic"/><e_potential name="potential"/></sensor>"#
    } else {
        "</sensor>"
    };
    Model::from_xml_str(&text().replace("</sensor>", energies)).unwrap()
}

fn text() -> String {
    String::from(
        r#"<mujoco>
             <option timestep="0.01"/>
             <worldbody>
               <geom type="plane" size="9 9 1"/>
               <body name="arm" pos="0 0 0.3"><joint name="swing" axis="0 1 0" damping="0.1"/>
                 <geom type="capsule" size="0.05" fromto="0 0 0 0.4 0 0"/><site name="hand" pos="0.4 0 0"/>
                 <body pos="0.4 0 0"><joint axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/></body>
               </body>
             </worldbody>
             <actuator><motor name="motor" joint="swing"/></actuator>
             <sensor>
               <jointpos name="position" joint="swing"/><jointvel name="velocity" joint="swing"/>
               <accelerometer name="acceleration" site="hand"/><gyro name="gyro" site="hand"/>
               <force name="force" site="hand"/><subtreelinvel name="momentum" body="arm"/>
             </sensor>
           </mujoco>"#,
    )
}

fn is_not_computed<T>(result: &Result<T>) -> bool {
    matches!(result, Err(Error::NotComputed { .. }))
}

fn computed(data: &Data) -> [bool; 3] {
    ["position", "velocity", "acceleration"].map(|name| data.sensor(name).unwrap().data().is_ok())
}

#[test]
fn a_reading_is_an_error_until_the_stage_of_its_sensor_has_been_computed() {
    let mut data = Data::new(model()).unwrap();
    assert_eq!(computed(&data), [false; 3]);
    let error = data.sensor("gyro").unwrap().data().unwrap_err().to_string();
    assert!(error.contains("sensor_vel") && error.contains("forward"), "{error}");
    data.fwd_position().unwrap();
    assert_eq!(computed(&data), [false; 3], "positions without position sensors");
    data.sensor_pos().unwrap();
    assert_eq!(computed(&data), [true, false, false]);
    data.step1().unwrap();
    assert_eq!(computed(&data), [true, true, false]);
    data.step2().unwrap();
    assert_eq!(computed(&data), [true; 3]);
    data.step1().unwrap();
    assert_eq!(computed(&data), [true, true, false], "the acceleration belongs to the previous step");
    data.inverse().unwrap();
    assert_eq!(computed(&data), [true; 3]);
    data.forward_skip(Stage::Velocity, SensorUpdate::Skip).unwrap_err();
    data.forward().unwrap();
    data.forward_skip(Stage::Velocity, SensorUpdate::Skip).unwrap();
    assert_eq!(computed(&data), [true, true, false], "forces without force sensors");
    data.forward_skip(Stage::Velocity, SensorUpdate::Compute).unwrap();
    assert_eq!(computed(&data), [true; 3]);
    assert_eq!(computed(&data.clone()), [true; 3]);
    data.edit_model(|model| model.set_timestep(0.001)).unwrap();
    assert_eq!(computed(&data), [false; 3], "the readings belong to another model");
    data.step().unwrap();
    data.reset().unwrap();
    assert_eq!(computed(&data), [false; 3]);
}

#[test]
fn step2_does_not_validate_readings_that_step1_has_not_computed() {
    let mut data = Data::new(model()).unwrap();
    data.fwd_position().unwrap();
    data.fwd_velocity().unwrap();
    data.step2().unwrap();
    assert_eq!(computed(&data), [false, false, true]);
}

#[test]
fn sensors_that_the_options_disable_have_no_reading() {
    let mut data = Data::new(model()).unwrap();
    data.edit_model(|model| model.edit_options(|options| options.disable |= DisableFlags::SENSOR)).unwrap();
    data.forward().unwrap();
    let result = data.sensor("gyro").unwrap().data();
    assert!(matches!(result, Err(Error::Unsupported(_))), "{result:?}");
}

#[test]
fn forces_on_bodies_are_an_error_until_they_have_been_computed() {
    let mut data = Data::new(model()).unwrap();
    for _ in 0..50 {
        data.step().unwrap();
        let arm = data.body("arm").unwrap();
        assert!(is_not_computed(&arm.cfrc_ext()) && is_not_computed(&arm.cfrc_int()) && is_not_computed(&arm.cacc()));
        assert!(is_not_computed(&arm.subtree_linvel()) && is_not_computed(&arm.subtree_angmom()));
    }
    let error = data.body("arm").unwrap().cfrc_ext().unwrap_err().to_string();
    assert!(error.contains("rne_post_constraint") && error.contains("after forward or step"), "{error}");
    assert!(is_not_computed(&data.require(MissingResults::BODY_FORCES)));
    data.rne_post_constraint().unwrap();
    data.require(MissingResults::BODY_FORCES).unwrap();
    assert_eq!(*data.body("arm").unwrap().cfrc_int().unwrap(), data.cfrc_int()[1]);
    assert!(data.cfrc_int()[1].iter().any(|&force| force != 0.0));
    data.subtree_vel().unwrap();
    assert_eq!(*data.body("arm").unwrap().subtree_linvel().unwrap(), data.subtree_linvel()[1]);
    data.step().unwrap();
    assert!(is_not_computed(&data.body("arm").unwrap().cfrc_ext()), "the forces belong to the previous state");
}

#[test]
fn require_succeeds_exactly_for_computed_results() {
    let mut data = Data::new(model()).unwrap();
    let met = |data: &Data| {
        [Stage::None, Stage::Position, Stage::Velocity, Stage::Acceleration].map(|stage| data.require(stage).is_ok())
    };
    assert_eq!(met(&data), [true, false, false, false]);
    data.fwd_position().unwrap();
    assert_eq!(met(&data), [true, true, false, false]);
    data.step1().unwrap();
    assert_eq!(met(&data), [true, true, true, false]);
    assert!(is_not_computed(&data.require(MissingResults::SENSORS)));
    data.step().unwrap();
    assert_eq!(met(&data), [true; 4]);
    data.require(MissingResults::SENSORS).unwrap();
}

#[test]
fn a_controller_in_a_step_reads_the_sensors_of_the_stages_before_it() {
    for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
        let mut data = Data::new(model()).unwrap();
        data.edit_model(|model| model.edit_options(|options| options.integrator = integrator)).unwrap();
        let mut calls = 0;
        let control = Callbacks::new().with_control(|context| {
            assert_eq!(computed(context), [true, true, false], "the acceleration is not computed yet");
            let position = context.sensor("position").unwrap().data().unwrap()[0];
            context.ctrl_mut()[0] = -position;
            calls += 1;
        });
        data.with_callbacks(control, |data| data.step_n(3)).unwrap();
        assert!(calls >= 3);
    }
}

/// A call that computes results, in some cases after a change of its inputs.
type Call = fn(&mut Data, f64) -> Result<()>;

fn sensors(number: f64) -> SensorUpdate {
    if number > 0.0 { SensorUpdate::Skip } else { SensorUpdate::Compute }
}

const CALLS: [Call; 19] = [
    |data, _| data.forward(),
    |data, _| data.inverse(),
    |data, _| data.step(),
    |data, _| data.step1(),
    |data, _| data.step2(),
    |data, _| data.sensor_pos(),
    |data, _| data.sensor_vel(),
    |data, _| data.sensor_acc(),
    |data, _| data.runge_kutta(),
    |data, _| data.fwd_velocity(),
    |data, _| data.forward_skip(Stage::Position, SensorUpdate::Skip),
    |data, number| {
        data.qpos_mut()[0] = number;
        data.fwd_position()
    },
    |data, number| {
        data.qpos_mut()[1] = number;
        data.kinematics()
    },
    |data, number| {
        data.qpos_mut()[0] = number;
        data.forward_skip(Stage::None, sensors(number))
    },
    |data, number| {
        data.qvel_mut()[0] = number;
        data.fwd_velocity()
    },
    |data, number| {
        data.qvel_mut()[0] = number;
        data.com_vel()
    },
    |data, number| {
        data.qvel_mut()[0] = number;
        data.forward_skip(Stage::Position, sensors(number))
    },
    |data, number| {
        data.ctrl_mut()[0] = number;
        data.forward_skip(Stage::Velocity, sensors(number))?;
        data.rne_post_constraint()
    },
    |data, number| {
        data.qacc_mut()[0] = number;
        data.inverse_skip(if number > 0.5 { Stage::Position } else { Stage::Velocity }, sensors(number))
    },
];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// Calling the sensor's stage again gives the same reading.
    #[test]
    fn every_available_reading_is_current(
        calls in prop::collection::vec((0..CALLS.len(), -1.0..1.0), 1..12),
    ) {
        let mut data = Data::new(model_with_energies()).unwrap();
        for (call, number) in calls {
            // Some calls have requirements that earlier calls have not met.
            let before = data.state(mujoco_safe::StateSpec::INTEGRATION);
            if CALLS[call](&mut data, number).is_err() {
                // Inputs written for a rejected call are not tracked.
                data.set_state(mujoco_safe::StateSpec::INTEGRATION, &before).unwrap();
                data.forward().unwrap();
            }
            let mut again = data.clone();
            if again.sensor_pos().is_err() {
                continue; // The state has advanced.
            }
            let _ = (again.sensor_vel(), again.sensor_acc());
            for sensor in data.sensors() {
                if let (Ok(ours), Ok(theirs)) = (sensor.data(), again.sensor(sensor).data()) {
                    prop_assert_eq!(ours, theirs, "{:?} after call {}", sensor, call);
                }
            }
        }
    }
}
