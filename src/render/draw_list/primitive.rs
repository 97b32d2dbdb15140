//! Decomposition of geoms into parts: unit shapes that are scaled, and shifted along the z-axis of
//! the geom.

use super::level_of_detail::Detail;
use crate::element::Object;
use crate::render::assets::{RoundShape, Shapes};
use crate::render::bounding_volume::ARROWHEAD_SCALE;
use crate::scene::{SceneGeom, SceneGeomType};

/// Shape in the frame of a geom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) shape: u32,
    /// Scale along the axes of the geom. Negative y and z are a rotation by 180° about x.
    pub(super) scale: [f32; 3],
    /// Translation along z, m.
    pub(super) shift: f32,
    /// Scale from the local positions of the shape to those used for texture coordinates.
    pub(super) texture_scale: [f32; 3],
    /// Translation along z for texture coordinates.
    pub(super) texture_shift: f32,
    /// Scale and translation of the texture coordinates of the vertices.
    pub(super) texcoord_scale: [f32; 2],
    pub(super) texcoord_shift: [f32; 2],
    /// The part shows the texture of the geom.
    pub(super) is_textured: bool,
    /// All lights shine on the part, even in shadows.
    pub(super) is_unshadowed: bool,
    /// Ends of a line in the frame of the geom, m, instead of the scale and the translation.
    pub(super) edge: Option<[[f32; 3]; 2]>,
}

impl Part {
    fn new(shape: u32, scale: [f32; 3]) -> Self {
        Self {
            shape,
            scale,
            shift: 0.0,
            texture_scale: [1.0; 3],
            texture_shift: 0.0,
            texcoord_scale: [1.0; 2],
            texcoord_shift: [0.0; 2],
            is_textured: true,
            is_unshadowed: false,
            edge: None,
        }
    }

    /// Creates a line between two points in the frame of the geom.
    fn line(shape: u32, from: [f32; 3], to: [f32; 3]) -> Self {
        Self { edge: Some([from, to]), ..Self::new(shape, [1.0; 3]) }
    }

    /// Translates the part along z.
    fn shifted(self, shift: f32) -> Self {
        Self { shift, ..self }
    }

    /// Translates the texture coordinates along z.
    fn texture_shifted(self, texture_shift: f32) -> Self {
        Self { texture_shift, ..self }
    }

    /// Rotates a disk by 180° about x, before the translation. Its points keep their texture
    /// coordinates.
    fn flipped(self) -> Self {
        let flipped = |[x, y, z]: [f32; 3]| [x, -y, -z];
        Self {
            scale: flipped(self.scale),
            texture_scale: flipped(self.texture_scale),
            texcoord_scale: [1.0, -1.0],
            texcoord_shift: [0.0, 1.0],
            ..self
        }
    }

    /// Rotates a surface of revolution by 180° about x, before the translation. Its texture
    /// coordinates are again an angle about z and a coordinate that falls along z.
    fn reversed(self) -> Self {
        Self { texcoord_scale: [-1.0; 2], texcoord_shift: [1.0; 2], ..self.flipped() }
    }
}

/// Appends the parts of a geom at a level of detail. Appends nothing for a geom without a shape or
/// with an unknown asset.
///
/// `is_before_materials` states that neither this geom nor an opaque geom before it has a material.
/// The engine then disables the shadow map with the texture when it draws the edges and vertices of
/// a flex.
pub(super) fn parts(
    geom: SceneGeom<'_>,
    shapes: &Shapes,
    detail: Detail,
    is_before_materials: bool,
    parts: &mut Vec<Part>,
) {
    let round = |shape: RoundShape| shapes.round(shape, detail.round);
    let size = geom.size();
    let asset = |shape: u32| Part::new(shape, [1.0; 3]);
    match geom.geom_type() {
        SceneGeomType::Plane => parts.push(plane(geom, shapes)),
        SceneGeomType::HeightField => {
            let shape = geom.height_field().and_then(|field| shapes.height_field(field.index()));
            parts.extend(shape.map(asset));
        }
        SceneGeomType::Sphere | SceneGeomType::Ellipsoid => parts.push(Part::new(round(RoundShape::Sphere), size)),
        SceneGeomType::Capsule => parts.extend(capsule(size, round)),
        SceneGeomType::Cylinder => parts.extend(cylinder(size, round)),
        SceneGeomType::Box => parts.push(Part::new(shapes.cuboid(), size)),
        SceneGeomType::Mesh | SceneGeomType::Sdf => {
            let shape = geom.mesh().and_then(|mesh| {
                let mesh = mesh.index();
                if geom.shows_convex_hull() { shapes.hull(mesh) } else { shapes.mesh(mesh, detail.mesh) }
            });
            parts.extend(shape.map(asset));
        }
        SceneGeomType::Arrow => parts.extend(arrow(size, ARROWHEAD_SCALE, round)),
        SceneGeomType::Arrow1 => parts.extend(arrow(size, 1.0, round)),
        SceneGeomType::Arrow2 => parts.extend(double_arrow(size, round)),
        SceneGeomType::Line => parts.push(Part::line(shapes.line(), [0.0; 3], [0.0, 0.0, size[2]])),
        SceneGeomType::Skin => {
            if let Some(Object::Skin(skin)) = geom.object() {
                parts.extend(shapes.skin(skin.index()).map(asset));
            }
        }
        SceneGeomType::Flex => {
            let [faces, skeleton] = shapes.flex(geom);
            parts.extend(faces.map(asset));
            // The engine disables the texture for vertices and edges.
            let skeleton = skeleton.map(asset);
            parts.extend(skeleton.map(|part| Part { is_textured: false, is_unshadowed: is_before_materials, ..part }));
        }
        SceneGeomType::LineBox => parts.extend(edges(size).map(|[from, to]| Part::line(shapes.line(), from, to))),
        SceneGeomType::Triangle => parts.push(Part::new(shapes.triangle(), [size[0], size[1], 1.0])),
        SceneGeomType::Label | SceneGeomType::None => {}
    }
}

