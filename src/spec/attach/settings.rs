//! Settings of `compiler` on which two specs must agree.

use super::super::attributes::{self, Meaning, Named};
use super::super::tree::{Index, Tree};
use super::super::value;
use super::super::{Spec, names, paths};
use super::{BODY, classes, computed, inertia};
use crate::error::{Error, InvalidKind, Result};
use crate::kind::Kind;
use crate::spec::schema::Schema;

/// Settings that change the meaning of a model, with their defaults.
const SETTINGS: [(&str, &str); 11] = [
    ("coordinate", "local"),
    ("convexhull", "true"),
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

/// Those that act on inertias only.
const OF_INERTIAS: [&str; 5] = ["inertiafromgeom", "inertiagrouprange", "boundmass", "boundinertia", "balanceinertia"];

/// Those that act on the geoms of the world too, by the meshes.
const OF_MESHES: [&str; 3] = ["convexhull", "exactmeshinertia", "fitaabb"];

/// Default of `autolimits`.
const AUTOLIMITS: &str = if cfg!(engine_since = "2.3.0") { "true" } else { "false" };

/// Adapts `child`, a copy of the elements of `other`, to the settings of the spec to which it is
/// attached, or returns an error. A spec without bodies, or without meshes, takes those settings of
/// the attached one that it does not have.
pub(super) fn agree(tree: &mut Tree, child: &mut Tree, other: &Spec) -> Result<()> {
    if paths::setting(child, "coordinate") == Some("global") {
        return Err(Error::Unsupported("cannot attach a spec with global coordinates".to_owned()));
    }
    convert_limits(tree, child)?;
    let same_inertia = compute_inertia(child);
    let has_bodies = names::all(tree, BODY).any(|index| tree.tag(index) == "body");
    let has_meshes = names::all(tree, Named::Kind(Kind::Mesh)).next().is_some();
    let undecided = child.sections("compiler").flat_map(|section| attributes::unknown(child, section));
    let undecided: Vec<String> = undecided.map(str::to_owned).collect();
    // The default of a setting of a newer engine is not known.
    let undecided = undecided.iter().map(|attribute| (&attribute[..], None));
    // Result of the only attempt.
    let mut explicit = None;
    for (attribute, default) in
        SETTINGS.map(|(attribute, default)| (attribute, Some(default))).into_iter().chain(undecided)
    {
        let ours = paths::setting(tree, attribute);
        let Some(theirs) = paths::setting(child, attribute).or(default) else { continue };
        let is_same =
            ours.or(default).is_some_and(|ours| ours.split_ascii_whitespace().eq(theirs.split_ascii_whitespace()));
        if is_same || (same_inertia && attribute == "inertiafromgeom" && ours != Some("false")) {
            continue;
        }
        let is_of_meshes = OF_MESHES.contains(&attribute);
        if ours.is_some() || (has_bodies && !is_of_meshes) || (has_meshes && is_of_meshes) {
            let theirs = theirs.to_owned();
            let ours = ours.or(default);
            if ours.is_some_and(|ours| inertia::adapt(child, attribute, &theirs, ours)) {
                continue;
            }
            let expected = match (attribute, ours) {
                ("settotalmass", _) => {
                    "absent: it scales a whole model, and mjSpec ignores it in an attached one".to_owned()
                }
                (_, Some(ours)) if OF_INERTIAS.contains(&attribute) && !replaces_inertias(tree) => {
                    let explicit = explicit.get_or_insert_with(|| computed::make_explicit(child, other));
                    match explicit {
                        Ok(true) if computed::is_respected(child, attribute, ours) => continue,
                        Ok(true) => format!("'{ours}', as in this spec, whose bound would change a body"),
                        Ok(false) => format!("'{ours}', as in this spec, beside elements that create bodies"),
                        Err(error) => {
                            format!("'{ours}', as in this spec, or a setting of a spec that compiles alone: {error}")
                        }
                    }
                }
                (_, ours) => {
                    format!("{}, as in this spec", ours.map_or("absent".to_owned(), |ours| format!("'{ours}'")))
                }
            };
            let what = format!("'{attribute}' of <compiler> in the attached spec");
            return Err(Error::invalid(InvalidKind::Unsuitable, what, format!("'{theirs}'"), expected));
        }
        let theirs = theirs.to_owned();
        let section = tree.section("compiler");
        tree.node_mut(section).set(attribute, theirs);
    }
    Ok(())
}

/// Returns `true` if the compiler replaces explicit inertias by those of geoms.
fn replaces_inertias(tree: &Tree) -> bool {
    paths::setting(tree, "inertiafromgeom") == Some("true")
}

/// Returns `true` if ranges are limits unless a text says otherwise.
pub(super) fn are_limits_automatic(tree: &Tree) -> bool {
    paths::setting(tree, "autolimits").unwrap_or(AUTOLIMITS) == "true"
}

/// Removes the inertias that the compiler replaces by inertias computed from the geoms. Returns
/// `true` if all inertias are computed from geoms.
fn compute_inertia(child: &mut Tree) -> bool {
    let inertias = inertia::inertials(child);
    match paths::setting(child, "inertiafromgeom").unwrap_or("auto") {
        "true" => {
            let replaced = |index: &Index| child.parent(*index).is_some_and(|body| inertia::is_from_geoms(child, body));
            let replaced: Vec<Index> = inertias.into_iter().filter(replaced).collect();
            for index in replaced {
                child.remove(index);
            }
        }
        "auto" if inertias.is_empty() => {}
        _ => return false,
    }
    true
}

/// Makes the limits explicit that depend on `autolimits`, if the specs differ in this setting.
fn convert_limits(tree: &Tree, child: &mut Tree) -> Result<()> {
    let theirs = are_limits_automatic(child);
    if theirs == are_limits_automatic(tree) {
        return Ok(());
    }
    let schema = Schema::of_engine()?;
    let mut changes = Vec::new();
    for index in child.descendants(Tree::ROOT) {
        let limits = attributes::meanings(child, index).iter().filter(|(_, meaning)| **meaning == Meaning::Limited);
        for (&limited, _) in limits {
            let range = limited.replace("limited", "range");
            let has_range = classes::effective(child, index, &range).is_some();
            let is_automatic = classes::effective(child, index, limited).is_none_or(|value| value == "auto");
            if has_range && is_automatic && schema.has(child, index, limited) {
                let is_range = is_range(classes::effective(child, index, &range));
                changes.push((index, limited, theirs && is_range));
            }
        }
    }
    for (index, limited, is_limited) in changes {
        child.node_mut(index).set(limited, is_limited.to_string());
    }
    Ok(())
}

/// Returns `true` if the compiler makes a range a limit.
pub(super) fn is_range(text: Option<&str>) -> bool {
    let numbers = text.and_then(value::numbers);
    numbers.is_some_and(|numbers| numbers.len() == 2 && numbers[0] < numbers[1])
}

#[cfg(test)]
mod tests {
    use super::super::super::attributes::{Meaning, meanings};
    use super::super::super::text;
    use super::SETTINGS;

    #[test]
    fn the_settings_on_which_specs_agree_have_defaults() {
        let tree = text::parse("<mujoco><compiler/></mujoco>").unwrap();
        let rows = meanings(&tree, tree.sections("compiler").next().unwrap()).iter();
        let mut agreed: Vec<&str> =
            rows.filter(|(_, meaning)| **meaning == Meaning::Agreed).map(|(&attribute, _)| attribute).collect();
        let mut settings = SETTINGS.map(|(attribute, _)| attribute);
        agreed.sort_unstable();
        settings.sort_unstable();
        assert_eq!(agreed, settings);
    }
}
