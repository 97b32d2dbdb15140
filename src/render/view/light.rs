//! Active lights and their shadow projections.

use super::ViewFrustum;
use super::matrix::{Matrix4, look_to, orthographic, perspective, product, unit};
use crate::numerics::spatial::{cross, dot};
use crate::render::settings::{VisualSettings, accepted, is_drawable};
use crate::scene::{RenderFlags, Scene, SceneLight};

/// Maximum number of shadow-casting lights. Each one needs a texture, and adapters guarantee only
/// 16 textures per shader stage.
pub(crate) const MAX_SHADOWS: usize = 8;

/// A headlight follows the viewpoints and the transform that a program sets after an update, as in
/// the images of engines before 3.2. From 3.2 on it remains where the update or
/// [`Scene::update_lights`] has put it.
const HEADLIGHT_FOLLOWS: bool = cfg!(not(engine_since = "3.2.0"));

/// Features of a light for which the shader is specialised, instead of branching at run time.
#[allow(clippy::struct_excessive_bools, reason = "each is an independent switch")]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(crate) struct LightFeatures {
    pub(crate) directional: bool,
    /// Distance attenuation.
    pub(crate) attenuated: bool,
    /// Cutoff at the edge of a cone.
    pub(crate) spot: bool,
    /// Intensity falls off towards the edge of the cone (non-zero spot exponent).
    pub(crate) focused: bool,
    pub(crate) ambient: bool,
    pub(crate) specular: bool,
    pub(crate) shadow: bool,
}

impl LightFeatures {
    /// Returns the features that one of two lights has, for a shader that draws both. `None` if
    /// they need different shaders: directional and other lights, or with and without shadows.
    pub(crate) fn union(self, other: Self) -> Option<Self> {
        let Self { directional, attenuated, spot, focused, ambient, specular, shadow } = self;
        ((directional, shadow) == (other.directional, other.shadow)).then_some(Self {
            directional,
            attenuated: attenuated || other.attenuated,
            spot: spot || other.spot,
            focused: focused || other.focused,
            ambient: ambient || other.ambient,
            specular: specular || other.specular,
            shadow,
        })
    }
}

/// Light of the scene, validated.
#[derive(Debug, Clone)]
pub(crate) struct ActiveLight {
    pub(crate) features: LightFeatures,
    pub(crate) light: SceneLight,
    /// Projection from world space to the clip space of the shadow map; `None` for a light without
    /// shadows.
    pub(crate) shadow: Option<Matrix4>,
}

/// Active lights of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lights {
    pub(crate) active: Vec<ActiveLight>,
    /// The scene has no lights that are drawn, and is rendered with ambient light.
    pub(crate) ambient_only: bool,
}

impl Lights {
    /// Collects the first `max_lights` lights of a scene, except lights with invalid values.
    pub(crate) fn new(
        scene: &Scene,
        frustum: &ViewFrustum,
        settings: &VisualSettings,
        has_shadows: bool,
        max_lights: Option<usize>,
    ) -> Self {
        let has_shadows = has_shadows && scene.render_flags().contains(RenderFlags::SHADOW);
        let mut shadows = 0;
        let mut active = Vec::new();
        for (index, mut light) in scene.lights().enumerate().take(max_lights.unwrap_or(usize::MAX)) {
            if HEADLIGHT_FOLLOWS && index == 0 && light.headlight {
                light.pos = frustum.position.map(|coordinate| coordinate as f32);
                light.dir = frustum.forward.map(|coordinate| coordinate as f32);
            }
            if light.shines_along_view {
                light.dir = frustum.forward.map(|coordinate| coordinate as f32);
                (light.directional, light.castshadow) = (true, false);
            }
            let Some(mut features) = sanitise(&mut light).filter(|_| light.drawn) else { continue };
            let mut shadow = None;
            if has_shadows && light.castshadow && shadows < MAX_SHADOWS {
                shadow = shadow_matrix(&light, frustum, settings);
            }
            features.shadow = shadow.is_some();
            shadows += usize::from(features.shadow);
            active.push(ActiveLight { features, light, shadow });
        }
        Self { ambient_only: !scene.lights().any(|light| light.drawn), active }
    }

    /// Iterates over the features of all lights.
    pub(crate) fn features(&self) -> impl Iterator<Item = LightFeatures> + Clone + '_ {
        self.active.iter().map(|light| light.features)
    }

    /// Iterates over the shadow projections of the lights that cast shadows.
    pub(crate) fn shadows(&self) -> impl Iterator<Item = &Matrix4> + '_ {
        self.active.iter().filter_map(|light| light.shadow.as_ref())
    }
}

/// Constant, linear and quadratic attenuation of a light that is as bright at all distances.
const NO_ATTENUATION: [f32; 3] = [1.0, 0.0, 0.0];

/// Replaces the parameters of a light that OpenGL rejects and returns its features, or `None` if a
/// parameter cannot be rendered.
fn sanitise(light: &mut SceneLight) -> Option<LightFeatures> {
    let colors = light.ambient.iter().chain(&light.diffuse).chain(&light.specular);
    let mut numbers = light.pos.iter().chain(&light.dir).chain(&light.attenuation).chain(colors);
    if !numbers.all(|&number| is_drawable(number)) {
        return None;
    }
    if light.directional {
        light.attenuation = NO_ATTENUATION;
        light.exponent = 0.0;
    }
    light.exponent = accepted(light.exponent, 0.0..=128.0, 0.0);
    for (coefficient, initial) in light.attenuation.iter_mut().zip(NO_ATTENUATION) {
        *coefficient = accepted(*coefficient, 0.0..=f32::MAX, initial);
    }
    let is_spot = !light.directional && (0.0..=90.0).contains(&light.cutoff);
    Some(LightFeatures {
        directional: light.directional,
        attenuated: light.attenuation != NO_ATTENUATION,
        spot: is_spot,
        focused: is_spot && light.exponent > 0.0,
        ambient: light.ambient != [0.0; 3],
        specular: light.specular != [0.0; 3],
        shadow: false,
    })
}

/// Computes the projection from world space to the clip space of a shadow map.
fn shadow_matrix(light: &SceneLight, frustum: &ViewFrustum, settings: &VisualSettings) -> Option<Matrix4> {
    let (pos, dir) = (light.pos.map(f64::from), light.dir.map(f64::from));
    let projection = if light.directional {
        if settings.shadow_clip <= 0.0 {
            return None;
        }
        let half = settings.shadow_clip;
        orthographic([-half, half], [-half, half], frustum.range)
    } else {
        let angle = (2.0 * f64::from(light.cutoff) * settings.shadow_scale).min(160.0);
        if angle.is_nan() || angle <= 0.0 {
            return None;
        }
        let half = (angle / 2.0).to_radians().tan() * frustum.range[0];
        perspective([-half, half], [-half, half], frustum.range)
    };
    let view = look_to(pos, dir, perpendicular(dir));
    let matrix = product(&projection, &view);
    matrix.as_flattened().iter().all(|&number| is_drawable(number as f32)).then_some(matrix)
}

/// Returns a unit vector perpendicular to a direction.
fn perpendicular(direction: [f64; 3]) -> [f64; 3] {
    let across = cross(&direction, &[-1.0, 0.0, 0.0]);
    unit(if dot(&across, &across) > 0.01 { across } else { cross(&direction, &[0.0, 1.0, 0.0]) })
}
