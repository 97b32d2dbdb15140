//! The text for each light, with nothing in it that the light does not do.

use std::fmt::Write;

use super::Shade;
use crate::render::frame::LightKind;

/// What a program says about lights.
#[derive(Debug, Default)]
pub(super) struct Texts {
    pub(super) functions: String,
    between: String,
    vertex_light: String,
    vertex_shadow: String,
    fragment_shadow: String,
}

/// The first locations between a vertex and a pixel that shadows take.
const SHADOW_LOCATION: usize = 7;

pub(super) fn texts(kinds: &[LightKind], shade: Shade) -> Texts {
    let mut texts = Texts::default();
    let mut unshadowed = String::new();
    let shadows = kinds.iter().filter(|kind| kind.shadow).count();
    let mut shadow = 0;
    for (index, kind) in kinds.iter().enumerate() {
        texts.functions.push_str(&function(index, *kind));
        if kind.shadow {
            texts.shadow(index, shadow, shadows, *kind, shade);
            shadow += 1;
        } else {
            let _ = writeln!(unshadowed, "    color += light_{index}(point);");
        }
    }
    let _ = write!(
        texts.functions,
        "fn unshadowed(point: Point) -> vec3f {{\n    var color = point.rgb * (point.material.x + view.ambient.rgb);\n\
         {unshadowed}    return clamp(color, vec3f(0.0), vec3f(1.0));\n}}\n"
    );
    texts
}

impl Texts {
    /// What takes the place of which line.
    pub(super) fn inserts(&self) -> [(&'static str, &str); 4] {
        [
            ("between", &self.between),
            ("vertex_light", &self.vertex_light),
            ("vertex_shadow", &self.vertex_shadow),
            ("fragment_shadow", &self.fragment_shadow),
        ]
    }

    /// A light whose shadow is looked up.
    fn shadow(&mut self, light: usize, index: usize, count: usize, kind: LightKind, shade: Shade) {
        let _ = writeln!(self.functions, "@group(0) @binding({}) var shadow_map_{index}: texture_2d<f32>;", index + 1);
        let _ = writeln!(self.between, "    @location({}) shadow_{index}: vec4f,", SHADOW_LOCATION + index);
        let _ =
            writeln!(self.vertex_shadow, "    out.shadow_{index} = view.shadows[{index}].texels * vec4f(world, 1.0);");
        let lit = format!("clamp(light_{light}(point), vec3f(0.0), vec3f(1.0))");
        let lit = if shade == Shade::Vertex {
            // The free locations below those of the shadows, then those above.
            let location = if index < 3 { index + 1 } else { SHADOW_LOCATION + count + index - 3 };
            let _ = writeln!(self.between, "    @location({location}) lit_{index}: vec3f,");
            let _ = writeln!(self.vertex_light, "    out.lit_{index} = {lit};");
            format!("in.lit_{index}")
        } else {
            lit
        };
        // A directional light looks along parallels.
        let point =
            if kind.directional { "xyz" } else { "xyz / in.shadow_INDEX.w" }.replace("INDEX", &index.to_string());
        let _ = write!(
            self.fragment_shadow,
            "    let at_{index} = in.shadow_{index}.{point};\n    \
             let texel_{index} = vec2i(clamp(at_{index}.xy, vec2f(0.0), view.shadows[{index}].last.xy));\n    \
             if min(at_{index}.z, view.shadows[{index}].last.z) <= textureLoad(shadow_map_{index}, texel_{index}, 0).r {{\n        \
             color += {lit};\n    }}\n"
        );
    }
}

/// What a light adds to a point, as OpenGL has it: Blinn's model, seen from where the eye is.
fn function(index: usize, kind: LightKind) -> String {
    let mut body = String::new();
    if kind.directional {
        body.push_str("    let toward = light.place.xyz;\n");
    } else {
        body.push_str("    let way = light.place.xyz - point.world;\n");
        body.push_str("    let distance = sqrt(max(dot(way, way), 1e-30));\n");
        body.push_str("    let toward = way / distance;\n");
    }
    let mut strength = Vec::new();
    if kind.attenuated {
        body.push_str("    let weaker = light.attenuation.x + distance * (light.attenuation.y + distance * light.attenuation.z);\n");
        strength.push("1.0 / max(weaker, 1e-20)");
    }
    if kind.spot {
        body.push_str("    let along = -dot(toward, light.axis.xyz);\n");
        let within = if kind.focused { "pow(max(along, 1e-9), light.axis.w)" } else { "1.0" };
        let _ = writeln!(body, "    let cone = select(0.0, {within}, along >= light.attenuation.w);");
        strength.push("cone");
    }
    body.push_str("    let facing = dot(point.normal, toward);\n");
    body.push_str("    var color = point.rgb * (max(facing, 0.0) * light.diffuse.rgb");
    body.push_str(if kind.ambient { " + light.ambient.rgb);\n" } else { ");\n" });
    if kind.specular {
        body.push_str("    let middle = toward + point.eye;\n");
        body.push_str(
            "    let glance = max(dot(point.normal, middle) * inverseSqrt(max(dot(middle, middle), 1e-20)), 1e-9);\n",
        );
        body.push_str("    let gloss = select(0.0, pow(glance, point.material.z), facing > 0.0);\n");
        body.push_str("    color += gloss * point.material.y * light.specular.rgb;\n");
    }
    let strength = if strength.is_empty() { String::new() } else { format!(" * ({})", strength.join(" * ")) };
    format!(
        "fn light_{index}(point: Point) -> vec3f {{\n    let light = view.lights[{index}];\n{body}    return color{strength};\n}}\n"
    )
}