/// Returns the ends of the twelve edges of a box around the origin with these half lengths.
fn edges(half: [f32; 3]) -> [[[f32; 3]; 2]; 12] {
    std::array::from_fn(|index| {
        let (along, sides) = (index / 4, index % 4);
        let corner = |end: f32| {
            std::array::from_fn(|axis| {
                let sign = match (axis + 3 - along) % 3 {
                    0 => end,
                    other => {
                        if sides & other == 0 {
                            -1.0
                        } else {
                            1.0
                        }
                    }
                };
                sign * half[axis]
            })
        };
        [corner(-1.0), corner(1.0)]
    })
}

/// Returns the square of a plane. Planes of the model may be infinite.
fn plane(geom: SceneGeom<'_>, shapes: &Shapes) -> Part {
    let [x, y, _] = geom.size();
    let of_model = shapes.plane(geom.plane());
    let infinite = shapes.infinite_plane();
    let half = half_lengths(geom, shapes);
    let shape = match of_model {
        Some(plane) => plane.shape,
        None if x > 0.0 && y > 0.0 => shapes.square(),
        None => infinite.shape,
    };
    let mut part = Part::new(shape, [half[0], half[1], 1.0]);
    // The texture repeats per metre on planes of the model and on infinite planes. It covers every
    // other plane exactly once.
    if of_model.is_some() || x <= 0.0 || y <= 0.0 {
        part.texture_scale = [half[0], half[1], 1.0];
    }
    part
}

/// Returns the half-lengths of a plane as it is drawn, m.
pub(super) fn half_lengths(geom: SceneGeom<'_>, shapes: &Shapes) -> [f32; 2] {
    let (size, of_model, infinite) = (geom.size(), shapes.plane(geom.plane()), shapes.infinite_plane());
    [0, 1].map(|axis| match of_model {
        Some(plane) => plane.half[axis],
        None if size[axis] > 0.0 => size[axis],
        None => infinite.half[axis],
    })
}

/// Returns the lateral surface of a cylinder, with more stacks if it is long.
fn cylinder_side(size: [f32; 3], round: impl Fn(RoundShape) -> u32) -> Part {
    let [x, y, z] = size;
    Part::new(round(if z > 10.0 * x.max(y) { RoundShape::LongCylinder } else { RoundShape::Cylinder }), size)
}

/// Returns the bottom, the side and the top of a cylinder, in the order in which the engine blends
/// them.
fn cylinder(size: [f32; 3], round: impl Fn(RoundShape) -> u32) -> [Part; 3] {
    let [x, y, z] = size;
    let end = Part::new(round(RoundShape::Disk), [x, y, z]);
    let (top, bottom) = (end.shifted(z).texture_shifted(1.0), end.flipped().shifted(-z).texture_shifted(-1.0));
    [bottom, cylinder_side(size, round), top]
}

/// Returns the side, the upper and the lower hemisphere of a capsule.
fn capsule(size: [f32; 3], round: impl Fn(RoundShape) -> u32) -> [Part; 3] {
    let [x, y, z] = size;
    let cap = Part::new(round(RoundShape::Hemisphere), [x, y, x.midpoint(y)]);
    let (top, bottom) = (cap.shifted(z).texture_shifted(1.0), cap.reversed().shifted(-z).texture_shifted(-1.0));
    [cylinder_side(size, round), top, bottom]
}

