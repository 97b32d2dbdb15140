//! Motion: poses of the frames in their parents, and the animations of nodes.

use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Extras, Index, Node};

use super::document::{Document, Kind};
use super::node::{rotation, translation};
use crate::error::{Error, Result};
use crate::math::{mul_quat, neg_quat, rot_vec_quat};
use crate::replay::Pose;

/// Smallest error of quaternions as integers of 16 bits: half a step in each of four components
/// moves a unit quaternion by at most a step of 1/32,767, and its rotation by twice that angle.
const SHORT_ERROR: f64 = 6.2e-5;

/// Motion of all frames. A node moves if a coordinate changes by more than a millionth of the
/// extent of the model, up to 1 µm, or a component of its quaternion by more than a millionth.
const STILL: f64 = 1e-6;

/// Recorded motion.
#[derive(Debug)]
pub(super) struct Clip {
    name: String,
    /// Times since the start, s, ascending.
    times: Vec<[f32; 1]>,
    /// For each frame its poses in its parent at these times.
    poses: Vec<Vec<Pose>>,
}

impl Clip {
    /// Takes the poses of frames in the world, of which each has a parent or is the world.
    pub(super) fn new(name: &str, times: &[f64], world: &[Vec<Pose>], parents: &[Option<usize>]) -> Result<Self> {
        let mut kept: Vec<(usize, [f32; 1])> = Vec::new();
        for (record, time) in times.iter().enumerate() {
            let time = (time - times[0]) as f32;
            if !time.is_finite() {
                return Err(Error::out_of_range("a time to save as glTF", times[record], "finite"));
            }
            // Programs reject times that do not ascend.
            if kept.last().is_none_or(|(_, [last])| time > *last) {
                kept.push((record, [time]));
            }
        }
        let local = |(poses, parent): (&Vec<Pose>, &Option<usize>)| {
            let mut locals: Vec<Pose> = Vec::with_capacity(kept.len());
            for &(record, _) in &kept {
                let pose = parent.map_or(poses[record], |parent| relative(world[parent][record], poses[record]));
                locals.push(pose.near(locals.last().map(|pose| pose.quat)));
            }
            locals
        };
        let poses = world.iter().zip(parents).map(local).collect();
        Ok(Self { name: name.to_owned(), times: kept.into_iter().map(|(_, time)| time).collect(), poses })
    }

    /// Returns the first pose of each frame in its parent.
    pub(super) fn start(&self) -> Vec<Pose> {
        self.poses.iter().map(|poses| poses[0]).collect()
    }

    /// Adds the animation of the nodes that move or differ from their pose at rest.
    pub(super) fn animate(
        &self,
        document: &mut Document,
        nodes: &[Index<Node>],
        rest: &[Pose],
        extent: f64,
        rotation_error: f64,
    ) -> Result<()> {
        let mut parts = Parts { channels: Vec::new(), samplers: Vec::new(), input: None, times: &self.times };
        for ((&node, rest), poses) in nodes.iter().zip(rest).zip(&self.poses) {
            let moves = |value: f64, start: f64, scale: f64| (value - start).abs() > STILL * scale;
            let scale = if extent > 0.0 { extent.min(1.0) } else { 1.0 };
            if poses.iter().any(|pose| (0..3).any(|axis| moves(pose.pos[axis], rest.pos[axis], scale))) {
                let values = poses.iter().map(|pose| translation(pose.pos)).collect::<Result<Vec<_>>>()?;
                let output = document.floats(Kind::Motion, &values);
                parts.push(document, node, Property::Translation, output);
            }
            let turns = |pose: &Pose| {
                let pose = pose.near(Some(rest.quat));
                (0..4).any(|part| moves(pose.quat[part], rest.quat[part], 1.0))
            };
            if poses.iter().any(turns) {
                let values = poses.iter().map(|pose| rotation(pose.quat)).collect::<Result<Vec<_>>>()?;
                let is_short = rotation_error >= SHORT_ERROR;
                let output =
                    if is_short { document.short_rotations(&values) } else { document.floats(Kind::Motion, &values) };
                parts.push(document, node, Property::Rotation, output);
            }
        }
        let Parts { channels, samplers, .. } = parts;
        if !channels.is_empty() {
            let name = if self.name.is_empty() { "motion" } else { &self.name };
            document.root.push(Animation {
                channels,
                samplers,
                name: Some(name.to_owned()),
                extensions: None,
                extras: Extras::default(),
            });
        }
        Ok(())
    }
}

/// Returns the pose in the frame of `parent`.
fn relative(parent: Pose, child: Pose) -> Pose {
    let inverse = neg_quat(&parent.quat);
    let offset: [f64; 3] = std::array::from_fn(|axis| child.pos[axis] - parent.pos[axis]);
    Pose { pos: rot_vec_quat(&offset, &inverse), quat: mul_quat(&inverse, &child.quat) }
}

/// Channels and samplers of an animation.
struct Parts<'t> {
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
    input: Option<Index<Accessor>>,
    times: &'t [[f32; 1]],
}

impl Parts<'_> {
    fn push(&mut self, document: &mut Document, node: Index<Node>, path: Property, output: Index<Accessor>) {
        let input = *self.input.get_or_insert_with(|| document.floats(Kind::Times, self.times));
        let interpolation = Valid(Interpolation::Linear);
        let sampler = Sampler { extensions: None, extras: Extras::default(), input, interpolation, output };
        let sampler = Index::push(&mut self.samplers, sampler);
        let target = Target { extensions: None, extras: Extras::default(), node, path: Valid(path) };
        self.channels.push(Channel { sampler, target, extensions: None, extras: Extras::default() });
    }
}
