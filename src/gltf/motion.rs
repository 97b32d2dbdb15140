//! Motion: poses of the frames in their parents, and the animations of nodes.

use std::ops::Range;

use gltf_json::Index;
use gltf_json::accessor::ComponentType;
use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf_json::validation::Checked::Valid;

use super::document::{Document, object};
use super::node::{rotation, translation};
use crate::error::{Error, Result};
use crate::math::{Pose, mul_pose, neg_pose};

/// Smallest error of quaternions as integers of 16 bits: half a step in each of four components
/// moves a unit quaternion by at most a step of 1/32,767, and its rotation by twice that angle.
const SHORT_ERROR: f64 = 6.2e-5;

/// A node moves if a coordinate changes by more than a millionth of the extent of the model, up to
/// 1 µm, or a component of its quaternion by more than a millionth.
const STILL: f64 = 1e-6;

/// Returns the times of records since the first, s, which ascend. Programs reject times that do not
/// ascend in single precision: their records are removed.
pub(super) fn ascending(times: &[f64], records: &mut Vec<usize>) -> Result<Vec<[f32; 1]>> {
    let start = times[records[0]];
    let since_start = |record: usize| (times[record] - start) as f32;
    if let Some(&record) = records.iter().find(|&&record| !since_start(record).is_finite()) {
        return Err(Error::out_of_range("a time to save as glTF", times[record], "finite"));
    }
    records.dedup_by(|later, earlier| since_start(*later) <= since_start(*earlier));
    Ok(records.iter().map(|&record| [since_start(record)]).collect())
}

/// Recorded motion.
#[derive(Debug)]
pub(super) struct Clip<'n> {
    pub(super) name: &'n str,
    /// Times since the start, s, ascending.
    pub(super) times: Vec<[f32; 1]>,
    /// For each frame its poses in the world at these times.
    pub(super) poses: Vec<Vec<Pose>>,
}

impl Clip<'_> {
    /// Returns the poses of the frames in their parents.
    pub(super) fn in_parents(&self, parents: &[Option<usize>]) -> Vec<Vec<Pose>> {
        let local = |(poses, parent): (&Vec<Pose>, &Option<usize>)| {
            let mut locals: Vec<Pose> = Vec::with_capacity(poses.len());
            for (record, &pose) in poses.iter().enumerate() {
                let pose = parent.map_or(pose, |parent| mul_pose(&neg_pose(&self.poses[parent][record]), &pose));
                locals.push(pose.near(locals.last()));
            }
            locals
        };
        self.poses.iter().zip(parents).map(local).collect()
    }
}

impl Document<'_> {
    /// Adds the animation of the nodes that move or differ from their pose at rest. `poses` are
    /// those of the clip in their parents.
    pub(super) fn animate(
        &mut self,
        clip: &Clip<'_>,
        poses: &[Vec<Pose>],
        rest: &[Pose],
        rotation_error: f64,
    ) -> Result<()> {
        let extent = self.model.statistics().extent;
        let scale = if extent > 0.0 { extent.min(1.0) } else { 1.0 };
        let mut outputs = Vec::new();
        for (index, (rest, poses)) in rest.iter().zip(poses).enumerate() {
            let moves = |parts: Range<usize>, scale: f64| {
                let start = rest.numbers();
                let mut numbers = poses.iter().map(|pose| pose.near(Some(rest)).numbers());
                numbers.any(|now| parts.clone().any(|part| (now[part] - start[part]).abs() > STILL * scale))
            };
            if moves(0..3, scale) {
                let values = poses.iter().map(|pose| translation(pose.pos)).collect::<Result<Vec<_>>>()?;
                outputs.push((index, Property::Translation, self.floats(&values, None)));
            }
            if moves(3..7, 1.0) {
                let values = poses.iter().map(|pose| rotation(pose.quat)).collect::<Result<Vec<_>>>()?;
                let output = if rotation_error >= SHORT_ERROR {
                    let short = |part: f32| ((part * 32767.0).round() as i16).to_le_bytes();
                    self.vectors(&values, ComponentType::I16, short, None)
                } else {
                    self.floats(&values, None)
                };
                outputs.push((index, Property::Rotation, output));
            }
        }
        if outputs.is_empty() {
            return Ok(());
        }
        let input = self.bounded(&clip.times, None);
        let parts = (0..).zip(outputs).map(|(index, (frame, path, output))| {
            let interpolation = Valid(Interpolation::Linear);
            let sampler = object!(Sampler { input, interpolation, output });
            let node = self.nodes[frame];
            let target = object!(Target { node, path: Valid(path) });
            (object!(Channel { sampler: Index::new(index), target }), sampler)
        });
        let (channels, samplers) = parts.unzip();
        let name = Some(if clip.name.is_empty() { "motion" } else { clip.name }.to_owned());
        self.root.push(object!(Animation { channels, samplers, name }));
        Ok(())
    }
}
