//! Keyframes, whose values belong to elements.
//!
//! A key has one vector of numbers for all joints, actuators or mocap bodies. Each vector keeps the
//! elements to which its numbers belonged when it was set, and becomes the vector of the present
//! elements when the text is written.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use super::attach::Defaults;
use super::layout::{self, VECTORS};
use super::names;
use super::tree::{Entry, Index, Tree};
use super::value::{self, Value};
use crate::error::{Error, InvalidKind, Result};

/// Remembers the elements to which the numbers of a vector belong, if the attribute is one.
pub(super) fn remember(tree: &mut Tree, index: Index, attribute: &str) {
    if is_key(tree, index) && VECTORS.contains(&attribute) {
        let entries = Arc::new(layout::of(tree, attribute));
        tree.node_mut(index).owners.push((attribute.to_owned(), entries));
    }
}

/// Remembers the elements to which the numbers of all keyframes belong.
pub(super) fn remember_all(tree: &mut Tree) {
    for attribute in VECTORS {
        let keys: Vec<Index> = keys(tree).filter(|&key| tree.attribute(key, attribute).is_some()).collect();
        if keys.is_empty() {
            continue;
        }
        let entries = Arc::new(layout::of(tree, attribute));
        for key in keys {
            tree.node_mut(key).owners.push((attribute.to_owned(), entries.clone()));
        }
    }
}

/// Gives the vectors of a keyframe that was copied from another tree the copies of their elements.
pub(super) fn map_owners(tree: &mut Tree, key: Index, copies: &HashMap<Index, Index>) {
    /// Element that does not exist any more.
    const REMOVED: Index = Index::MAX;
    for (_, entries) in &mut tree.node_mut(key).owners {
        let mapped = entries.iter().cloned().map(|entry| {
            let index = copies.get(&entry.index).copied().unwrap_or(REMOVED);
            Entry { index, ..entry }
        });
        *entries = Arc::new(mapped.collect());
    }
}

/// Returns the tree with the values of keyframes in the order of the present elements. If some
/// cannot be placed, returns the first error too, and the tree has a text in their place that the
/// compiler rejects.
pub(super) fn joined(tree: Cow<'_, Tree>) -> (Cow<'_, Tree>, Result<()>) {
    let keys: Vec<Index> = keys(&tree).filter(|&key| !tree.node(key).owners.is_empty()).collect();
    let mut changes = Vec::new();
    let mut result = Ok(());
    let mut present: HashMap<&str, Vec<Entry>> = HashMap::new();
    for key in keys {
        for attribute in VECTORS {
            let Some(owners) = owners(&tree, key, attribute) else { continue };
            let entries = present.entry(attribute).or_insert_with(|| layout::of(&tree, attribute));
            match join(&tree, key, attribute, owners, entries) {
                Ok(None) => {}
                Ok(Some(numbers)) => changes.push((key, attribute, (&numbers[..]).text().into_owned())),
                Err(error) => {
                    changes.push((key, attribute, format!("unknown: {error}")));
                    result = result.and(Err(error));
                }
            }
        }
    }
    if changes.is_empty() {
        return (tree, result);
    }
    let mut tree = tree.into_owned();
    for (key, attribute, text) in changes {
        if text.is_empty() {
            tree.node_mut(key).unset(attribute);
        } else {
            tree.node_mut(key).set(attribute, text);
        }
    }
    (Cow::Owned(tree), result)
}

/// Returns `true` for a vector of a keyframe whose values follow their elements.
pub(super) fn has_owners(tree: &Tree, index: Index, attribute: &str) -> bool {
    owners(tree, index, attribute).is_some()
}

/// Returns the values of a vector of a keyframe in the order of the present elements, or `None` if
/// the text has this order. Positions of joints in the tree are resolved.
pub(super) fn values(tree: &Tree, index: Index, attribute: &str) -> Result<Option<Vec<f64>>> {
    match owners(tree, index, attribute) {
        Some(owners) => join(tree, index, attribute, owners, &layout::of(tree, attribute)),
        None => Ok(None),
    }
}

fn keys(tree: &Tree) -> impl Iterator<Item = Index> {
    tree.sections("keyframe").flat_map(|section| tree.children(section)).copied().filter(|&key| tree.tag(key) == "key")
}

