//! Classes of defaults of two specs that become one.

use super::super::names::{self, MAIN, Named};
use super::super::tree::{Index, Tree};
use super::has_class;
use crate::error::{Error, Result};
use crate::kind::Kind;

/// Tags of actuators. In a class their defaults are those of one actuator.
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

/// Returns an attribute of an element, or that of its class of defaults.
pub(super) fn effective<'t>(tree: &'t Tree, index: Index, attribute: &str) -> Option<&'t str> {
    if let Some(value) = tree.attribute(index, attribute) {
        return Some(value);
    }
    let tag = tree.tag(index);
    let own = tree.attribute(index, "class").or_else(|| {
        // Defaults have those of the classes around theirs.
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
        settings.find_map(|&child| tree.attribute(child, attribute))
    };
    if let Some(class) = names::find(tree, Named::Class, class) {
        let outer = std::iter::once(class).chain(ancestors(tree, class));
        if let Some(value) = outer.take_while(|&class| tree.parent(class) != Some(Tree::ROOT)).find_map(in_class) {
            return Some(value);
        }
    }
    tree.sections("default").rev().find_map(in_class)
}

/// Returns the elements that contain an element, from the inside.
fn ancestors(tree: &Tree, index: Index) -> impl Iterator<Item = Index> {
    std::iter::successors(tree.parent(index), |&outer| tree.parent(outer)).filter(|&outer| outer != Tree::ROOT)
}

/// Gives a tree and one that becomes a part of it separate classes, so that no element gets defaults of the other one. `body` is the body
/// that will contain the child, and `prefix` that of the child's names. Returns the new class of the tree's own elements, if `main` had defaults.
pub(super) fn separate(tree: &mut Tree, child: &mut Tree, body: Index, prefix: &str) -> Result<Option<String>> {
    let of_body =
        std::iter::once(body).chain(ancestors(tree, body)).any(|outer| tree.attribute(outer, "childclass").is_some());
    let ours = has_settings(tree);
    if !(ours || of_body || child.sections("default").next().is_some()) {
        return Ok(None);
    }
    let own = ours.then(|| unused(tree, "outer"));
    if let Some(name) = &own {
        demote(tree, name, true)?;
    }
    let name = if prefix.is_empty() { unused(tree, "attached") } else { MAIN.to_owned() };
    demote(child, &name, ours || of_body || has_settings(child))?;
    Ok(own)
}

/// Returns the name of a class that does not exist, which starts with `name`.
fn unused(tree: &Tree, name: &str) -> String {
    let mut name = name.to_owned();
    while names::find(tree, Named::Class, &name).is_some() {
        name.push('_');
    }
    name
}

/// Returns `true` if the class `main` has defaults.
fn has_settings(tree: &Tree) -> bool {
    tree.sections("default").any(|section| tree.children(section).iter().any(|&child| tree.tag(child) != "default"))
}

/// Moves all classes into a new one with this name, which is directly in `main`, and gives it to all elements without a class.
fn demote(tree: &mut Tree, name: &str, matters: bool) -> Result<()> {
    let sections: Vec<Index> = tree.sections("default").collect();
    let old = sections.iter().find_map(|&section| tree.attribute(section, "class")).unwrap_or(MAIN).to_owned();
    names::rename_references(tree, Named::Class, &old, name);
    let root = tree.section("default");
    let class = tree.add(root, "default");
    for section in sections {
        for child in tree.children(section).to_vec() {
            if child != class {
                tree.relocate(child, class);
            }
        }
        tree.node_mut(section).unset("class");
    }
    tree.node_mut(class).set("class", name.to_owned());

    let mut elements: Vec<Index> = Vec::new();
    for section in tree.children(Tree::ROOT).to_vec() {
        let children = tree.children(section);
        match tree.tag(section) {
            "worldbody" | "asset" | "contact" | "equality" | "tendon" | "actuator" | "sensor" => {
                elements.extend(children);
            }
            _ => {}
        }
    }
    while let Some(index) = elements.pop() {
        match tree.tag(index) {
            "body" | "frame" => set_if_missing(tree, index, "childclass", name),
            "replicate" => elements.extend(tree.children(index)),
            "composite" | "flexcomp" if matters => {
                let element = names::describe(tree, index);
                return Err(Error::Unsupported(format!(
                    "cannot separate the defaults of {element} in the world; put it into a body"
                )));
            }
            _ if has_class(tree, index)? => set_if_missing(tree, index, "class", name),
            _ => {}
        }
    }
    Ok(())
}

fn set_if_missing(tree: &mut Tree, index: Index, attribute: &str, value: &str) {
    // The world of newer engines can have a class for its elements.
    let of_world = tree.parent(index).and_then(|parent| tree.attribute(parent, "childclass")).map(str::to_owned);
    if tree.attribute(index, attribute).is_none() {
        tree.node_mut(index).set(attribute, of_world.unwrap_or_else(|| value.to_owned()));
    }
}
