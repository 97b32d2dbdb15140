//! Elements and types of the linked engine that the corpus lacks.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use mujoco_safe::Model;

use super::models;

/// Types of actuators in MJCF.
const TYPES: [(&str, &[&str]); 3] = [
    ("dyntype", &["none", "integrator", "filter", "filterexact", "muscle", "dcmotor", "pid", "user"]),
    ("gaintype", &["fixed", "affine", "muscle", "dcmotor", "so3", "pid", "user"]),
    ("biastype", &["none", "affine", "muscle", "dcmotor", "so3", "user"]),
];

/// Returns the elements and the types of actuators of the linked engine that no model of the corpus has. Plugins are not loaded.
pub fn missing() -> Vec<String> {
    let mut covered = BTreeMap::new();
    let mut used: BTreeSet<(&str, i32)> = BTreeSet::new();
    for which in 0..models::all().len() {
        let element = models::attribute(which).map(|attribute| attribute.element.clone());
        if element.as_ref().is_some_and(|element| covered.get(element) == Some(&true)) {
            continue;
        }
        let loaded = models::loaded(which);
        if let Some(element) = element {
            covered.insert(element, loaded.is_some());
        }
        used.extend(loaded.iter().flat_map(|model| types(model)));
    }
    // The compiler of 2.2.2 rejects constraints of distances, which have no implementation.
    let is_absent = |element: &str| {
        element.contains("plugin") || element.starts_with("extension") || element == "equality/distance"
    };
    let mut missing: Vec<String> = covered
        .into_iter()
        .filter(|(element, covered)| !covered && !is_absent(element))
        .map(|(element, _)| element)
        .collect();
    for (attribute, names) in TYPES {
        for name in names {
            let text = probe(attribute, name);
            if let Some((_, found)) = text.iter().flat_map(types).find(|(of, _)| *of == attribute)
                && !used.contains(&(attribute, found))
            {
                missing.push(format!("{attribute} {name}"));
            }
        }
    }
    missing
}

/// Returns the types of actuators in a model.
fn types(model: &Arc<Model>) -> Vec<(&'static str, i32)> {
    let of = |attribute: &'static str, types: &[i32]| types.iter().map(|&found| (attribute, found)).collect::<Vec<_>>();
    [
        of("dyntype", model.actuator_dyntype()),
        of("gaintype", model.actuator_gaintype()),
        of("biastype", model.actuator_biastype()),
    ]
    .concat()
}

/// Returns a model with an actuator of this type, if the engine has it.
fn probe(attribute: &str, name: &str) -> Option<Arc<Model>> {
    let others = match name {
        "pid" => r#"dyntype="pid" gaintype="pid" biastype="affine" dynprm="1 1""#.to_owned(),
        "dcmotor" => r#"dyntype="dcmotor" gaintype="dcmotor" biastype="dcmotor" dynprm="1" gainprm="1 1""#.to_owned(),
        _ => format!(r#"{attribute}="{name}" lengthrange="-1 1""#),
    };
    let text = format!(
        r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody><actuator><general joint="j" {others}/></actuator></mujoco>"#
    );
    Model::from_xml_str(&text).ok().map(Arc::new)
}