/// Returns the parts of an arrow from the origin along z: the end of the shaft, the shaft, its
/// other end, the head and its base. The arrow is half as long as `size` states; two thirds of it
/// are the shaft.
fn arrow(size: [f32; 3], head_scale: f32, round: impl Fn(RoundShape) -> u32) -> [Part; 5] {
    let [x, y, length] = size;
    let sixth = length / 6.0;
    let shaft = [x, y, sixth];
    let end = Part::new(round(RoundShape::Disk), shaft);
    let head = [head_scale * x, head_scale * y, sixth];
    [
        end.flipped().texture_shifted(-1.0),
        Part::new(round(RoundShape::LongCylinder), shaft).shifted(sixth),
        end.shifted(2.0 * sixth).texture_shifted(1.0),
        Part::new(round(RoundShape::Cone), head).shifted(2.0 * sixth),
        Part::new(round(RoundShape::Disk), head).flipped().shifted(2.0 * sixth),
    ]
}

/// Returns the parts of a double arrow centred on the origin: the shaft, the lower head with its
/// base, and the upper one.
fn double_arrow(size: [f32; 3], round: impl Fn(RoundShape) -> u32) -> [Part; 5] {
    let [x, y, length] = size;
    let third = length / 3.0;
    let head = [ARROWHEAD_SCALE * x, ARROWHEAD_SCALE * y, third / 2.0];
    let cone = Part::new(round(RoundShape::Cone), head);
    let base = Part::new(round(RoundShape::Disk), head);
    [
        Part::new(round(RoundShape::LongCylinder), [x, y, third]),
        cone.reversed().shifted(-third),
        base.shifted(-third),
        cone.shifted(third),
        base.flipped().shifted(third),
    ]
}

#[cfg(test)]
mod tests {
    use super::{Part, arrow, capsule, cylinder, double_arrow, edges};
    use crate::render::assets::RoundShape;

    /// Returns the extent of a part along z, for a shape with the given extent.
    fn extent(part: &Part, shape: [f32; 2]) -> [f32; 2] {
        let ends = shape.map(|end| part.shift + part.scale[2] * end);
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    fn round(shape: RoundShape) -> u32 {
        shape as u32
    }

    #[test]
    fn the_caps_of_a_capsule_are_on_its_ends() {
        let [side, top, bottom] = capsule([0.25, 0.25, 2.0], round);
        assert_eq!(extent(&side, [-1.0, 1.0]), [-2.0, 2.0]);
        assert_eq!(extent(&top, [0.0, 1.0]), [2.0, 2.25]);
        assert_eq!(extent(&bottom, [0.0, 1.0]), [-2.25, -2.0]);
    }

    #[test]
    fn the_disks_of_a_cylinder_are_on_its_ends() {
        let [bottom, side, top] = cylinder([0.25, 0.25, 2.0], round);
        assert_eq!(extent(&side, [-1.0, 1.0]), [-2.0, 2.0]);
        assert_eq!((extent(&top, [0.0; 2])[0], extent(&bottom, [0.0; 2])[0]), (2.0, -2.0));
    }

    #[test]
    fn an_arrow_starts_at_the_origin_and_has_no_gap() {
        let [bottom, shaft, top, cone, base] = arrow([0.1, 0.1, 6.0], 1.75, round);
        assert_eq!(extent(&shaft, [-1.0, 1.0]), [0.0, 2.0]);
        assert_eq!((extent(&top, [0.0; 2])[0], extent(&bottom, [0.0; 2])[0]), (2.0, 0.0));
        assert_eq!(extent(&cone, [0.0, 1.0]), [2.0, 3.0]);
        assert_eq!(extent(&base, [0.0; 2])[0], 2.0);
    }

    #[test]
    fn a_box_has_twelve_edges() {
        let edges = edges([1.0, 2.0, 3.0]);
        for [from, to] in edges {
            let differing: Vec<usize> = (0..3).filter(|&axis| from[axis] != to[axis]).collect();
            assert_eq!(differing.len(), 1, "{from:?} {to:?}");
            assert!((0..3).all(|axis| from[axis].abs() == [1.0, 2.0, 3.0][axis]), "{from:?}");
        }
        let mut distinct = edges.to_vec();
        distinct.sort_by(|a, b| a.partial_cmp(b).unwrap());
        distinct.dedup();
        assert_eq!(distinct.len(), 12);
    }

    #[test]
    fn a_double_arrow_is_symmetric() {
        let [shaft, down, _, up, _] = double_arrow([0.1, 0.1, 6.0], round);
        assert_eq!(extent(&shaft, [-1.0, 1.0]), [-2.0, 2.0]);
        assert_eq!(extent(&up, [0.0, 1.0]), [2.0, 3.0]);
        assert_eq!(extent(&down, [0.0, 1.0]), [-3.0, -2.0]);
    }
}
