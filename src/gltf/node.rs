//! Nodes, cameras, and lights by the extension `KHR_lights_punctual`.

use std::f32::consts::{FRAC_PI_2, PI};

use gltf_json::camera::{Camera, Orthographic, Perspective, Type};
use gltf_json::extensions::scene::Node as Extensions;
use gltf_json::extensions::scene::khr_lights_punctual::{self as light, KhrLightsPunctual};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Node, Root};

use super::document::object;
use super::material::unit;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::kind::Kind;
use crate::math::{Pose, norm, normalize4, quat_z2vec};
use crate::model::Model;
use crate::replay::{Light, label};
use crate::scene::Viewpoint;

/// Returns a node in a pose.
///
/// # Errors
///
/// [`Error::Invalid`] for numbers that are not finite in single precision.
pub(super) fn node(name: String, pose: Pose) -> Result<Node> {
    let translation = Some(translation(pose.pos)?).filter(|at| *at != [0.0; 3]);
    let rotation = Some(rotation(pose.quat)?).filter(|quat| *quat != [0.0, 0.0, 0.0, 1.0]).map(UnitQuaternion);
    Ok(Node { name: Some(name), translation, rotation, ..Node::default() })
}

/// Adds a node as a child of another.
pub(super) fn add_child(root: &mut Root, parent: Index<Node>, node: Node) -> Index<Node> {
    let index = root.push(node);
    root.nodes[parent.value()].children.get_or_insert_default().push(index);
    index
}

/// Converts a position, m.
pub(super) fn translation(pos: [f64; 3]) -> Result<[f32; 3]> {
    let single = pos.map(|number| number as f32);
    let is_finite = single.iter().all(|number| number.is_finite());
    Error::check_range(is_finite, "a position to save as glTF", format_args!("{pos:?}"), "finite in single precision")?;
    Ok(single)
}

/// Converts a quaternion to `[x, y, z, w]`, of length 1.
pub(super) fn rotation(mut quat: [f64; 4]) -> Result<[f32; 4]> {
    normalize4(&mut quat);
    let is_finite = quat.iter().all(|number| number.is_finite());
    Error::check_range(is_finite, "an orientation to save as glTF", format_args!("{quat:?}"), "finite")?;
    Ok([1, 2, 3, 0].map(|part| quat[part] as f32))
}

/// Converts a frustum. `None` for one that glTF does not have.
pub(super) fn camera(name: String, view: &Viewpoint) -> Option<Camera> {
    let &Viewpoint { frustum_width: width, frustum_near: near, frustum_far: far, orthographic, .. } = view;
    let half = 0.5 * (view.frustum_top - view.frustum_bottom);
    let all = [view.frustum_center, width, half, near, far];
    if !(all.iter().all(|number| number.is_finite()) && half > 0.0 && near > 0.0 && far > near) {
        return None;
    }
    let aspect_ratio = (width > 0.0).then_some(width / half);
    let yfov = 2.0 * (half / near).atan();
    let perspective = object!(Perspective { aspect_ratio, yfov, zfar: Some(far), znear: near });
    let xmag = half * aspect_ratio.unwrap_or(1.0);
    let parallel = object!(Orthographic { xmag, ymag: half, zfar: far, znear: near });
    Some(object!(Camera {
        name: Some(name),
        orthographic: orthographic.then_some(parallel),
        perspective: (!orthographic).then_some(perspective),
        type_: Valid(if orthographic { Type::Orthographic } else { Type::Perspective }),
    }))
}

/// Returns `false` for a frustum that a camera of glTF, which is symmetric, does not have.
pub(super) fn is_symmetric(view: &Viewpoint) -> bool {
    let (bottom, top) = (view.frustum_bottom, view.frustum_top);
    let least = 0.5e-3 * (top - bottom);
    view.frustum_center.abs() <= least && (top + bottom).abs() <= least
}

/// Adds a light, and returns its node in its frame. The simulation has its position.
///
/// A light of the engine with the colour 1 draws a white surface that faces it white. In glTF such
/// a surface reflects the fraction 1/π of its illuminance, so a light has the intensity π. The
/// colours of lights are taken as linear: a surface on which lights add up to 1 has its own colour
/// then, as in the engine. The engine's spot lights have no decay with the distance by default,
/// those of glTF decay with its square: they have the engine's brightness at the centre of the
/// model.
pub(super) fn light(root: &mut Root, data: &Data, look: &Light) -> Result<Node> {
    let (model, center) = (data.model(), data.model().statistics().center);
    let from_center = |pos: [f64; 3]| norm(&[0, 1, 2].map(|axis| pos[axis] - center[axis]));
    let distance = look.index.map_or(0.0, |index| from_center(data.light_xpos()[index]));
    let name = look.index.map_or_else(|| "headlight".to_owned(), |index| label(model, Kind::Light, index));
    let distance = if distance > 0.0 && distance.is_finite() { distance as f32 } else { 1.0 };
    let cone = look.cutoff.to_radians();
    let is_spot = !look.directional && cone > 0.0 && cone <= FRAC_PI_2;
    // In single precision, a right angle is above π/2.
    let cone = cone.min(FRAC_PI_2.next_down());
    // An exponent of the engine concentrates the light about the axis.
    let inner_cone_angle = if look.exponent > 0.0 { 0.0 } else { 0.99 * cone };
    let type_ = match (look.directional, is_spot) {
        (true, _) => light::Type::Directional,
        (_, true) => light::Type::Spot,
        _ => light::Type::Point,
    };
    let index = root.push(object!(light::Light {
        color: look.diffuse.map(unit),
        intensity: if look.directional { PI } else { candela(model, look, PI * distance.powi(2)) },
        name: Some(name.clone()),
        range: None,
        spot: is_spot.then_some(light::Spot { inner_cone_angle, outer_cone_angle: cone }),
        type_: Valid(type_),
    }));
    root.extensions_used = vec!["KHR_lights_punctual".to_owned()];
    // A light of glTF shines along the negative z-axis of its node.
    let pose = Pose { pos: look.pos, quat: quat_z2vec(&look.dir.map(|part| -part)) };
    let mut node = node(name, pose)?;
    node.extensions.get_or_insert_with(Extensions::default).khr_lights_punctual =
        Some(KhrLightsPunctual { light: index });
    Ok(node)
}

/// Returns the intensity of a spot light: that of the model, if it has one.
fn candela(model: &Model, light: &Light, default: f32) -> f32 {
    #[cfg(engine_since = "3.5.0")]
    if let Some(own) = light.index.map(|index| model.light_intensity()[index]).filter(|own| *own > 0.0) {
        return own.min(f32::MAX);
    }
    #[cfg(not(engine_since = "3.5.0"))]
    let _ = (model, light);
    default
}
