//! Order in which the compiler lays out the values of joints, actuators and mocap bodies.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::attach::effective;
use super::tree::{Entry, Index, Tree};
use super::{copies, names};
use crate::kind::Kind;

/// Attributes of a keyframe with the values of all elements of a kind.
pub(super) const VECTORS: [&str; 6] = ["qpos", "qvel", "act", "ctrl", "mpos", "mquat"];

/// Attributes that do not determine how many values an element has: names, which attachments
/// change, places and looks.
const WITHOUT_VALUES: [&str; 23] = [
    "name",
    "class",
    "prefix",
    "instance",
    "joint",
    "jointinparent",
    "tendon",
    "site",
    "refsite",
    "cranksite",
    "slidersite",
    "material",
    "rgba",
    "group",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "mass",
    "spacing",
    "radius",
];

/// Number of elements and copies beyond which the layout is not known.
const MOST: usize = 1_000_000;

/// Number of activations of an actuator beyond which the layout is not known.
const MOST_ACTIVATIONS: usize = 1_000;

/// Returns the elements with values in a vector, in the order of the compiled model.
pub(super) fn of(tree: &Tree, vector: &str) -> Vec<Entry> {
    match vector {
        "act" | "ctrl" => of_actuators(tree, vector),
        _ => of_bodies(tree, vector),
    }
}

fn entry(tree: &Tree, index: Index, copies: Vec<usize>, width: Option<usize>) -> Entry {
    let makeup = if width.is_none() { makeup(tree, index) } else { 0 };
    Entry { index, copies, width, makeup }
}

/// Returns a hash of what determines the number of values of an element, as far as the tree has it:
/// the contents of files and the settings of plugin instances may change it too.
fn makeup(tree: &Tree, index: Index) -> u64 {
    let mut hasher = DefaultHasher::new();
    let is_actuator = names::kind(tree, index) == Some(Kind::Actuator);
    let classes = if is_actuator { super::attach::defaults_of(tree, index) } else { Vec::new() };
    for element in classes.into_iter().flat_map(|default| tree.descendants(default)).chain(tree.descendants(index)) {
        tree.tag(element).hash(&mut hasher);
        for (attribute, value) in &tree.node(element).attributes {
            if attribute == "file" {
                value.rsplit(['/', '\\']).next().hash(&mut hasher);
            } else if !WITHOUT_VALUES.contains(&&attribute[..]) {
                (attribute, value).hash(&mut hasher);
            }
        }
    }
    hasher.finish()
}

fn of_actuators(tree: &Tree, vector: &str) -> Vec<Entry> {
    let order = copies::actuators(tree);
    let is_known = order.is_some();
    let in_text = || {
        let sections = tree.descendants(Tree::ROOT).into_iter();
        let is_one = |&index: &Index| names::kind(tree, index) == Some(Kind::Actuator) || tree.tag(index) == "attach";
        sections.filter(is_one).map(|index| (index, Vec::new())).collect()
    };
    let width = |index| {
        let (activations, controls) = if tree.tag(index) == "attach" { (None, None) } else { widths(tree, index) };
        if vector == "act" { activations } else { controls }
    };
    let entries = order.unwrap_or_else(in_text).into_iter();
    entries.map(|(index, copies)| entry(tree, index, copies, width(index).filter(|_| is_known))).collect()
}

/// Returns the numbers of activations and of controls of an actuator. The shortcuts of `general`
/// in a class set the same defaults.
fn widths(tree: &Tree, index: Index) -> (Option<usize>, Option<usize>) {
    /// Dynamics and gain that an element sets.
    #[derive(Clone, Copy)]
    struct State<'t> {
        activations: Option<usize>,
        controls: Option<usize>,
        dimension: Option<&'t str>,
    }
    let simple = |activations| State { activations: Some(activations), controls: Some(1), dimension: None };
    let unknown = State { activations: None, controls: None, dimension: None };
    let mut state = simple(0);
    // `Some(true)` if a `position` without a time constant inherits a filter from its classes.
    // `None` after an element that removes the filter in some engines only.
    let mut has_filter = Some(false);
    let mut is_general = true;
    for place in super::attach::defaults_of(tree, index).into_iter().chain([index]) {
        let tag = tree.tag(place);
        state = match tag {
            // It keeps the activation of its classes with some engines only.
            "adhesion" if state.activations != Some(0) => State { activations: None, ..simple(0) },
            "motor" | "velocity" | "damper" | "adhesion" => simple(0),
            "intvelocity" | "cylinder" | "muscle" => simple(1),
            "position" => {
                let given = tree.attribute(place, "timeconst").map(|text| text.trim().parse::<f64>().ok());
                has_filter = given.map_or(has_filter, |time| time.map(|time| time != 0.0));
                // Without a time constant, engines between these keep other dynamics of its
                // classes.
                let replaces = cfg!(any(not(engine_since = "2.3.0"), engine_since = "3.17.0"));
                let is_known = replaces || given.is_some() || state.activations == has_filter.map(usize::from);
                State { activations: has_filter.filter(|_| is_known).map(usize::from), ..simple(0) }
            }
            "general" => {
                let activations = match tree.attribute(place, "dyntype") {
                    None => state.activations,
                    Some("none") => Some(0),
                    Some("integrator" | "filter" | "filterexact" | "muscle" | "user") => Some(1),
                    Some(_) => None,
                };
                let controls = match tree.attribute(place, "gaintype") {
                    None => state.controls,
                    Some("fixed" | "affine" | "muscle" | "user") => Some(1),
                    Some(_) => None,
                };
                State { activations, controls, dimension: tree.attribute(place, "actdim").or(state.dimension) }
            }
            _ => unknown,
        };
        let dynamics = tree.attribute(place, "dyntype").filter(|_| tag == "general");
        is_general &= tag == "general" && tree.attribute(place, "dynprm").is_none();
        has_filter = match (tag, dynamics) {
            ("position", _) | ("general", None) => has_filter,
            ("general", Some("filterexact")) => is_general.then_some(true),
            ("general", Some(_)) => Some(false),
            _ => has_filter.filter(|has| !has),
        };
    }
    let activations = match (state.activations, state.dimension.map(|text| text.trim().parse::<i64>())) {
        (activations, None | Some(Ok(..0))) => activations,
        (Some(_), Some(Ok(dimension))) => usize::try_from(dimension).ok().filter(|&width| width <= MOST_ACTIVATIONS),
        _ => None,
    };
    (activations, state.controls)
}

