//! Playback of trajectories, with bursts: several records of a trajectory in one frame.

use std::sync::Arc;

use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::{Model, Relation};
use crate::scene::{Categories, FrameMode, Scene, SceneOptions, VisualFlags};
use crate::trajectory::Trajectory;
use crate::viewer::link::{Burst, InfoLine, InfoLines, PlaybackState, Sampling, Timeline};

/// Player of at least one trajectory, each with at least one record.
#[derive(Debug)]
pub(super) struct Player {
    trajectories: Vec<Trajectory>,
    names: Arc<[String]>,
    trajectory: usize,
    frame: usize,
    pub reversed: bool,
    pub burst: Burst,
    /// Simulation that computes the poses of the other records of a burst. Created by the first
    /// burst.
    burst_data: Option<Data>,
    /// Index of the first geom of each record of a burst in the scene, and the index of the record.
    added: Vec<(usize, usize)>,
}

impl Player {
    /// Creates a player for trajectories of this model, with their names.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a trajectory of another model, [`Error::Invalid`] for a trajectory
    /// without records or an empty list.
    pub fn new(trajectories: Vec<(String, Trajectory)>, model: &Model) -> Result<Self> {
        let (names, trajectories): (Vec<_>, Vec<_>) = trajectories.into_iter().unzip();
        for trajectory in &trajectories {
            trajectory.check_sizes(model)?;
        }
        if trajectories.is_empty() || trajectories.iter().any(Trajectory::is_empty) {
            return Err(Error::out_of_range("a trajectory to be shown", "empty", "of at least one record"));
        }
        Ok(Self {
            trajectories,
            names: names.into(),
            trajectory: 0,
            frame: 0,
            reversed: false,
            burst: Burst::default(),
            burst_data: None,
            added: Vec::new(),
        })
    }

    /// Returns `true` if all trajectories have the sizes of this model.
    pub fn fits(&self, model: &Model) -> bool {
        self.trajectories.iter().all(|trajectory| trajectory.check_sizes(model).is_ok())
    }

    /// Returns the names of the trajectories.
    pub fn names(&self) -> &Arc<[String]> {
        &self.names
    }

    /// Sets the records of a timeline.
    pub fn describe_times(&self, timeline: &mut Timeline) {
        let times = self.present().times();
        timeline.set(times.len(), |index| times[index]);
    }

    pub fn state(&self) -> PlaybackState {
        PlaybackState {
            frame: self.frame,
            frames: self.present().len(),
            trajectory: self.trajectory,
            trajectories: self.trajectories.len(),
            reversed: self.reversed,
            burst: self.burst,
        }
    }

    fn present(&self) -> &Trajectory {
        &self.trajectories[self.trajectory]
    }

    /// Sets the state of the simulation to the current record.
    pub fn show(&self, data: &mut Data) -> Result<()> {
        self.present().apply(self.frame, data)
    }

    /// Advances by this number of records, cyclically. Returns the corresponding duration, s.
    pub fn advance(&mut self, records: i64, timestep: f64) -> f64 {
        let (from, count) = (self.frame, self.present().len() as i64);
        self.frame = (self.frame as i64 + records).rem_euclid(count) as usize;
        let times = self.present().times();
        let taken = (times[self.frame] - times[from]).abs();
        let wrapped = (self.frame as i64 - from as i64) != records;
        if wrapped || !taken.is_finite() || taken == 0.0 { timestep } else { taken }
    }

    /// Advances by one record in the direction of playback. Returns the corresponding duration, s.
    pub fn play(&mut self, timestep: f64) -> f64 {
        self.advance(if self.reversed { -1 } else { 1 }, timestep)
    }

    /// Shows a record, or the last if there are fewer.
    pub fn go_to(&mut self, frame: usize) {
        self.frame = frame.min(self.present().len() - 1);
    }

    /// Advances by this number of trajectories, cyclically. Keeps the index of the record if
    /// possible.
    pub fn cycle(&mut self, step: i32) {
        let count = self.trajectories.len() as i64;
        self.choose((self.trajectory as i64 + i64::from(step)).rem_euclid(count) as usize);
    }

    /// Shows a trajectory, or the last if there are fewer.
    pub fn choose(&mut self, trajectory: usize) {
        self.trajectory = trajectory.min(self.trajectories.len() - 1);
        self.go_to(self.frame);
        let Burst { factor, gamma, .. } = Burst::default();
        (self.burst.factor, self.burst.gamma) = (factor, gamma);
    }

    fn sampling(&self, timestep: f64) -> Sampling {
        let times = self.present().times();
        let span = times[times.len() - 1] - times[0];
        let interval = span / (times.len().max(2) - 1) as f64;
        let usable = interval.is_finite() && interval > 0.0;
        Sampling { count: times.len(), interval: if usable { interval } else { timestep } }
    }

    /// Adds the geoms of the other records of a burst to a scene, up to its capacity.
    pub fn add_burst(&mut self, scene: &mut Scene, model: &Arc<Model>, options: &SceneOptions) -> Result<()> {
        let sampling = self.sampling(model.timestep());
        let room = (scene.max_geoms() / scene.ngeom().max(1)).saturating_sub(1);
        // Contacts and constraint forces would require more than the kinematics of the record.
        let mut options = options.clone();
        options.flags.remove(VisualFlags::CONTACTPOINT | VisualFlags::CONTACTFORCE | VisualFlags::CONSTRAINT);
        options.frame = FrameMode::None;

        let data = match &mut self.burst_data {
            Some(data) if model.relation(data.model()) == Relation::Same => data,
            place => place.insert(Data::new(model)?),
        };
        let trajectory = &self.trajectories[self.trajectory];
        self.added.clear();
        for record in self.burst.records(sampling, self.frame, room) {
            trajectory.apply(record, data)?;
            options.compute(data, Categories::DYNAMIC)?;
            self.added.push((scene.ngeom(), record));
            match scene.add_geoms(data, &options, None, Categories::DYNAMIC) {
                Ok(_) => {}
                Err(Error::SceneFull { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        let Some(&(first, _)) = self.added.first() else { return Ok(()) };
        let mut added = self.added.iter().copied().peekable();
        let mut record = self.frame;
        for (index, mut geom) in scene.geoms_mut().enumerate().skip(first) {
            while let Some((_, next)) = added.next_if(|&(start, _)| start <= index) {
                record = next;
            }
            let rgba = self.burst.shade(geom.view().rgba(), sampling, self.frame, record);
            geom.set_rgba(rgba);
        }
        Ok(())
    }

    /// Writes the lines of the info panel.
    pub fn describe(&self, lines: &mut Vec<InfoLine>) {
        let mut lines = InfoLines::new(lines);
        let on = |on: bool| if on { "On" } else { "Off" };
        lines.push("Record", format_args!("{}/{}", self.frame + 1, self.present().len()));
        let name = self.names[self.trajectory].as_str();
        let number = self.trajectory + 1;
        // By default the name is the number.
        let is_number = name.parse() == Ok(number);
        let [space, name] = if is_number { [""; 2] } else { [" ", name] };
        lines.push("Trajectory", format_args!("{number}/{}{space}{name}", self.trajectories.len()));
        lines.push("Burst", format_args!("{}", on(self.burst.on)));
        lines.push("Burst Density", format_args!("{}/{}", self.burst.factor.round(), Burst::RANGE.end()));
        lines.push("Burst Fading", format_args!("{}/{}", self.burst.gamma.round(), Burst::RANGE.end()));
        lines.push("Burst Doppler", format_args!("{}", on(self.burst.doppler)));
        lines.finish();
    }
}
