//! Recorded states: times, states and controls.
//!
//! | file | what is in it |
//! |---|---|
//! | `csv.rs` | files of text |
//! | `npz.rs` | files of NumPy (feature `npz`) |
//! | `serde.rs` | the records as plain data, checked on their way in (feature `serde`) |

mod csv;
#[cfg(feature = "npz")]
mod npz;
#[cfg(feature = "serde")]
mod serde;

use crate::controller::Controller;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;

/// What a simulation went through: at each recorded moment the time, the physics state `[qpos; qvel; act]` and the controls.
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
    /// One state behind another.
    states: Vec<f64>,
    /// One vector of controls behind another.
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

    /// The names of the columns of a file.
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
    /// An empty one, for simulations of this model.
    pub fn new(model: &Model) -> Self {
        Self { sizes: Sizes::of(model), times: Vec::new(), states: Vec::new(), controls: Vec::new() }
    }

    /// Returns an empty trajectory with room for this many records, so that [`push`](Self::push) allocates nothing up to there.
    /// If there is no memory for so many, it has no room, and grows with its records.
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

    /// Records the present time, state and controls.
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

    /// Takes `steps` steps under a controller and records each moment before its step, with the controls that were set for it.
    ///
    /// # Errors
    ///
    /// Those of the controller and of [`Data::step`]; what was recorded up to there stays.
    pub fn record(&mut self, data: &mut Data, controller: &mut (impl Controller + ?Sized), steps: usize) -> Result<()> {
        for _ in 0..steps {
            controller.control(data)?;
            self.push(data)?;
            data.step()?;
        }
        Ok(())
    }

    /// The number of records.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// All times, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// All states, one `[qpos; qvel; act]` behind another.
    pub fn states(&self) -> &[f64] {
        &self.states
    }

    /// All controls, one vector behind another.
    pub fn controls(&self) -> &[f64] {
        &self.controls
    }

    /// The state `[qpos; qvel; act]` of a record.
    ///
    /// # Panics
    ///
    /// If there is no such record.
    pub fn state(&self, record: usize) -> &[f64] {
        self.check(record);
        &self.states[record * self.sizes.state()..][..self.sizes.state()]
    }

    /// The positions of a record.
    ///
    /// # Panics
    ///
    /// If there is no such record.
    pub fn qpos(&self, record: usize) -> &[f64] {
        &self.state(record)[..self.sizes.nq]
    }

    /// The velocities of a record.
    ///
    /// # Panics
    ///
    /// If there is no such record.
    pub fn qvel(&self, record: usize) -> &[f64] {
        &self.state(record)[self.sizes.nq..][..self.sizes.nv]
    }

    /// The controls of a record.
    ///
    /// # Panics
    ///
    /// If there is no such record.
    pub fn ctrl(&self, record: usize) -> &[f64] {
        self.check(record);
        &self.controls[record * self.sizes.nu..][..self.sizes.nu]
    }

    /// Refuses a model that the records do not fit.
    pub(crate) fn check_sizes(&self, model: &Model) -> Result<()> {
        let sizes = Sizes::of(model);
        if sizes == self.sizes {
            return Ok(());
        }
        Err(other_sizes("the simulation to apply to (state, controls)", self.sizes, sizes))
    }

    /// Before a product that could wrap round to another record.
    #[track_caller]
    fn check(&self, record: usize) {
        assert!(record < self.len(), "record {record} of a trajectory of {}", self.len());
    }

    /// Sets a simulation to a record: time, state and controls.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the simulation's model has other sizes.
    ///
    /// # Panics
    ///
    /// If there is no such record.
    pub fn apply(&self, record: usize, data: &mut Data) -> Result<()> {
        self.check_sizes(data.model())?;
        data.set_physics_state(self.state(record))?;
        data.ctrl_mut().copy_from_slice(self.ctrl(record));
        data.set_time(self.times[record]);
        Ok(())
    }
}
