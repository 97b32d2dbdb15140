//! Lights, by the extension `KHR_lights_punctual`.
//!
//! A light of the engine with the colour 1 draws a white surface that faces it white. In glTF such
//! a surface reflects the fraction 1/π of its illuminance, so a light has π times the colour. The
//! colours of lights are taken as linear: a surface on which lights add up to 1 has its own colour
//! then, as in the engine. The engine's spot lights have no decay with the distance by default,
//! those of glTF decay with its square: they have the engine's brightness at the centre of the
//! model.

use std::f32::consts::{FRAC_PI_2, PI};

use gltf_json::extensions::root;
use gltf_json::extensions::scene::Node as Extensions;
use gltf_json::extensions::scene::khr_lights_punctual::{KhrLightsPunctual, Light as GltfLight, Spot, Type};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Extras, Index, Node, Root};

use super::material::unit;
use super::node::node;
use crate::error::Result;
use crate::math::quat_z2vec;
use crate::model::Model;
use crate::replay::{Light, Pose};

const EXTENSION: &str = "KHR_lights_punctual";

/// Adds a light, and returns its node in its frame. `distance` is that of the centre of the model,
/// m.
pub(super) fn light(root: &mut Root, model: &Model, light: &Light, distance: f64) -> Result<Node> {
    let name = light.index.map_or_else(|| "headlight".to_owned(), |index| name(model, index));
    let color = light.diffuse.map(unit);
    let brightness = color.into_iter().fold(0.0, f32::max);
    let color = if brightness > 0.0 { color.map(|part| part / brightness) } else { color };
    let distance = if distance > 0.0 && distance.is_finite() { distance as f32 } else { 1.0 };
    let illuminance = PI * brightness;
    let cone = light.cutoff.to_radians();
    let (type_, spot, intensity) = if light.directional {
        (Type::Directional, None, illuminance)
    } else {
        let is_spot = cone > 0.0 && cone <= FRAC_PI_2;
        // In single precision, a right angle is above π/2.
        let cone = cone.min(FRAC_PI_2.next_down());
        // An exponent of the engine concentrates the light about the axis.
        let inner_cone_angle = if light.exponent > 0.0 { 0.0 } else { 0.99 * cone };
        let spot = is_spot.then_some(Spot { inner_cone_angle, outer_cone_angle: cone });
        (if is_spot { Type::Spot } else { Type::Point }, spot, candela(model, light, illuminance * distance.powi(2)))
    };
    let lights = &mut root.extensions.get_or_insert_with(root::Root::default).khr_lights_punctual;
    let lights = &mut lights.get_or_insert_default().lights;
    let index = Index::push(
        lights,
        GltfLight {
            color,
            extensions: None,
            extras: Extras::default(),
            intensity,
            name: Some(name.clone()),
            range: None,
            spot,
            type_: Valid(type_),
        },
    );
    if root.extensions_used.is_empty() {
        root.extensions_used.push(EXTENSION.to_owned());
    }
    // A light of glTF shines along the negative z-axis of its node.
    let pose = Pose { pos: light.pos, quat: quat_z2vec(&light.dir.map(|part| -part)) };
    let mut node = node(name, pose)?;
    node.extensions.get_or_insert_with(Extensions::default).khr_lights_punctual =
        Some(KhrLightsPunctual { light: index });
    Ok(node)
}

pub(super) fn name(model: &Model, index: usize) -> String {
    let name = model.lights().nth(index).and_then(|light| light.name());
    name.map_or_else(|| format!("light {index}"), str::to_owned)
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
