//! Delays of actuators and sensors. The independent sources are the C functions of the same engine,
//! and the definition of a delay.

use std::sync::Arc;

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
