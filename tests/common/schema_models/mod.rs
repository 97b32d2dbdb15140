//! Models from the schema that the linked engine prints: every element and attribute, with values
//! that the engine accepts.
//!
//! [`attributes`] lists the attributes of the engine, and [`case`] returns a small model in which
//! one of them has a value that differs from the default and, if possible, changes the motion. The
//! values are in `values.txt`, the elements in `specimens.xml`, and the model around them in
//! `rig.xml`. An attribute or element that they lack is found by trying guesses. Everything is the
//! same in each run with the same engine.
//!
//! A program that wants the elements of plugins must load the plugins first.

#![allow(
    dead_code,
    unreachable_pub,
    unused_imports,
    reason = "included by several programs, each of which uses some of it"
)]

#[path = "../assets.rs"]
mod assets;
mod cases;
mod document;
mod flexes;
mod hostile;
mod schema;
mod specimens;
mod values;

use std::sync::OnceLock;

pub use self::cases::{Case, Effect, case, combination, excite, is_only_stored, load};
pub use self::document::Node;
pub use self::hostile::hostile;
pub use self::schema::{Attribute, Element, attributes, elements};

fn rig() -> Node {
    Node::parse(include_str!("rig.xml"))
}

/// Files that values of attributes name.
pub fn files() -> &'static [(&'static str, Vec<u8>)] {
    static FILES: OnceLock<Vec<(&str, Vec<u8>)>> = OnceLock::new();
    FILES.get_or_init(|| {
        let mut files = assets::all();
        files.push(("piece.xml", PIECE.into()));
        // Other contents of files that a folder of the compiler selects. Older engines compare
        // names without their path.
        if cfg!(engine_since = "3.0.0") {
            files.push(("other/meshes/solid.stl", twice_as_large(assets::stl())));
            files.push(("other/images/flat.png", assets::png(png::ColorType::Rgb, 1, 1, &[1, 2, 3])));
        }
        files
    })
}

/// A model that others attach.
const PIECE: &str = "<mujoco model='piece'><worldbody><frame name='place'><body name='piece' pos='-0.5 -0.5 0.5'><freejoint/>\
    <geom size='0.05'/></body></frame></worldbody></mujoco>";

/// Scales a binary STL.
fn twice_as_large(mut stl: Vec<u8>) -> Vec<u8> {
    for number in stl[84..].chunks_mut(50).flat_map(|face| face[12..48].chunks_mut(4)) {
        let value = 2.0 * f32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        number.copy_from_slice(&value.to_le_bytes());
    }
    stl
}