fn is_key(tree: &Tree, index: Index) -> bool {
    tree.tag(index) == "key" && tree.parent(index).is_some_and(|parent| tree.tag(parent) == "keyframe")
}

fn owners<'t>(tree: &'t Tree, key: Index, attribute: &str) -> Option<&'t [Entry]> {
    let owners = &tree.node(key).owners;
    owners.iter().find(|(found, _)| found == attribute).map(|(_, entries)| &entries[..])
}

/// Returns the numbers of a vector for the present elements, or `None` if the text has them, or is
/// not a list of numbers.
fn join(tree: &Tree, key: Index, attribute: &str, owners: &[Entry], present: &[Entry]) -> Result<Option<Vec<f64>>> {
    let text = tree.attribute(key, attribute).unwrap_or_default();
    let Some(numbers) = value::numbers(text).filter(|_| owners != present) else { return Ok(None) };
    let invalid = |found: String, expected: &str| {
        let what = format!("attribute '{attribute}' of {}", names::describe(tree, key));
        Err(Error::invalid(InvalidKind::Unsuitable, what, found, expected))
    };
    // The compiler pads a shorter vector at its end.
    let (known, unknown) =
        owners.split_at(owners.iter().position(|entry| entry.width.is_none()).unwrap_or(owners.len()));
    let mut start = 0;
    let mut values = HashMap::new();
    for entry in known {
        let width = entry.width.unwrap_or_default();
        let [from, to] = [start, start + width].map(|end| end.min(numbers.len()));
        values.insert((entry.index, &entry.copies[..]), (width, &numbers[from..to]));
        start += width;
    }
    // The values that belong to these together.
    let rest = &numbers[start.min(numbers.len())..];
    if unknown.is_empty() && !rest.is_empty() {
        let found = format!("{} values, set when the spec had {start}", numbers.len());
        return invalid(found, "values that are set after the elements to which they belong");
    }

    let value = |entry: &Entry| {
        let found = values.get(&(entry.index, &entry.copies[..]));
        found.filter(|(width, _)| Some(*width) == entry.width).map(|(_, numbers)| *numbers)
    };
    let defaults = Defaults::new(tree);
    let mut joined = Vec::new();
    let mut at = 0;
    let mut is_rest_placed = rest.is_empty() || !unknown.iter().any(|entry| present.contains(entry));
    let stop = loop {
        let Some(entry) = present.get(at) else { break None };
        if !rest.is_empty() && present[at..].starts_with(unknown) {
            joined.extend_from_slice(rest);
            is_rest_placed = true;
            at += unknown.len();
            // The number of values in the rest is not known.
            break unknown.first();
        }
        if entry.width.is_none() {
            break Some(entry);
        }
        let given = value(entry).unwrap_or_default();
        joined.extend_from_slice(given);
        if entry.width != Some(given.len()) {
            let Some(default) = defaults.of(attribute, entry) else { break Some(entry) };
            joined.extend_from_slice(&default[given.len()..]);
        }
        at += 1;
    };
    // The compiler adds the default values of the other elements. Compilers before 3.16 add wrong
    // ones of some joints.
    let is_wrong = |entry: &Entry| match tree.tag(entry.index) {
        "joint" | "freejoint" => {
            defaults.of(attribute, entry).is_none_or(|values| values.iter().any(|&value| value != 0.0))
        }
        "flexcomp" => false,
        _ => true,
    };
    if attribute == "qpos" && !cfg!(engine_since = "3.17.0") {
        is_rest_placed &= !present[at..].iter().any(is_wrong);
    }
    let is_lost = present[at..].iter().any(|entry| value(entry).is_some_and(|given| !given.is_empty()));
    if is_lost || !is_rest_placed {
        let element = stop.or(unknown.first()).filter(|entry| tree.contains(entry.index));
        let element = element.map_or("a removed element".to_owned(), |entry| names::describe(tree, entry.index));
        let found =
            format!("values that cannot be placed: the number or the defaults of those of {element} are not known");
        return invalid(found, "values that are set after all changes of the elements");
    }
    Ok(Some(joined))
}
