//! Pictures of a [`Scene`](crate::scene::Scene), drawn by wgpu: no window, no display, no OpenGL context.
//!
//! | file | what is in it |
//! |---|---|
//! | `shape/` | vertices of the basic shapes, and of the model's meshes, hulls, height fields and skins |

#![forbid(unsafe_code)]

pub(crate) mod shape;
