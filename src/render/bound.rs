//! How far the geoms of a scene reach: what is out of sight need not be drawn, and what is transparent is drawn in the order of
//! distance.

use crate::element::HeightField;
use crate::id::HeightFieldId;
use crate::model::Model;
use crate::scene::{SceneGeom, SceneGeomType, SceneObject};

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) centre: [f32; 3],
    pub(crate) radius: f32,
}

/// Where a geom of a scene may be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Reach {
    /// It has no shape, or no place.
    Nowhere,
    /// Within a sphere, world frame, m.
    Within(Sphere),
    /// It has no end, or one that is not known beforehand.
    Everywhere,
}

/// How far the meshes and the height fields of a model reach, each in its own frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bounds {
    meshes: Vec<Option<Sphere>>,
    height_fields: Vec<Option<Sphere>>,
}

impl Bounds {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            meshes: model.meshes().map(|mesh| around(mesh.vert().iter().copied())).collect(),
            height_fields: model.height_fields().map(around_field).collect(),
        }
    }

    /// Measures a height field again, of which the elevations have changed.
    pub(crate) fn update_height_field(&mut self, model: &Model, id: HeightFieldId) {
        if let Some(bound) = self.height_fields.get_mut(id.index()) {
            *bound = around_field(model.height_field(id));
        }
    }

    /// Where a geom of a scene may be seen.
    pub(crate) fn reach(&self, geom: SceneGeom<'_>) -> Reach {
        let [x, y, z] = geom.size();
        let own = match geom.geom_type() {
            SceneGeomType::Skin => return Reach::Everywhere,
            SceneGeomType::Label | SceneGeomType::None => return Reach::Nowhere,
            SceneGeomType::Plane if x <= 0.0 || y <= 0.0 => return Reach::Everywhere,
            SceneGeomType::Plane => centred([x, y, 0.0]),
            SceneGeomType::Sphere | SceneGeomType::Ellipsoid => centred_on_axis(x.max(y).max(z)),
            SceneGeomType::Capsule => centred_on_axis(z + x.max(y)),
            SceneGeomType::Cylinder | SceneGeomType::Box => centred([x, y, z]),
            // Twice as wide as the shaft, almost; from the origin, or to both sides of it.
            SceneGeomType::Arrow | SceneGeomType::Arrow1 | SceneGeomType::Line => {
                let Sphere { radius, .. } = centred([WEDGE * x, WEDGE * y, z / 2.0]);
                Sphere { centre: [0.0, 0.0, z / 2.0], radius }
            }
            SceneGeomType::Arrow2 => centred([WEDGE * x, WEDGE * y, z]),
            SceneGeomType::Mesh => match geom.mesh().and_then(|(mesh, _)| *self.meshes.get(mesh.index())?) {
                Some(bound) => bound,
                None => return Reach::Nowhere,
            },
            SceneGeomType::HeightField => {
                match geom.height_field().and_then(|field| *self.height_fields.get(field.index())?) {
                    Some(bound) => bound,
                    None => return Reach::Nowhere,
                }
            }
        };
        in_world(own, geom.pos(), geom.mat())
    }
}

/// By how much the wedge of an arrow is wider than its shaft.
const WEDGE: f32 = 1.75;

/// The radius that the engine subtracts from a transparent geom's distance before it puts them in order.
#[doc(alias = "mjv_rbound")]
pub(crate) fn sorting_radius(geom: SceneGeom<'_>) -> f32 {
    if matches!(geom.object(), Some(SceneObject::Geom(_))) {
        return geom.modelrbound();
    }
    let [x, y, z] = geom.size();
    match geom.geom_type() {
        SceneGeomType::Sphere => x,
        SceneGeomType::Capsule => x + z,
        SceneGeomType::Cylinder => x.hypot(z),
        SceneGeomType::Box => x.hypot(y).hypot(z),
        _ => x.max(y).max(z),
    }
}

fn centred([x, y, z]: [f32; 3]) -> Sphere {
    centred_on_axis(x.hypot(y).hypot(z))
}

fn centred_on_axis(radius: f32) -> Sphere {
    Sphere { centre: [0.0; 3], radius }
}

/// The sphere around the box around the points that are finite; none if there is none.
fn around(points: impl Iterator<Item = [f32; 3]> + Clone) -> Option<Sphere> {
    let points = points.filter(|point| point.iter().all(|coordinate| coordinate.is_finite()));
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in points.clone() {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    // Halves first: their sum does not overflow.
    let centre = [0, 1, 2].map(|axis| low[axis] / 2.0 + high[axis] / 2.0);
    let distance = |point: [f32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| point[axis] - centre[axis]);
        x.hypot(y).hypot(z)
    };
    let radius = points.map(distance).reduce(f32::max)?;
    Some(Sphere { centre, radius })
}

fn around_field(field: HeightField<'_>) -> Option<Sphere> {
    let [x, y, height, depth] = field.size().map(|length| length as f32);
    let base = [[-x, -y, -depth], [x, y, -depth]];
    let top = field.data().iter().map(|&elevation| [0.0, 0.0, elevation * height]);
    let (low, high) = top
        .clone()
        .filter(|point| point[2].is_finite())
        .fold((0.0, 0.0), |(low, high), [_, _, z]| (f32::min(low, z), f32::max(high, z)));
    around(base.into_iter().chain([[-x, -y, low], [x, y, high]]))
}

/// A sphere that is turned and moved with a geom, a little larger for the rounding.
fn in_world(Sphere { centre, radius }: Sphere, pos: [f32; 3], mat: [f32; 9]) -> Reach {
    const ROUNDING: f32 = 1.0 + 1e-4;
    let rows = [0, 3, 6].map(|row| [mat[row], mat[row + 1], mat[row + 2]]);
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    // A matrix that the user gave may stretch: by no more than the root of the sum of its squares, which for a rotation is
    // more than it does.
    let is_rotation =
        (0..3).all(|i| (0..3).all(|j| (dot(rows[i], rows[j]) - if i == j { 1.0 } else { 0.0 }).abs() < ROUNDING - 1.0));
    let stretch = if is_rotation { 1.0 } else { rows.map(|row| dot(row, row)).iter().sum::<f32>().sqrt() };
    let centre = [0, 1, 2].map(|axis| pos[axis] + dot(rows[axis], centre));
    let radius = radius * stretch * ROUNDING;
    if radius.is_finite() && centre.iter().all(|coordinate| coordinate.is_finite()) {
        Reach::Within(Sphere { centre, radius })
    } else if pos.iter().chain(&mat).all(|number| number.is_finite()) && !radius.is_nan() {
        Reach::Everywhere
    } else {
        Reach::Nowhere
    }
}
