//! Inertias that the compiler computes, as explicit ones.

use std::collections::HashMap;

use super::super::Spec;
use super::super::attributes::Named;
use super::super::names;
use super::super::tree::{Index, Tree};
use super::super::value::{self, Value};
use super::inertia;
use crate::error::Result;
use crate::kind::Kind;

/// Sections of a spec that determine the inertias of its bodies.
const SECTIONS: [&str; 7] = ["compiler", "option", "size", "extension", "default", "asset", "worldbody"];

/// Settings for the model as a whole, which those of an attached spec are not.
const OF_MODEL: [&str; 3] = ["fusestatic", "discardvisual", "settotalmass"];

/// Gives all bodies of `child`, a copy of the elements of `spec`, the inertias that they have in
/// the compiled spec. Returns `false` if other elements create bodies.
///
/// # Errors
///
/// As for [`Spec::compile`].
pub(super) fn make_explicit(child: &mut Tree, spec: &Spec) -> Result<bool> {
    if inertia::creates_bodies(child) {
        return Ok(false);
    }
    let mut alone = spec.clone();
    for section in alone.tree.children(Tree::ROOT).to_vec() {
        if !SECTIONS.contains(&alone.tree.tag(section)) {
            alone.tree.remove(section);
        } else if alone.tree.tag(section) == "compiler" {
            for setting in OF_MODEL {
                alone.tree.node_mut(section).unset(setting);
            }
        }
    }
    let model = alone.compile()?;
    let known = (1..model.nbody()).filter_map(|body| Some((model.source_of(Kind::Body, body)?, body)));
    let known: HashMap<Index, usize> = known.collect();
    for index in bodies(child) {
        let Some(&body) = known.get(&index) else { return Ok(false) };
        let given: Vec<Index> = inertials(child, index).collect();
        let (mass, moments) = (model.body_mass()[body], model.body_inertia()[body]);
        // Geoms that are added later give such a body its mass.
        if given.is_empty() && mass == 0.0 && moments == [0.0; 3] && inertia::geoms(child, index).is_empty() {
            continue;
        }
        for inertial in given {
            child.remove(inertial);
        }
        let inertial = child.add(index, "inertial");
        let node = child.node_mut(inertial);
        node.set("pos", model.body_ipos()[body].text().into_owned());
        node.set("quat", model.body_iquat()[body].text().into_owned());
        node.set("mass", mass.text().into_owned());
        node.set("diaginertia", moments.text().into_owned());
    }
    Ok(true)
}

/// Returns `true` if a setting of another spec does not change the explicit inertias of `child`.
pub(super) fn is_respected(child: &Tree, setting: &str, value: &str) -> bool {
    let attribute = match setting {
        "boundmass" => "mass",
        "boundinertia" => "diaginertia",
        _ => return true,
    };
    let Ok(least) = value.trim().parse::<f64>() else { return false };
    bodies(child).into_iter().all(|body| {
        let numbers = inertials(child, body).filter_map(|inertial| child.attribute(inertial, attribute));
        let numbers: Vec<f64> = numbers.filter_map(value::numbers).flatten().collect();
        if numbers.is_empty() { least <= 0.0 } else { numbers.iter().all(|number| *number >= least) }
    })
}

fn bodies(tree: &Tree) -> Vec<Index> {
    names::all(tree, Named::Kind(Kind::Body)).filter(|&body| tree.tag(body) == "body").collect()
}

fn inertials(tree: &Tree, body: Index) -> impl Iterator<Item = Index> {
    tree.children(body).iter().copied().filter(|&child| tree.tag(child) == "inertial")
}
