//! Recorded trajectories: times, states, controls and sensor readings, with import and export as
//! CSV, NumPy archives, MCAP files and serde data.

mod csv;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "npz")]
mod npz;
#[cfg(feature = "serde")]
mod serde;

use crate::controller::Controller;
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::model::Model;

/// Recorded simulation: the time, the physics state `[qpos; qvel; act]` and the controls of each
/// record, and the sensor readings if the trajectory was created
/// [`with_sensordata`](Self::with_sensordata).
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
    /// Number of sensor readings of a record: `nsensordata` of the model, or 0 if they are not
    /// recorded.
    nsensordata: usize,
    /// Sensor readings, concatenated.
    sensordata: Vec<f64>,
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
    fn columns(self, nsensordata: usize) -> impl Iterator<Item = String> {
        let part = |name: &'static str, count: usize| (0..count).map(move |index| format!("{name}{index}"));
        std::iter::once("time".to_owned())
            .chain(part("qpos", self.nq))
            .chain(part("qvel", self.nv))
            .chain(part("act", self.na))
            .chain(part("ctrl", self.nu))
            .chain(part("sensordata", nsensordata))
    }
}

fn other_sizes(what: &'static str, expected: Sizes, found: Sizes) -> Error {
    let differs = expected.state() != found.state() || expected.nu != found.nu;
    if differs {
        return Error::Shape { what, expected: (expected.state(), expected.nu), found: (found.state(), found.nu) };
    }
    let list = |sizes: Sizes| format!("nq {}, nv {}, na {}", sizes.nq, sizes.nv, sizes.na);
    Error::invalid(InvalidKind::Unsuitable, what, list(found), list(expected))
}

impl Trajectory {
    /// Creates an empty trajectory for simulations of this model, without sensor readings.
    pub fn new(model: &Model) -> Self {
        Self {
            sizes: Sizes::of(model),
            times: Vec::new(),
            states: Vec::new(),
            controls: Vec::new(),
            nsensordata: 0,
            sensordata: Vec::new(),
        }
    }

    /// Creates an empty trajectory that also records the readings of all sensors.
    ///
    /// ```
    /// use mujoco_safe::{Data, RandomController, Trajectory, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut trajectory = Trajectory::with_sensordata(data.model());
    /// trajectory.record(&mut data, &mut RandomController::new(1), 50)?;
    ///
    /// // The readings are those of the recorded state.
    /// let tip = data.model().sensor("tip_position")?.data_range();
    /// let (x, qpos) = (trajectory.sensordata(49)[tip.start], trajectory.qpos(49));
    /// assert!((x - (qpos[0] + 0.6 * qpos[1].sin())).abs() < 1e-12);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn with_sensordata(model: &Model) -> Self {
        Self { nsensordata: model.nsensordata(), ..Self::new(model) }
    }

    /// Creates an empty trajectory with capacity for `records` records, so that
    /// [`push`](Self::push) does not allocate up to that number. If there is not enough memory, the
    /// trajectory starts without capacity and grows on demand.
    pub fn with_capacity(model: &Model, records: usize) -> Self {
        let mut trajectory = Self::new(model);
        trajectory.reserve(records);
        trajectory
    }

    /// Reserves capacity for at least `additional` more records, so that [`push`](Self::push) and
    /// [`record`](Self::record) do not allocate up to that number. Has no effect if there is not
    /// enough memory.
    pub fn reserve(&mut self, additional: usize) {
        let Self { sizes, times, states, controls, nsensordata, sensordata } = self;
        let room = |values: &mut Vec<f64>, width: usize| {
            additional.checked_mul(width).is_some_and(|length| values.try_reserve_exact(length).is_ok())
        };
        let _ =
            room(times, 1) && room(states, sizes.state()) && room(controls, sizes.nu) && room(sensordata, *nsensordata);
    }

    /// Appends the present time, state and controls, and the sensor readings if they are recorded.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the simulation's model has other sizes. If sensor readings are recorded:
    /// [`Error::NotComputed`] unless they have been computed for the present state, as
    /// [`Data::forward`] does and [`Data::step`] does not; [`Error::Unsupported`] if the options of
    /// the model disable sensors. After an error the trajectory is unchanged.
    ///
    /// ```
    /// use mujoco_safe::{Data, Error, Trajectory, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut trajectory = Trajectory::with_sensordata(data.model());
    /// data.step()?; // computes the readings of the state before the step
    /// assert!(matches!(trajectory.push(&data), Err(Error::NotComputed { .. })));
    /// data.forward()?;
    /// trajectory.push(&data)?;
    /// # Ok::<(), Error>(())
    /// ```
    pub fn push(&mut self, data: &Data) -> Result<()> {
        let readings = match self.nsensordata {
            0 => &[],
            _ => data.present_readings("Trajectory::push")?,
        };
        self.push_state(data)?;
        self.sensordata.extend_from_slice(readings);
        Ok(())
    }

    /// Appends the present time, state and controls, without sensor readings.
    fn push_state(&mut self, data: &Data) -> Result<()> {
        let sizes = Sizes::of(data.model());
        if sizes != self.sizes {
            return Err(other_sizes("the simulation to record (state, controls)", self.sizes, sizes));
        }
        if self.nsensordata > 0 {
            let found = data.model().nsensordata();
            Error::check_length("the sensor readings of the simulation to record", found, self.nsensordata)?;
        }
        self.times.push(data.time());
        for part in [data.qpos(), data.qvel(), data.act()] {
            self.states.extend_from_slice(part);
        }
        self.controls.extend_from_slice(data.ctrl());
        Ok(())
    }

    /// Performs `steps` steps under a controller. Records each state before its step, with the
    /// controls applied in that step and, if they are recorded, the sensor readings of that state,
    /// which the engine computes in that step. (With the integrator `Rk4`, it computes them in the
    /// first of the four evaluations, in the recorded state.)
    ///
    /// # Errors
    ///
    /// Errors of the controller and of [`Data::step`], and errors of [`push`](Self::push) except
    /// for [`Error::NotComputed`]. Earlier records are kept, and the sensor readings of a failed
    /// step are NaN.
    pub fn record(&mut self, data: &mut Data, controller: &mut (impl Controller + ?Sized), steps: usize) -> Result<()> {
        for _ in 0..steps {
            controller.control(data)?;
            self.push_state(data)?;
            let result = data.step().and_then(|()| self.push_readings(data));
            self.sensordata.resize(self.len() * self.nsensordata, f64::NAN);
            result?;
        }
        Ok(())
    }

    /// Appends the sensor readings of the step that has just been taken.
    fn push_readings(&mut self, data: &Data) -> Result<()> {
        if self.nsensordata > 0 {
            let readings = data.readings("Trajectory::record")?;
            // A callback during the step may have replaced the simulation by one of another model.
            Error::check_length("the sensor readings of the simulation to record", readings.len(), self.nsensordata)?;
            self.sensordata.extend_from_slice(readings);
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

    /// Returns the sensor readings of a record (`nsensordata`). Empty if the trajectory was not
    /// created [`with_sensordata`](Self::with_sensordata), or was loaded from a file without
    /// readings.
    ///
    /// # Panics
    ///
    /// If the record does not exist.
    pub fn sensordata(&self, record: usize) -> &[f64] {
        self.check(record);
        &self.sensordata[record * self.nsensordata..][..self.nsensordata]
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

    /// Sets the time, state and controls of a simulation to the values of a record.
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
