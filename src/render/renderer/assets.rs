//! Resources of a model that all images of a renderer share.

use crate::id::Lineage;
use crate::render::assets::{Shapes, Textures};
use crate::render::bounding_volume::AssetBounds;
use crate::render::draw_list::DrawCalls;
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::pass::{DrawContext, TileView};
use crate::render::settings::VisualSettings;
use crate::render::{Gpu, RendererOptions};

/// Resources of a model, and the options of its renderer.
pub(super) struct Assets {
    pub(super) gpu: Gpu,
    pub(super) lineage: Lineage,
    pub(super) settings: VisualSettings,
    pub(super) options: RendererOptions,
    pub(super) bounds: AssetBounds,
    pub(super) shapes: Shapes,
    pub(super) textures: Textures,
    /// The images of a batch are drawn together.
    pub(super) merges: bool,
}

impl Assets {
    /// Returns the resources of draw calls, of which the tiles of large planes are selected for
    /// these views, if there are any.
    pub(super) fn draw_context<'a>(
        &'a self,
        calls: &'a DrawCalls,
        instances: &'a GrowableBuffer,
        tiles: Option<&'a [TileView<'a>]>,
    ) -> DrawContext<'a> {
        let Self { gpu, shapes, textures, .. } = self;
        DrawContext { gpu, shapes, textures, calls, instances: instances.buffer(), tiles }
    }
}
