//! A height field.

use super::Part;
use crate::render::content::Shapes;
use crate::scene::SceneGeom;

pub(super) fn part(geom: SceneGeom<'_>, shapes: &Shapes) -> Option<Part> {
    Some(Part::new(shapes.height_field(geom.height_field()?.index())?, [1.0; 3]))
}
