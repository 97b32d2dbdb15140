//! Pictures of a [`Scene`](crate::scene::Scene), drawn by wgpu: no window, no display, no OpenGL context.
//!
//! | file | what is in it |
//! |---|---|
//! | `gpu/` | the graphics adapter |
//! | `shape/` | vertices of the basic shapes, and of the model's meshes, hulls, height fields and skins |

#![forbid(unsafe_code)]

mod error;
mod gpu;
mod options;
mod renderer;
pub(crate) mod shape;

pub use self::error::RenderError;
pub use self::gpu::{Gpu, GpuKind, GpuOptions, GpuPreference, own_device};
pub use self::options::{Lighting, RendererOptions};
pub use self::renderer::Renderer;
