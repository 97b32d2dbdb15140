//! Elements and types of the linked engine that the corpus lacks.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use mujoco_safe::{Model, built_against, sys};

use super::models;

/// Returns an array of a model.
type Array = fn(&Model) -> &[i32];

/// Enums of the engine, and the arrays with their values.
const ENUMS: [(&str, Array); 12] = [
    ("mjtJoint", Model::jnt_type),
    ("mjtGeom", Model::geom_type),
    ("mjtCamLight", Model::cam_mode),
    ("mjtTexture", Model::tex_type),
    ("mjtEq", Model::eq_type),
    ("mjtWrap", Model::wrap_type),
    ("mjtTrn", Model::actuator_trntype),
    ("mjtDyn", Model::actuator_dyntype),
    ("mjtGain", Model::actuator_gaintype),
    ("mjtBias", Model::actuator_biastype),
    ("mjtSensor", Model::sensor_type),
    ("mjtDataType", Model::sensor_datatype),
];

/// Constants that no text leads to. No engine implements constraints of distances, and MJCF of 4.0
/// has none of the vertices of a flex.
const UNUSED: &[&str] = if cfg!(engine_since = "4.0.0") {
    &["mjWRAP_NONE", "mjEQ_DISTANCE", "mjEQ_FLEXVERT"]
} else {
    &["mjWRAP_NONE", "mjEQ_DISTANCE"]
};

/// Values above which an enum has constants for the visualiser, and for missing values.
const MOST: i32 = 100;

/// Returns the elements of the linked engine's schema and the constants of its enums that no model
/// of the corpus has. The elements and the constants of plugins count if the plugins are loaded.
pub fn missing() -> Vec<String> {
    let mut covered = BTreeMap::new();
    let mut used: BTreeSet<(&str, i32)> = BTreeSet::new();
    let mut has_rangefinder_camera = false;
    for which in 0..models::all().len() {
        let element = models::attribute(which).map(|attribute| attribute.element.clone());
        if element.as_ref().is_some_and(|element| covered.get(element) == Some(&true)) {
            continue;
        }
        let loaded = models::loaded(which);
        if let Some(element) = element {
            covered.insert(element, loaded.is_some());
        }
        if let Some(model) = loaded {
            for (name, array) in ENUMS {
                used.extend(array(model).iter().map(|&value| (name, value)));
            }
            let mut objects = model.sensor_type().iter().zip(model.sensor_objtype());
            has_rangefinder_camera |= objects
                .any(|(&kind, &object)| (kind, object) == (sys::mjSENS_RANGEFINDER as i32, sys::mjOBJ_CAMERA as i32));
        }
    }
    let has_plugins = has_plugin("mujoco.pid");
    let is_expected = |name: &str| match name {
        // The compiler of 2.2.2 rejects constraints of distances.
        "equality/distance" => false,
        // No wheel since 3.5 has a plugin for flexes, and that of 4.0 has none for passive forces.
        name if name.starts_with("body/flexcomp/plugin") => false,
        name if name.starts_with("body/plugin") => has_plugin("mujoco.elasticity.cable"),
        name if name.starts_with("body/composite/plugin") => {
            has_plugin("mujoco.elasticity.cable") && models::loaded(models::index_of("cable plugin")).is_none()
        }
        name => has_plugins || !(name.contains("plugin") || name.starts_with("extension")),
    };
    let elements =
        covered.into_iter().filter(|(element, covered)| !covered && is_expected(element)).map(|(element, _)| element);
    let constants = constants().into_iter().filter(|(name, constant, value)| {
        let is_of_plugin = ["mjSENS_PLUGIN", "mjGEOM_SDF"].contains(&&constant[..]);
        !used.contains(&(*name, *value)) && (has_plugins || !is_of_plugin)
    });
    // Rangefinders of sites measure one distance, and those of cameras one for each pixel.
    let lacks_camera = cfg!(engine_since = "3.5.0") && !has_rangefinder_camera;
    let camera = lacks_camera.then(|| "a rangefinder of a camera".to_owned());
    elements.chain(constants.map(|(_, constant, _)| constant)).chain(camera).collect()
}

fn has_plugin(name: &str) -> bool {
    Model::from_xml_str(&format!("<mujoco><extension><plugin plugin='{name}'/></extension></mujoco>")).is_ok()
}

/// Returns the constants of [`ENUMS`] that the linked engine has: enum, name, value.
fn constants() -> Vec<(&'static str, String, i32)> {
    let file = format!("mujoco-sys/src/bindings/v{}.rs", built_against().to_string().replace('.', "_"));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let bindings = std::fs::read_to_string(path).expect("the bindings of an engine with tests are in the repository");
    let constant = |line: &str| {
        let (name, rest) = line.strip_prefix("pub const ")?.split_once(": ")?;
        let (kind, value) = rest.trim_end_matches(';').split_once(" = ")?;
        let (kind, _) = ENUMS.into_iter().find(|(found, _)| *found == kind)?;
        let value = value.parse().ok().filter(|&value| value < MOST)?;
        (!name.starts_with("mjN") && !UNUSED.contains(&name)).then(|| (kind, name.to_owned(), value))
    };
    bindings.lines().filter_map(constant).collect()
}
