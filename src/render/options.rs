//! How pictures are drawn.

/// Where light is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Lighting {
    /// At the corners of triangles, and between them interpolated, as the engine's own renderer does: its pictures are the same but
    /// for roundings.
    #[default]
    PerVertex,
    /// At each pixel: round highlights, and spots of light with clear edges.
    PerPixel,
}

/// How a [`Renderer`](super::Renderer) draws. What is not here is in the model's [`Visual`](crate::Visual) settings, which are taken
/// over when the renderer is made, and in the scene's [`RenderFlags`](crate::scene::RenderFlags).
///
/// ```
/// use mujoco_safe::render::{Lighting, RendererOptions};
///
/// let fast = RendererOptions::default().samples(1).shadow_size(1024);
/// let smooth = RendererOptions::default().lighting(Lighting::PerPixel);
/// assert_eq!((fast.samples, smooth.lighting), (Some(1), Lighting::PerPixel));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RendererOptions {
    /// Samples for a pixel, for smooth edges: 1, 2, 4 or 8, of which the adapter may not have all. `None` for the model's
    /// [`offsamples`](crate::model::VisualQuality::offsamples).
    pub samples: Option<u32>,
    /// Width and height of the maps that shadows are computed in, pixels; 0 for no shadows. `None` for the model's
    /// [`shadowsize`](crate::model::VisualQuality::shadowsize).
    pub shadow_size: Option<u32>,
    /// Where light is computed.
    pub lighting: Lighting,
}

impl RendererOptions {
    /// The default with another number of samples.
    #[must_use]
    pub fn samples(self, samples: u32) -> Self {
        Self { samples: Some(samples), ..self }
    }

    /// The default with shadow maps of another size.
    #[must_use]
    pub fn shadow_size(self, size: u32) -> Self {
        Self { shadow_size: Some(size), ..self }
    }

    /// The default with light computed elsewhere.
    #[must_use]
    pub fn lighting(self, lighting: Lighting) -> Self {
        Self { lighting, ..self }
    }
}
