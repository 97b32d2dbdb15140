//! Poses of the elements of a world that becomes part of a body.

use super::super::names;
use super::super::tree::{Index, Tree};
use super::super::value::Value;
use super::angles::ORIENTATIONS;
use super::units::{Angles, parsed};
use super::{classes, inertia};
use crate::error::{Error, InvalidKind, Result};
use crate::math::{self, Pose};

/// Returns the pose of an element in the frame of its body.
pub(super) fn of(tree: &Tree, index: Index, angles: &Angles) -> Result<Pose> {
    Ok(Pose { pos: triple(tree, index, "pos")?.unwrap_or_default(), quat: orientation(tree, index, angles)? })
}

/// Moves an element by a pose. Returns the element, or a frame around it.
pub(super) fn moved(tree: &mut Tree, index: Index, pose: &Pose, angles: &Angles) -> Result<Index> {
    if *pose == Pose::default() {
        return Ok(index);
    }
    for flex in flexes_in_frames(tree, index) {
        // Older compilers ignore frames around a flexcomp.
        let moves = flex == index || cfg!(not(engine_since = "4.0.0"));
        if !is_movable(tree, flex, pose) || (moves && !move_in_place(tree, flex, pose, angles)?) {
            return not_movable(tree, flex);
        }
    }
    let is_framed = cfg!(engine_since = "3.2.0") && inertia::is_without(tree, index);
    if tree.tag(index) == "flexcomp" || (!is_framed && move_in_place(tree, index, pose, angles)?) {
        return Ok(index);
    }
    if cfg!(not(engine_since = "3.2.0")) {
        return not_movable(tree, index);
    }
    let parent = tree.parent(index).unwrap_or(Tree::ROOT);
    let frame = tree.add(parent, "frame");
    tree.node_mut(frame).set("pos", pose.pos.text().into_owned());
    tree.node_mut(frame).set("quat", pose.quat.text().into_owned());
    tree.relocate(index, frame);
    Ok(frame)
}

fn not_movable<T>(tree: &Tree, index: Index) -> Result<T> {
    let element = names::describe(tree, index);
    Err(Error::Unsupported(format!("cannot attach {element} at a pose; put it into a body of its spec")))
}

/// Returns the elements `flexcomp` to which the pose of an element applies: itself, or those in
/// frames.
fn flexes_in_frames(tree: &Tree, index: Index) -> Vec<Index> {
    match tree.tag(index) {
        "flexcomp" => vec![index],
        "frame" => tree.children(index).iter().flat_map(|&child| flexes_in_frames(tree, child)).collect(),
        _ => Vec::new(),
    }
}

/// Returns `true` if a `flexcomp` at another pose is the same object. The compiler moves the
/// vertices. The axes of their joints remain the axes of the body, and radial joints point away
/// from its origin. The box of the nodes turns in newer engines, but not with pins.
fn is_movable(tree: &Tree, flex: Index, pose: &Pose) -> bool {
    let is_turned = pose.quat != Pose::default().quat;
    let is_pinned = || tree.children(flex).iter().any(|&child| tree.tag(child) == "pin");
    match tree.attribute(flex, "dof") {
        _ if tree.attribute(flex, "rigid") == Some("true") => true,
        None | Some("full") => true,
        Some("trilinear" | "quadratic") => !is_turned || (cfg!(engine_since = "3.17.0") && !is_pinned()),
        Some("2d") => !is_turned,
        _ => false,
    }
}

