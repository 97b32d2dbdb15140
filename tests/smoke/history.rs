//! Delays of actuators and sensors. The independent sources are the C functions of the same engine,
//! and the definition of a delay.

use std::sync::Arc;

use mujoco_safe::data::Interpolation;
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::{Batch, Data, Differences, Error, Lineariser, Model, StateSpec, sys};

use super::Raw;

/// A pendulum above a floor, with every order of interpolation, a sample at intervals, and a
/// contact sensor.
const MODEL: &str = r#"<mujoco>
  <worldbody>
    <geom type="plane" size="1 1 .1" pos="0 0 -.2"/>
    <body><joint name="a" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/><site name="s" pos=".3 0 0" size=".2"/></body>
  </worldbody>
  <actuator>
    <motor name="delayed" joint="a" nsample="6" delay=".01"/><motor name="direct" joint="a"/>
    <motor name="linear" joint="a" nsample="6" delay=".007" interp="linear"/>
    <general joint="a" dyntype="filter" dynprm=".1" nsample="8" delay=".009" interp="cubic"/>
  </actuator>
  <sensor>
    <jointpos name="present" joint="a"/><jointpos name="late" joint="a" nsample="6" delay=".01"/>
    <jointvel joint="a" nsample="4" delay=".005" interp="linear"/><accelerometer site="s" nsample="8" delay=".011" interp="cubic"/>
    <touch site="s" nsample="3" interval=".01 0"/>
  </sensor>
</mujoco>"#;

fn model() -> Arc<Model> {
    Arc::new(Model::from_xml_str(MODEL).unwrap())
}

/// Sets controls that change with each step.
fn control(ctrl: &mut [f64], step: usize) {
    for (index, control) in ctrl.iter_mut().enumerate() {
        *control = 0.3 * f64::sin(0.05 * step as f64 + index as f64);
    }
}

fn advance(data: &mut Data, steps: std::ops::Range<usize>) {
    for step in steps {
        control(data.ctrl_mut(), step);
        data.step().unwrap();
    }
}

/// Returns an array of the engine.
fn array<'a>(values: *const f64, length: usize) -> &'a [f64] {
    // SAFETY: the callers pass an array of a living data with its length.
    unsafe { std::slice::from_raw_parts(values, length) }
}

#[test]
fn a_trajectory_with_delays_equals_that_of_the_c_functions_bit_for_bit() {
    let mut data = Data::new(model()).unwrap();
    let model = data.model().clone();
    let raw = Raw(c!(mj_makeData(model.as_ptr())));
    let mut touched = false;
    for step in 0..500 {
        control(data.ctrl_mut(), step);
        // SAFETY: the array has nu numbers, and nothing else uses the data.
        control(unsafe { std::slice::from_raw_parts_mut((*raw.0).ctrl, model.nu()) }, step);
        data.step().unwrap();
        c!(mj_step(model.as_ptr(), raw.0));
        // SAFETY: the pointers of a living data.
        let (qpos, sensordata, history) = unsafe { ((*raw.0).qpos, (*raw.0).sensordata, (*raw.0).history) };
        assert_eq!(data.qpos(), array(qpos, model.nq()), "step {step}");
        assert_eq!(data.sensordata(), array(sensordata, model.nsensordata()), "step {step}");
        assert_eq!(data.history(), array(history, data.history().len()), "step {step}");
        touched |= data.ncon() > 0;
    }
    assert!(touched);
}

#[test]
fn a_delayed_sensor_returns_the_value_of_an_earlier_step() {
    let mut data = Data::new(model()).unwrap();
    let delay = (0.01 / data.model().timestep()).round() as usize;
    let mut positions = Vec::new();
    for step in 0..50 {
        control(data.ctrl_mut(), step);
        data.forward().unwrap();
        positions.push(data.sensor("present").unwrap().data().unwrap()[0]);
        let late = data.sensor("late").unwrap().data().unwrap()[0];
        if step > delay {
            assert_eq!(late, positions[step - delay], "step {step}");
        }
        data.step().unwrap();
    }
    assert!(positions[49] != positions[30]);
}

