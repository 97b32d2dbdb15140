//! A plane: a square, or one of the model's, which may have no end.

use super::Part;
use crate::render::content::Shapes;
use crate::scene::SceneGeom;

pub(super) fn part(geom: SceneGeom<'_>, shapes: &Shapes) -> Part {
    let [x, y, _] = geom.size();
    let of_model = shapes.plane(geom.plane());
    let endless = shapes.endless();
    let half = |axis: usize, length: f32| match of_model {
        Some(plane) => plane.half[axis],
        None if length > 0.0 => length,
        None => endless.half[axis],
    };
    let half = [half(0, x), half(1, y)];
    let shape = match of_model {
        Some(plane) => plane.shape,
        None if x > 0.0 && y > 0.0 => shapes.square(),
        None => endless.shape,
    };
    let mut part = Part::new(shape, [half[0], half[1], 1.0]);
    // Textures are put on the model's planes by metres, and on others once for all of it.
    if of_model.is_some() || x <= 0.0 || y <= 0.0 {
        part.wrap = [half[0], half[1], 1.0];
    }
    part
}
