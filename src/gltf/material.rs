//! Materials and textures.
//!
//! The engine's colours are those of the screen, which glTF has as sRGB in textures and as linear
//! factors elsewhere. A highlight of the engine with the exponent n of a cosine has the roughness
//! `(2 / (n + 2))^(1/4)` (B. Walter et al., "Microfacet models for refraction through rough
//! surfaces", 2007, with the square of the roughness as their width, as glTF defines it).

use std::collections::HashMap;

use gltf_json::image::{Image, MimeType};
use gltf_json::material::{AlphaMode, EmissiveFactor, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::texture::{Info, MagFilter, MinFilter, Sampler, Texture};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Extras, Index, Material};

use super::document::Document;
use crate::model::Model;
use crate::replay::{self, Geom};

/// Materials and textures of a file.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// Materials by their text.
    known: HashMap<String, Index<Material>>,
    /// Textures by their index in the model.
    textures: HashMap<usize, Index<Texture>>,
    sampler: Option<Index<Sampler>>,
}

impl Materials {
    /// Adds the material of a geom.
    pub(super) fn add(
        &mut self,
        document: &mut Document,
        model: &Model,
        geom: &Geom,
        texture: Option<&replay::Texture>,
    ) -> Index<Material> {
        let mut color = geom.rgba.map(unit);
        let mut info = None;
        match (texture, geom.texture) {
            (Some(cube), _) if cube.is_cube => {
                for (channel, mean) in color.iter_mut().zip(cube.mean) {
                    *channel *= mean as f32;
                }
            }
            (Some(flat), Some(index)) => info = Some(self.texture(document, model, index, flat)),
            _ => {}
        }
        let is_clear = color[3] < 1.0 || info.is_some() && texture.is_some_and(|texture| texture.has_alpha);
        let [r, g, b, alpha] = color;
        let emission = geom.emission;
        let [metallic, roughness] = surface(model, geom);
        let material = Material {
            name: geom
                .material
                .and_then(|index| model.materials().nth(index))
                .and_then(|material| material.name())
                .map(str::to_owned),
            alpha_mode: Valid(if is_clear { AlphaMode::Blend } else { AlphaMode::Opaque }),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor([linear(r), linear(g), linear(b), alpha]),
                base_color_texture: info.clone(),
                metallic_factor: StrengthFactor(metallic),
                roughness_factor: StrengthFactor(roughness),
                ..PbrMetallicRoughness::default()
            },
            emissive_factor: EmissiveFactor([r, g, b].map(|part| linear(unit(emission * part)))),
            emissive_texture: if emission > 0.0 { info } else { None },
            ..Material::default()
        };
        let text = gltf_json::serialize::to_string(&material).expect("Bug: materials have valid parts");
        *self.known.entry(text).or_insert_with(|| document.root.push(material))
    }

    fn texture(&mut self, document: &mut Document, model: &Model, index: usize, texture: &replay::Texture) -> Info {
        let sampler = *self.sampler.get_or_insert_with(|| {
            document.root.push(Sampler {
                mag_filter: Some(Valid(MagFilter::Linear)),
                min_filter: Some(Valid(MinFilter::LinearMipmapLinear)),
                ..Sampler::default()
            })
        });
        let index = *self.textures.entry(index).or_insert_with(|| {
            let name = model.textures().nth(index).and_then(|texture| texture.name()).map(str::to_owned);
            let view = document.view(&texture.png, None);
            let source = document.root.push(Image {
                buffer_view: Some(view),
                mime_type: Some(MimeType("image/png".to_owned())),
                name: name.clone(),
                uri: None,
                extensions: None,
                extras: Extras::default(),
            });
            document.root.push(Texture {
                name,
                sampler: Some(sampler),
                source,
                extensions: None,
                extras: Extras::default(),
            })
        });
        Info { index, tex_coord: 0, extensions: None, extras: Extras::default() }
    }
}

/// Returns the metallic and the roughness coefficient: those of the material where it has them.
fn surface(model: &Model, geom: &Geom) -> [f32; 2] {
    let exponent = 128.0 * unit(geom.shininess);
    let rough = if geom.specular > 0.0 { (2.0 / (exponent + 2.0)).powf(0.25) } else { 1.0 };
    #[cfg(engine_since = "3.2.0")]
    if let Some(index) = geom.material {
        let own = |value: f32, default: f32| if value >= 0.0 { unit(value) } else { default };
        return [own(model.mat_metallic()[index], 0.0), own(model.mat_roughness()[index], rough)];
    }
    #[cfg(not(engine_since = "3.2.0"))]
    let _ = model;
    [0.0, rough]
}

/// Limits a number to the interval from 0 to 1. NaN becomes 0.
pub(super) fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Converts a colour from sRGB to linear (IEC 61966-2-1).
fn linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
