//! Other values in the attributes of a text.

use std::collections::BTreeMap;
use std::ops::Range;

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

/// Returns the places of the values of all attributes that are lists of numbers, with the names of
/// the attributes.
fn numeric_attributes(text: &str) -> Vec<(&str, Range<usize>)> {
    let mut found = Vec::new();
    let mut rest = 0;
    while let Some(equals) = text[rest..].find('=').map(|at| rest + at) {
        let name = text[rest..equals].rsplit([' ', '\n', '\t']).next().unwrap_or_default();
        let quote = text[equals + 1..].chars().next().unwrap_or_default();
        if quote != '\'' && quote != '"' {
            rest = equals + 1;
            continue;
        }
        let start = equals + 2;
        let Some(end) = text[start..].find(quote).map(|at| start + at) else { break };
        let value = &text[start..end];
        if !value.trim().is_empty() && value.split_whitespace().all(|number| number.parse::<f64>().is_ok()) {
            found.push((name, start..end));
        }
        rest = end + 1;
    }
    found
}

/// Returns another value for a number of an attribute.
fn other(name: &str, value: f64, random: &mut Xoshiro256PlusPlus) -> String {
    match name {
        "contype" | "conaffinity" | "priority" | "group" => random.random_range(0..4).to_string(),
        "condim" => [1, 3, 4, 6][random.random_range(0..4)].to_string(),
        _ => {
            let number = match random.random_range(0..5) {
                0 => 0.0,
                1 => -value,
                2 => value + random.random_range(-0.5..0.5),
                3 => value * random.random_range(0.1..4.0),
                _ => random.random_range(0.01..1.0),
            };
            format!("{number:.4}")
        }
    }
}

/// Changes one number of one attribute. Returns the changed attribute and the text.
pub(super) fn perturb(text: &str, random: &mut Xoshiro256PlusPlus) -> (String, String) {
    let attributes = numeric_attributes(text);
    let (name, place) = &attributes[random.random_range(0..attributes.len())];
    let mut values: Vec<String> = text[place.clone()].split_whitespace().map(str::to_owned).collect();
    let at = random.random_range(0..values.len());
    values[at] = other(name, values[at].parse().unwrap(), random);
    let mut changed = text.to_owned();
    changed.replace_range(place.clone(), &values.join(" "));
    (format!("{name}={}", values.join(" ")), changed)
}

/// Arrays that follow from others: `update_constants` computes them, or the test compares their
/// effects.
const FOLLOWING: [&str; 25] = [
    "body_simple",
    "dof_simplenum",
    "body_sameframe",
    "geom_sameframe",
    "site_sameframe",
    "body_subtreemass",
    "body_margin",
    "body_contype",
    "body_conaffinity",
    "geom_aabb",
    "bvh_aabb",
    "bvh_nodeid",
    "bvh_child",
    "bvh_depth",
    "body_bvhadr",
    "body_bvhnum",
    "nbvh",
    "nbvhstatic",
    "dof_length",
    "nbuffer",
    "flexedge_invweight0",
    "mesh_graphadr",
    "mesh_bvhadr",
    "stat.meanmass",
    "stat.meaninertia",
];

/// Returns the fields that differ and that an edit cannot set.
pub(super) fn structural(
    before: &BTreeMap<&'static str, Vec<f64>>,
    target: &BTreeMap<&'static str, Vec<f64>>,
    written: &[&'static str],
) -> Vec<&'static str> {
    let follows = |field| !written.is_empty() && (FOLLOWING.contains(&field) || super::DERIVED.contains(&field));
    let can_differ = |field| written.contains(&field) || follows(field);
    // The compiler of 3.5.0 computes NaN from a singular inertia matrix.
    let is_same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
    let are_same = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(*a, *b));
    let is_unchanged = |field: &str, values: &[f64]| target.get(field).is_some_and(|target| are_same(target, values));
    let differing = before.iter().filter(|(field, values)| !can_differ(**field) && !is_unchanged(field, values));
    differing.map(|(field, _)| *field).collect()
}
