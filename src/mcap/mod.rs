//! Logs of simulations as MCAP files, which Foxglove and Rerun show.
//!
//! [`Log`] makes the steps of a simulation and writes a file while it runs:
//!
//! ```
//! use mujoco_safe::mcap::Log;
//! use mujoco_safe::{Controller, Data, RandomController, Trajectory, sample};
//!
//! let path = std::env::temp_dir().join("mujoco_safe_fall.mcap");
//! let mut data = Data::new(sample::humanoid())?;
//! let mut controller = RandomController::new(1);
//! let mut log = Log::create(&path, data.model())?;
//! for _ in 0..200 {
//!     controller.control(&mut data)?;
//!     log.step(&mut data)?;
//! }
//! log.finish()?;
//!
//! // The states are those of the simulation, bit for bit.
//! let trajectory = Trajectory::load_mcap(data.model(), &path)?;
//! assert_eq!((trajectory.len(), trajectory.qpos(0)), (200, data.model().qpos0()));
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! [`Trajectory::save_mcap`](crate::Trajectory::save_mcap) writes a recorded trajectory in the same
//! form.
//!
//! # Contents
//!
//! All messages are protobuf, so their numbers are those of the simulation, bit for bit. The file
//! contains the schemas.
//!
//! | topic | schema | messages |
//! |---|---|---|
//! | `/state` | `mujoco.State` | each record: `time`, `qpos`, `qvel`, `act`, `ctrl` |
//! | `/sensors` | `mujoco.Sensors` | each record: an array for each sensor, with its name |
//! | `/joints` | `foxglove.JointStates` | display: position, velocity and effort of hinges and slides |
//! | `/tf` | `foxglove.FrameTransforms` | display: the frame of each body in the frame `world` |
//! | `/contacts` | `mujoco.Contacts` | display: geoms, position, normal, distance, force on the second geom |
//! | `/scene` | `foxglove.SceneUpdate` | once, and when an edit of the model changes them: shapes in the frames of the bodies |
//! | `/scene/deformable` | `foxglove.SceneUpdate` | display: vertices of skins and flexes in the frame `world` |
//! | `/camera/NAME/…` | `foxglove.RawImage`, `foxglove.CompressedImage`, `foxglove.CameraCalibration` | by `Log::write_image` and `Log::write_camera` |
//!
//! Units are SI units, and vectors are in the world frame. The messages for display have a
//! [rate](Log::with_display_rate) of 50 Hz of simulated time. The time of a message is the
//! simulated time, so an episode that starts again at zero needs another file. The messages of a
//! record have the same sequence number.
//!
//! Names of sensors keep letters, digits and underscores, other characters become underscores; a
//! number follows if two are then equal up to underscores and case. Elements without a name have
//! their kind and index, such as `geom3`. The shapes are the geoms, skins and flexes of the groups
//! 0 to 2, without their textures.
//!
//! The metadata `mujoco` has the versions, the sizes and the options of the model, and the
//! attachment `model.xml` the model, if [`Model::to_xml`] can write it.
//!
//! [`read_joint_states`] reads the joint states of ROS 2 bags.
//!
//! # Cost
//!
//! A record of state and sensors overwrites the numbers of two messages that have been encoded
//! before, and copies them into a buffer. A thread writes full buffers of 512 KiB to the file, so
//! an error of the file can appear some steps later, and a process that is killed loses them. If it
//! has four buffers to write, a step waits. `cargo bench --features mcap --bench mcap` compares
//! with a step without a log: 1.01 for the humanoid with a time step of 1 ms.
//!
//! The file has chunks of 256 KiB with checksums. They are not compressed; `mcap compress` of the
//! program `mcap` does that afterwards.
//!
//! Requires the feature `mcap`.

mod background;
mod channels;
mod deformable;
mod geometry;
mod joint_states;
mod protobuf;
mod read;
mod schema;

use std::fmt;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

pub(crate) use self::channels::Channels;
pub use self::joint_states::{JointSeries, read_joint_states};
#[cfg(feature = "renderer")]
pub(crate) use self::protobuf::Message;
pub(crate) use self::read::{Part, read_states};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::Lineage;
use crate::model::Model;

/// Default of [`Log::with_display_rate`].
pub(crate) const DISPLAY_RATE: f64 = 50.0;

/// Log of a simulation in an MCAP file. See the [module](self).
///
/// Call [`finish`](Self::finish) at the end. A log that is dropped finishes the file too, but
/// ignores errors.
pub struct Log {
    path: PathBuf,
    channels: Channels,
    lineage: Lineage,
    /// Revision of the model of the channels.
    revision: u64,
    clock: DisplayClock,
    /// `true` if the shapes must be written with the next record.
    has_new_scene: bool,
    /// Positions and velocities of the present record, if it is for display.
    state: (Vec<f64>, Vec<f64>),
}

impl Log {
    /// Creates a file, or replaces one, for simulations of this model, its clones and edits.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written.
    pub fn create(path: impl AsRef<Path>, model: &Model) -> Result<Self> {
        let path = path.as_ref();
        let channels = File::create(path).and_then(|file| Channels::create(file, model));
        Ok(Self {
            path: path.to_owned(),
            channels: channels.map_err(Error::file(path))?,
            lineage: model.lineage(),
            revision: model.revision(),
            clock: DisplayClock::new(DISPLAY_RATE),
            has_new_scene: true,
            state: (Vec::new(), Vec::new()),
        })
    }

