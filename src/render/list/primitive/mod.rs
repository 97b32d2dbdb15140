//! What each primitive is made of: shapes of unit size, stretched and moved along the geom's z-axis.
//!
//! One primitive, one file.

mod arrow;
mod capsule;
mod cuboid;
mod cylinder;
mod height_field;
mod line;
mod mesh;
mod plane;
mod skin;
mod sphere;

use crate::render::content::{Level, Round, Shapes};
use crate::scene::{SceneGeom, SceneGeomType, SceneObject};

/// A shape in the frame of a geom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) shape: u32,
    /// How long it is along each axis of the geom. Where y and z are negative it is turned by half a turn about x.
    pub(super) scale: [f32; 3],
    /// How far it is moved along z, m.
    pub(super) shift: f32,
    /// From the shape's own coordinates to those that a texture is put on by: a scale, and a shift along z.
    pub(super) wrap: [f32; 3],
    pub(super) lift: f32,
}

impl Part {
    fn new(shape: u32, scale: [f32; 3]) -> Self {
        Self { shape, scale, shift: 0.0, wrap: [1.0; 3], lift: 0.0 }
    }

    /// Moved along z.
    fn shifted(self, shift: f32) -> Self {
        Self { shift, ..self }
    }

    /// As seen by a texture.
    fn lifted(self, lift: f32) -> Self {
        Self { lift, ..self }
    }

    /// Turned by half a turn about x, before it is moved.
    fn turned(self) -> Self {
        let turned = |[across, along, upward]: [f32; 3]| [across, -along, -upward];
        Self { scale: turned(self.scale), wrap: turned(self.wrap), ..self }
    }
}

/// The shapes of a geom, at a level of detail, added to `parts`. None for one without a shape, or with one that the model has not.
pub(super) fn parts(geom: SceneGeom<'_>, shapes: &Shapes, level: Level, parts: &mut Vec<Part>) {
    let round = |shape: Round| shapes.round(shape, level);
    let size = geom.size();
    match geom.geom_type() {
        SceneGeomType::Plane => parts.push(plane::part(geom, shapes)),
        SceneGeomType::HeightField => parts.extend(height_field::part(geom, shapes)),
        SceneGeomType::Sphere | SceneGeomType::Ellipsoid => parts.push(sphere::part(size, round)),
        SceneGeomType::Capsule => parts.extend(capsule::parts(size, round)),
        SceneGeomType::Cylinder => parts.extend(cylinder::parts(size, round)),
        SceneGeomType::Box => parts.push(cuboid::part(size, shapes)),
        SceneGeomType::Mesh => parts.extend(mesh::part(geom, shapes)),
        SceneGeomType::Arrow => parts.extend(arrow::parts(size, arrow::WEDGE, round)),
        SceneGeomType::Arrow1 => parts.extend(arrow::parts(size, 1.0, round)),
        SceneGeomType::Arrow2 => parts.extend(arrow::double(size, round)),
        SceneGeomType::Line => parts.push(line::part(size, shapes)),
        SceneGeomType::Skin => {
            if let Some(SceneObject::Skin(skin)) = geom.object() {
                parts.extend(skin::part(skin, shapes));
            }
        }
        SceneGeomType::Label | SceneGeomType::None => {}
    }
}

/// The side of a cylinder, which is cut into more pieces where it is long.
fn side(size: [f32; 3], round: impl Fn(Round) -> u32) -> Part {
    let [x, y, z] = size;
    Part::new(round(if z > 10.0 * x.max(y) { Round::LongSide } else { Round::Side }), size)
}

#[cfg(test)]
mod tests;
