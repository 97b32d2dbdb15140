//! Validation of all shader variants with naga, without a graphics adapter.

use std::collections::BTreeSet;
use std::sync::Mutex;

use wgpu::naga::front::wgsl;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

use super::{Output, ShaderKind, ShaderVariant, Shading, TextureKind, preprocess};
use crate::render::view::{LightFeatures, UniformData};

/// Checks the shader of one image and, unless it is of labels, that of several.
fn check(variant: &ShaderVariant<'_>) {
    check_source(&variant.source(), Capabilities::empty());
    if variant.kind != ShaderKind::Label {
        let [view, light, shadow] = UniformData::VECTORS;
        let shadows = variant.lights.iter().filter(|light| light.shadow).count();
        // The exact size of a shader that reads the lights, and more than others read.
        let vectors = view + light * variant.lights.len() + shadow * shadows;
        let source = ShaderVariant { vectors: Some(vectors as u32), ..*variant }.source();
        check_source(&source, Capabilities::CLIP_DISTANCES);
    }
}

/// Checks a text once: options that a shader does not use leave its text unchanged.
fn check_source(source: &str, capabilities: Capabilities) {
    static CHECKED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    if !CHECKED.lock().expect("no test panics here").insert(source.to_owned()) {
        return;
    }
    let module = wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}\n{source}", error.emit_to_string(source)));
    let mut validator = Validator::new(ValidationFlags::all(), capabilities);
    validator.validate(&module).unwrap_or_else(|error| panic!("{}\n{source}", error.emit_to_string(source)));
}

/// Decodes light features from the bits of a number.
fn features(bits: u32) -> LightFeatures {
    let bit = |index: u32| bits >> index & 1 == 1;
    let directional = bit(0);
    LightFeatures {
        directional,
        attenuated: bit(1) && !directional,
        spot: bit(2) && !directional,
        focused: bit(2) && bit(3) && !directional,
        ambient: bit(4),
        specular: bit(5),
        shadow: bit(6),
    }
}

const SURFACE: ShaderVariant<'static> = ShaderVariant {
    kind: ShaderKind::Surface,
    output: Output::Color,
    texture_kind: TextureKind::None,
    shading: Shading::Pixel,
    lights: &[],
    fog: false,
    blended: false,
    quad_edges: false,
    clip: false,
    aliased: false,
    vectors: None,
};

/// Returns 1, or 3 if a third of the cases runs.
fn stride() -> usize {
    if std::env::var_os("MUJOCO_SAFE_ALL_CASES").is_some() { 1 } else { 3 }
}

#[test]
fn surface_shader_is_valid_for_every_light() {
    for shading in [Shading::Vertex, Shading::Pixel] {
        check(&ShaderVariant { shading, ..SURFACE });
        for bits in (0..1 << 7).step_by(stride()) {
            let lights = [features(bits), LightFeatures { shadow: true, ..features(bits) }];
            check(&ShaderVariant { shading, lights: &lights, ..SURFACE });
        }
    }
}

#[test]
fn surface_shader_is_valid_for_any_number_of_lights() {
    for shading in [Shading::Vertex, Shading::Pixel] {
        for count in (0..=8).step_by(stride()) {
            let mut lights = vec![features(0b111_1110); count];
            lights.extend([features(0); 3]);
            check(&ShaderVariant {
                shading,
                lights: &lights,
                texture_kind: TextureKind::D2,
                fog: true,
                blended: true,
                clip: true,
                ..SURFACE
            });
        }
        check(&ShaderVariant { shading, lights: &[features(0b11_0110); 100], ..SURFACE });
    }
}

#[test]
fn every_shader_is_valid_with_every_option() {
    let skies = [false, true].map(|haze| ShaderKind::Sky { haze });
    let others = [ShaderKind::Surface, ShaderKind::Line, ShaderKind::Depth, ShaderKind::Label];
    for kind in others.into_iter().chain(skies) {
        for output in [Output::Color, Output::Ids, Output::DepthOnly] {
            let texture_kinds: &[TextureKind] = match output {
                Output::Color => &[TextureKind::None, TextureKind::D2, TextureKind::Cube],
                _ => &[TextureKind::None],
            };
            for &texture_kind in texture_kinds {
                for (first, shading) in [Shading::None, Shading::Vertex, Shading::Pixel].into_iter().enumerate() {
                    for bits in (0..16).skip(first % stride()).step_by(stride()) {
                        let lights = &[features(0b111_1110), features(1)];
                        let [fog, clip, quad_edges, blended] = [1, 2, 4, 8].map(|bit| bits & bit == bit);
                        let aliased = fog != clip;
                        check(&ShaderVariant {
                            kind,
                            output,
                            texture_kind,
                            shading,
                            lights,
                            fog,
                            blended,
                            quad_edges,
                            clip,
                            aliased,
                            vectors: None,
                        });
                    }
                }
            }
        }
    }
}

#[test]
fn preprocessor_selects_lines_and_inserts() {
    let file = "a\n//#if X\nb\n//#if Y\nc\n//#end\nd\n//#end\n// a comment\n//#here\ne";
    let inserts = [("here", "new\n")];
    assert_eq!(preprocess(&[file], &[("X", true), ("Y", false)], &inserts), "a\nb\nd\nnew\ne\n");
    assert_eq!(preprocess(&[file], &[("X", false), ("Y", true)], &inserts), "a\nnew\ne\n");
}
