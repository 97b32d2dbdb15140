//! Identification of parameters from measurements.

#[path = "../common/cases.rs"]
mod cases;
mod errors;
mod least_squares;
mod problems;
#[cfg(feature = "html")]
mod report;
mod robots;
mod shooting;
mod statistics;

use std::sync::Arc;

use mujoco_safe::identification::{Experiment, Measurement, Signal};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Matrix, Model};

/// A mass on a spring with a motor.
const SPRING: &str = r#"<mujoco>
  <option timestep="0.002"><flag contact="disable"/></option>
  <worldbody>
    <body name="mass">
      <inertial pos="0 0 0" mass="1" diaginertia="0.001 0.001 0.001"/>
      <joint name="slide" type="slide" axis="1 0 0" stiffness="100" damping="5"/>
      <geom type="sphere" size="0.05"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide"/></actuator>
  <sensor><jointpos name="position" joint="slide"/><jointvel name="velocity" joint="slide"/></sensor>
</mujoco>"#;

/// Two pendulums, one below the other, without friction: a chaotic motion.
const DOUBLE_PENDULUM: &str = r#"<mujoco>
  <option timestep="0.002" integrator="RK4"><flag contact="disable"/></option>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.4" size=".02" mass=".5"/>
      <body name="lower" pos="0 0 -.4">
        <joint name="elbow" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass=".3"/>
      </body>
    </body>
  </worldbody>
  <sensor><jointpos name="q1" joint="shoulder"/><jointpos name="q2" joint="elbow"/></sensor>
</mujoco>"#;

fn model(xml: &str) -> Arc<Model> {
    Arc::new(Model::from_xml_str(xml).unwrap())
}

/// Recording of a simulation with the true parameters: times, physics states, controls and
/// readings.
struct Log {
    times: Vec<f64>,
    states: Matrix,
    controls: Matrix,
    readings: Matrix,
}

/// Simulates a truth, and records each state with the readings in it.
fn record(mut truth: Data, steps: usize, control: impl Fn(f64) -> Vec<f64>) -> Log {
    let model = truth.model().clone();
    let (mut times, mut states, mut controls, mut readings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for _ in 0..steps {
        times.push(truth.time());
        states.extend(truth.physics_state());
        let control = control(truth.time());
        truth.ctrl_mut().copy_from_slice(&control);
        controls.extend_from_slice(truth.ctrl());
        truth.step().unwrap();
        // Of the state before the step.
        readings.extend_from_slice(truth.sensordata());
    }
    let matrix = |values: Vec<f64>| Matrix::from_row_major(steps, values.len() / steps, values);
    let [states, controls, readings] = [states, controls, readings].map(matrix);
    assert_eq!(states.ncols(), model.nq() + model.nv() + model.na());
    Log { times, states, controls, readings }
}

impl Log {
    /// Returns every `stride`-th reading of a sensor.
    fn sensor(&self, model: &Model, name: &str, stride: usize) -> Signal {
        self.signal(model.sensor(name).unwrap().data_range(), stride)
    }

    /// Returns every `stride`-th of some readings.
    fn signal(&self, range: std::ops::Range<usize>, stride: usize) -> Signal {
        let rows: Vec<usize> = (0..self.times.len()).step_by(stride).collect();
        let values = rows.iter().flat_map(|&row| self.readings.row(row)[range.clone()].to_vec()).collect();
        let times = rows.iter().map(|&row| self.times[row]).collect();
        Signal::new(times, Matrix::from_row_major(rows.len(), range.len(), values)).unwrap()
    }

    fn controls(&self) -> Signal {
        Signal::new(self.times.clone(), self.controls.clone()).unwrap()
    }

    /// Returns the experiment that measures all sensors.
    fn experiment(&self, start: &Data) -> Experiment {
        let model = start.model();
        let all = model
            .sensors()
            .map(|sensor| Measurement::of_sensor(model, sensor.id(), self.signal(sensor.data_range(), 1)).unwrap());
        all.fold(Experiment::new("log", start).with_controls(self.controls()), Experiment::with_measurement)
    }
}

fn add_noise(signal: &Signal, deviation: f64, noise: &mut Random) -> Signal {
    let mut values = signal.values().clone();
    values.as_mut_slice().iter_mut().for_each(|value| *value += deviation * noise.normal());
    Signal::new(signal.times().to_vec(), values).unwrap()
}
