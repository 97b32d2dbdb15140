//! A skin, of which the corners are in the world's frame.

use super::Part;
use crate::id::SkinId;
use crate::render::content::Shapes;

pub(super) fn part(skin: SkinId, shapes: &Shapes) -> Option<Part> {
    Some(Part::new(shapes.skin(skin.index())?, [1.0; 3]))
}
