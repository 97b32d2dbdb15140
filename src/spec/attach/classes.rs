//! Classes of defaults of two specs that become one.

use std::collections::HashSet;

use super::super::attributes::Named;
use super::super::names::{self, MAIN};
use super::super::tree::{Index, Tree};
use super::has_class;
use crate::error::{Error, Result};
use crate::kind::Kind;

/// Tags of actuators. In a class they share the defaults of one actuator.
pub(super) const ACTUATORS: [&str; 13] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "plugin",
    "pid",
    "orientation",
    "dcmotor",
];

/// Returns an attribute of an element, or of its class of defaults if the element does not have it.
pub(in super::super) fn effective<'t>(tree: &'t Tree, index: Index, attribute: &str) -> Option<&'t str> {
    tree.attribute(index, attribute).or_else(|| of_class(tree, index, attribute))
}

/// Returns the value that an attribute has by the class of defaults of an element.
pub(super) fn of_class<'t>(tree: &'t Tree, index: Index, attribute: &str) -> Option<&'t str> {
    tree.attribute(default(tree, index, attribute)?, attribute)
}

/// Returns the defaults from which an element has an attribute that is not its own.
pub(super) fn default(tree: &Tree, index: Index, attribute: &str) -> Option<Index> {
    let tag = tree.tag(index);
    let own = tree.attribute(index, "class").or_else(|| {
        // Defaults inherit the defaults of the classes around their class.
        let class = tree.parent(index).filter(|&parent| tree.tag(parent) == "default");
        class.and_then(|class| names::name(tree, class))
    });
    let inherited = || ancestors(tree, index).find_map(|outer| tree.attribute(outer, "childclass"));
    let class = own.or_else(inherited).unwrap_or(MAIN);
    let is_default = |child: &str| match names::kind(tree, index) {
        Some(Kind::Actuator) => ACTUATORS.contains(&child),
        Some(Kind::Tendon) => child == "tendon",
        Some(Kind::Equality) => child == "equality",
        _ => child == tag,
    };
    let in_class = |class: Index| {
        let mut settings = tree.children(class).iter().rev().filter(|&&child| is_default(tree.tag(child)));
        settings.find(|&&child| child != index && tree.attribute(child, attribute).is_some()).copied()
    };
    around(tree, class).into_iter().find_map(in_class)
}

/// Returns a class of defaults, the classes around it, and the sections of `main` that act on it,
/// from the inside.
fn around(tree: &Tree, class: &str) -> Vec<Index> {
    let mut sections: Vec<Index> = tree.sections("default").collect();
    let mut classes = Vec::new();
    if let Some(class) = names::find(tree, Named::Class, class).filter(|class| !sections.contains(class)) {
        classes.push(class);
        classes.extend(ancestors(tree, class));
        let section = classes.pop();
        // A class has no defaults of later sections.
        sections.truncate(1 + sections.iter().position(|&found| Some(found) == section).unwrap_or_default());
    }
    classes.extend(sections.into_iter().rev());
    classes
}

/// Returns the defaults of an actuator in its class and in those around it, from the outside.
pub(in super::super) fn defaults_of(tree: &Tree, actuator: Index) -> Vec<Index> {
    let classes = around(tree, tree.attribute(actuator, "class").unwrap_or(MAIN));
    let children = classes.into_iter().rev().flat_map(|class| tree.children(class)).copied();
    children.filter(|&child| ACTUATORS.contains(&tree.tag(child))).collect()
}

/// Returns the elements that have an attribute from the defaults in a class.
pub(in super::super) fn heirs(tree: &Tree, defaults: Index, attribute: &str) -> Vec<Index> {
    let is_heir = |&index: &Index| {
        let is_element = tree.parent(index).is_some_and(|parent| tree.tag(parent) != "default");
        is_element && tree.attribute(index, attribute).is_none() && default(tree, index, attribute) == Some(defaults)
    };
    tree.descendants(Tree::ROOT).into_iter().filter(is_heir).collect()
}

/// Returns the elements that contain an element, from the inside.
fn ancestors(tree: &Tree, index: Index) -> impl Iterator<Item = Index> {
    std::iter::successors(tree.parent(index), |&outer| tree.parent(outer)).filter(|&outer| outer != Tree::ROOT)
}

/// Gives a tree and one that becomes a part of it separate classes, so that no element gets
/// defaults of the other one. `body` is the body that will contain the child, and `prefix` the
/// prefix of the child's names. Returns the new class of the tree's own elements, if `main` had
/// defaults.
pub(super) fn separate(tree: &mut Tree, child: &mut Tree, body: Index, prefix: &str) -> Result<Option<Index>> {
    let of_body =
        std::iter::once(body).chain(ancestors(tree, body)).any(|outer| tree.attribute(outer, "childclass").is_some());
    let ours = has_settings(tree);
    if !(ours || of_body || has_classes(child)) {
        return Ok(None);
    }
    let name = unused(&[tree, child], "outer");
    let own = if ours { Some(demote(tree, &name, true, false, &HashSet::new())?) } else { None };
    let name = if prefix.is_empty() { unused(&[tree, child], "attached") } else { MAIN.to_owned() };
    demote(child, &name, ours || of_body || has_settings(child), of_body, &HashSet::new())?;
    Ok(own)
}

