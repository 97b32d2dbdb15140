//! A box.

use super::Part;
use crate::render::content::Shapes;

pub(super) fn part(size: [f32; 3], shapes: &Shapes) -> Part {
    Part::new(shapes.cuboid(), size)
}