/// Changes the pose of an element. Returns `false`, and changes nothing, if only the compiler can
/// do that.
fn move_in_place(tree: &mut Tree, index: Index, pose: &Pose, angles: &Angles) -> Result<bool> {
    let is_turned = pose.quat != Pose::default().quat;
    match tree.tag(index) {
        "body" | "frame" | "geom" | "site" | "camera" | "flexcomp" => {
            if let Some(ends) = classes::effective(tree, index, "fromto").map(str::to_owned) {
                let ends = parsed(tree, index, "fromto", &ends)?;
                // The compiler chooses the rotation about the axis, which would be another one.
                if is_turned {
                    return turn_ends(tree, index, pose, &ends);
                }
                let moved =
                    ends.chunks_exact(3).flat_map(|point| math::trn_vec_pose(pose, &[point[0], point[1], point[2]]));
                let moved: Vec<f64> = moved.collect();
                tree.node_mut(index).set("fromto", (&moved[..]).text().into_owned());
                return Ok(true);
            }
            // A quaternion does not replace these attributes of a class, also where the element has
            // replaced them by its own.
            let of_class = |name: &&str| classes::of_class(tree, index, name).is_some();
            if is_turned && (competes(tree, index) || ORIENTATIONS[1..].iter().any(of_class)) {
                return Ok(false);
            }
            let quat = if is_turned { orientation(tree, index, angles)? } else { Pose::default().quat };
            let old = Pose { pos: triple(tree, index, "pos")?.unwrap_or_default(), quat };
            let new = math::mul_pose(pose, &old);
            let node = tree.node_mut(index);
            node.set("pos", new.pos.text().into_owned());
            if is_turned {
                for attribute in ORIENTATIONS {
                    node.unset(attribute);
                }
                node.set("quat", new.quat.text().into_owned());
            }
        }
        "light" => {
            let pos = triple(tree, index, "pos")?.unwrap_or_default();
            let dir = triple(tree, index, "dir")?.unwrap_or([0.0, 0.0, -1.0]);
            let node = tree.node_mut(index);
            node.set("pos", math::trn_vec_pose(pose, &pos).text().into_owned());
            node.set("dir", math::rot_vec_quat(&dir, &pose.quat).text().into_owned());
        }
        // These have no pose, or one with another meaning.
        _ => return Ok(false),
    }
    Ok(true)
}

/// Replaces the ends of a capsule or cylinder by its size and its pose, with the rotation about the
/// axis that the compiler chooses. Newer engines have frames for this.
fn turn_ends(tree: &mut Tree, index: Index, pose: &Pose, ends: &[f64]) -> Result<bool> {
    let is_of_class = |name: &str| classes::of_class(tree, index, name).is_some();
    let is_round = matches!(classes::effective(tree, index, "type"), Some("capsule" | "cylinder"));
    let size = classes::effective(tree, index, "size").map(|text| parsed(tree, index, "size", text)).transpose()?;
    let (Ok::<[f64; 6], _>(ends), Some(&radius)) = (ends.try_into(), size.as_deref().and_then(<[f64]>::first)) else {
        return Ok(false);
    };
    let replaces_class = ORIENTATIONS[1..].iter().chain(&["fromto"]).any(|&name| is_of_class(name));
    if cfg!(engine_since = "3.2.0") || !is_round || replaces_class {
        return Ok(false);
    }
    let axis = [0, 1, 2].map(|cell| ends[cell] - ends[cell + 3]);
    let pos = [0, 1, 2].map(|cell| f64::midpoint(ends[cell], ends[cell + 3]));
    let old = Pose { pos, quat: math::quat_z2vec(&axis) };
    let new = math::mul_pose(pose, &old);
    let half = axis.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0;
    let node = tree.node_mut(index);
    for attribute in ORIENTATIONS.iter().chain(&["fromto"]) {
        node.unset(attribute);
    }
    node.set("size", [radius, half].text().into_owned());
    node.set("pos", new.pos.text().into_owned());
    node.set("quat", new.quat.text().into_owned());
    Ok(true)
}

/// Returns `true` if an element and its classes have several attributes of its orientation, of
/// which the version of the engine decides which one it uses.
fn competes(tree: &Tree, index: Index) -> bool {
    let found: Vec<&str> =
        ORIENTATIONS.into_iter().filter(|name| classes::effective(tree, index, name).is_some()).collect();
    match found[..] {
        [] | [_] => false,
        ["quat", other] => tree.attribute(index, other).is_none(),
        _ => true,
    }
}

/// Returns the orientation of an element, by its attributes or the attributes of its class.
fn orientation(tree: &Tree, index: Index, angles: &Angles) -> Result<[f64; 4]> {
    if competes(tree, index) {
        let element = names::describe(tree, index);
        return Err(Error::Unsupported(format!(
            "cannot compute the pose of {element}: its class has another orientation"
        )));
    }
    // A quaternion counts only if there is nothing else.
    let found = ORIENTATIONS.iter().rev().find_map(|name| Some((name, classes::effective(tree, index, name)?)));
    found.map_or(Ok(Pose::default().quat), |(attribute, text)| angles.quaternion(tree, index, attribute, text))
}

/// Returns an attribute with three numbers.
pub(super) fn triple(tree: &Tree, index: Index, attribute: &str) -> Result<Option<[f64; 3]>> {
    let Some(text) = classes::effective(tree, index, attribute) else { return Ok(None) };
    let numbers = parsed(tree, index, attribute, text)?;
    let triple = numbers.try_into().map_err(|_| {
        let what = format!("attribute '{attribute}' of {}", names::describe(tree, index));
        Error::invalid(InvalidKind::Text, what, format!("'{text}'"), "3 numbers")
    })?;
    Ok(Some(triple))
}
