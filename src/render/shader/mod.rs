//! The programs of the graphics card: text that is put together for what a picture needs, so that they ask nothing while they run.
//! On a processor that draws, a loop over lights costs more than all else.
//!
//! | file | what is in it |
//! |---|---|
//! | `view.wgsl`, `instance.wgsl`, `light.wgsl` | what the others share |
//! | `surface.wgsl` | surfaces in the light |
//! | `line.wgsl` | lines |
//! | `depth.wgsl` | places only |
//! | `sky.wgsl` | the sky and the haze |
//! | `label.wgsl` | text |
//! | `light.rs` | the text for each light |
//! | `part.rs` | which lines of a text are used |

mod light;
mod part;

use super::frame::LightKind;

/// What a program draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Subject {
    Surface,
    Line,
    /// Only the place of surfaces.
    Depth,
    Sky,
    Label,
}

/// What a program gives for each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Output {
    Color,
    /// The number of the geom, and its depth.
    Ids,
    /// Only what every program gives: the depth within the frustum.
    Nothing,
}

/// The picture on a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Coat {
    Plain,
    Flat,
    Cube,
}

/// Where light is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Shade {
    /// Nowhere: colours are as they are.
    None,
    Vertex,
    Pixel,
}

/// What a program is written for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Program<'a> {
    pub(crate) subject: Subject,
    pub(crate) output: Output,
    pub(crate) coat: Coat,
    pub(crate) shade: Shade,
    pub(crate) lights: &'a [LightKind],
    pub(crate) fog: bool,
    /// Whether what is behind a plane is left out.
    pub(crate) clip: bool,
}

/// So many lights can cast shadows where light is computed at vertices: more do not fit between a vertex and a pixel.
const MOST_VERTEX_SHADOWS: usize = 5;

impl Program<'_> {
    /// Whether it computes light.
    fn is_lit(&self) -> bool {
        self.subject == Subject::Surface && self.output == Output::Color && self.shade != Shade::None
    }

    /// Whether it reads the colours of instances, and their numbers. Lines have both.
    fn instance(&self) -> [bool; 2] {
        [Output::Color, Output::Ids].map(|output| match self.subject {
            Subject::Line => true,
            subject => subject == Subject::Surface && self.output == output,
        })
    }

    /// Whether it reads what is at a location of a corner or an instance: `instance.wgsl` says the same. Some drivers spend time on
    /// each that is there.
    pub(crate) fn reads(&self, location: u32) -> bool {
        match location {
            1 | 7 => self.is_lit(),
            2 | 8 => self.coat != Coat::Plain,
            6 => self.instance()[0],
            9 => self.instance()[1],
            _ => true,
        }
    }

    /// Its text.
    pub(crate) fn source(&self) -> String {
        let is_lit = self.is_lit();
        let shadows = if is_lit { self.lights.iter().filter(|light| light.shadow).count() } else { 0 };
        let shade = match self.shade {
            Shade::Vertex if shadows > MOST_VERTEX_SHADOWS => Shade::Pixel,
            shade => shade,
        };
        let flags = [
            ("COLOR", self.output == Output::Color),
            ("IDS", self.output == Output::Ids),
            ("COLORED", self.instance()[0]),
            ("NUMBERED", self.instance()[1]),
            ("LIT", is_lit),
            ("LIGHTS", is_lit && !self.lights.is_empty()),
            ("SHADOWS", shadows > 0),
            ("VERTEX_LIGHT", is_lit && shade == Shade::Vertex),
            ("PIXEL_LIGHT", is_lit && shade == Shade::Pixel),
            ("FLAT", !is_lit),
            ("TEXTURE_FLAT", self.coat == Coat::Flat),
            ("TEXTURE_CUBE", self.coat == Coat::Cube),
            ("TEXTURED", self.coat != Coat::Plain),
            ("FOG", self.fog),
            ("CLIP", self.clip),
        ];
        let files: &[&str] = match self.subject {
            Subject::Surface => &[LIGHT, VIEW, INSTANCE, SURFACE],
            Subject::Line => &[VIEW, INSTANCE, include_str!("line.wgsl")],
            Subject::Depth => &[VIEW, INSTANCE, include_str!("depth.wgsl")],
            Subject::Sky => &[VIEW, include_str!("sky.wgsl")],
            Subject::Label => &[VIEW, include_str!("label.wgsl")],
        };
        let lights = if is_lit { light::texts(self.lights, shade) } else { light::Texts::default() };
        let mut text = part::chosen(files, &flags, &lights.inserts());
        if is_lit {
            text.push_str(&lights.functions);
        }
        text.replace("LIGHT_COUNT", &self.lights.len().to_string()).replace("SHADOW_COUNT", &shadows.to_string())
    }
}

const VIEW: &str = include_str!("view.wgsl");
const INSTANCE: &str = include_str!("instance.wgsl");
const LIGHT: &str = include_str!("light.wgsl");
const SURFACE: &str = include_str!("surface.wgsl");

#[cfg(test)]
mod tests;
