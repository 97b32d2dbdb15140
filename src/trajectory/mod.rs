//! Recorded trajectories: times, states and controls, with import and export as CSV, NumPy archives and serde data.

mod csv;
#[cfg(feature = "npz")]
mod npz;
#[cfg(feature = "serde")]
mod serde;

use crate::controller::Controller;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;

/// Recorded simulation: the time, the physics state `[qpos; qvel; act]` and the controls of each record.
///
/// ```
/// use mujoco_safe::{Data, RandomController, Trajectory, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// let mut trajectory = Trajectory::new(data.model());
/// trajectory.record(&mut data, &mut RandomController::new(1), 400)?;
/// assert_eq!(trajectory.len(), 400);
/// assert_eq!(trajectory.qpos(0), data.model().qpos0());
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    sizes: Sizes,
    times: Vec<f64>,
    /// States `[qpos; qvel; act]`, concatenated.
    states: Vec<f64>,
    /// Controls, concatenated.
    controls: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sizes {
    nq: usize,
    nv: usize,
    na: usize,
    nu: usize,
}

impl Sizes {
    fn of(model: &Model) -> Self {
        Self { nq: model.nq(), nv: model.nv(), na: model.na(), nu: model.nu() }
    }

    fn state(self) -> usize {
        self.nq + self.nv + self.na
    }

    /// Returns the column names of a file.
    fn columns(self) -> impl Iterator<Item = String> {
        let part = |name: &'static str, count: usize| (0..count).map(move |index| format!("{name}{index}"));
        std::iter::once("time".to_owned())
            .chain(part("qpos", self.nq))
            .chain(part("qvel", self.nv))
            .chain(part("act", self.na))
            .chain(part("ctrl", self.nu))
    }
}

fn other_sizes(what: &'static str, expected: Sizes, found: Sizes) -> Error {
    let differs = expected.state() != found.state() || expected.nu != found.nu;
    if differs {
        return Error::Shape { what, expected: (expected.state(), expected.nu), found: (found.state(), found.nu) };
    }
    let list = |sizes: Sizes| format!("nq {}, nv {}, na {}", sizes.nq, sizes.nv, sizes.na);
    Error::invalid(what, list(found), list(expected))
}

impl Trajectory {
    /// Creates an empty trajectory for simulations of this model.
    pub fn new(model: &Model) -> Self {
        Self { sizes: Sizes::of(model), times: Vec::new(), states: Vec::new(), controls: Vec::new() }
    }

    /// Creates an empty trajectory with capacity for `records` records, so that [`push`](Self::push) does not allocate up to that
    /// number. If there is not enough memory, the trajectory starts without capacity and grows on demand.
    pub fn with_capacity(model: &Model, records: usize) -> Self {
        let mut trajectory = Self::new(model);
        let Self { sizes, times, states, controls } = &mut trajectory;
        let room = |values: &mut Vec<f64>, width: usize| {
            records.checked_mul(width).is_some_and(|length| values.try_reserve_exact(length).is_ok())
        };
        if room(times, 1) && room(states, sizes.state()) && room(controls, sizes.nu) {
            return trajectory;
        }
        Self::new(model)
    }

    /// Appends the present time, state and controls.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the simulation's model has other sizes.
    pub fn push(&mut self, data: &Data) -> Result<()> {
        let sizes = Sizes::of(data.model());
        if sizes != self.sizes {
            return Err(other_sizes("the simulation to record (state, controls)", self.sizes, sizes));
        }
        self.times.push(data.time());
        for part in [data.qpos(), data.qvel(), data.act()] {
            self.states.extend_from_slice(part);
        }
        self.controls.extend_from_slice(data.ctrl());
        Ok(())
    }

    /// Performs `steps` steps under a controller. Records each state before its step, with the controls applied in that step.
    ///
    /// # Errors
    ///
    /// Errors of the controller and of [`Data::step`]; earlier records are kept.
    pub fn record(&mut self, data: &mut Data, controller: &mut (impl Controller + ?Sized), steps: usize) -> Result<()> {
        for _ in 0..steps {
            controller.control(data)?;
            self.push(data)?;
            data.step()?;
        }
        Ok(())
    }

    /// Returns the number of records.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Returns `true` if there are no records.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Returns all times, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns all states `[qpos; qvel; act]`, concatenated.
    pub fn states(&self) -> &[f64] {
        &self.states
    }

    /// Returns all controls, concatenated.
    pub fn controls(&self) -> &[f64] {
        &self.controls
    }

    /// Returns the state `[qpos; qvel; act]` of a record.
    ///
    /// # Panics
    ///
    /// If the record does not exist.
    pub fn state(&self, record: usize) -> &[f64] {
        self.check(record);
        &self.states[record * self.sizes.state()..][..self.sizes.state()]
    }

    /// Returns the positions of a record.
    ///
    /// # Panics
    ///
    /// If the record does not exist.
    pub fn qpos(&self, record: usize) -> &[f64] {
        &self.state(record)[..self.sizes.nq]
    }

    /// Returns the velocities of a record.
    ///
    /// # Panics
    ///
    /// If the record does not exist.
    pub fn qvel(&self, record: usize) -> &[f64] {
        &self.state(record)[self.sizes.nq..][..self.sizes.nv]
    }

    /// Returns the controls of a record.
    ///
    /// # Panics
    ///
    /// If the record does not exist.
    pub fn ctrl(&self, record: usize) -> &[f64] {
        self.check(record);
        &self.controls[record * self.sizes.nu..][..self.sizes.nu]
    }

    /// Returns an error unless the sizes of the model match the records.
    pub(crate) fn check_sizes(&self, model: &Model) -> Result<()> {
        let sizes = Sizes::of(model);
        if sizes == self.sizes {
            return Ok(());
        }
        Err(other_sizes("the simulation to set (state, controls)", self.sizes, sizes))
    }

    /// Checks an index before the multiplication with the width of a record, which could overflow.
    #[track_caller]
    fn check(&self, record: usize) {
        assert!(record < self.len(), "index out of range: record {record} of a trajectory of {} records", self.len());
    }

    /// Sets the time, state and controls of a simulation to those of a record.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the simulation's model has other sizes.
    ///
    /// # Panics
    ///
    /// If the record does not exist.
    pub fn apply(&self, record: usize, data: &mut Data) -> Result<()> {
        self.check_sizes(data.model())?;
        data.set_physics_state(self.state(record))?;
        data.ctrl_mut().copy_from_slice(self.ctrl(record));
        data.set_time(self.times[record]);
        Ok(())
    }
}
