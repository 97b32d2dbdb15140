//! Which moment of which trajectory is shown.

use std::sync::Arc;

use super::burst::Records;
use super::info::InfoLines;
use super::{Burst, InfoLine};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::scene::{Categories, FrameMode, Scene, SceneOptions, VisualFlags};
use crate::trajectory::Trajectory;

/// How trajectories are played, for the panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Playback {
    /// Which record of the trajectory is shown, from 0, and how many there are.
    pub frame: usize,
    pub frames: usize,
    /// Which trajectory is shown, from 0, and how many there are.
    pub trajectory: usize,
    pub trajectories: usize,
    pub reversed: bool,
    pub burst: Burst,
}

/// Plays trajectories, of which there is one at least, each of one record at least.
#[derive(Debug)]
pub(crate) struct Player {
    trajectories: Vec<Trajectory>,
    trajectory: usize,
    frame: usize,
    pub reversed: bool,
    pub burst: Burst,
    /// A simulation that the other moments are computed with, once they are shown.
    other: Option<Data>,
    /// Where in the scene the geoms of the other moments begin, and of which record they are.
    added: Vec<(usize, usize)>,
}

impl Player {
    /// For trajectories of this model.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] or [`Error::Invalid`] for those of another model, or without records.
    pub fn new(trajectories: Vec<Trajectory>, model: &Model) -> Result<Self> {
        for trajectory in &trajectories {
            trajectory.check_sizes(model)?;
        }
        if trajectories.is_empty() || trajectories.iter().any(Trajectory::is_empty) {
            return Err(Error::invalid("a trajectory to be shown", "empty", "of one record at least"));
        }
        Ok(Self {
            trajectories,
            trajectory: 0,
            frame: 0,
            reversed: false,
            burst: Burst::default(),
            other: None,
            added: Vec::new(),
        })
    }

    /// Whether all of this fits another model too.
    pub fn fits(&self, model: &Model) -> bool {
        self.trajectories.iter().all(|trajectory| trajectory.check_sizes(model).is_ok())
    }

    pub fn playback(&self) -> Playback {
        Playback {
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

    /// Sets the simulation to the present record.
    pub fn show(&self, data: &mut Data) -> Result<()> {
        self.present().apply(self.frame, data)
    }

    /// Goes so many records on, or back, round the ends. How long that takes when it is played is returned, s.
    pub fn advance(&mut self, records: i64, timestep: f64) -> f64 {
        let (from, count) = (self.frame, self.present().len() as i64);
        self.frame = (self.frame as i64 + records).rem_euclid(count) as usize;
        let times = self.present().times();
        let taken = (times[self.frame] - times[from]).abs();
        let wrapped = (self.frame as i64 - from as i64) != records;
        if wrapped || !taken.is_finite() || taken == 0.0 { timestep } else { taken }
    }

    /// One record on, in the direction that it plays in.
    pub fn play(&mut self, timestep: f64) -> f64 {
        self.advance(if self.reversed { -1 } else { 1 }, timestep)
    }

    /// Goes to a record, or to the last.
    pub fn go_to(&mut self, frame: usize) {
        self.frame = frame.min(self.present().len() - 1);
    }

    /// Goes to a trajectory, round the ends, at the record where it is or the last.
    pub fn cycle(&mut self, step: i32) {
        let count = self.trajectories.len() as i64;
        self.choose((self.trajectory as i64 + i64::from(step)).rem_euclid(count) as usize);
    }

    /// Goes to a trajectory, or to the last.
    pub fn choose(&mut self, trajectory: usize) {
        self.trajectory = trajectory.min(self.trajectories.len() - 1);
        self.go_to(self.frame);
        let Burst { factor, gamma, .. } = Burst::default();
        (self.burst.factor, self.burst.gamma) = (factor, gamma);
    }

    fn records(&self, timestep: f64) -> Records {
        let times = self.present().times();
        let span = times[times.len() - 1] - times[0];
        let interval = span / (times.len().max(2) - 1) as f64;
        let usable = interval.is_finite() && interval > 0.0;
        Records { count: times.len(), interval: if usable { interval } else { timestep } }
    }

    /// Adds the geoms of other moments to a scene, as far as there is room.
    pub fn add_burst(&mut self, scene: &mut Scene, model: &Arc<Model>, options: &SceneOptions) -> Result<()> {
        let records = self.records(model.timestep());
        let room = (scene.max_geoms() / scene.ngeom().max(1)).saturating_sub(1);
        // What contacts there were is not known; they would have to be computed with the forces.
        let mut options = options.clone();
        options.flags.remove(VisualFlags::CONTACTPOINT | VisualFlags::CONTACTFORCE | VisualFlags::CONSTRAINT);
        options.frame = FrameMode::None;

        if self.other.as_ref().is_none_or(|other| !Arc::ptr_eq(other.model(), model)) {
            self.other = Some(Data::new(model.clone())?);
        }
        let other = self.other.as_mut().expect("Bug: just made");
        let trajectory = &self.trajectories[self.trajectory];
        self.added.clear();
        for record in self.burst.moments(records, self.frame, room) {
            trajectory.apply(record, other)?;
            other.fwd_position()?;
            self.added.push((scene.ngeom(), record));
            match scene.add(other, &options, None, Categories::DYNAMIC) {
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
            let rgba = self.burst.shade(geom.view().rgba(), records, self.frame, record);
            geom.set_rgba(rgba);
        }
        Ok(())
    }

    /// What it says in the info panel.
    pub fn describe(&self, lines: &mut Vec<InfoLine>) {
        let mut lines = InfoLines::new(lines);
        let on = |on: bool| if on { "On" } else { "Off" };
        lines.push("t", format_args!("{}/{}", self.frame + 1, self.present().len()));
        lines.push("Trajectory ID", format_args!("{}/{}", self.trajectory + 1, self.trajectories.len()));
        lines.push("Burst Mode", format_args!("{}", on(self.burst.on)));
        lines.push("Burst Factor", format_args!("{}/{}", self.burst.factor.round(), Burst::NOTCHES.end()));
        lines.push("Burst Gamma", format_args!("{}/{}", self.burst.gamma.round(), Burst::NOTCHES.end()));
        lines.push("Burst Doppler", format_args!("{}", on(self.burst.doppler)));
        lines.finish();
    }
}