    /// Sets the rate of the messages for display, Hz of simulated time. Infinity means each record,
    /// zero none.
    #[must_use]
    pub fn with_display_rate(mut self, rate: f64) -> Self {
        self.clock = DisplayClock::new(rate);
        self
    }

    /// Writes the state and the controls, makes a [`Data::step`], and writes the sensors, poses and
    /// contacts that it has computed of that state. (With the integrator
    /// [`Rk4`](crate::enums::Integrator::Rk4) the poses and contacts are those of the last of the
    /// four states in which the engine evaluates the dynamics.) The step is the same as without a
    /// log.
    ///
    /// # Errors
    ///
    /// As for [`Data::step`]: the log then has the state before the failed step, without sensors.
    /// [`Error::File`] if the file cannot be written, and [`Error::OtherModel`]. The step is not
    /// made after these errors, unless writing fails after the step.
    pub fn step(&mut self, data: &mut Data) -> Result<()> {
        data.check_usable()?;
        let (time, is_displayed) = (data.time(), self.begin(data)?);
        data.step()?;
        self.write_results(time, is_displayed, data)
    }

    /// Writes the present state and controls. Also writes the sensors, poses and contacts if they
    /// belong to this state, as after [`Data::forward`]; after a step they do not. A controller can
    /// call this method.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written, [`Error::OtherModel`], [`Error::Poisoned`].
    ///
    /// ```
    /// use mujoco_safe::mcap::Log;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let path = std::env::temp_dir().join("mujoco_safe_poses.mcap");
    /// let mut data = Data::new(sample::humanoid())?;
    /// let mut log = Log::create(&path, data.model())?.with_display_rate(f64::INFINITY);
    /// for (seconds, key) in [(0.0, "stand"), (1.0, "squat")] {
    ///     data.reset_to_key(key)?;
    ///     data.set_time(seconds);
    ///     data.forward()?;
    ///     log.write(&data)?;
    /// }
    /// log.finish()?;
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn write(&mut self, data: &Data) -> Result<()> {
        data.check_usable()?;
        let is_displayed = self.begin(data)?;
        if data.has_present_results() { self.write_results(data.time(), is_displayed, data) } else { Ok(()) }
    }

    /// Writes a message of a topic, which is added at its first message.
    #[cfg(feature = "renderer")]
    pub(crate) fn write_message(&mut self, time: f64, topic: &str, schema: &str, message: &mut Message) -> Result<()> {
        self.channels.output.send(time, topic, schema, message).map_err(|error| Error::file(&self.path)(error))
    }

    /// Writes the end of the file.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written.
    pub fn finish(self) -> Result<()> {
        self.channels.finish().map_err(Error::file(self.path))
    }

    /// Writes the start of a record. Returns `true` if it is also for display.
    fn begin(&mut self, data: &Data) -> Result<bool> {
        let model = data.model();
        if model.revision() != self.revision {
            if model.lineage() != self.lineage {
                return Err(Error::OtherModel { what: "the simulation to log" });
            }
            self.has_new_scene |= self.channels.set_model(model);
            self.revision = model.revision();
        }
        let time = data.time();
        let mut write = || {
            if self.has_new_scene {
                self.channels.write_scene(time)?;
                self.has_new_scene = false;
            }
            self.channels.write_state(time, [data.qpos(), data.qvel(), data.act(), data.ctrl()])
        };
        write().map_err(|error| Error::file(&self.path)(error))?;
        let is_displayed = self.clock.is_due(time);
        if is_displayed {
            data.qpos().clone_into(&mut self.state.0);
            data.qvel().clone_into(&mut self.state.1);
        }
        Ok(is_displayed)
    }

    /// Writes the results that were computed from the state of the record.
    fn write_results(&mut self, time: f64, is_displayed: bool, data: &Data) -> Result<()> {
        let mut write = || {
            if let Ok(readings) = data.readings("Log::step")
                && !readings.is_empty()
            {
                self.channels.write_sensors(time, data.model(), readings)?;
            }
            if is_displayed && data.require(Stage::Acceleration).is_ok() {
                self.channels.write_display(time, &self.state.0, &self.state.1, data)?;
            }
            Ok(())
        };
        write().map_err(|error: io::Error| Error::file(&self.path)(error))
    }
}

impl fmt::Debug for Log {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Log in {}", self.path.display())
    }
}

/// Times of the messages for display.
pub(crate) struct DisplayClock {
    period: f64,
    /// Time of the last messages.
    last: f64,
}

impl DisplayClock {
    pub(crate) fn new(rate: f64) -> Self {
        // Rounding errors of the simulated time do not delay the messages by a step.
        Self { period: (1.0 - 1e-6) / rate.max(0.0), last: f64::NAN }
    }

    /// Returns `true` at the first time, after the period, and after a reset.
    pub(crate) fn is_due(&mut self, time: f64) -> bool {
        let is_waiting = time >= self.last && time < self.last + self.period;
        if is_waiting || self.period == f64::INFINITY {
            return false;
        }
        self.last = time;
        true
    }
}