#[test]
fn a_control_acts_after_its_delay() {
    let mut data = Data::new(model()).unwrap();
    let timestep = data.model().timestep();
    data.ctrl_mut()[0] = 1.0;
    let mut first = None;
    for step in 0..20 {
        data.step().unwrap();
        if first.is_none() && data.actuator("delayed").unwrap().force() != 0.0 {
            first = Some(step);
        }
    }
    assert_eq!(first, Some((0.01 / timestep).round() as usize));
}

#[test]
fn a_simulation_that_is_set_to_a_state_with_delays_continues_bit_for_bit() {
    let mut data = Data::new(model()).unwrap();
    advance(&mut data, 0..100);
    let saved = data.state(StateSpec::INTEGRATION);
    let mut clone = data.clone();
    advance(&mut data, 100..200);
    let expected = data.state(StateSpec::INTEGRATION);
    let mut other = Data::new(data.model().clone()).unwrap();
    other.set_state(StateSpec::INTEGRATION, &saved).unwrap();
    advance(&mut other, 100..200);
    advance(&mut clone, 100..200);
    assert_eq!(other.state(StateSpec::INTEGRATION), expected);
    assert_eq!(clone.state(StateSpec::INTEGRATION), expected);
    data.reset().unwrap();
    assert_eq!(data.history(), Data::new(data.model().clone()).unwrap().history());
}

#[test]
fn a_batch_with_delays_equals_single_simulations() {
    let model = model();
    let mut batch = Batch::new(model.clone(), 3).unwrap();
    let mut alone = Data::new(model.clone()).unwrap();
    for step in 0..50 {
        let mut ctrl = vec![0.0; model.nu()];
        control(&mut ctrl, step);
        batch
            .step(|_, controls| {
                for (row, controls) in controls.as_mut_slice().chunks_exact_mut(model.nu()).enumerate() {
                    controls.iter_mut().zip(&ctrl).for_each(|(target, value)| *target = value * (row + 1) as f64);
                }
            })
            .unwrap();
        alone.ctrl_mut().iter_mut().zip(&ctrl).for_each(|(target, value)| *target = value * 2.0);
        alone.step().unwrap();
        assert_eq!(batch.states().row(1), alone.state(StateSpec::INTEGRATION), "step {step}");
    }
}

#[test]
fn a_state_with_the_index_of_a_sample_that_does_not_exist_is_rejected_and_changes_nothing() {
    let mut data = Data::new(model()).unwrap();
    advance(&mut data, 0..10);
    let before = data.state(StateSpec::INTEGRATION);
    let cursors: Vec<usize> = (data.model().actuator_historyadr().iter().chain(data.model().sensor_historyadr()))
        .filter(|address| **address >= 0)
        .map(|address| usize::try_from(*address).unwrap() + 1)
        .collect();
    assert_eq!(cursors.len(), 7);
    for cursor in cursors {
        for wrong in [-1.0, 0.5, 8.0, 1e9, -1e300, f64::INFINITY, f64::NAN] {
            let mut state = data.history().to_vec();
            state[cursor] = wrong;
            let error = data.set_state(StateSpec::HISTORY, &state).unwrap_err();
            assert!(matches!(error, Error::Invalid { .. }), "{error}");
            assert!(error.to_string().contains(&format!("history[{cursor}]")), "{error}");
        }
    }
    assert_eq!(data.state(StateSpec::INTEGRATION), before);
}

#[test]
fn any_samples_and_times_are_safe() {
    let mut data = Data::new(model()).unwrap();
    let range = |address: i32, samples: i32, width: usize| {
        let start = usize::try_from(address).unwrap();
        (start, start + 2 + usize::try_from(samples).unwrap() * (1 + width))
    };
    let model = data.model().clone();
    let actuators = model.actuator_history().iter().zip(model.actuator_historyadr()).map(|pair| (pair, 1));
    let widths = model.sensor_dim().iter().map(|&width| usize::try_from(width).unwrap());
    let sensors = model.sensor_history().iter().zip(model.sensor_historyadr()).zip(widths);
    let buffers: Vec<(usize, usize)> = (actuators.chain(sensors))
        .filter(|((samples, _), _)| samples[0] > 0)
        .map(|((samples, address), width)| range(*address, samples[0], width))
        .collect();
    for (index, value) in [f64::NAN, f64::INFINITY, -1e300, 0.0, 1e9].into_iter().cycle().take(40).enumerate() {
        let mut state = data.history().to_vec();
        for &(start, end) in &buffers {
            state[start] = value;
            (start + 2 + index % 3..end).step_by(1 + index % 4).for_each(|at| state[at] = value);
        }
        data.set_state(StateSpec::HISTORY, &state).unwrap();
        data.set_state(StateSpec::TIME, &[if index % 2 == 0 { value } else { 0.3 }]).unwrap();
        for _ in 0..5 {
            if data.step().is_err() {
                data.reset().unwrap();
            }
        }
    }
}

