//! Motion of a trajectory: the poses of all frames, and the plotted signals.

use serde::Serialize;

use super::deformable::{Sampler, Vertices};
use super::options::{HtmlOptions, Signal};
use super::signal::{self, Source};
use super::stream::{Binary, Interval, LIMIT, Part, Prediction};
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::replay::{self, Frame};
use crate::trajectory::Trajectory;

/// Resolution of times, s.
const TIME_STEP: f64 = 1e-6;

/// Steps of the numbers in streams.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Steps {
    /// Of times, s.
    time: f64,
    /// Of coordinates of positions, m.
    position: f64,
    /// Of components of quaternions.
    rotation: f64,
}

impl Steps {
    pub(super) fn new(options: &HtmlOptions, extent: f64) -> Result<Self> {
        let check = |what: &str, error: f64, limit: f64| {
            if error > 0.0 && error <= limit {
                return Ok(error);
            }
            Err(Error::invalid(InvalidKind::OutOfRange, what, error, format!("above 0 and at most {limit}")))
        };
        let position = options.position_error.unwrap_or_else(|| HtmlOptions::default_error(extent));
        let position = check("HtmlOptions::position_error", position, f64::MAX)?;
        let rotation = check("HtmlOptions::rotation_error", options.rotation_error, 0.1)?;
        Ok(Self {
            time: TIME_STEP,
            // Half a step along each axis.
            position: position * 2.0 / 3.0_f64.sqrt(),
            // Half a step in each of four components moves a unit quaternion by at most one step
            // s, and turns it by an angle of at most asin(s). Its rotation turns by 2 asin(s).
            rotation: (0.5 * rotation).sin(),
        })
    }
}

/// A trajectory in the page.
#[derive(Debug, Serialize)]
pub(super) struct Track {
    label: String,
    /// Number of records.
    count: usize,
    /// Times, one channel.
    times: Part,
    /// Poses: for each frame seven channels, the position and the quaternion.
    poses: Part,
    deformables: Vec<Moving>,
    /// Curves, empty for all but the first trajectory.
    curves: Vec<Curve>,
}

/// Vertices of a deformable shape.
#[derive(Debug, Serialize)]
struct Moving {
    /// Number of vertices.
    vertices: usize,
    /// Three channels for each vertex.
    values: Part,
}

impl Moving {
    /// Takes the vertices in each record. Segments that a record lacks have no length.
    fn new(binary: &mut Binary, records: &[Vertices], step: f64) -> Result<Self> {
        let count = records.iter().map(Vec::len).max().unwrap_or(0);
        let mut channels = Vec::with_capacity(3 * count);
        for vertex in 0..count {
            for axis in 0..3 {
                let value =
                    |record: &Vertices| record.get(vertex).or(record.last()).map_or(0.0, |at| f64::from(at[axis]));
                channels.push(rounded(records.iter().map(value), step)?);
            }
        }
        let values =
            binary.part(|binary| channels.into_iter().for_each(|channel| binary.channel(Prediction::Line, channel)));
        Ok(Self { vertices: count, values })
    }
}

/// A curve of a plot.
#[derive(Debug, Serialize)]
struct Curve {
    name: String,
    /// Empty for a number without a unit, or with one that the model does not state.
    unit: &'static str,
    interval: Interval,
    /// One channel, in which 0 is a value that is not finite, and 1 the number 0.
    values: Part,
}

/// Simulates the poses of a trajectory.
pub(super) struct Motion<'m> {
    pub(super) data: &'m mut Data,
    pub(super) frames: &'m [Frame],
    pub(super) steps: Steps,
    pub(super) options: &'m HtmlOptions,
    /// `None` if the model has no deformable shapes.
    pub(super) sampler: Option<&'m mut Sampler>,
}

impl Motion<'_> {
    pub(super) fn track(
        &mut self,
        binary: &mut Binary,
        label: &str,
        trajectory: &Trajectory,
        signals: &[Signal],
    ) -> Result<Track> {
        let records = replay::records(trajectory.times(), self.options.frames_per_second)?;
        let mut sources = Vec::new();
        for signal in signals {
            sources.extend(signal::sources(self.data, trajectory, signal)?);
        }
        let mut values: Vec<Vec<f64>> = vec![Vec::with_capacity(records.len()); sources.len()];
        let mut shapes: Vec<Vec<Vertices>> = Vec::new();
        let poses = replay::poses(self.data, self.frames, trajectory, &records, |data, record| {
            for (values, source) in values.iter_mut().zip(&sources) {
                values.push(source.place.value(data, trajectory, record));
            }
            if let Some(sampler) = &mut self.sampler {
                sampler.find(binary, data)?;
                for (shape, vertices) in sampler.vertices().into_iter().enumerate() {
                    shapes.resize_with(shapes.len().max(shape + 1), Vec::new);
                    shapes[shape].push(vertices);
                }
            }
            Ok(())
        })?;
        let Steps { time, position, rotation } = self.steps;
        let times = rounded(records.iter().map(|&record| trajectory.times()[record]), time)?;
        let times = binary.part(|binary| binary.channel(Prediction::Line, times));
        let mut channels = Vec::with_capacity(7 * self.frames.len());
        for poses in &poses {
            for axis in 0..3 {
                channels.push(rounded(poses.iter().map(|pose| pose.pos[axis]), position)?);
            }
            for part in 0..4 {
                channels.push(rounded(poses.iter().map(|pose| pose.quat[part]), rotation)?);
            }
        }
        let poses = binary.part(|binary| {
            for channel in channels {
                binary.channel(Prediction::Line, channel);
            }
        });
        let deformables = shapes.iter().map(|records| Moving::new(binary, records, position)).collect::<Result<_>>()?;
        let curves =
            sources.into_iter().zip(values).map(|(source, values)| Curve::new(binary, source, &values)).collect();
        Ok(Track { label: label.to_owned(), count: records.len(), times, poses, deformables, curves })
    }
}

/// Returns the multiples of a step that are nearest to values.
fn rounded(values: impl Iterator<Item = f64>, step: f64) -> Result<Vec<i64>> {
    let number = |value: f64| {
        let number = (value / step).round();
        // NaN is no number.
        if number.abs() <= LIMIT {
            return Ok(number as i64);
        }
        let expected = format!("within {:e} for this precision", LIMIT * step);
        Err(Error::invalid(InvalidKind::OutOfRange, "a time or a coordinate in a page", value, expected))
    };
    values.map(number).collect()
}

impl Curve {
    fn new(binary: &mut Binary, source: Source<'_>, values: &[f64]) -> Self {
        let interval = Interval::of(values.iter().copied());
        let number = |&value: &f64| if value.is_finite() { 1 + interval.number(value) } else { 0 };
        let values = binary.part(|binary| binary.channel(Prediction::Line, values.iter().map(number)));
        Self { name: source.name, unit: source.unit, interval, values }
    }
}
