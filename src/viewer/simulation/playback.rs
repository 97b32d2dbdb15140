//! Playback of trajectories, with bursts: several records of a trajectory in one frame.

use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::scene::{Categories, FrameMode, Scene, SceneOptions, VisualFlags};
use crate::trajectory::Trajectory;
use crate::viewer::link::{InfoLine, InfoLines};

/// State of the playback for the panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaybackState {
    /// Index of the current record in its trajectory, from 0.
    pub frame: usize,
    /// Number of records of the trajectory.
    pub frames: usize,
    /// Index of the current trajectory, from 0.
    pub trajectory: usize,
    /// Number of trajectories.
    pub trajectories: usize,
    pub reversed: bool,
    pub burst: Burst,
}

/// Player of at least one trajectory, each with at least one record.
#[derive(Debug)]
pub(super) struct Player {
    trajectories: Vec<Trajectory>,
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
    /// Creates a player for trajectories of this model.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a trajectory of another model, [`Error::Invalid`] for a trajectory
    /// without records or an empty list.
    pub fn new(trajectories: Vec<Trajectory>, model: &Model) -> Result<Self> {
        for trajectory in &trajectories {
            trajectory.check_sizes(model)?;
        }
        if trajectories.is_empty() || trajectories.iter().any(Trajectory::is_empty) {
            return Err(Error::invalid("a trajectory to be shown", "empty", "of at least one record"));
        }
        Ok(Self {
            trajectories,
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

        if self.burst_data.as_ref().is_none_or(|data| !Arc::ptr_eq(data.model(), model)) {
            self.burst_data = Some(Data::new(model.clone())?);
        }
        let data = self.burst_data.as_mut().expect("Bug: burst data was created above");
        let trajectory = &self.trajectories[self.trajectory];
        self.added.clear();
        for record in self.burst.records(sampling, self.frame, room) {
            trajectory.apply(record, data)?;
            data.fwd_position()?;
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
        lines.push("Trajectory", format_args!("{}/{}", self.trajectory + 1, self.trajectories.len()));
        lines.push("Burst", format_args!("{}", on(self.burst.on)));
        lines.push("Burst Density", format_args!("{}/{}", self.burst.factor.round(), Burst::RANGE.end()));
        lines.push("Burst Fading", format_args!("{}/{}", self.burst.gamma.round(), Burst::RANGE.end()));
        lines.push("Burst Doppler", format_args!("{}", on(self.burst.doppler)));
        lines.finish();
    }
}

/// Display of several records of a trajectory in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Burst {
    pub on: bool,
    /// Shades past records red and future records blue.
    pub doppler: bool,
    /// Number of records, on a scale from 1 to 40. A touchpad changes it by fractions.
    pub factor: f64,
    /// Time constant of the fading, on a scale from 1 to 40. A touchpad changes it by fractions.
    pub gamma: f64,
}

impl Default for Burst {
    fn default() -> Self {
        Self { on: false, doppler: false, factor: 20.0, gamma: 20.0 }
    }
}

/// Sampling of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sampling {
    /// Number of records.
    count: usize,
    /// Mean time between records, s.
    interval: f64,
}

impl Burst {
    /// Range of `factor` and `gamma`.
    pub const RANGE: RangeInclusive<f64> = 1.0..=40.0;

    /// Returns `factor` or `gamma` after a turn of the mouse wheel.
    pub fn adjusted(value: f64, notches: f64) -> f64 {
        if notches.is_finite() { (value + notches).clamp(*Self::RANGE.start(), *Self::RANGE.end()) } else { value }
    }

    /// Maps a value from its range to 0..1.
    fn fraction(value: f64) -> f64 {
        (value.round() - Self::RANGE.start()) / (Self::RANGE.end() - Self::RANGE.start())
    }

    /// Returns the records that are shown besides `present`: at most `room`, evenly spaced over the
    /// whole trajectory.
    fn records(&self, sampling: Sampling, present: usize, room: usize) -> impl Iterator<Item = usize> {
        let Sampling { count, interval } = sampling;
        // The maximum is one record every 20 ms, for any time step.
        let most = (50.0 * (count as f64 / 100.0) * (interval / 0.01)).round().max(1.0);
        let wanted = 1.0 + Self::fraction(self.factor) * (most - 1.0);
        let number = (wanted.round() as usize).min(count).min(room);
        let spacing = if number > 1 { (count - 1) as f64 / (number - 1) as f64 } else { 0.0 };
        (0..number).map(move |index| (index as f64 * spacing).round() as usize).filter(move |&record| record != present)
    }

