//! Values of elements in the initial configuration.

use super::super::layout::joint_type;
use super::super::tree::{Entry, Index, Tree};
use super::super::{paths, value};
use super::units::Angles;
use super::{classes, pose};
use crate::math::{self, Pose};

/// Values that elements have without a keyframe.
pub(in super::super) struct Defaults<'t> {
    tree: &'t Tree,
    angles: Angles,
}

impl<'t> Defaults<'t> {
    pub(in super::super) fn new(tree: &'t Tree) -> Self {
        Self { tree, angles: Angles::of(tree) }
    }

    /// Returns the values in a vector of a keyframe, or `None` if only the compiler knows them.
    pub(in super::super) fn of(&self, vector: &str, entry: &Entry) -> Option<Vec<f64>> {
        match vector {
            "qpos" => self.position(entry),
            "mpos" => self.pose(entry).map(|pose| pose.pos.to_vec()),
            "mquat" => self.pose(entry).map(|pose| pose.quat.to_vec()),
            _ => entry.width.map(|width| vec![0.0; width]),
        }
    }

    fn position(&self, entry: &Entry) -> Option<Vec<f64>> {
        let joint = entry.index;
        match joint_type(self.tree, joint) {
            "ball" => Some(vec![1.0, 0.0, 0.0, 0.0]),
            "free" => {
                // The compiler turns the body to its inertia.
                let align = match self.tree.attribute(joint, "align") {
                    None | Some("auto") => paths::setting(self.tree, "alignfree"),
                    own => own,
                };
                if align == Some("true") {
                    return None;
                }
                let mut bodies = std::iter::successors(Some(joint), |&index| self.tree.parent(index));
                let body = bodies.find(|&index| self.tree.tag(index) == "body")?;
                let pose = self.pose(&Entry { index: body, ..entry.clone() })?;
                Some([&pose.pos[..], &pose.quat].concat())
            }
            kind => {
                let text = classes::effective(self.tree, joint, "ref").unwrap_or("0");
                let [reference] = value::numbers(text)?.try_into().ok()?;
                Some(vec![if kind == "hinge" { reference * self.angles.unit } else { reference }])
            }
        }
    }

    /// Returns the pose of a body in the world.
    fn pose(&self, entry: &Entry) -> Option<Pose> {
        if !entry.copies.is_empty() || paths::setting(self.tree, "coordinate") == Some("global") {
            return None;
        }
        let of = |index| pose::of(self.tree, index, &self.angles).ok();
        let mut pose = of(entry.index)?;
        let mut around: Option<Index> = self.tree.parent(entry.index);
        while let Some(frame) = around.filter(|&index| self.tree.tag(index) == "frame") {
            pose = math::mul_pose(&of(frame)?, &pose);
            around = self.tree.parent(frame);
        }
        (around.map(|index| self.tree.tag(index)) == Some("worldbody")).then_some(pose)
    }
}
