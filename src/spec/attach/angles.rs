//! Conversion of angles to other settings of `compiler`.

use super::super::attributes::{self, Meaning};
use super::super::names;
use super::super::tree::{Index, Tree};
use super::super::value::Value;
use super::units::{Angles, parsed};
use super::{classes, positions};
use crate::error::{Error, InvalidKind, Result};
use crate::math;

/// Attributes of an orientation. An element has at most one of them.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

impl Angles {
    /// Converts the angles of a model to other settings.
    pub(super) fn convert(&self, tree: &mut Tree, new: &Self) -> Result<()> {
        if self == new {
            return Ok(());
        }
        // The elements first: the conversion of some depends on that they have from their classes.
        let with_axes = tags_with_axes(tree);
        let (defaults, elements): (Vec<Index>, Vec<Index>) =
            tree.descendants(Tree::ROOT).into_iter().partition(|&index| is_default(tree, index));
        for index in elements.into_iter().chain(defaults) {
            if tree.tag(index) == "joint" && tree.parent(index).is_some_and(|parent| tree.tag(parent) == "composite") {
                // The type of the composite decides whether the range is an angle.
                if tree.attribute(index, "range").is_some() {
                    return Err(not_convertible("a limited joint of a composite"));
                }
                continue;
            }
            let meanings = attributes::meanings(tree, index);
            let names: Vec<String> = tree.node(index).attributes.iter().map(|(name, _)| name.clone()).collect();
            for attribute in names {
                match meanings.get(&attribute[..]) {
                    Some(Meaning::Angle) if self.unit != new.unit => {
                        positions::convert(tree, index, &attribute, self, new)?;
                    }
                    Some(Meaning::Rotation) => self.convert_rotation(tree, index, &attribute, new, &with_axes)?,
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Converts a rotation. Where attributes of an element and of its class compete, the kind of
    /// the attribute decides which one the compiler uses, so the kind stays the same if the order
    /// of Euler angles does.
    fn convert_rotation(
        &self,
        tree: &mut Tree,
        index: Index,
        attribute: &str,
        new: &Self,
        with_axes: &[String],
    ) -> Result<()> {
        let text = tree.attribute(index, attribute).unwrap_or_default().to_owned();
        if attribute == "axisangle" || self.eulerseq == new.eulerseq {
            let mut numbers = parsed(tree, index, attribute, &text)?;
            let start = if attribute == "axisangle" { 3 } else { 0 };
            for number in numbers.iter_mut().skip(start) {
                *number = self.in_unit_of(new, *number);
            }
            tree.node_mut(index).set(attribute, (&numbers[..]).text().into_owned());
            return Ok(());
        }
        if tree.tag(index) == "replicate" {
            let numbers = parsed(tree, index, attribute, &text)?;
            let Some(angles) = self.in_order_of(new, &numbers) else {
                return Err(not_convertible("<replicate euler> about axes in another order"));
            };
            tree.node_mut(index).set(attribute, angles.text().into_owned());
            return Ok(());
        }
        let competes = is_default(tree, index)
            || ORIENTATIONS[1..].iter().any(|other| classes::of_class(tree, index, other).is_some());
        // Older compilers prefer axes of the element or of the class by their kind.
        if competes && cfg!(not(engine_since = "3.2.0")) && with_axes.iter().any(|tag| tag == tree.tag(index)) {
            return Err(not_convertible(&format!("Euler angles in a class of {}", names::describe(tree, index))));
        }
        let quat = self.quaternion(tree, index, attribute, &text)?;
        let node = tree.node_mut(index);
        node.unset(attribute);
        if competes {
            // Other than a quaternion, axes replace the orientation of a class in all engines.
            let columns = math::quat2mat(&quat);
            let axes: Vec<f64> = [0, 3, 6, 1, 4, 7].map(|cell| columns[cell]).to_vec();
            node.set("xyaxes", (&axes[..]).text().into_owned());
        } else {
            node.set("quat", quat.text().into_owned());
        }
        Ok(())
    }

    /// Returns the same Euler angles for another sequence, or `None` if it turns about these axes
    /// in another order: the compiler multiplies each angle by the number of the copy, so that no
    /// other angles give the same copies.
    fn in_order_of(&self, new: &Self, numbers: &[f64]) -> Option<[f64; 3]> {
        let &[_, _, _] = numbers else { return None };
        let mut left = rotations(&new.eulerseq).into_iter();
        let mut angles = [0.0; 3];
        for (axis, place) in rotations(&self.eulerseq) {
            let angle = *numbers.get(place)?;
            if angle != 0.0 {
                let (_, place) = left.find(|(other, _)| *other == axis)?;
                *angles.get_mut(place)? = self.in_unit_of(new, angle);
            }
        }
        Some(angles)
    }

    /// Returns the quaternion of an orientation, as the compiler computes it.
    pub(super) fn quaternion(&self, tree: &Tree, index: Index, attribute: &str, text: &str) -> Result<[f64; 4]> {
        let numbers = parsed(tree, index, attribute, text)?;
        let invalid = |length: usize| {
            let what = format!("attribute '{attribute}' of {}", names::describe(tree, index));
            Error::invalid(InvalidKind::Text, what, format!("'{text}'"), format!("{length} numbers"))
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

/// Returns the axes of a sequence of Euler angles, and their places in it, in the order of a
/// product of rotations: an axis in capitals is that of the fixed frame.
fn rotations(eulerseq: &str) -> Vec<(char, usize)> {
    let mut found = Vec::new();
    for (place, letter) in eulerseq.chars().enumerate() {
        let rotation = (letter.to_ascii_lowercase(), place);
        if letter.is_ascii_lowercase() { found.push(rotation) } else { found.insert(0, rotation) }
    }
    found
}

/// Returns the tags of the elements whose orientation is given by axes.
fn tags_with_axes(tree: &Tree) -> Vec<String> {
    let has_axes = |index: &Index| ["xyaxes", "zaxis"].iter().any(|name| tree.attribute(*index, name).is_some());
    tree.descendants(Tree::ROOT).into_iter().filter(has_axes).map(|index| tree.tag(index).to_owned()).collect()
}

/// Returns `true` for the defaults of elements in a class.
fn is_default(tree: &Tree, index: Index) -> bool {
    tree.parent(index).is_some_and(|parent| tree.tag(parent) == "default")
}

fn not_convertible(element: &str) -> Error {
    Error::Unsupported(format!("cannot attach a spec with {element} if 'angle' or 'eulerseq' of <compiler> differs"))
}
