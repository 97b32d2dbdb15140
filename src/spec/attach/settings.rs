//! Settings of `compiler` on which two specs must agree.

use super::super::tree::{Index, Tree};
use super::super::{names, paths, value};
use super::{BODY, classes};
use crate::error::{Error, Result};
use crate::kind::Kind;
use crate::spec::schema::Schema;

/// Settings that change the meaning of a model, with their defaults.
const SETTINGS: [(&str, &str); 10] = [
    ("coordinate", "local"),
    ("inertiafromgeom", "auto"),
    ("inertiagrouprange", "0 5"),
    ("boundmass", "0"),
    ("boundinertia", "0"),
    ("balanceinertia", "false"),
    ("exactmeshinertia", "false"),
    ("settotalmass", "-1"),
    ("fitaabb", "false"),
    ("alignfree", "false"),
];

/// Default of `autolimits`.
const AUTOLIMITS: &str = if cfg!(engine_since = "2.3.0") { "true" } else { "false" };

/// Adapts a spec to the settings of the one to which it is attached, or returns an error. A spec without bodies takes the settings of the
/// attached one that it does not have.
pub(super) fn agree(tree: &mut Tree, child: &mut Tree) -> Result<()> {
    if paths::setting(child, "coordinate") == Some("global") {
        return Err(Error::Unsupported("cannot attach a spec with global coordinates".to_owned()));
    }
    convert_limits(tree, child)?;
    let same_inertia = compute_inertia(child);
    let has_bodies = names::all(tree, BODY).any(|index| tree.tag(index) == "body");
    for (attribute, default) in SETTINGS {
        let ours = paths::setting(tree, attribute);
        let theirs = paths::setting(child, attribute).unwrap_or(default);
        let is_same = ours.unwrap_or(default).split_ascii_whitespace().eq(theirs.split_ascii_whitespace());
        if is_same || (same_inertia && attribute == "inertiafromgeom" && ours != Some("false")) {
            continue;
        }
        if ours.is_some() || has_bodies {
            let what = format!("'{attribute}' of <compiler> in the attached spec");
            return Err(Error::invalid(
                what,
                format!("'{theirs}'"),
                format!("'{}', as in this spec", ours.unwrap_or(default)),
            ));
        }
        let section = tree.section("compiler");
        tree.node_mut(section).set(attribute, theirs.to_owned());
    }
    Ok(())
}

/// Removes the inertias that the compiler replaces by those of the geoms. Returns `true` if all inertias are those of geoms.
fn compute_inertia(child: &mut Tree) -> bool {
    let inertias: Vec<Index> =
        child.descendants(Tree::ROOT).into_iter().filter(|&index| child.tag(index) == "inertial").collect();
    match paths::setting(child, "inertiafromgeom").unwrap_or("auto") {
        "true" => inertias.into_iter().for_each(|index| child.remove(index)),
        "auto" if inertias.is_empty() => {}
        _ => return false,
    }
    true
}

/// Makes the limits explicit that depend on `autolimits`, if the specs differ in this setting.
fn convert_limits(tree: &Tree, child: &mut Tree) -> Result<()> {
    let [ours, theirs] = [tree, child].map(|tree| paths::setting(tree, "autolimits").unwrap_or(AUTOLIMITS) == "true");
    if ours == theirs {
        return Ok(());
    }
    let schema = Schema::of_engine()?;
    let mut changes = Vec::new();
    for index in child.descendants(Tree::ROOT) {
        for &(limited, range) in limits(child, index) {
            let Some(text) = child.attribute(index, range) else { continue };
            let is_automatic = classes::effective(child, index, limited).is_none_or(|value| value == "auto");
            if is_automatic && schema.has(child, index, limited) {
                let is_range =
                    value::numbers(text).is_some_and(|numbers| numbers.len() == 2 && numbers[0] < numbers[1]);
                changes.push((index, limited, theirs && is_range));
            }
        }
    }
    for (index, limited, is_limited) in changes {
        child.node_mut(index).set(limited, is_limited.to_string());
    }
    Ok(())
}

/// Returns the attributes of an element, or of defaults, that say whether a range is a limit, and those of the ranges.
fn limits(tree: &Tree, index: Index) -> &'static [(&'static str, &'static str)] {
    const LENGTHS: &[(&str, &str)] = &[("limited", "range"), ("actuatorfrclimited", "actuatorfrcrange")];
    const SIGNALS: &[(&str, &str)] =
        &[("ctrllimited", "ctrlrange"), ("forcelimited", "forcerange"), ("actlimited", "actrange")];
    match (names::kind(tree, index), tree.tag(index)) {
        (Some(Kind::Joint | Kind::Tendon), _) | (None, "joint" | "tendon") => LENGTHS,
        (Some(Kind::Actuator), _) => SIGNALS,
        (None, tag) if classes::ACTUATORS.contains(&tag) => SIGNALS,
        _ => &[],
    }
}