    /// Returns the colour of a geom of another record: opacity fades with the distance in time, and
    /// the Doppler effect scales red and blue and removes green.
    fn shade(&self, rgba: [f32; 4], sampling: Sampling, present: usize, record: usize) -> [f32; 4] {
        let [mut r, mut g, mut b, a] = rgba;
        let distance = record.abs_diff(present) as f64;
        let slowest = 0.85_f64.powf(sampling.interval / 0.01);
        let gamma = slowest + Self::fraction(self.gamma) * (1.0 - slowest);
        if self.doppler {
            // From one half next to the current record to one at the ends of the trajectory.
            let (ahead, whole) =
                if record < present { (false, present + 1) } else { (true, sampling.count.saturating_sub(present)) };
            let beta = ((distance + 1.0) / whole.max(1) as f64 / 2.0 + 0.5).min(1.0) as f32;
            let (red, blue) = if ahead { (1.0 - beta, beta) } else { (beta, 1.0 - beta) };
            (r, g, b) = (r * red, 0.0, b * blue);
        }
        [r, g, b, a * gamma.powf(distance) as f32]
    }
}

#[cfg(test)]
mod tests {
    use super::{Burst, Sampling};

    fn with(factor: f64, gamma: f64) -> Burst {
        Burst { on: true, factor, gamma, ..Burst::default() }
    }

    #[test]
    fn burst_is_evenly_spaced_from_the_first_to_the_last_record() {
        let sampling = Sampling { count: 100, interval: 0.01 };
        let all: Vec<_> = with(40.0, 20.0).records(sampling, 7, 1000).collect();
        assert_eq!((all.first(), all.last()), (Some(&0), Some(&99)));
        assert_eq!(all.len(), 50);
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(with(1.0, 20.0).records(sampling, 7, 1000).collect::<Vec<_>>(), [0]);
        assert!(!with(40.0, 20.0).records(sampling, 99, 1000).any(|record| record == 99));
    }

    #[test]
    fn burst_respects_short_trajectories_and_full_scenes() {
        for count in 1..20 {
            for interval in [1e-4, 0.01, 0.1, 10.0] {
                for factor in [1.0, 2.5, 20.0, 40.0] {
                    for room in [0, 1, 3, 1000] {
                        let records: Vec<_> =
                            with(factor, 20.0).records(Sampling { count, interval }, 0, room).collect();
                        assert!(records.iter().all(|&record| record < count), "{records:?} of {count}");
                        assert!(records.len() <= room.min(count));
                        assert!(records.windows(2).all(|pair| pair[0] < pair[1]), "{records:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn opacity_fades_with_the_distance_in_time() {
        let sampling = Sampling { count: 100, interval: 0.01 };
        let opacity = |gamma, record| with(20.0, gamma).shade([1.0, 1.0, 1.0, 0.8], sampling, 50, record)[3];
        assert!((opacity(1.0, 51) - 0.8 * 0.85).abs() < 1e-6);
        assert!((opacity(1.0, 48) - 0.8 * 0.85 * 0.85).abs() < 1e-6);
        assert_eq!(opacity(40.0, 99), 0.8);
        assert_eq!(with(20.0, 1.0).shade([0.1, 0.2, 0.3, 1.0], sampling, 50, 51)[..3], [0.1, 0.2, 0.3]);
    }

    #[test]
    fn doppler_shades_the_past_red_and_the_future_blue() {
        let sampling = Sampling { count: 11, interval: 0.01 };
        let burst = Burst { doppler: true, ..with(40.0, 40.0) };
        let shade = |record| burst.shade([1.0, 1.0, 1.0, 1.0], sampling, 5, record);
        let [r, g, b, _] = shade(0);
        assert!((r, g, b) == (1.0, 0.0, 0.0), "{:?}", shade(0));
        let [r, g, b, _] = shade(10);
        assert!((r, g, b) == (0.0, 0.0, 1.0), "{:?}", shade(10));
        let ([past, _, _, _], [older, _, _, _]) = (shade(4), shade(2));
        assert!(0.5 < past && past < older && older < 1.0);
    }

    #[test]
    fn adjusted_values_are_clamped_and_may_be_fractions() {
        assert_eq!(Burst::adjusted(20.0, 0.25), 20.25);
        assert_eq!(Burst::adjusted(39.5, 7.0), 40.0);
        assert_eq!(Burst::adjusted(1.0, -0.1), 1.0);
        assert_eq!(Burst::adjusted(5.0, f64::NAN), 5.0);
    }
}