#[test]
fn linearisations_with_delays_are_unsupported() {
    let mut data = Data::new(model()).unwrap();
    let error = data.transition_fd(1e-6, Differences::Central).unwrap_err();
    assert!(matches!(&error, Error::Unsupported(text) if text.contains("delays")), "{error}");
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    assert!(matches!(lineariser.linear_system(&mut data), Err(Error::Unsupported(_))));
    data.step().unwrap();
}

#[test]
fn the_state_of_the_engine_has_the_same_buffers() {
    let mut data = Data::new(model()).unwrap();
    advance(&mut data, 0..30);
    let part = sys::mjSTATE_HISTORY;
    let length = usize::try_from(c!(mj_stateSize(data.model().as_ptr(), part as _))).unwrap();
    let mut state = vec![0.0; length];
    c!(mj_getState(data.model().as_ptr(), data.as_ptr(), state.as_mut_ptr(), part as _));
    assert_eq!(data.state(StateSpec::HISTORY), state);
}

/// The model, and one with an actuator with two controls between the others.
fn models() -> Vec<Arc<Model>> {
    let mut models = vec![model()];
    if cfg!(engine_since = "3.17.0") {
        let pid = r#"<pid name="pid" joint="a" kp="2" nsample="5" delay=".007"/><motor name="direct""#;
        models.push(Arc::new(Model::from_xml_str(&MODEL.replace("<motor name=\"direct\"", pid)).unwrap()));
        assert!(models[1].nu() > models[1].nactuator());
    }
    models
}

#[test]
fn values_at_earlier_times_are_those_of_the_c_functions_bit_for_bit() {
    models().into_iter().for_each(check_values_at_earlier_times);
}

fn check_values_at_earlier_times(model: Arc<Model>) {
    let mut data = Data::new(model).unwrap();
    let model = data.model().clone();
    advance(&mut data, 0..40);
    data.forward().unwrap();
    let time = data.time();
    let orders = [(None, -1), (Some(Interpolation::ZeroOrderHold), 0), (Some(Interpolation::Linear), 1)];
    for (order, number) in orders.into_iter().chain([(Some(Interpolation::Cubic), 2)]) {
        for step in -4..40 {
            let time = time - 0.0013 * f64::from(step);
            for actuator in 0..model.nactuator() {
                // The C functions take -1 for the interpolation of the element.
                let indices = model.actuator(actuator).unwrap().controls();
                let controls = indices.len();
                let (mut ours, mut theirs) = (vec![f64::NAN; controls], vec![f64::NAN; controls]);
                let result = data.read_ctrl_into(actuator, time, order, &mut ours);
                // The function of these engines does not know several controls.
                if cfg!(all(engine_since = "3.11.0", not(engine_since = "3.14.0")))
                    && indices != (actuator..actuator + 1)
                {
                    assert!(result.is_err());
                    continue;
                }
                result.unwrap();
                let (m, d, id) = (model.as_ptr(), data.as_ptr(), actuator as i32);
                #[cfg(engine_since = "3.14.0")]
                {
                    let at = c!(mj_readCtrl(m, d, id, time, theirs.as_mut_ptr(), number));
                    if !at.is_null() {
                        theirs = array(at, controls).to_vec();
                    }
                }
                #[cfg(not(engine_since = "3.14.0"))]
                {
                    theirs[0] = c!(mj_readCtrl(m, d, id, time, number));
                }
                assert_eq!(ours, theirs, "actuator {actuator}, {time}, {order:?}");
            }
            for sensor in model.sensors() {
                let (mut ours, mut theirs) = (vec![f64::NAN; sensor.dim()], vec![f64::NAN; sensor.dim()]);
                data.read_sensor_into(sensor, time, order, &mut ours).unwrap();
                let (m, d, id) = (model.as_ptr(), data.as_ptr(), sensor.index() as i32);
                let at = c!(mj_readSensor(m, d, id, time, theirs.as_mut_ptr(), number));
                if !at.is_null() {
                    theirs = array(at, sensor.dim()).to_vec();
                }
                assert_eq!(ours, theirs, "sensor {sensor:?}, {time}, {order:?}");
            }
        }
    }
}