/// Gives the elements of a tree a class without the attached ones, which `main` contains too.
/// Returns the class.
pub(in super::super) fn separate_own(tree: &mut Tree, attached: &HashSet<Index>) -> Result<Index> {
    let name = unused(&[tree], "outer");
    demote(tree, &name, true, false, attached)
}

/// Returns `true` if a tree has classes, or refers to `main`, which always exists.
fn has_classes(tree: &Tree) -> bool {
    let refers = |index| ["class", "childclass"].iter().any(|name| tree.attribute(index, name).is_some());
    tree.sections("default").next().is_some() || tree.descendants(Tree::ROOT).into_iter().any(refers)
}

/// Returns the name of a class that does not exist in these trees, which starts with `name`.
fn unused(trees: &[&Tree], name: &str) -> String {
    let mut name = name.to_owned();
    while trees.iter().any(|tree| names::find(tree, Named::Class, &name).is_some()) {
        name.push('_');
    }
    name
}

/// Returns `true` if the class `main` has defaults.
fn has_settings(tree: &Tree) -> bool {
    tree.sections("default").any(|section| tree.children(section).iter().any(|&child| tree.tag(child) != "default"))
}

/// Moves all classes into a new one with this name, which is directly in `main`, and gives it to
/// all elements without a class, except `others`. Returns the class. `matters` is true if one of
/// the specs has defaults, and `of_body` if the elements come into a body with a class.
fn demote(tree: &mut Tree, name: &str, matters: bool, of_body: bool, others: &HashSet<Index>) -> Result<Index> {
    let of = |tree: &Tree, index| -> Vec<Index> {
        tree.children(index).iter().copied().filter(|child| !others.contains(child)).collect()
    };
    let sections: Vec<Index> = tree.sections("default").collect();
    let old = sections.iter().find_map(|&section| tree.attribute(section, "class")).unwrap_or(MAIN).to_owned();
    names::rename_references(tree, Named::Class, &old, name);
    // The only defaults that a flexcomp has from its class.
    let has_joints = sections.iter().any(|&section| of(tree, section).iter().any(|&child| tree.tag(child) == "joint"));
    let mut contents: Vec<Vec<Index>> = sections.iter().map(|&section| of(tree, section)).collect();
    let last = contents.pop().unwrap_or_default();
    let mut place = tree.section("default");
    for content in contents.into_iter().map(Some).chain([None]) {
        // Classes in a section have the defaults of this and of earlier sections, but not of later
        // ones.
        let class_name = if content.is_some() { unused(&[tree], &format!("{name}_")) } else { name.to_owned() };
        let class = tree.add(place, "default");
        tree.node_mut(class).set("class", class_name);
        for child in content.unwrap_or_else(|| last.clone()) {
            tree.relocate(child, class);
        }
        place = class;
    }
    for section in sections {
        tree.node_mut(section).unset("class");
    }

    let mut elements: Vec<Index> = Vec::new();
    for section in tree.children(Tree::ROOT).to_vec() {
        let children = of(tree, section);
        match tree.tag(section) {
            "worldbody" | "asset" | "contact" | "equality" | "tendon" | "actuator" | "sensor" => {
                elements.extend(children);
            }
            _ => {}
        }
    }
    let flex = elements.iter().find_map(|&element| flexcomp_in(tree, element));
    if let Some(flex) = flex.filter(|_| has_joints || of_body) {
        return Err(inseparable(&names::describe(tree, flex)));
    }
    while let Some(index) = elements.pop() {
        match tree.tag(index) {
            "body" | "frame" => set_if_missing(tree, index, "childclass", name),
            "replicate" => elements.extend(tree.children(index)),
            "composite" if matters => return Err(inseparable(&names::describe(tree, index))),
            "flexcomp" => {}
            _ if has_class(tree, index)? => set_if_missing(tree, index, "class", name),
            _ => {}
        }
    }
    Ok(place)
}

/// Returns a `flexcomp` that has the defaults of joints from the body around an element.
pub(in super::super) fn flexcomp_in(tree: &Tree, index: Index) -> Option<Index> {
    let mut open = vec![index];
    while let Some(index) = open.pop() {
        match tree.tag(index) {
            "flexcomp" => return Some(index),
            "frame" | "replicate" => open.extend(tree.children(index)),
            _ => {}
        }
    }
    None
}

/// Returns the error for an element in the world that has defaults and no attribute for a class.
pub(in super::super) fn inseparable(element: &str) -> Error {
    Error::Unsupported(format!("cannot separate the defaults of {element} in the world; put it into a body"))
}

fn set_if_missing(tree: &mut Tree, index: Index, attribute: &str, value: &str) {
    // The world of newer engines can have a class for its elements.
    let of_world = tree.parent(index).and_then(|parent| tree.attribute(parent, "childclass")).map(str::to_owned);
    if tree.attribute(index, attribute).is_none() {
        tree.node_mut(index).set(attribute, of_world.unwrap_or_else(|| value.to_owned()));
    }
}
