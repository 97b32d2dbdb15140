//! Actuators that the compiler copies with the elements of a `replicate`.

use std::collections::{HashMap, HashSet};

use super::attributes::Named;
use super::names;
use super::tree::{Index, Tree};
use crate::kind::Kind;

/// Number of copies beyond which the order is not known.
const MOST: usize = 1_000_000;

/// Returns the actuators, and the elements that attach a model with actuators, in the order of the
/// compiled model, each with the number of its copy in each `replicate` from the outside. Returns
/// `None` if only the compiler knows the order.
///
/// The compiler reads the bodies last. An `attach` appends the actuators of its model. A
/// `replicate`, those in it first, appends copies of the actuators that refer to elements in it
/// only, and removes the actuators that refer to one.
pub(super) fn actuators(tree: &Tree) -> Option<Vec<(Index, Vec<usize>)>> {
    let sections = tree.sections("actuator");
    let mut order: Vec<(Index, Vec<usize>)> =
        sections.flat_map(|section| tree.children(section)).map(|&index| (index, Vec::new())).collect();
    let creators = creators(tree);
    if creators.iter().all(|&index| tree.tag(index) == "attach") {
        order.extend(creators.into_iter().map(|index| (index, Vec::new())));
        return Some(order);
    }
    // Compilers before compare keyframes with the model without copies.
    if cfg!(not(engine_since = "3.17.0")) {
        return None;
    }
    let elements = elements(tree);
    let mut left = MOST;
    for creator in creators {
        if tree.tag(creator) == "attach" {
            // Without a model it copies a part of this one.
            tree.attribute(creator, "model")?;
            order.push((creator, Vec::new()));
            continue;
        }
        let count: usize = tree.attribute(creator, "count")?.trim().parse().ok()?;
        let inside: HashSet<Index> = tree.descendants(creator).into_iter().collect();
        let creates = |index: &Index| matches!(tree.tag(*index), "attach" | "composite" | "flexcomp");
        let has_others = inside.iter().any(creates);
        let (mut kept, mut copied) = (Vec::new(), Vec::new());
        for (index, copies) in order {
            let Referring { total, inside, unknown } = referring(tree, index, &elements, &inside);
            match (total, inside) {
                // Elements that do not exist in the text are created by others.
                _ if unknown > 0 && has_others => return None,
                (_, 0) => kept.push((index, copies)),
                (total, inside) if total == inside => copied.push((index, copies)),
                _ => {}
            }
        }
        left = left.checked_sub(count.checked_mul(copied.len().max(1))?)?;
        for number in 0..count {
            kept.extend(copied.iter().map(|(index, copies)| (*index, [&[number], &copies[..]].concat())));
        }
        order = kept;
    }
    Some(order)
}

/// Returns the elements that copy or attach others, in the order in which the compiler handles
/// them.
fn creators(tree: &Tree) -> Vec<Index> {
    let mut found = Vec::new();
    let mut open: Vec<Index> = tree.sections("worldbody").collect();
    // In reverse, the elements in an element come first.
    while let Some(index) = open.pop() {
        if matches!(tree.tag(index), "replicate" | "attach") {
            found.push(index);
        }
        open.extend(tree.children(index));
    }
    found.reverse();
    found
}

/// Returns the elements with names to which actuators and tendons can refer.
fn elements(tree: &Tree) -> HashMap<(Named, &str), Index> {
    let all = tree.descendants(Tree::ROOT).into_iter().rev();
    all.filter_map(|index| Some(((names::named(tree, index)?, names::name(tree, index)?), index))).collect()
}

/// Numbers of references of an actuator or a tendon.
#[derive(Default)]
struct Referring {
    total: usize,
    /// Those to elements in a `replicate`.
    inside: usize,
    /// Those to elements that do not exist in the text, also by a tendon.
    unknown: usize,
}

/// Counts the references of an element. A tendon is inside if one part of its path is: the
/// compiler copies it with the others.
fn referring(
    tree: &Tree,
    index: Index,
    elements: &HashMap<(Named, &str), Index>,
    inside: &HashSet<Index>,
) -> Referring {
    if tree.tag(index) == "attach" {
        return Referring { total: 1, inside: usize::from(inside.contains(&index)), unknown: 0 };
    }
    let mut found = Referring::default();
    for reference in names::references(tree, index) {
        if matches!(reference.class, Named::Class | Named::Instance) {
            continue;
        }
        found.total += 1;
        let name = tree.attribute(index, reference.attribute).unwrap_or_default();
        match (reference.class, elements.get(&(reference.class, name))) {
            (_, None) => found.unknown += 1,
            (Named::Kind(Kind::Tendon), Some(&tendon)) => {
                let parts = tree.children(tendon).iter().map(|&part| referring(tree, part, elements, inside));
                let parts: Vec<Referring> = parts.collect();
                found.inside += usize::from(parts.iter().any(|part| part.inside > 0));
                found.unknown += parts.iter().map(|part| part.unknown).sum::<usize>();
            }
            (_, Some(target)) => found.inside += usize::from(inside.contains(target)),
        }
    }
    found
}
