//! Names of elements, and descriptions of those that are left out.

use crate::element::Object;
use crate::kind::Kind;
use crate::model::Model;
use crate::scene::{SceneGeom, SceneGeomType};

/// Returns the name of an element, or its kind and index.
pub(crate) fn label(model: &Model, kind: Kind, index: usize) -> String {
    model.name_at(kind, index).map_or_else(|| format!("{kind} {index}"), str::to_owned)
}

/// Returns the kind of an element, and its name or index.
pub(crate) fn description(model: &Model, kind: Kind, index: usize) -> String {
    model.name_at(kind, index).map_or_else(|| format!("{kind} {index}"), |name| format!("{kind} {name}"))
}

/// Describes a geom of the scene that is neither a geom nor a site of the model.
pub(crate) fn decoration(model: &Model, geom: SceneGeom<'_>) -> String {
    match (geom.object(), geom.geom_type()) {
        (Some(Object::Tendon(id)), _) => description(model, Kind::Tendon, id.index()),
        (Some(Object::Skin(id)), _) => description(model, Kind::Skin, id.index()),
        (_, SceneGeomType::Flex) => format!("flex {}", geom.flex().unwrap_or_default()),
        (Some(other), shape) => format!("{shape:?} of {other:?}"),
        (None, shape) => format!("decoration: {shape:?}"),
    }
}
