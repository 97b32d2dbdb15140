//! Generation of the lighting code: one function per light, without code for features that the
//! light does not have.

use std::fmt::Write;

use super::Shading;
use crate::render::view::LightFeatures;

/// Generated lighting code.
#[derive(Debug, Default)]
pub(super) struct LightingCode {
    /// Functions, appended to the shader.
    pub(super) functions: String,
    varyings: String,
    vertex_light: String,
    vertex_shadow: String,
    fragment_shadow: String,
}

/// First location of the varyings of shadows.
const SHADOW_LOCATION: usize = 7;

/// Maximum number of shadow-casting lights whose shadow coordinates are varyings, limited by the
/// number of inter-stage variables. With more lights each fragment computes them from its position.
const MAX_SHADOW_VARYINGS: usize = 5;

/// Location of the position, if fragments compute shadow coordinates with per-vertex lighting.
const WORLD_LOCATION: usize = 13;

impl LightingCode {
    pub(super) fn new(lights: &[LightFeatures], shading: Shading, is_textured: bool) -> Self {
        let mut code = Self::default();
        let mut unshadowed = String::new();
        let shadows = lights.iter().filter(|light| light.shadow).count();
        let mut shadow = 0;
        for (index, &light) in lights.iter().enumerate() {
            code.functions.push_str(&light_function(index, light));
            if light.shadow {
                code.add_shadow(index, [shadow, shadows], light, shading, is_textured);
                shadow += 1;
            } else {
                let _ = writeln!(unshadowed, "    color += light_{index}(point);");
            }
        }
        let _ = write!(
            code.functions,
            "fn unshadowed_light(point: SurfacePoint) -> vec3f {{\n    \
             var color = point.rgb * (point.material.x + view.ambient.rgb);\n\
             {unshadowed}    return clamp(color, vec3f(0.0), vec3f(1.0));\n}}\n"
        );
        code
    }

    /// Generates the code of lines, which add their own colour for each shadow map.
    pub(super) fn of_line(lights: &[LightFeatures]) -> Self {
        let mut code = Self::default();
        for (index, &light) in lights.iter().filter(|light| light.shadow).enumerate() {
            code.add_map(index);
            let _ = writeln!(code.fragment_shadow, "    let shadow_{index} = {};", projected(index, "in.world"));
            code.add_test(index, light, "", "in.rgba.rgb");
        }
        code
    }

