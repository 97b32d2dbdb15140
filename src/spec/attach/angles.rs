//! Units and conventions of angles in the text of a model.

use super::super::tree::{Index, Tree};
use super::super::value::{self, Value};
use super::super::{names, paths};
use super::classes;
use crate::error::{Error, Result};
use crate::kind::Kind;
use crate::math;

/// Attributes of an orientation. An element has at most one of them.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Settings of `compiler` on angles.
#[derive(Clone, PartialEq)]
pub(super) struct Angles {
    /// Radians in a unit.
    unit: f64,
    /// Order of Euler angles.
    eulerseq: String,
}

impl Angles {
    pub(super) fn of(tree: &Tree) -> Self {
        let unit = if paths::setting(tree, "angle") == Some("radian") { 1.0 } else { 1_f64.to_radians() };
        Self { unit, eulerseq: paths::setting(tree, "eulerseq").unwrap_or("xyz").to_owned() }
    }

    /// Converts the angles of a model to other settings: orientations become quaternions, and joints get their limits, reference and spring
    /// reference in the other unit, also those that they have from a class.
    pub(super) fn convert(&self, tree: &mut Tree, new: &Self) -> Result<()> {
        if self == new {
            return Ok(());
        }
        let (joints, others): (Vec<Index>, Vec<Index>) = (tree.descendants(Tree::ROOT).into_iter())
            .partition(|&index| names::kind(tree, index) == Some(Kind::Joint));
        // The joints first: the others contain their defaults.
        for index in joints {
            self.convert_joint(tree, index, new.unit)?;
        }
        for index in others {
            let parent = tree.parent(index).map_or("", |parent| tree.tag(parent));
            match (parent, tree.tag(index)) {
                ("default", "joint") => self.convert_joint(tree, index, new.unit)?,
                (_, "replicate") if tree.attribute(index, "euler").is_some() => {
                    return Err(not_convertible("<replicate euler>"));
                }
                ("composite", "joint") if tree.attribute(index, "range").is_some() => {
                    return Err(not_convertible("a limited joint of a composite"));
                }
                _ => {}
            }
            for attribute in ["euler", "axisangle"] {
                let Some(text) = tree.attribute(index, attribute).map(str::to_owned) else { continue };
                let quat = self.quaternion(tree, index, attribute, &text)?;
                let node = tree.node_mut(index);
                node.unset(attribute);
                node.set("quat", quat.text().into_owned());
            }
        }
        Ok(())
    }

    fn convert_joint(&self, tree: &mut Tree, index: Index, unit: f64) -> Result<()> {
        if matches!(classes::effective(tree, index, "type"), Some("slide" | "free")) || tree.tag(index) == "freejoint" {
            return Ok(());
        }
        for attribute in ["range", "ref", "springref"] {
            let Some(text) = classes::effective(tree, index, attribute).map(str::to_owned) else { continue };
            let numbers = parsed(tree, index, attribute, &text)?;
            let numbers: Vec<f64> = numbers.into_iter().map(|number| number * self.unit / unit).collect();
            tree.node_mut(index).set(attribute, (&numbers[..]).text().into_owned());
        }
        Ok(())
    }

    /// Returns the quaternion of an orientation, as the compiler computes it.
    pub(super) fn quaternion(&self, tree: &Tree, index: Index, attribute: &str, text: &str) -> Result<[f64; 4]> {
        let numbers = parsed(tree, index, attribute, text)?;
        let invalid = |length: usize| {
            let what = format!("attribute '{attribute}' of {}", names::describe(tree, index));
            Error::invalid(what, format!("'{text}'"), format!("{length} numbers"))
        };
        match attribute {
            "quat" => {
                let mut quat: [f64; 4] = numbers.try_into().map_err(|_| invalid(4))?;
                math::normalize4(&mut quat);
                Ok(quat)
            }
            "axisangle" => {
                let [x, y, z, angle]: [f64; 4] = numbers.try_into().map_err(|_| invalid(4))?;
                let mut axis = [x, y, z];
                math::normalize(&mut axis);
                Ok(math::axis_angle2quat(&axis, angle * self.unit))
            }
            "euler" => {
                let angles: [f64; 3] = numbers.try_into().map_err(|_| invalid(3))?;
                math::euler2quat(&angles.map(|angle| angle * self.unit), &self.eulerseq)
            }
            "xyaxes" => {
                let axes: [f64; 6] = numbers.try_into().map_err(|_| invalid(6))?;
                let [mut x, mut y]: [[f64; 3]; 2] = [[axes[0], axes[1], axes[2]], [axes[3], axes[4], axes[5]]];
                math::normalize(&mut x);
                let along: f64 = x.iter().zip(&y).map(|(x, y)| x * y).sum();
                for (y, x) in y.iter_mut().zip(&x) {
                    *y -= along * x;
                }
                math::normalize(&mut y);
                let z = math::cross(&x, &y);
                let columns = [x, y, z];
                let mut quat = math::mat2quat(&std::array::from_fn(|cell| columns[cell % 3][cell / 3]));
                math::normalize4(&mut quat);
                Ok(quat)
            }
            _ => {
                let axis: [f64; 3] = numbers.try_into().map_err(|_| invalid(3))?;
                Ok(math::quat_z2vec(&axis))
            }
        }
    }
}

fn not_convertible(element: &str) -> Error {
    Error::Unsupported(format!("cannot attach a spec with {element} if 'angle' or 'eulerseq' of <compiler> differs"))
}

/// Parses the numbers of an attribute.
pub(super) fn parsed(tree: &Tree, index: Index, attribute: &str, text: &str) -> Result<Vec<f64>> {
    value::numbers(text).ok_or_else(|| {
        let what = format!("attribute '{attribute}' of {}", names::describe(tree, index));
        Error::invalid(what, format!("'{text}'"), "a list of numbers")
    })
}
