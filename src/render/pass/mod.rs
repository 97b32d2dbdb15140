//! How a list is drawn.
//!
//! | file | what is in it |
//! |---|---|
//! | `pipeline.rs` | programs with all that is set around them, made when they are first needed |
//! | `target.rs` | the textures that are drawn to |
//! | `shadow.rs` | shadow maps |
//! | `scenery.rs` | everything that is seen, in one pass |
//! | `sky.rs` | the sky and the haze, and whether they are seen |
//! | `label.rs` | texts |
//! | `numbers.rs` | numbers and depths of geoms |
//! | `memory.rs` | buffers that grow |

mod draw;
mod label;
mod memory;
pub(crate) mod numbers;
mod pipeline;
mod scenery;
mod shadow;
mod sky;
mod target;

pub(crate) use self::draw::Draw;
pub(crate) use self::label::Labels;
pub(crate) use self::memory::Memory;
pub(crate) use self::numbers::Ids;
pub(crate) use self::pipeline::{Key, Pipelines, Step};
pub(crate) use self::scenery::{Canvas, Frame, Scenes};
pub(crate) use self::shadow::Shadows;
pub(crate) use self::sky::Sky;
pub(crate) use self::target::{COLOR, Target, check_size, texture, view};
