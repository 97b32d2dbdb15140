//! What of the model the graphics card keeps.
//!
//! | file | what is in it |
//! |---|---|
//! | `shapes.rs` | corners and triangles: of the basic shapes, of the model's planes, meshes, height fields and skins |
//! | `surface.rs` | one shape |
//! | `textures.rs` | pictures on surfaces, and of the sky |

mod shapes;
mod surface;
mod textures;

pub(crate) use self::shapes::{FINE, LEVELS, Level, Round, Shapes};
pub(crate) use self::surface::{Surface, Tile};
pub(crate) use self::textures::{Layouts, Textures};
