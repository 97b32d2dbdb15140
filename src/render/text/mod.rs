//! Texts: labels of things, and whatever is written onto a picture.
//!
//! The font is Noto Sans Mono, from the crate `noto-sans-mono-bitmap`: its letters are small images, all of one size. They lie
//! beside each other in one image, the atlas, and a text is a row of rectangles that show pieces of it.
//!
//! | file | what is in it |
//! |---|---|
//! | `atlas.rs` | the letters, and their halos |
//! | `layout.rs` | where the letters of a text are |

mod atlas;
mod layout;

pub(crate) use self::atlas::{Atlas, CELL};
pub(crate) use self::layout::{Quad, Style, quads};
