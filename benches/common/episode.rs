//! A repeatable simulation with an observer.

use mujoco_safe::{Controller, Data, RandomController, Result, StateSpec};

/// Simulation of the standing humanoid from one state under the same random controls, with an
/// observer of its steps.
pub(crate) struct Episode<O> {
    data: Data,
    observer: O,
    start: Vec<f64>,
    controls: Vec<Vec<f64>>,
}

impl<O> Episode<O> {
    /// Prepares this number of steps.
    pub(crate) fn new(mut data: Data, steps: u32, observer: impl FnOnce(&Data) -> Result<O>) -> Result<Self> {
        data.reset_to_key("stand")?;
        let start = data.state(StateSpec::INTEGRATION);
        let mut random = RandomController::new(1);
        let mut control = || {
            random.control(&mut data)?;
            Ok(data.ctrl().iter().map(|ctrl| 0.1 * ctrl).collect())
        };
        let controls = (0..steps).map(|_| control()).collect::<Result<_>>()?;
        let observer = observer(&data)?;
        Ok(Self { data, observer, start, controls })
    }

    pub(crate) fn observer(&self) -> &O {
        &self.observer
    }

    pub(crate) fn run(&mut self, step: impl Fn(&mut O, &mut Data) -> Result<()>) {
        let Self { data, observer, start, controls } = self;
        data.set_state(StateSpec::INTEGRATION, start).expect("the state has the right length");
        for controls in controls {
            data.ctrl_mut().copy_from_slice(controls);
            step(observer, data).expect("the simulation is stable");
        }
    }
}