fn of_bodies(tree: &Tree, vector: &str) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut left = MOST;
    // Bodies, and elements that create bodies.
    let mut open: Vec<(Index, Vec<usize>)> = tree.sections("worldbody").map(|world| (world, Vec::new())).collect();
    open.reverse();
    while let Some((body, copies)) = open.pop() {
        let is_mocap = tree.attribute(body, "mocap") == Some("true");
        match (tree.tag(body), vector) {
            ("body", "mpos" | "mquat") if is_mocap => {
                let width = Some(if vector == "mpos" { 3 } else { 4 });
                entries.push(entry(tree, body, copies.clone(), width));
            }
            ("body" | "worldbody", _) => {}
            ("composite" | "flexcomp", "mpos" | "mquat") => continue,
            _ => {
                entries.push(entry(tree, body, copies, None));
                continue;
            }
        }
        let Some(elements) = elements(tree, body, &copies, &mut left) else {
            entries.push(entry(tree, body, copies, None));
            return entries;
        };
        let is_joint = |index| names::kind(tree, index) == Some(Kind::Joint);
        for (index, copies) in elements.iter().filter(|(index, _)| {
            !matches!(vector, "mpos" | "mquat")
                && tree.tag(body) == "body"
                && (is_joint(*index) || tree.tag(*index) == "composite")
        }) {
            let width = if is_joint(*index) { dimensions(tree, *index, vector) } else { None };
            entries.push(entry(tree, *index, copies.clone(), width));
        }
        let creates = |tag: &str| matches!(tag, "body" | "composite" | "flexcomp" | "attach");
        open.extend(elements.into_iter().rev().filter(|(index, _)| creates(tree.tag(*index))));
    }
    entries
}

/// Returns the elements of a body, those in frames and the copies that it contains, or `None` if
/// there are too many.
pub(super) fn elements(
    tree: &Tree,
    body: Index,
    copies: &[usize],
    left: &mut usize,
) -> Option<Vec<(Index, Vec<usize>)>> {
    let mut found = Vec::new();
    let mut open: Vec<(Index, Vec<usize>)> =
        tree.children(body).iter().rev().map(|&child| (child, copies.to_vec())).collect();
    while let Some((index, copies)) = open.pop() {
        *left = left.checked_sub(1)?;
        let children = tree.children(index).iter().rev();
        match tree.tag(index) {
            "frame" => open.extend(children.map(|&child| (child, copies.clone()))),
            "replicate" => {
                let count: usize = tree.attribute(index, "count")?.trim().parse().ok()?;
                *left = left.checked_sub(count.checked_mul(tree.children(index).len().max(1))?)?;
                for number in (0..count).rev() {
                    let copies = [&copies[..], &[number]].concat();
                    open.extend(tree.children(index).iter().rev().map(|&child| (child, copies.clone())));
                }
            }
            _ => found.push((index, copies)),
        }
    }
    Some(found)
}

/// Type of a joint.
pub(super) fn joint_type(tree: &Tree, joint: Index) -> &str {
    if tree.tag(joint) == "freejoint" { "free" } else { effective(tree, joint, "type").unwrap_or("hinge") }
}

fn dimensions(tree: &Tree, joint: Index, vector: &str) -> Option<usize> {
    let is_position = vector == "qpos";
    match joint_type(tree, joint) {
        "free" => Some(if is_position { 7 } else { 6 }),
        "ball" => Some(if is_position { 4 } else { 3 }),
        "hinge" | "slide" => Some(1),
        _ => None,
    }
}
