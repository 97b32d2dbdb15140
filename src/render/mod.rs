//! Pictures of a [`Scene`](crate::scene::Scene), drawn by wgpu: no window, no display, no OpenGL context.
//!
//! | file | what is in it |
//! |---|---|
//! | `gpu/` | the graphics adapter |
//! | `renderer.rs`, `options.rs` | [`Renderer`], [`RendererOptions`] |
//! | `picture/` | [`Picture`], [`DepthPicture`], [`SegmentationPicture`]: arrays of pixels, and files of them |
//! | `frame/` | from where a picture is drawn, and in which light |
//! | `list/` | what is drawn: the geoms of a scene as shapes in places, in order |
//! | `pass/` | how it is drawn: shadows, mirror images, sky, transparent things, numbers |
//! | `shader/` | the programs of the graphics card |
//! | `content/` | what of the model the graphics card keeps |
//! | `bound.rs` | how far geoms reach |
//! | `shape/` | vertices of the basic shapes, and of the model's meshes, hulls, height fields and skins |
//! | `text/` | letters, and where they are in a text |
//! | `texture/` | the images of the model's textures, in all sizes |

#![forbid(unsafe_code)]

mod bound;
mod content;
mod error;
mod frame;
mod gpu;
mod list;
mod options;
mod pass;
mod picture;
mod read_back;
mod renderer;
mod settings;
mod shader;
mod shape;
mod text;
mod texture;

pub use self::error::RenderError;
pub use self::gpu::{Gpu, GpuKind, GpuOptions, GpuPreference, own_device};
pub use self::options::{Lighting, RendererOptions};
pub use self::picture::{DepthPicture, Picture, Segment, SegmentationPicture};
pub use self::renderer::Renderer;

#[cfg(test)]
mod leak_tests;