#[test]
fn buffers_are_filled_as_by_the_c_functions() {
    models().into_iter().for_each(check_filled_buffers);
}

fn check_filled_buffers(model: Arc<Model>) {
    let mut data = Data::new(model).unwrap();
    advance(&mut data, 0..7);
    let model = data.model().clone();
    let raw = Raw(c!(mj_copyData(std::ptr::null_mut(), model.as_ptr(), data.as_ptr())));
    let times = [-0.05, -0.04, -0.02, 0.0, 0.01, 0.3];
    let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    data.init_ctrl_history("delayed", &times, &values).unwrap();
    data.init_sensor_history("late", &times, &values, 0.25).unwrap();
    let late = model.sensor("late").unwrap().index() as i32;
    c!(mj_initCtrlHistory(model.as_ptr(), raw.0, 0, times.as_ptr(), values.as_ptr()));
    c!(mj_initSensorHistory(model.as_ptr(), raw.0, late, times.as_ptr(), values.as_ptr(), 0.25));
    if let Ok(pid) = model.actuator("pid") {
        let both: Vec<f64> = (0..5 * pid.controls().len()).map(|number| number as f64).collect();
        data.init_ctrl_history(pid, &times[..5], &both).unwrap();
        c!(mj_initCtrlHistory(model.as_ptr(), raw.0, pid.index() as i32, times.as_ptr(), both.as_ptr()));
        assert!(matches!(data.init_ctrl_history(pid, &times[..5], &values[..5]), Err(Error::Shape { .. })));
    }
    // SAFETY: a pointer of a living data.
    let theirs = array(unsafe { (*raw.0).history }, data.history().len());
    assert_eq!(data.history(), theirs);
    assert!(matches!(data.init_ctrl_history("delayed", &times[1..], &values), Err(Error::Shape { .. })));
    assert!(matches!(data.init_ctrl_history("delayed", &times, &values[1..]), Err(Error::Shape { .. })));
    let error = data.init_ctrl_history("delayed", &values.map(|value| -value), &values).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    for wrong in [f64::NAN, f64::NEG_INFINITY, times[1] - 1e-17] {
        let wrong = [wrong, times[1], times[2], times[3], times[4], times[5]];
        let error = data.init_sensor_history("late", &wrong, &values, 0.25).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
    assert!(matches!(data.init_sensor_history("late", &times, &values, f64::NAN), Err(Error::Invalid { .. })));
    assert_eq!(data.history(), theirs);
}

#[test]
fn buffers_with_hostile_times_are_read_within_their_memory() {
    let mut data = Data::new(model()).unwrap();
    advance(&mut data, 0..9);
    data.forward().unwrap();
    let mut history = data.state(StateSpec::HISTORY);
    for hostile in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 0.0] {
        for place in 0..history.len() {
            let before = std::mem::replace(&mut history[place], hostile);
            // Invalid cursors are rejected.
            if data.set_state(StateSpec::HISTORY, &history).is_ok() {
                for order in [Interpolation::ZeroOrderHold, Interpolation::Linear, Interpolation::Cubic] {
                    for time in [-1.0, 0.003, 0.013, 1e300, f64::INFINITY] {
                        for actuator in 0..data.model().nactuator() {
                            data.read_ctrl_into(actuator, time, Some(order), &mut [0.0]).unwrap();
                        }
                        for sensor in data.model().sensors() {
                            data.read_sensor_into(sensor, time, Some(order), &mut vec![0.0; sensor.dim()]).unwrap();
                        }
                    }
                }
            }
            history[place] = before;
        }
    }
}
