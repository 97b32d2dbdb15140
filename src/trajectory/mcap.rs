//! Trajectories as MCAP files, in the form of [`mcap::Log`](crate::mcap::Log).

use std::io;
use std::path::Path;

use super::Trajectory;
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::file;
use crate::mcap::{Channels, DISPLAY_RATE, DisplayClock, Part, read_states};
use crate::model::{IntoModel, Model};

impl Trajectory {
    /// Writes the records as an MCAP file, which Foxglove and Rerun show, with the topics of
    /// [`mcap::Log`](crate::mcap). Reading the file restores every value bit for bit. For display,
    /// the poses and contacts of 50 records in a second are computed; they are missing if the
    /// engine cannot compute them, for example because of invalid numbers. Mocap bodies, which a
    /// trajectory does not record, are in their initial poses. `/sensors` has the recorded
    /// readings.
    ///
    /// Requires the feature `mcap`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
    /// [`Error::Shape`] or [`Error::Invalid`] for a model of other sizes, and the errors of
    /// [`Data::new`].
    ///
    /// ```
    /// use mujoco_safe::{Data, RandomController, Trajectory, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut trajectory = Trajectory::with_sensordata(data.model());
    /// trajectory.record(&mut data, &mut RandomController::new(1), 100)?;
    ///
    /// let path = std::env::temp_dir().join("mujoco_safe_cartpole.mcap");
    /// trajectory.save_mcap(data.model(), &path)?;
    /// assert_eq!(Trajectory::load_mcap(data.model(), &path)?, trajectory);
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn save_mcap(&self, model: impl IntoModel, path: impl AsRef<Path>) -> Result<()> {
        let model = model.into_model();
        self.check_sizes(&model)?;
        if self.nsensordata > 0 {
            let expected = model.nsensordata();
            Error::check_length("the sensor readings of the trajectory to save", self.nsensordata, expected)?;
        }
        let mut data = Data::new(&model)?;
        file::replace(path.as_ref(), |out| {
            let mut channels = Channels::create(out.get_ref().try_clone()?, &model)?;
            let mut clock = DisplayClock::new(DISPLAY_RATE);
            channels.write_scene(self.times.first().copied().unwrap_or_default())?;
            for (record, &time) in self.times.iter().enumerate() {
                let (qpos, qvel) = (self.qpos(record), self.qvel(record));
                let act = &self.state(record)[qpos.len() + qvel.len()..];
                channels.write_state(time, [qpos, qvel, act, self.ctrl(record)])?;
                if self.nsensordata > 0 {
                    channels.write_sensors(time, &model, self.sensordata(record))?;
                }
                if clock.is_due(time) && self.compute(record, &mut data).is_ok() {
                    channels.write_display(time, qpos, qvel, &data)?;
                }
            }
            channels.finish()
        })
    }

    /// Computes all quantities of a record.
    fn compute(&self, record: usize, data: &mut Data) -> Result<()> {
        data.reset()?;
        self.apply(record, data)?;
        data.forward()?;
        data.require(Stage::Acceleration)
    }

    /// Reads the states and, if there are any, the sensor readings of a file of
    /// [`save_mcap`](Self::save_mcap) or [`mcap::Log`](crate::mcap::Log), for simulations of this
    /// model. Readings that some records lack are NaN. Other topics are ignored.
    ///
    /// Requires the feature `mcap`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is a pipe or a device, is damaged or incomplete,
    /// has compressed chunks, or belongs to a model with other sizes. The message has the topic and
    /// the number of the message, and the place in the file.
    pub fn load_mcap(model: &Model, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read_mcap(model, path).map_err(Error::file(path))
    }

    fn read_mcap(model: &Model, path: &Path) -> io::Result<Self> {
        let mut trajectory = Self::new(model);
        let sizes = trajectory.sizes;
        read_states(path, |message| {
            let Self { times, states, controls, nsensordata, sensordata, .. } = &mut trajectory;
            match message {
                Part::State(time, parts) => {
                    let (expected, found) = ([sizes.nq, sizes.nv, sizes.na, sizes.nu], parts.map(<[f64]>::len));
                    if found != expected {
                        return Err(format!("has nq, nv, na, nu = {found:?}, but this model has {expected:?}"));
                    }
                    let [qpos, qvel, act, ctrl] = parts;
                    times.push(time);
                    for part in [qpos, qvel, act] {
                        states.extend_from_slice(part);
                    }
                    controls.extend_from_slice(ctrl);
                }
                Part::Sensors(readings) => {
                    if readings.len() != model.nsensordata() {
                        let expected = model.nsensordata();
                        return Err(format!("has {} readings, but this model has {expected}", readings.len()));
                    }
                    *nsensordata = readings.len();
                    fill(sensordata, (times.len() - 1) * *nsensordata)?;
                    sensordata.extend_from_slice(readings);
                }
            }
            Ok(())
        })?;
        let length = trajectory.len() * trajectory.nsensordata;
        fill(&mut trajectory.sensordata, length).map_err(io::Error::other)?;
        Ok(trajectory)
    }
}

/// Appends NaN up to a length.
fn fill(values: &mut Vec<f64>, length: usize) -> Result<(), String> {
    values.try_reserve(length.saturating_sub(values.len())).map_err(|error| error.to_string())?;
    values.resize(length, f64::NAN);
    Ok(())
}
