//! A line, as wide everywhere on the picture.

use super::Part;
use crate::render::content::Shapes;

pub(super) fn part(size: [f32; 3], shapes: &Shapes) -> Part {
    Part::new(shapes.line(), [1.0, 1.0, size[2]])
}
