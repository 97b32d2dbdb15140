//! WGSL shaders, specialised for each frame's lights, textures and output. Specialisation avoids
//! branches and loops at run time: on a software rasteriser a loop over lights would dominate the
//! cost of a frame.
//!
//! A preprocessor selects lines of the `.wgsl` files: those between `//#if NAME` and `//#end`
//! remain if the flag is set, and a line `//#name` is replaced by generated code.

mod lighting;
mod merged;

use std::fmt::Write;

use self::lighting::LightingCode;
use super::view::LightFeatures;

/// Shader program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum ShaderKind {
    Surface,
    Line,
    /// Depth of surfaces only.
    Depth,
    /// Skybox, optionally with haze.
    Sky {
        haze: bool,
    },
    Label,
}

/// Output of the fragment shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Output {
    Color,
    /// Geom id and depth in metres.
    Ids,
    /// No fragment shader.
    DepthOnly,
}

/// Kind of the texture of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum TextureKind {
    None,
    D2,
    Cube,
}

/// Stage of the lighting computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Shading {
    /// No lighting.
    None,
    Vertex,
    Pixel,
}

/// Parameters of shader specialisation.
#[allow(clippy::struct_excessive_bools, reason = "each is an independent switch")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShaderVariant<'a> {
    pub(crate) kind: ShaderKind,
    pub(crate) output: Output,
    pub(crate) texture_kind: TextureKind,
    pub(crate) shading: Shading,
    pub(crate) lights: &'a [LightFeatures],
    pub(crate) fog: bool,
    /// Colours are blended by their opacity.
    pub(crate) blended: bool,
    /// Fragments on the diagonals of quadrilaterals are discarded.
    pub(crate) quad_edges: bool,
    /// Fragments behind the clipping plane are discarded.
    pub(crate) clip: bool,
    /// The image has one sample per pixel.
    pub(crate) aliased: bool,
    /// Several images are drawn together, whose views are in an array: number of vectors of four
    /// numbers in a view.
    pub(crate) vectors: Option<u32>,
}