    /// Returns the replacements of the preprocessor.
    pub(super) fn inserts(&self) -> [(&'static str, &str); 4] {
        [
            ("varyings", &self.varyings),
            ("vertex_light", &self.vertex_light),
            ("vertex_shadow", &self.vertex_shadow),
            ("fragment_shadow", &self.fragment_shadow),
        ]
    }

    /// Adds the code of a light with a shadow map, which is given by its index among the shadow
    /// maps and their number. In an image with transparency, a shadow map lights only opaque
    /// texels, as does the engine's alpha test.
    fn add_shadow(
        &mut self,
        light: usize,
        [index, count]: [usize; 2],
        features: LightFeatures,
        shading: Shading,
        is_textured: bool,
    ) {
        self.add_map(index);
        let has_varying = count <= MAX_SHADOW_VARYINGS;
        if has_varying {
            let _ = writeln!(self.varyings, "    @location({}) shadow_{index}: vec4f,", SHADOW_LOCATION + index);
            let _ = writeln!(self.vertex_shadow, "    out.shadow_{index} = {};", projected(index, "world"));
            let _ = writeln!(self.fragment_shadow, "    let shadow_{index} = in.shadow_{index};");
        } else {
            if index == 0 && shading == Shading::Vertex {
                let _ = writeln!(self.varyings, "    @location({WORLD_LOCATION}) world: vec3f,");
                self.vertex_shadow.push_str("    out.world = world;\n");
            }
            let _ = writeln!(self.fragment_shadow, "    let shadow_{index} = {};", projected(index, "in.world"));
        }
        let lit = format!("clamp(light_{light}(point), vec3f(0.0), vec3f(1.0))");
        let lit = if shading == Shading::Vertex {
            // The free locations before the shadows' locations, then the free ones after, or the
            // shadows' own.
            let after = if has_varying { SHADOW_LOCATION + count } else { SHADOW_LOCATION };
            let location = if index < 3 { index + 1 } else { after + index - 3 };
            let _ = writeln!(self.varyings, "    @location({location}) lit_{index}: vec3f,");
            let _ = writeln!(self.vertex_light, "    out.lit_{index} = {lit};");
            format!("in.lit_{index}")
        } else {
            lit
        };
        let opaque = if is_textured { " && texel.a >= 0.99" } else { "" };
        self.add_test(index, features, opaque, &lit);
    }

    /// Declares a shadow map.
    fn add_map(&mut self, index: usize) {
        let _ = writeln!(self.functions, "@group(0) @binding({}) var shadow_map_{index}: texture_2d<f32>;", index + 1);
    }

    /// Adds the colour `lit` where a shadow map and another condition have the light shine.
    fn add_test(&mut self, index: usize, features: LightFeatures, condition: &str, lit: &str) {
        // The projection of a directional light is orthographic.
        let divided = if features.directional { "xyz".to_owned() } else { format!("xyz / shadow_{index}.w") };
        let _ = write!(
            self.fragment_shadow,
            "    let at_{index} = shadow_{index}.{divided};\n    \
             let bounds_{index} = view.shadows[{index}].bounds;\n    \
             let texel_{index} = vec2i(clamp(at_{index}.xy, bounds_{index}.xy, bounds_{index}.zw));\n    \
             if min(at_{index}.z, view.shadows[{index}].farthest.x) <= textureLoad(shadow_map_{index}, texel_{index}, 0).r{condition} {{\n        \
             color += {lit};\n    }}\n"
        );
    }
}

/// Returns the coordinates of a point in a shadow map, before the division.
fn projected(index: usize, world: &str) -> String {
    format!("view.shadows[{index}].texels * vec4f({world}, 1.0)")
}

/// Generates the function of a light: OpenGL's lighting model, which is Blinn–Phong with a local
/// viewer.
fn light_function(index: usize, light: LightFeatures) -> String {
    let mut body = String::new();
    if light.directional {
        body.push_str("    let to_light = light.position.xyz;\n");
    } else {
        body.push_str("    let offset = light.position.xyz - point.world;\n");
        body.push_str("    let squared_distance = max(dot(offset, offset), 1e-30);\n");
        body.push_str("    let inverse_distance = inverseSqrt(squared_distance);\n");
        body.push_str("    let to_light = offset * inverse_distance;\n");
    }
    let mut factors = Vec::new();
    if light.attenuated {
        body.push_str("    let distance = squared_distance * inverse_distance;\n");
        body.push_str("    let attenuation = light.attenuation.x + distance * (light.attenuation.y + distance * light.attenuation.z);\n");
        factors.push("1.0 / max(attenuation, 1e-20)");
    }
    if light.spot {
        body.push_str("    let cosine = -dot(to_light, light.axis.xyz);\n");
        let intensity = if light.focused { "power_of_square(cosine * cosine, light.axis.w)" } else { "1.0" };
        let _ = writeln!(body, "    let cone = select(0.0, {intensity}, cosine >= light.attenuation.w);");
        factors.push("cone");
    }
    body.push_str("    let n_dot_l = dot(point.normal, to_light);\n");
    body.push_str("    var color = point.rgb * (max(n_dot_l, 0.0) * light.diffuse.rgb");
    body.push_str(if light.ambient { " + light.ambient.rgb);\n" } else { ");\n" });
    if light.specular {
        body.push_str("    let half_vector = to_light + point.to_camera;\n");
        body.push_str("    let n_dot_h = max(dot(point.normal, half_vector), 0.0);\n");
        body.push_str("    let squared_cosine = n_dot_h * n_dot_h / max(dot(half_vector, half_vector), 1e-20);\n");
        body.push_str(
            "    let highlight = select(0.0, power_of_square(squared_cosine, point.material.z), n_dot_l > 0.0);\n",
        );
        body.push_str("    color += highlight * point.material.y * light.specular.rgb;\n");
    }
    let factor = if factors.is_empty() { String::new() } else { format!(" * ({})", factors.join(" * ")) };
    format!(
        "fn light_{index}(point: SurfacePoint) -> vec3f {{\n    let light = view.lights[{index}];\n{body}    return color{factor};\n}}\n"
    )
}
