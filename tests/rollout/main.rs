//! Rollouts and batches against a plain loop over `Data::step`, with a separate `Data` for each
//! simulation.
#![forbid(unsafe_code)]

#[path = "../common/cases.rs"]
mod cases;
#[macro_use]
#[path = "../common/fields.rs"]
mod fields;

mod adopt;
mod batch;
mod controllers;
mod disturbances;
mod edits;
mod environments;
mod equality;
mod field_parameters;
mod forward;
mod gymnasium;
mod isolation;
mod parameters;
mod schedules;
mod sizes;
mod tasks;

#[path = "../common/parameter_edits.rs"]
mod parameter_edits;
#[path = "../common/trouble.rs"]
mod trouble;

use std::sync::Arc;

use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder};
use mujoco_safe::{Controller, Data, Model, RandomController, StateSpec, sample};

/// Returns a pool of this number of threads.
fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

/// Returns the bits, so that NaN equals itself and zero differs from negative zero.
fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Expected results of rollouts.
#[derive(Default, PartialEq, Debug)]
struct Expected {
    states: Vec<f64>,
    sensordata: Vec<f64>,
}

/// A model, initial states and controls.
struct Case {
    model: Arc<Model>,
    count: usize,
    steps: usize,
    spec: StateSpec,
    initial: Vec<f64>,
    controls: Vec<f64>,
}

impl Case {
    /// Returns a case with initial states from random motion, and random controls.
    fn new(model: Model, count: usize, steps: usize) -> Self {
        let model = Arc::new(model);
        let spec = StateSpec::INTEGRATION;
        let (mut initial, mut controls) = (Vec::new(), Vec::new());
        for index in 0..count {
            let mut random = RandomController::new(index as u64);
            let mut data = Data::new(model.clone()).unwrap();
            for _ in 0..5 * index {
                random.control(&mut data).unwrap();
                data.step().unwrap();
            }
            initial.extend(data.state(spec));
            for _ in 0..steps {
                random.control(&mut data).unwrap();
                controls.extend_from_slice(data.ctrl());
            }
        }
        Self { model, count, steps, spec, initial, controls }
    }

    fn all() -> Vec<Self> {
        let every_element = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
        vec![
            Self::new(sample::cartpole(), 13, 60),
            Self::new(sample::humanoid(), 7, 25),
            Self::new(Model::from_xml_path(every_element).unwrap(), 6, 20),
        ]
    }

    fn initial_of(&self, index: usize) -> &[f64] {
        let size = self.model.state_size(self.spec);
        &self.initial[index * size..][..size]
    }

    fn controls_of(&self, index: usize, step: usize) -> &[f64] {
        let nu = self.model.nu();
        &self.controls[(index * self.steps + step) * nu..][..nu]
    }

    /// Computes the expected results in a plain loop.
    fn expected(&self) -> Expected {
        let mut expected = Expected::default();
        for index in 0..self.count {
            let mut data = Data::new(self.model.clone()).unwrap();
            data.set_state(self.spec, self.initial_of(index)).unwrap();
            expected.states.extend(data.physics_state());
            for step in 0..self.steps {
                data.ctrl_mut().copy_from_slice(self.controls_of(index, step));
                data.step().unwrap();
                expected.sensordata.extend_from_slice(data.sensordata());
                expected.states.extend(data.physics_state());
            }
        }
        expected
    }
}
