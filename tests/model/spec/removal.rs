//! Removal of elements, compared with `mjSpec` where the engine has it (since 3.2), and with a text
//! from which an independent program has removed the element and everything that the compiler then
//! rejects.

use std::collections::BTreeSet;

use mujoco_safe::kind::Keyframe;
use mujoco_safe::spec::{Any, ElementId, Spec};
#[cfg(engine_since = "3.2.0")]
use mujoco_safe::sys;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::schema_models::Node;
use super::counts::Counts;
use super::elements;
#[cfg(engine_since = "3.2.0")]
use super::engine_spec as raw;
use super::engine_spec::{RawModel, Source};
#[cfg(engine_since = "3.2.0")]
use super::operations::writes_beyond_an_array;
use super::operations::{CORRECTED, KEYS};

/// Removes random elements from a model.
pub(super) fn check(source: &Source, spec: &Spec, rng: &mut Xoshiro256PlusPlus, counts: &mut Counts) {
    let name = source.name();
    let mut spec = spec.clone();
    for key in spec.ids::<Keyframe>() {
        spec.remove(key).unwrap();
    }
    let text = spec.to_xml();
    let named: Vec<(ElementId<Any>, &str, &str)> = elements(&spec)
        .into_iter()
        .filter_map(|id| {
            let element = spec.element(id);
            let is_part = element.parent().is_some_and(|parent| PARTS.contains(&spec.element(parent).tag()));
            let is_removable = is_part || TAGS.contains(&element.tag());
            element.attribute("name").filter(|_| is_removable).map(|name| (id, element.tag(), name))
        })
        .collect();
    for _ in 0..named.len().min(6) {
        let (id, tag, element) = named[rng.random_range(0..named.len())];
        let mut ours = spec.clone();
        let removed = ours.remove_with_references(id).and_then(|()| ours.compile());
        let Some(expected) =
            by_the_engine(source, &spec, id, element, counts).or_else(|| by_trials(source, &text, tag, element))
        else {
            counts.operations += 1;
            if removed.is_ok() {
                *counts.only_ours.entry(format!("removal of <{tag}>")).or_default() += 1;
            }
            continue;
        };
        let what = format!("remove {tag} '{element}' {name}");
        counts.compare(&what, removed, &expected, 1e-12, &[&KEYS[..], &CORRECTED].concat());
    }
}

/// Elements that are removed, beside those of [`PARTS`].
const TAGS: [&str; 10] = ["body", "joint", "freejoint", "geom", "site", "camera", "light", "mesh", "hfield", "skin"];

/// Sections whose elements refer to others, in an order in which each refers to earlier ones.
const PARTS: [&str; 6] = ["tendon", "equality", "contact", "actuator", "sensor", "custom"];

#[cfg(not(engine_since = "3.2.0"))]
fn by_the_engine(_: &Source, _: &Spec, _: ElementId<Any>, _: &str, _: &mut Counts) -> Option<RawModel> {
    None
}

/// Removes an element with `mjs_delete`. Returns `None` if the compiler rejects the rest, which may
/// refer to the element.
#[cfg(engine_since = "3.2.0")]
fn by_the_engine(
    source: &Source,
    spec: &Spec,
    id: ElementId<Any>,
    name: &str,
    counts: &mut Counts,
) -> Option<RawModel> {
    let element = spec.element(id);
    let section = element.parent().map(|parent| spec.element(parent).tag());
    let kind = match (section, element.tag()) {
        (_, "body") => sys::mjOBJ_BODY,
        (Some("tendon"), _) => sys::mjOBJ_TENDON,
        (Some("equality"), _) => sys::mjOBJ_EQUALITY,
        (Some("actuator"), _) => sys::mjOBJ_ACTUATOR,
        (Some("sensor"), _) => sys::mjOBJ_SENSOR,
        (_, "joint" | "freejoint") => sys::mjOBJ_JOINT,
        (_, "geom") => sys::mjOBJ_GEOM,
        (_, "site") => sys::mjOBJ_SITE,
        (_, "camera") => sys::mjOBJ_CAMERA,
        (_, "light") => sys::mjOBJ_LIGHT,
        _ => return None,
    };
    if writes_beyond_an_array(spec) {
        return None;
    }
    let raw = raw::RawSpec::parse(source)?.without_keyframes();
    let removed = raw.remove(kind, name).then(|| raw.compile()).flatten();
    if removed.is_none() {
        *counts.dangling.entry(raw.error().split('\'').next().unwrap_or_default().to_owned()).or_default() += 1;
    }
    removed
}

/// Removes an element from a text, and then all elements of [`PARTS`] that the compiler rejects.
/// Returns `None` if it rejects another element.
fn by_trials(source: &Source, text: &str, tag: &str, name: &str) -> Option<RawModel> {
    // Each part needs a compilation.
    const MOST_PARTS: usize = 60;
    let mut whole = Node::parse(text);
    whole
        .children
        .iter_mut()
        .filter(|section| section.name != "default")
        .for_each(|section| remove(section, tag, name));
    let mut parts: Vec<(usize, usize, usize)> = Vec::new();
    for (number, section) in whole.children.iter().enumerate() {
        if let Some(rank) = PARTS.iter().position(|part| *part == section.name) {
            parts.extend((0..section.children.len()).map(|part| (rank, number, part)));
        }
    }
    parts.sort_unstable();
    if parts.len() > MOST_PARTS {
        return None;
    }
    let mut rejected: BTreeSet<(usize, usize)> = parts.iter().map(|&(_, section, part)| (section, part)).collect();
    let compiled = |rejected: &BTreeSet<(usize, usize)>| {
        let mut document = whole.clone();
        for &(section, part) in rejected.iter().rev() {
            document.children[section].children.remove(part);
        }
        source.compile_other(&document.text())
    };
    let mut found = compiled(&rejected)?;
    for (_, section, part) in parts {
        rejected.remove(&(section, part));
        match compiled(&rejected) {
            Some(model) => found = model,
            None => _ = rejected.insert((section, part)),
        }
    }
    Some(found)
}

/// Removes the elements with a tag and a name in another one.
fn remove(node: &mut Node, tag: &str, name: &str) {
    node.children.retain(|child| !(child.name == tag && child.get("name") == Some(name)));
    node.children.iter_mut().for_each(|child| remove(child, tag, name));
}
