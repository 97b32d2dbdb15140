//! GPU copies of the model's assets: vertex and index buffers of all shapes, textures with mip
//! maps, and the glyph atlas of labels.

mod font;
mod glyph_atlas;
mod level_of_detail;
mod mipmap;
mod plane;
mod shape_buffers;
mod shapes;
mod skin;
mod textures;

#[cfg(feature = "viewer")]
pub(crate) use self::font::{FontFile, font_for};
pub(crate) use self::glyph_atlas::{GlyphAtlas, PlacedGlyph};
pub(crate) use self::level_of_detail::{COLOR_LEVELS, DEPTH_LEVELS, DepthLevels, DetailLevel, RoundShape};
pub(crate) use self::shape_buffers::Tile;
pub(crate) use self::shapes::Shapes;
pub(crate) use self::textures::{TextureBindings, Textures, glyph_atlas};
