//! Materials and textures.
//!
//! The engine's colours are those of the screen, which glTF has as sRGB in textures and as linear
//! factors elsewhere. A highlight of the engine with the exponent n of a cosine has the roughness
//! `(2 / (n + 2))^(1/4)` (B. Walter et al., "Microfacet models for refraction through rough
//! surfaces", 2007, with the square of the roughness as their width, as glTF defines it).

use gltf_json::image::{Image, MimeType};
use gltf_json::material::{AlphaMode, EmissiveFactor, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::texture::{Info, Texture};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Material};

use super::document::{Document, object};
use crate::kind::Kind;
use crate::model::Model;
use crate::replay::{self, Surface, label};

impl Document<'_> {
    /// Adds the material of a surface. `material` and the number of the texture are indices of the
    /// model.
    pub(super) fn material(
        &mut self,
        surface: &Surface,
        material: Option<usize>,
        texture: Option<(usize, &replay::Texture)>,
        double_sided: bool,
    ) -> Index<Material> {
        let mut color = surface.rgba.map(unit);
        let mut info = None;
        match texture {
            Some((index, cube)) if cube.is_cube => {
                let name = label(self.model, Kind::Texture, index);
                self.left_out.insert(format!("the pattern of the cube texture {name}"));
                color.iter_mut().zip(cube.mean).for_each(|(channel, mean)| *channel *= mean as f32);
            }
            Some((index, flat)) => info = Some(self.texture(index, flat)),
            None => {}
        }
        let is_clear = color[3] < 1.0 || info.is_some() && texture.is_some_and(|(_, texture)| texture.has_alpha);
        let [r, g, b, alpha] = color;
        let emission = surface.emission;
        let [metallic, roughness] = coefficients(self.model, surface, material);
        let material = Material {
            name: material.and_then(|index| self.model.name_at(Kind::Material, index)).map(str::to_owned),
            double_sided,
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
        *self.materials.entry(text).or_insert_with(|| self.root.push(material))
    }

    fn texture(&mut self, index: usize, texture: &replay::Texture) -> Info {
        let known = self.textures.get(&index).copied();
        let stored = known.unwrap_or_else(|| {
            let name = self.model.name_at(Kind::Texture, index).map(str::to_owned);
            let buffer_view = Some(self.view(&texture.png, None));
            let mime_type = Some(MimeType("image/png".to_owned()));
            let image = object!(Image { buffer_view, mime_type, name: name.clone(), uri: None });
            // Without a sampler, a texture repeats, and programs select the filters.
            let texture = object!(Texture { name, sampler: None, source: self.root.push(image) });
            self.root.push(texture)
        });
        self.textures.insert(index, stored);
        object!(Info { index: stored, tex_coord: 0 })
    }
}

/// Returns the metallic and the roughness coefficient: those of the material where it has them.
fn coefficients(model: &Model, surface: &Surface, material: Option<usize>) -> [f32; 2] {
    let exponent = 128.0 * unit(surface.shininess);
    let rough = if surface.specular > 0.0 { (2.0 / (exponent + 2.0)).powf(0.25) } else { 1.0 };
    #[cfg(engine_since = "3.2.0")]
    if let Some(index) = material {
        let own = |value: f32, default: f32| if value >= 0.0 { unit(value) } else { default };
        return [own(model.mat_metallic()[index], 0.0), own(model.mat_roughness()[index], rough)];
    }
    #[cfg(not(engine_since = "3.2.0"))]
    let _ = (model, material);
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
