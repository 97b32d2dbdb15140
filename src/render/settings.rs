//! Renderer options and the visual settings of a model.

use std::ops::RangeInclusive;

use crate::macros::with_methods;
use crate::model::Model;
use crate::shape::Tessellation;

/// Frequency of the lighting computation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Lighting {
    /// Per vertex, with interpolation between vertices (Gouraud shading), as in the engine's
    /// renderer. Images are equal to the engine's up to rounding.
    #[default]
    PerVertex,
    /// Per pixel (Phong shading): round highlights, and spotlights with sharp edges.
    PerPixel,
}

/// Options of a [`Renderer`](super::Renderer). All other settings are in the model's
/// [`Visual`](crate::model::Visual), which the renderer copies at construction, and in the scene's
/// [`RenderFlags`](crate::scene::RenderFlags).
///
/// ```
/// use mujoco_safe::render::{Lighting, RendererOptions};
///
/// let fast = RendererOptions::default().with_samples(1).with_shadow_size(1024);
/// let smooth = RendererOptions::default().with_lighting(Lighting::PerPixel);
/// assert_eq!((fast.samples, smooth.lighting), (Some(1), Lighting::PerPixel));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RendererOptions {
    /// MSAA samples per pixel: 1, 2, 4 or 8, subject to the adapter's support. `None` selects the
    /// model's [`offsamples`](crate::model::VisualQuality::offsamples).
    pub samples: Option<usize>,
    /// Width and height of shadow maps, texels; 0 disables shadows. `None` selects the model's
    /// [`shadowsize`](crate::model::VisualQuality::shadowsize). Maps are rendered with fewer texels
    /// for small images: see the [differences from the
    /// engine](crate::render#differences-from-the-engines-renderer).
    pub shadow_size: Option<usize>,
    /// Frequency of the lighting computation.
    pub lighting: Lighting,
    /// Number of active lights: the first lights of the scene, of which the first is the headlight,
    /// if it is active. `Some(8)` imitates the engine's renderer, in which OpenGL ignores the
    /// others. `None` selects all, of which the engine allows 100.
    pub max_lights: Option<usize>,
    /// Size of labels relative to lines of 16 pixels, for example the scale of a display. Values
    /// outside of 0.25 to 10 are limited to this range.
    #[doc(alias = "mjtFontScale")]
    pub font_scale: f64,
}

impl Default for RendererOptions {
    fn default() -> Self {
        Self { samples: None, shadow_size: None, lighting: Lighting::default(), max_lights: None, font_scale: 1.0 }
    }
}

with_methods!(RendererOptions {
    with_samples(samples: usize) = Some(samples),
    with_shadow_size(shadow_size: usize) = Some(shadow_size),
    with_lighting(lighting: Lighting),
    with_max_lights(max_lights: usize) = Some(max_lights),
    with_font_scale(font_scale: f64),
});

/// Both faces of a triangle cast shadows, as in the renderer of engines from 3.3, so that a
/// transparent solid casts a shadow on its contents. With other engines only back faces do, if back
/// faces are culled.
pub(crate) const ALL_FACES_CAST_SHADOWS: bool = cfg!(engine_since = "3.3.0");

/// Largest magnitude of a value that can be rendered. Its square is finite in single precision.
pub(crate) const MAX_MAGNITUDE: f32 = 1e15;

/// Returns `true` if a value is finite and not too large to be rendered.
pub(crate) fn is_drawable(number: f32) -> bool {
    number.abs() <= MAX_MAGNITUDE
}

/// Returns a parameter that OpenGL accepts. It rejects others, and keeps the initial value.
pub(crate) fn accepted(number: f32, range: RangeInclusive<f32>, initial: f32) -> f32 {
    if range.contains(&number) { number } else { initial }
}

/// Validated copy of the model's visual settings. The engine's compiler accepts any value for them.
#[derive(Debug, Clone)]
pub(crate) struct VisualSettings {
    /// Half-width of the orthographic shadow volume of directional lights, m.
    pub(crate) shadow_clip: f64,
    /// Fraction of a spotlight's cone that its shadow map covers.
    pub(crate) shadow_scale: f64,
    /// Depths at which fog starts and at which it is opaque, m.
    pub(crate) fog: [f32; 2],
    pub(crate) fog_color: [f32; 4],
    pub(crate) haze_color: [f32; 4],
    /// Radial width of the haze, as a fraction of the distance to the horizon.
    pub(crate) haze: f32,
    /// Number of slices of round shapes.
    pub(crate) slices: u32,
    /// Line width in wireframe mode, pixels.
    pub(crate) line_width: f32,
    /// Far plane of the model's own frustum, m.
    pub(crate) far: f64,
}

impl VisualSettings {
    /// Copies the settings, converts multiples of the model's extent to metres, and clamps invalid
    /// values.
    pub(crate) fn new(model: &Model) -> Self {
        let visual = model.visual();
        let extent = model.statistics().extent;
        let map = visual.map;
        let metres = |fraction: f32| {
            let metres = f64::from(fraction) * extent;
            if is_drawable(metres as f32) { metres } else { 0.0 }
        };
        let fraction = |number: f32| if number.is_finite() { number.clamp(0.0, 1.0) } else { 0.0 };
        Self {
            shadow_clip: metres(map.shadowclip),
            shadow_scale: f64::from(map.shadowscale),
            fog: [metres(map.fogstart) as f32, metres(map.fogend) as f32],
            fog_color: visual.rgba.fog.map(fraction),
            haze_color: visual.rgba.haze.map(fraction),
            // Above 1 the haze reaches beyond the camera. The limit keeps its positions finite.
            haze: if map.haze.is_finite() { map.haze.clamp(0.0, 1e3) } else { 0.0 },
            slices: Tessellation::of_model(model).slices,
            line_width: if visual.global.linewidth.is_finite() {
                visual.global.linewidth.clamp(0.1, 100.0)
            } else {
                1.0
            },
            far: metres(map.zfar),
        }
    }
}
