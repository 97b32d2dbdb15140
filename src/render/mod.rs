//! Pictures of a [`Scene`](crate::scene::Scene), drawn by wgpu: no window, no display, no OpenGL context.
//!
//! | file | what is in it |
//! |---|---|
//! | `gpu/` | the graphics adapter |
//! | `bound.rs` | how far geoms reach |
//! | `picture/` | [`Picture`], [`DepthPicture`], [`SegmentationPicture`]: arrays of pixels, and files of them |
//! | `shape/` | vertices of the basic shapes, and of the model's meshes, hulls, height fields and skins |
//! | `text/` | letters, and where they are in a text |
//! | `texture/` | the images of the model's textures, in all sizes |

#![forbid(unsafe_code)]

mod error;
mod gpu;
mod options;
mod renderer;

pub use self::error::RenderError;
pub use self::gpu::{Gpu, GpuKind, GpuOptions, GpuPreference, own_device};
pub use self::options::{Lighting, RendererOptions};
pub use self::renderer::Renderer;
#[allow(dead_code)]
pub(crate) mod bound;
#[allow(dead_code)]
mod picture;
#[allow(dead_code, unused_imports)]
pub(crate) mod shape;
#[allow(dead_code, unused_imports)]
pub(crate) mod text;
#[allow(dead_code)]
pub(crate) mod texture;

pub use self::picture::{DepthPicture, Picture, Segment, SegmentationPicture};
