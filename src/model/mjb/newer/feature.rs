//! Features of compiled models that binary models must not have, because the rules of a safe file
//! are not known for them.

use std::mem::offset_of;

use mujoco_sys::{mjENBL_MULTICCD, mjGEOM_SDF, mjOption, mjSENS_PLUGIN, mjSENS_TACTILE};

use super::super::invalid::Invalid;
use super::super::layout::{Size, field, size};
use super::super::view::View;
use crate::model::engine_limits::MOST_SAFE_POLYGON;

/// Sizes that must be zero, and the feature that they count.
const ABSENT: [(Size, &str); 17] = [
    (size::nplugin, PLUGINS),
    (size::npluginattr, PLUGINS),
    (size::npluginstate, PLUGINS),
    (size::noct, "signed distance fields"),
    (size::nflex, FLEXES),
    (size::nflexnode, FLEXES),
    (size::nflexvert, FLEXES),
    (size::nflexedge, FLEXES),
    (size::nflexelem, FLEXES),
    (size::nflexelemdata, FLEXES),
    (size::nflexelemedge, FLEXES),
    (size::nflexshelldata, FLEXES),
    (size::nflexevpair, FLEXES),
    (size::nflextexcoord, FLEXES),
    (size::nJfe, FLEXES),
    (size::nJfv, FLEXES),
    (size::nbvhdynamic, FLEXES),
];

const PLUGINS: &str = "plugins";
const FLEXES: &str = "flexes";

/// Returns an error for a file with such a feature.
pub(in super::super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let reject = |feature: &str| Err(Invalid::unsupported(feature));
    if let Some((_, feature)) = ABSENT.into_iter().find(|&(size, _)| view.size(size) > 0) {
        return reject(feature);
    }
    if view.values(field::geom_type).any(|kind| kind as u32 == mjGEOM_SDF) {
        return reject("signed distance fields");
    }
    if view.values(field::sensor_type).any(|kind| [mjSENS_TACTILE, mjSENS_PLUGIN].contains(&(kind as u32))) {
        return reject("tactile sensors or sensors of plugins");
    }
    let enable: i32 = view.option(offset_of!(mjOption, enableflags));
    let largest = view.values(field::mesh_polyvertnum).max().unwrap_or(0);
    if enable as u32 & mjENBL_MULTICCD != 0 && largest > MOST_SAFE_POLYGON {
        return reject("the option multiccd and meshes whose convex hull has a polygon of more than 8 vertices");
    }
    Ok(())
}

/// Returns `true` if the size must be zero.
#[cfg(test)]
pub(in super::super) fn is_absent(size: Size) -> bool {
    ABSENT.iter().any(|&(absent, _)| absent == size)
}
