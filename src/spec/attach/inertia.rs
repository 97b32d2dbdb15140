//! Attached bodies whose mass and inertia do not depend on the settings of the other spec.

use super::super::attributes::Named;
use super::super::layout::joint_type;
use super::super::names;
use super::super::paths;
use super::super::tree::{Index, Tree};
use super::super::value::{self, Value};
use super::classes;
use crate::kind::Kind;
use crate::math;

/// Changes a spec so that it has the same bodies with another value of a setting of `compiler`.
/// Returns `false` if only the compiler could do that.
pub(super) fn adapt(child: &mut Tree, attribute: &str, theirs: &str, ours: &str) -> bool {
    match attribute {
        "convexhull" | "exactmeshinertia" | "fitaabb" => !has_meshes(child),
        "alignfree" => {
            !creates_bodies(child)
                && !names::all(child, Named::Kind(Kind::Joint)).any(|joint| joint_type(child, joint) == "free")
        }
        // The setting of the outer spec is one of the whole model.
        "settotalmass" => theirs.trim().parse().is_ok_and(|mass: f64| mass <= 0.0),
        "inertiafromgeom" => ours != "true" && are_inertias_explicit(child),
        // Else the geoms of the outer range replace explicit inertias.
        "inertiagrouprange" => paths::setting(child, "inertiafromgeom") != Some("true") && are_inertias_explicit(child),
        "boundmass" => bound(child, "mass", theirs, ours),
        "boundinertia" => {
            diagonalize(child);
            bound(child, "diaginertia", theirs, ours)
        }
        "balanceinertia" => {
            diagonalize(child);
            theirs != "true" || balance(child)
        }
        _ => false,
    }
}

/// Returns `true` for a body without an inertia. The compiler takes its position, before that of a
/// frame around it, as its centre of mass too.
pub(super) fn is_without(tree: &Tree, index: Index) -> bool {
    tree.tag(index) == "body"
        && !tree.children(index).iter().any(|&child| tree.tag(child) == "inertial")
        && (paths::setting(tree, "inertiafromgeom") == Some("false") || !is_from_geoms(tree, index))
}

/// Returns `true` if a body has geoms of the groups from which the compiler computes inertias. Else
/// it uses the given one in all settings.
pub(super) fn is_from_geoms(tree: &Tree, body: Index) -> bool {
    let numbers = |text: &str| value::numbers(text).unwrap_or_default();
    let range = numbers(paths::setting(tree, "inertiagrouprange").unwrap_or("0 5"));
    let [low, high] = range[..] else { return true };
    let is_inside = |geom: Index| {
        let group = numbers(classes::effective(tree, geom, "group").unwrap_or("0"));
        group.iter().all(|group| (low..=high).contains(group))
    };
    geoms(tree, body).into_iter().any(is_inside)
}

/// Returns the geoms of a body, also in frames and copies.
pub(super) fn geoms(tree: &Tree, body: Index) -> Vec<Index> {
    let mut found = Vec::new();
    let mut open = vec![body];
    while let Some(index) = open.pop() {
        for &child in tree.children(index) {
            match tree.tag(child) {
                "geom" => found.push(child),
                "frame" | "replicate" => open.push(child),
                _ => {}
            }
        }
    }
    found
}

fn has_meshes(tree: &Tree) -> bool {
    names::all(tree, Named::Kind(Kind::Mesh)).next().is_some()
}

/// Returns `true` if bodies come from other elements than `body`.
pub(super) fn creates_bodies(tree: &Tree) -> bool {
    let creates = |index: Index| matches!(tree.tag(index), "composite" | "flexcomp" | "attach");
    tree.descendants(Tree::ROOT).into_iter().any(creates)
}

pub(super) fn inertials(tree: &Tree) -> Vec<Index> {
    tree.descendants(Tree::ROOT).into_iter().filter(|&index| tree.tag(index) == "inertial").collect()
}

/// Returns `true` if no inertia is computed from geoms.
fn are_inertias_explicit(tree: &Tree) -> bool {
    let is_explicit = |body: Index| tree.children(body).iter().any(|&child| tree.tag(child) == "inertial");
    let mut bodies = names::all(tree, Named::Kind(Kind::Body)).filter(|&body| tree.tag(body) == "body");
    !creates_bodies(tree) && bodies.all(is_explicit)
}

/// Replaces complete matrices of inertia by moments about principal axes. Leaves those that the
/// compiler rejects.
fn diagonalize(child: &mut Tree) {
    for index in inertials(child) {
        let numbers = child.attribute(index, "fullinertia").and_then(value::numbers).unwrap_or_default();
        let [xx, yy, zz, xy, xz, yz] = numbers[..] else { continue };
        let principal = math::eig3(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
        if principal.eigval[2] > 0.0 && child.attribute(index, "quat").is_none() {
            let node = child.node_mut(index);
            node.unset("fullinertia");
            node.set("quat", principal.quat.text().into_owned());
            node.set("diaginertia", principal.eigval.text().into_owned());
        }
    }
}

/// Applies a lower bound to the numbers of all inertias. Returns `false` if they are not known, or
/// if the bound of the other spec would change them.
fn bound(child: &mut Tree, attribute: &str, theirs: &str, ours: &str) -> bool {
    let [Ok(theirs), Ok(ours)] = [theirs, ours].map(|text| text.trim().parse::<f64>()) else { return false };
    if !are_inertias_explicit(child) {
        return false;
    }
    for index in inertials(child) {
        let Some(numbers) = child.attribute(index, attribute).and_then(value::numbers) else { return false };
        let bounded: Vec<f64> = numbers.iter().map(|number| number.max(theirs)).collect();
        if bounded.iter().any(|number| *number < ours) {
            return false;
        }
        if bounded != numbers {
            child.node_mut(index).set(attribute, (&bounded[..]).text().into_owned());
        }
    }
    true
}

/// Replaces the inertias that no body can have by the mean of their diagonals, as the compiler
/// does.
fn balance(child: &mut Tree) -> bool {
    // Those of meshes are computed, and may be others than the shape has.
    if has_meshes(child) && !are_inertias_explicit(child) {
        return false;
    }
    // The compiler applies this bound first.
    let least = paths::setting(child, "boundinertia").and_then(|text| text.trim().parse().ok()).unwrap_or(0.0_f64);
    for index in inertials(child) {
        let numbers = child.attribute(index, "diaginertia").and_then(value::numbers).unwrap_or_default();
        let [a, b, c] = numbers[..] else { return false };
        let [a, b, c] = [a.max(least), b.max(least), c.max(least)];
        if a + b < c || a + c < b || b + c < a {
            child.node_mut(index).set("diaginertia", [(a + b + c) / 3.0; 3].text().into_owned());
        }
    }
    true
}
