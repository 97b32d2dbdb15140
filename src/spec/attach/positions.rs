//! Joint positions of a spec with another unit of angles.
//!
//! The type of a joint decides whether its position is an angle, and the type and the position can
//! have different places: one is an attribute of the joint and the other one of its class, which
//! also serves joints of other types, and both can change later. So an attribute keeps its value as
//! an angle and as a length until the text is written.

use std::borrow::Cow;

use super::super::names;
use super::super::tree::{Index, Position, Tree};
use super::super::value::Value;
use super::units::{Angles, parsed};
use super::{classes, settings};
use crate::error::{Error, Result};
use crate::kind::Kind;

/// Attributes of joint positions.
pub(super) const POSITIONS: [&str; 4] = ["range", "ref", "springref", "springyield"];

/// Converts an attribute of a joint, or of the defaults of joints, to another unit of angles.
pub(super) fn convert(tree: &mut Tree, index: Index, attribute: &str, old: &Angles, new: &Angles) -> Result<()> {
    let node = tree.node(index);
    let known = node.positions.iter().find(|position| position.attribute == attribute);
    let text = node.attribute(attribute).unwrap_or_default();
    let [angle, length] = known.map_or([text, text], |known| [&known.angle, &known.length]).map(str::to_owned);
    let numbers: Vec<f64> =
        parsed(tree, index, attribute, &angle)?.into_iter().map(|number| old.in_unit_of(new, number)).collect();
    let position = Position { attribute: attribute.to_owned(), angle: (&numbers[..]).text().into_owned(), length };
    let value = if is_angle(tree, index, attribute)? { &position.angle } else { &position.length }.clone();
    let node = tree.node_mut(index);
    node.set(attribute, value);
    node.positions.push(position);
    Ok(())
}

/// Returns the tree with those values of joint positions that the types of the joints need.
pub(in super::super) fn resolved(tree: &Tree) -> Cow<'_, Tree> {
    if !tree.has_positions() {
        return Cow::Borrowed(tree);
    }
    let mut resolved = tree.clone();
    for index in tree.descendants(Tree::ROOT) {
        if names::kind(tree, index) != Some(Kind::Joint) || tree.tag(index) != "joint" {
            continue;
        }
        for attribute in POSITIONS {
            let place = match tree.attribute(index, attribute) {
                Some(_) => Some(index),
                None => classes::default(tree, index, attribute),
            };
            let Some(place) = place else { continue };
            let position = tree.node(place).positions.iter().find(|position| position.attribute == attribute);
            // The compiler rejects a type that it does not know.
            let Some((position, is_angle)) = position.zip(is_angle(tree, index, attribute).ok()) else { continue };
            let value = if is_angle { &position.angle } else { &position.length };
            if tree.attribute(place, attribute) != Some(value) {
                resolved.node_mut(index).set(attribute, value.clone());
            }
        }
    }
    Cow::Owned(resolved)
}

/// Returns `true` if the compiler reads an attribute of a joint, or of the defaults of joints, as
/// an angle.
fn is_angle(tree: &Tree, index: Index, attribute: &str) -> Result<bool> {
    let joint_type = classes::effective(tree, index, "type").unwrap_or("hinge");
    match (joint_type, attribute) {
        ("free" | "slide", _) => Ok(false),
        // The compiler does not convert a range that is not a limit.
        ("hinge" | "ball", "range") => Ok(is_limited(tree, index)),
        ("hinge" | "ball", "springyield") => Ok(true),
        ("hinge" | "ball", "ref" | "springref") => Ok(joint_type == "hinge"),
        _ => {
            let joint = names::describe(tree, index);
            let message = format!(
                "cannot attach {joint} if 'angle' of <compiler> differs: whether '{attribute}' of the type '{joint_type}' is an angle is not known here"
            );
            Err(Error::Unsupported(message))
        }
    }
}

fn is_limited(tree: &Tree, index: Index) -> bool {
    match classes::effective(tree, index, "limited") {
        Some("true") => true,
        Some("false") => false,
        _ => settings::are_limits_automatic(tree) && settings::is_range(classes::effective(tree, index, "range")),
    }
}
