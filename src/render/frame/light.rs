//! Lights, and from where they cast shadows.

use super::Eye;
use super::matrix::{Matrix4, cross, dot, frustum, look, orthographic, product, unit};
use crate::render::settings::{Settings, is_drawable};
use crate::scene::{RenderFlags, Scene, SceneLight};

/// How many lights cast shadows at most: each needs a texture, and an adapter may have no more than 16 in a program.
pub(crate) const MOST_SHADOWS: usize = 8;

/// What a light does that others do not. Programs are written for the kinds of the lights, so that they need not ask.
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(crate) struct LightKind {
    pub(crate) directional: bool,
    /// Whether it is weaker farther away.
    pub(crate) attenuated: bool,
    /// Whether it shines within a cone only.
    pub(crate) spot: bool,
    /// Whether it is stronger in the middle of its cone.
    pub(crate) focused: bool,
    pub(crate) ambient: bool,
    pub(crate) specular: bool,
    pub(crate) shadow: bool,
}

/// A light that shines.
#[derive(Debug, Clone)]
pub(crate) struct Lamp {
    pub(crate) kind: LightKind,
    pub(crate) light: SceneLight,
    /// From the world to the cube that its shadow map shows.
    pub(crate) shadow: Option<Matrix4>,
}

/// The lights of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lights {
    pub(crate) lamps: Vec<Lamp>,
    /// Whether the scene has none at all, in which case everything glimmers.
    pub(crate) is_dark: bool,
}

impl Lights {
    /// Those of a scene, without those that are nowhere.
    pub(crate) fn new(scene: &Scene, eye: &Eye, settings: &Settings, has_shadows: bool) -> Self {
        let has_shadows = has_shadows && scene.render_flags().contains(RenderFlags::SHADOW);
        let mut shadows = 0;
        let mut lamps = Vec::new();
        for (index, mut light) in scene.lights().enumerate() {
            if index == 0 && light.headlight {
                light.pos = eye.head.map(|coordinate| coordinate as f32);
                light.dir = eye.gaze.map(|coordinate| coordinate as f32);
            }
            let Some(mut kind) = kind(&mut light) else { continue };
            let mut shadow = None;
            if has_shadows && light.castshadow && shadows < MOST_SHADOWS {
                shadow = shadow_matrix(&light, eye, settings);
            }
            kind.shadow = shadow.is_some();
            shadows += usize::from(kind.shadow);
            lamps.push(Lamp { kind, light, shadow });
        }
        Self { is_dark: scene.lights().len() == 0, lamps }
    }

    /// The kinds, for a program.
    pub(crate) fn kinds(&self) -> impl Iterator<Item = LightKind> + Clone + '_ {
        self.lamps.iter().map(|lamp| lamp.kind)
    }

    /// Those that cast shadows.
    pub(crate) fn shadows(&self) -> impl Iterator<Item = &Matrix4> + '_ {
        self.lamps.iter().filter_map(|lamp| lamp.shadow.as_ref())
    }
}

/// What a light does; nothing if it is nowhere. Its numbers are brought into the ranges that OpenGL allows.
fn kind(light: &mut SceneLight) -> Option<LightKind> {
    let colors = light.ambient.iter().chain(&light.diffuse).chain(&light.specular);
    let mut numbers = light.pos.iter().chain(&light.dir).chain(&light.attenuation).chain(colors);
    if !numbers.all(|&number| is_drawable(number)) {
        return None;
    }
    if light.directional {
        light.attenuation = [1.0, 0.0, 0.0];
        light.exponent = 0.0;
    }
    light.exponent = if light.exponent.is_finite() { light.exponent.clamp(0.0, 128.0) } else { 0.0 };
    let is_spot = !light.directional && (0.0..=90.0).contains(&light.cutoff);
    Some(LightKind {
        directional: light.directional,
        attenuated: light.attenuation != [1.0, 0.0, 0.0],
        spot: is_spot,
        focused: is_spot && light.exponent > 0.0,
        ambient: light.ambient != [0.0; 3],
        specular: light.specular != [0.0; 3],
        shadow: false,
    })
}

/// From the world to the cube that the shadow map of a light shows.
fn shadow_matrix(light: &SceneLight, eye: &Eye, settings: &Settings) -> Option<Matrix4> {
    let (pos, dir) = (light.pos.map(f64::from), light.dir.map(f64::from));
    let projection = if light.directional {
        if settings.shadow_clip <= 0.0 {
            return None;
        }
        orthographic(settings.shadow_clip, eye.range)
    } else {
        let angle = (2.0 * f64::from(light.cutoff) * settings.shadow_scale).min(160.0);
        if angle.is_nan() || angle <= 0.0 {
            return None;
        }
        let half = (angle / 2.0).to_radians().tan() * eye.range[0];
        frustum([-half, half], [-half, half], eye.range)
    };
    let view = look(pos, dir, upright(dir));
    let matrix = product(&projection, &view);
    matrix.as_flattened().iter().all(|&number| is_drawable(number as f32)).then_some(matrix)
}

/// A direction at a right angle to another.
fn upright(direction: [f64; 3]) -> [f64; 3] {
    let across = cross(direction, [-1.0, 0.0, 0.0]);
    unit(if dot(across, across) > 0.01 { across } else { cross(direction, [0.0, 1.0, 0.0]) })
}
