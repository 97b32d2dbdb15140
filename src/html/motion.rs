//! Motion of a trajectory: the poses of all frames, and the plotted signals.

use super::deformable::Vertices;
use super::page::{Curve, Moving, Page, Track};
use super::signal::{self, Source};
use super::stream::{Binary, Interval, LIMIT, Prediction};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::math::Pose;
use crate::replay;
use crate::trajectory::Trajectory;

impl Moving {
    /// Takes the vertices of a shape in each record. Segments that a record lacks have no length.
    fn new(binary: &mut Binary, records: &[Vec<Vertices>], shape: usize, step: f64) -> Result<Self> {
        let records = || records.iter().map(|shapes| &shapes[shape]);
        let vertices = records().map(Vec::len).max().unwrap_or(0);
        let channel = |index: usize| {
            let vertex = |record: &Vertices| record.get(index / 3).or(record.last()).copied().unwrap_or_default();
            rounded(records().map(|record| f64::from(vertex(record)[index % 3])), step)
        };
        let channels = (0..3 * vertices).map(channel).collect::<Result<Vec<_>>>()?;
        Ok(Self { vertices, values: binary.stream(Prediction::Line, channels) })
    }
}

impl Page<'_> {
    /// Adds records of a trajectory, of which the first has the signals.
    pub(super) fn add(
        &mut self,
        data: &mut Data,
        label: &str,
        trajectory: &Trajectory,
        records: &[usize],
    ) -> Result<()> {
        let Self { binary, steps, look, .. } = self;
        let signals = if self.tracks.is_empty() { &self.options.signals[..] } else { &[] };
        let mut sources = Vec::new();
        for signal in signals {
            sources.extend(signal::sources(data, trajectory, signal)?);
        }
        let (mut values, mut shapes) = (Vec::new(), Vec::new());
        let poses = replay::poses(data, trajectory, records, |data, record| {
            values.push(sources.iter().map(|source| (source.value)(data, record)).collect());
            if let Some(sampler) = &mut look.sampler {
                sampler.update(data)?;
                shapes.push(sampler.vertices());
            }
            Ok(())
        })?;
        let times = rounded(records.iter().map(|&record| trajectory.times()[record]), steps.time)?;
        let times = binary.stream(Prediction::Line, [times]);
        let channel = |(poses, number): (&Vec<Pose>, usize)| {
            let step = if number < 3 { steps.position } else { steps.rotation };
            rounded(poses.iter().map(|pose| pose.numbers()[number]), step)
        };
        let channels = poses.iter().flat_map(|poses| (0..7).map(move |number| (poses, number))).map(channel);
        let poses = binary.stream(Prediction::Line, channels.collect::<Result<Vec<_>>>()?);
        let shape = |index| Moving::new(binary, &shapes, index, steps.position);
        let deformables = (0..look.deformables.len()).map(shape).collect::<Result<_>>()?;
        let curve = |(index, source)| Curve::new(binary, source, values.iter().map(|values: &Vec<f64>| values[index]));
        let curves = sources.into_iter().enumerate().map(curve);
        let (label, count, curves) = (label.to_owned(), records.len(), curves.collect());
        self.tracks.push(Track { label, count, times, poses, deformables, curves });
        Ok(())
    }
}

/// Returns the multiples of a step that are nearest to values.
fn rounded(values: impl Iterator<Item = f64>, step: f64) -> Result<Vec<i64>> {
    let number = |value: f64| {
        let number = (value / step).round();
        // NaN is no number.
        let expected = format_args!("within {:e} for this precision", LIMIT * step);
        Error::check_range(number.abs() <= LIMIT, "a time or a coordinate in a page", value, expected)?;
        Ok(number as i64)
    };
    values.map(number).collect()
}

impl Curve {
    fn new(binary: &mut Binary, source: Source<'_>, values: impl Iterator<Item = f64> + Clone) -> Self {
        let interval = Interval::of(values.clone());
        let number = |value: f64| if value.is_finite() { 1 + interval.number(value) } else { 0 };
        let values = binary.stream(Prediction::Line, [values.map(number)]);
        Self { name: source.name, unit: source.unit, interval, values }
    }
}
