//! Motion of a trajectory: the poses of all frames, and the plotted signals.

use super::deformable::Vertices;
use super::page::{Curve, Moving, Page, Track};
use super::signal::{self, Source};
use super::stream::{Binary, Interval, LIMIT, Prediction};
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::replay::{self, Frame};
use crate::trajectory::Trajectory;

impl Moving {
    /// Takes the vertices in each record. Segments that a record lacks have no length.
    fn new(binary: &mut Binary, records: &[Vertices], step: f64) -> Result<Self> {
        let count = records.iter().map(Vec::len).max().unwrap_or(0);
        let start = binary.bytes().len();
        for vertex in 0..count {
            for axis in 0..3 {
                let value =
                    |record: &Vertices| record.get(vertex).or(record.last()).map_or(0.0, |at| f64::from(at[axis]));
                binary.channel(Prediction::Line, rounded(records.iter().map(value), step)?);
            }
        }
        Ok(Self { vertices: count, values: binary.since(start) })
    }
}

impl Page<'_> {
    /// Adds records of a trajectory, of which the first has the signals.
    pub(super) fn add(
        &mut self,
        data: &mut Data,
        frames: &[Frame],
        label: &str,
        trajectory: &Trajectory,
        records: &[usize],
    ) -> Result<()> {
        let Self { binary, sampler, steps, .. } = self;
        let mut sources = Vec::new();
        if self.tracks.is_empty() {
            for signal in &self.options.signals {
                sources.extend(signal::sources(data, trajectory, signal)?);
            }
        }
        let mut values: Vec<Vec<f64>> = vec![Vec::with_capacity(records.len()); sources.len()];
        let mut shapes: Vec<Vec<Vertices>> = Vec::new();
        let poses = replay::poses(data, frames, trajectory, records, |data, record| {
            for (values, source) in values.iter_mut().zip(&sources) {
                values.push(source.place.value(data, trajectory, record));
            }
            if let Some(sampler) = sampler {
                sampler.update(data)?;
                let vertices = sampler.vertices();
                shapes.resize_with(vertices.len(), Vec::new);
                shapes.iter_mut().zip(vertices).for_each(|(records, vertices)| records.push(vertices));
            }
            Ok(())
        })?;
        let times = rounded(records.iter().map(|&record| trajectory.times()[record]), steps.time)?;
        let times = binary.stream(Prediction::Line, times);
        let start = binary.bytes().len();
        for poses in &poses {
            for number in 0..7 {
                let step = if number < 3 { steps.position } else { steps.rotation };
                let numbers = rounded(poses.iter().map(|pose| pose.numbers()[number]), step)?;
                binary.channel(Prediction::Line, numbers);
            }
        }
        let poses = binary.since(start);
        let deformables = shapes.iter().map(|records| Moving::new(binary, records, steps.position));
        let deformables = deformables.collect::<Result<_>>()?;
        let curves = sources.into_iter().zip(values).map(|(source, values)| Curve::new(binary, source, &values));
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
        let values = binary.stream(Prediction::Line, values.iter().map(number));
        Self { name: source.name, unit: source.unit, interval, values }
    }
}