impl ShaderVariant<'_> {
    /// Returns `true` if the shader computes lighting.
    pub(crate) fn is_lit(&self) -> bool {
        self.kind == ShaderKind::Surface && self.output == Output::Color && self.shading != Shading::None
    }

    /// Returns `true` if each shadow map adds the colour of a line once more where its light
    /// shines, as in the engine's images: it draws opaque geoms once more for each shadow map, and
    /// does not light lines.
    fn adds_lines(&self) -> bool {
        self.kind == ShaderKind::Line && self.output == Output::Color && !self.blended
    }

    /// Returns `true` if the shader reads the lights of the view.
    pub(crate) fn has_lights(&self) -> bool {
        self.is_lit() || self.adds_lines()
    }

    /// Returns `true` if the shader reads an attribute of the instance that serves the given
    /// output. Lines read all attributes.
    fn reads_instance(&self, output: Output) -> bool {
        match self.kind {
            ShaderKind::Line => true,
            kind => kind == ShaderKind::Surface && self.output == output,
        }
    }

    /// Returns `true` if the shader reads the vertex or instance attribute at a location, as
    /// declared in `common.wgsl`. Unused attributes are removed from the pipeline because some
    /// drivers fetch them nevertheless.
    pub(crate) fn reads(&self, location: u32) -> bool {
        match location {
            1 | 10 => self.is_lit(),
            7 => self.is_lit() || self.kind == ShaderKind::Line,
            2 | 8 | 12 => self.texture_kind != TextureKind::None,
            11 => self.quad_edges,
            6 => self.reads_instance(Output::Color),
            9 => self.reads_instance(Output::Ids),
            13 => self.vectors.is_some(),
            _ => true,
        }
    }

    /// Generates the WGSL source.
    pub(crate) fn source(&self) -> String {
        let is_lit = self.is_lit();
        let has_lights = self.has_lights();
        let shadows = if has_lights { self.lights.iter().filter(|light| light.shadow).count() } else { 0 };
        let shading = self.shading;
        let file = match self.kind {
            ShaderKind::Surface => include_str!("surface.wgsl"),
            ShaderKind::Line => include_str!("line.wgsl"),
            ShaderKind::Depth => include_str!("depth.wgsl"),
            ShaderKind::Sky { .. } => include_str!("sky.wgsl"),
            ShaderKind::Label => include_str!("label.wgsl"),
        };
        let lights = if has_lights { self.lights.len() } else { 0 };
        let unread = merged::unread_vectors(self.vectors, lights, shadows);
        let flags = [
            ("SINGLE", self.vectors.is_none()),
            ("MERGED", self.vectors.is_some()),
            ("PADDED", unread > 0),
            ("COLOR", self.output == Output::Color),
            ("IDS", self.output == Output::Ids),
            ("INSTANCED", !matches!(self.kind, ShaderKind::Sky { .. } | ShaderKind::Label)),
            ("INSTANCE_COLOR", self.reads_instance(Output::Color)),
            ("INSTANCE_ID", self.reads_instance(Output::Ids)),
            ("LIT", is_lit),
            ("UNLIT", !is_lit),
            ("HAS_LIGHTS", has_lights),
            ("LIGHTS", has_lights && !self.lights.is_empty()),
            ("SHADOWS", shadows > 0),
            ("VERTEX_LIGHT", is_lit && shading == Shading::Vertex),
            ("PIXEL_LIGHT", is_lit && shading == Shading::Pixel),
            ("TEXTURE_2D", self.texture_kind == TextureKind::D2),
            ("NO_TEXTURE_2D", self.texture_kind != TextureKind::D2),
            ("TEXTURE_CUBE", self.texture_kind == TextureKind::Cube),
            ("TEXTURED", self.texture_kind != TextureKind::None),
            ("BLENDED", self.blended),
            ("OPAQUE", !self.blended),
            ("QUAD_EDGES", self.quad_edges),
            ("MATERIAL", self.reads(7)),
            ("FOG", self.fog),
            ("CLIP", self.clip),
            ("ALIASED", self.aliased),
            ("HAZE", self.kind == ShaderKind::Sky { haze: true }),
        ];
        let is_textured = self.texture_kind == TextureKind::D2;
        let lighting = if is_lit {
            LightingCode::new(self.lights, shading, is_textured)
        } else if has_lights {
            LightingCode::of_line(self.lights)
        } else {
            LightingCode::default()
        };
        let mut source = preprocess(&[include_str!("common.wgsl"), file], &flags, &lighting.inserts());
        source.push_str(&lighting.functions);
        for (name, count) in [("LIGHT_COUNT", lights), ("SHADOW_COUNT", shadows), ("UNREAD_COUNT", unread)] {
            source = source.replace(name, &count.to_string());
        }
        if self.vectors.is_some() { merged::of_single_view(&source) } else { source }
    }
}

/// Selects and replaces lines according to flags and inserts, and removes comments.
fn preprocess(files: &[&str], flags: &[(&str, bool)], inserts: &[(&str, &str)]) -> String {
    let mut source = String::new();
    // Conditions of the open `if` blocks.
    let mut conditions = Vec::new();
    for line in files.iter().flat_map(|file| file.lines()) {
        let is_active = conditions.iter().all(|&condition| condition);
        let Some(directive) = line.trim_start().strip_prefix("//#") else {
            if is_active && !line.trim_start().starts_with("//") {
                let _ = writeln!(source, "{line}");
            }
            continue;
        };
        if let Some(name) = directive.strip_prefix("if ") {
            let flag = flags.iter().find(|(flag, _)| *flag == name);
            conditions.push(flag.unwrap_or_else(|| panic!("Bug: unknown shader flag {name}")).1);
        } else if directive == "end" {
            conditions.pop();
        } else if is_active {
            let insert = inserts.iter().find(|(insert, _)| *insert == directive);
            source.push_str(insert.unwrap_or_else(|| panic!("Bug: unknown shader insert {directive}")).1);
        }
    }
    assert!(conditions.is_empty(), "Bug: unterminated if in a shader");
    source
}

#[cfg(test)]
mod tests;
