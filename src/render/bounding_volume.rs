//! Bounding spheres of geoms, for frustum culling, mirror culling, shadow culling and the order of
//! transparent geoms.

use crate::element::HeightField;
use crate::element::Object;
use crate::id::HeightFieldId;
use crate::model::Model;
use crate::render::settings::is_drawable;
use crate::scene::{Scene, SceneGeom, SceneGeomType};

/// Bounding sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) centre: [f32; 3],
    pub(crate) radius: f32,
}

/// Returns the signed distance of a point from a plane with unit normal, m.
pub(crate) fn signed_distance([x, y, z]: [f32; 3], plane: &[f32; 4]) -> f32 {
    plane[0] * x + plane[1] * y + plane[2] * z + plane[3]
}

/// Bounding volume of a geom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum BoundingVolume {
    /// The geom has no shape or a non-finite pose.
    Empty,
    /// Bounding sphere in the world frame, m.
    Sphere(Sphere),
    /// The geom is infinite or has unknown bounds.
    Unbounded,
}

/// Bounding spheres of the meshes and the height fields of a model, in their local frames.
#[derive(Debug, Clone, Default)]
pub(crate) struct AssetBounds {
    meshes: Vec<Option<Sphere>>,
    height_fields: Vec<Option<Sphere>>,
}

impl AssetBounds {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            meshes: model.meshes().map(|mesh| bounding_sphere(mesh.vert().iter().copied())).collect(),
            height_fields: model.height_fields().map(height_field_sphere).collect(),
        }
    }

    /// Recomputes the bounding sphere of a height field after a change of its elevations.
    pub(crate) fn update_height_field(&mut self, model: &Model, id: HeightFieldId) {
        if let Some(sphere) = self.height_fields.get_mut(id.index()) {
            *sphere = height_field_sphere(model.height_field(id));
        }
    }

    /// Computes the bounding volume of a geom of a scene.
    pub(crate) fn volume(&self, scene: &Scene, geom: SceneGeom<'_>) -> BoundingVolume {
        let [x, y, z] = geom.size();
        let local = match geom.geom_type() {
            SceneGeomType::Skin => return skin_volume(scene, geom),
            SceneGeomType::Flex => return BoundingVolume::Unbounded,
            SceneGeomType::Label | SceneGeomType::None => return BoundingVolume::Empty,
            SceneGeomType::Plane if x <= 0.0 || y <= 0.0 => return BoundingVolume::Unbounded,
            SceneGeomType::Plane | SceneGeomType::Triangle => box_sphere([x, y, 0.0]),
            SceneGeomType::Sphere | SceneGeomType::Ellipsoid => centred_sphere(x.max(y).max(z)),
            SceneGeomType::Capsule => centred_sphere(z + x.max(y)),
            SceneGeomType::Cylinder | SceneGeomType::Box | SceneGeomType::LineBox => box_sphere([x, y, z]),
            SceneGeomType::Arrow | SceneGeomType::Arrow1 | SceneGeomType::Line => {
                let Sphere { radius, .. } = box_sphere([ARROWHEAD_SCALE * x, ARROWHEAD_SCALE * y, z / 2.0]);
                Sphere { centre: [0.0, 0.0, z / 2.0], radius }
            }
            SceneGeomType::Arrow2 => box_sphere([ARROWHEAD_SCALE * x, ARROWHEAD_SCALE * y, z]),
            SceneGeomType::Mesh | SceneGeomType::Sdf => {
                match geom.mesh().and_then(|mesh| *self.meshes.get(mesh.index())?) {
                    Some(sphere) => sphere,
                    None => return BoundingVolume::Empty,
                }
            }
            SceneGeomType::HeightField => {
                match geom.height_field().and_then(|field| *self.height_fields.get(field.index())?) {
                    Some(sphere) => sphere,
                    None => return BoundingVolume::Empty,
                }
            }
        };
        to_world(local, geom.pos(), geom.mat())
    }
}

/// Ratio of the radius of an arrowhead to the radius of the shaft.
pub(crate) const ARROWHEAD_SCALE: f32 = 1.75;

/// Returns the radius that the engine subtracts from the distance of a transparent geom before
/// sorting.
#[doc(alias = "mjv_rbound")]
pub(crate) fn sorting_radius(geom: SceneGeom<'_>) -> f32 {
    if matches!(geom.object(), Some(Object::Geom(_))) {
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

/// Returns the bounding sphere of a box around the origin with the given half-sizes.
fn box_sphere([x, y, z]: [f32; 3]) -> Sphere {
    centred_sphere(x.hypot(y).hypot(z))
}

fn centred_sphere(radius: f32) -> Sphere {
    Sphere { centre: [0.0; 3], radius }
}

/// Returns the bounding sphere of the finite points, centred on their bounding box; `None` if no
/// point is finite.
fn bounding_sphere(points: impl Iterator<Item = [f32; 3]> + Clone) -> Option<Sphere> {
    let points = points.filter(|point| point.iter().all(|coordinate| coordinate.is_finite()));
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in points.clone() {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    // Dividing before adding avoids overflow.
    let centre = [0, 1, 2].map(|axis| low[axis] / 2.0 + high[axis] / 2.0);
    let distance = |point: [f32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| point[axis] - centre[axis]);
        x.hypot(y).hypot(z)
    };
    let radius = points.map(distance).reduce(f32::max)?;
    Some(Sphere { centre, radius })
}

/// Returns the sphere around the bounding box of a skin, whose vertices are in the world frame.
fn skin_volume(scene: &Scene, geom: SceneGeom<'_>) -> BoundingVolume {
    let Some(Object::Skin(skin)) = geom.object() else { return BoundingVolume::Empty };
    let Some(skin) = scene.skins().nth(skin.index()) else { return BoundingVolume::Empty };
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for vertex in skin.vertices {
        if !vertex.iter().all(|&coordinate| is_drawable(coordinate)) {
            return BoundingVolume::Unbounded;
        }
        for axis in 0..3 {
            low[axis] = low[axis].min(vertex[axis]);
            high[axis] = high[axis].max(vertex[axis]);
        }
    }
    let centre = [0, 1, 2].map(|axis| low[axis].midpoint(high[axis]));
    let [x, y, z] = [0, 1, 2].map(|axis| high[axis] - centre[axis]);
    to_world(Sphere { centre, radius: x.hypot(y).hypot(z) }, [0.0; 3], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
}

fn height_field_sphere(field: HeightField<'_>) -> Option<Sphere> {
    let [x, y, height, depth] = field.size().map(|length| length as f32);
    let (low, high) = field
        .data()
        .iter()
        .map(|&elevation| elevation * height)
        .filter(|z| z.is_finite())
        .fold((0.0, 0.0), |(low, high), z| (f32::min(low, z), f32::max(high, z)));
    bounding_sphere([[-x, -y, -depth], [x, y, -depth], [-x, -y, low], [x, y, high]].into_iter())
}

/// Factor that allows for rounding.
const ROUNDING: f32 = 1.0 + 1e-4;

/// Transforms a bounding sphere to the world frame. The radius is increased slightly to allow for
/// rounding.
fn to_world(Sphere { centre, radius }: Sphere, pos: [f32; 3], mat: [f32; 9]) -> BoundingVolume {
    let rows = [0, 3, 6].map(|row| [mat[row], mat[row + 1], mat[row + 2]]);
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    // A matrix from the user need not be a rotation. Its Frobenius norm bounds the scale; for a
    // rotation the norm exceeds the scale, which is 1.
    let scale = if is_rotation(&mat) { 1.0 } else { rows.map(|row| dot(row, row)).iter().sum::<f32>().sqrt() };
    let centre = [0, 1, 2].map(|axis| pos[axis] + dot(rows[axis], centre));
    let radius = radius * scale * ROUNDING;
    if radius.is_finite() && centre.iter().all(|coordinate| coordinate.is_finite()) {
        BoundingVolume::Sphere(Sphere { centre, radius })
    } else if pos.iter().chain(&mat).all(|number| number.is_finite()) && !radius.is_nan() {
        BoundingVolume::Unbounded
    } else {
        BoundingVolume::Empty
    }
}

/// Returns `true` if a matrix is a rotation or a reflection, up to rounding.
pub(crate) fn is_rotation(mat: &[f32; 9]) -> bool {
    let row = |i: usize| [mat[3 * i], mat[3 * i + 1], mat[3 * i + 2]];
    let product = |i: usize, j: usize| row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum::<f32>();
    (0..3).all(|i| (0..3).all(|j| (product(i, j) - if i == j { 1.0 } else { 0.0 }).abs() < ROUNDING - 1.0))
}

#[cfg(test)]
mod tests {
    use super::{AssetBounds, BoundingVolume, Sphere, sorting_radius};
    use crate::scene::{Camera, Categories, Connector, NewGeom, Scene, SceneOptions};
    use crate::{Data, Model, sample};

    fn model() -> Model {
        Model::from_xml_str(
            "<mujoco><asset><mesh name='m' vertex='0 0 0  1 0 0  0 1 0  0 0 4'/>
               <hfield name='h' nrow='3' ncol='3' size='2 3 0.5 0.25'/></asset></mujoco>",
        )
        .unwrap()
    }

    fn pushed(model: &Model, geom: &NewGeom) -> BoundingVolume {
        let mut scene = Scene::new(model, 1).unwrap();
        scene.add_geom(geom).unwrap();
        AssetBounds::new(model).volume(&scene, scene.geom(0))
    }

    /// Asserts that the sphere encloses all points and is at most 10 % too large.
    fn assert_encloses(volume: BoundingVolume, points: &[[f32; 3]]) {
        let BoundingVolume::Sphere(Sphere { centre, radius }) = volume else { panic!("{volume:?}") };
        let distance = |point: &[f32; 3]| (0..3).map(|axis| (point[axis] - centre[axis]).powi(2)).sum::<f32>().sqrt();
        let farthest = points.iter().map(distance).fold(0.0, f32::max);
        assert!(farthest <= radius && radius <= 1.1 * farthest, "{radius} around {farthest}");
    }

    #[test]
    fn spheres_enclose_every_shape() {
        let model = model();
        let (pos, mat) = ([1.0, 2.0, 3.0], [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let place = |[x, y, z]: [f32; 3]| [1.0 - y, 2.0 + x, 3.0 + z];
        let mesh = model.mesh("m").unwrap();
        let ends = |points: &[[f32; 3]]| points.iter().map(|&point| place(point)).collect::<Vec<_>>();
        let cases = [
            (NewGeom::plane([1.0, 2.0]), ends(&[[1.0, 2.0, 0.0]])),
            (NewGeom::sphere(2.0), ends(&[[0.0, 0.0, 2.0], [2.0, 0.0, 0.0]])),
            (NewGeom::capsule(0.5, 2.0), ends(&[[0.0, 0.0, 2.5], [0.5, 0.0, 2.0]])),
            (NewGeom::ellipsoid([1.0, 3.0, 2.0]), ends(&[[0.0, -3.0, 0.0], [0.0, 0.0, 2.0]])),
            (NewGeom::cylinder(0.5, 2.0), ends(&[[0.5, 0.0, -2.0], [0.0, 0.5, 2.0]])),
            (NewGeom::cuboid([1.0, 2.0, 3.0]), ends(&[[1.0, -2.0, 3.0], [-1.0, 2.0, 3.0]])),
            (NewGeom::mesh(mesh.id()), ends(mesh.vert())),
            (NewGeom::convex_hull(mesh.id()), ends(mesh.vert())),
        ];
        for (geom, points) in cases {
            assert_encloses(pushed(&model, &geom.with_pos(pos).with_mat(mat)), &points);
        }
        let field = NewGeom::height_field(model.height_field("h").unwrap().id());
        assert_encloses(
            pushed(&model, &field.with_pos(pos).with_mat(mat)),
            &ends(&[[2.0, 3.0, -0.25], [-2.0, -3.0, 0.0]]),
        );
    }

    #[test]
    fn updating_a_height_field_updates_its_sphere() {
        let mut model = model();
        let mut bounds = AssetBounds::new(&model);
        model.edit().height_field_mut("h").unwrap().data_mut()[4] = 20.0;
        let id = model.height_field("h").unwrap().id();
        let mut scene = Scene::new(&model, 1).unwrap();
        scene.add_geom(&NewGeom::height_field(id)).unwrap();
        let encloses = |bounds: &AssetBounds, z: f32| {
            let BoundingVolume::Sphere(Sphere { centre, radius }) = bounds.volume(&scene, scene.geom(0)) else {
                panic!()
            };
            centre[2] + radius >= z
        };
        assert!(!encloses(&bounds, 10.0));
        bounds.update_height_field(&model, id);
        assert!(encloses(&bounds, 10.0));
    }

    #[test]
    fn spheres_enclose_connectors() {
        let (from, to) = ([0.0, 0.0, 0.0], [0.0, 3.0, 4.0]);
        for shape in [Connector::Arrow, Connector::Arrow1, Connector::Line, Connector::Cylinder] {
            let volume = pushed(&model(), &NewGeom::connector(shape, 0.01, from, to));
            assert_encloses(volume, &[[0.0; 3], [0.0, 3.0, 4.0]]);
        }
    }

    #[test]
    fn infinite_geoms_are_unbounded_and_labels_are_empty() {
        let model = model();
        assert_eq!(pushed(&model, &NewGeom::plane([0.0, 0.0])), BoundingVolume::Unbounded);
        assert_eq!(pushed(&model, &NewGeom::plane([1.0, 0.0])), BoundingVolume::Unbounded);
        assert_eq!(pushed(&model, &NewGeom::text("here").unwrap()), BoundingVolume::Empty);
        assert_eq!(pushed(&model, &NewGeom::sphere(f64::from(f32::MAX))), BoundingVolume::Unbounded);
    }

    #[test]
    fn scaling_matrix_increases_the_radius() {
        let stretched = NewGeom::sphere(1.0).with_mat([5.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        let BoundingVolume::Sphere(Sphere { radius, .. }) = pushed(&model(), &stretched) else { panic!() };
        assert!(radius >= 5.0);
    }

    #[test]
    fn sorting_radii_equal_the_engines() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 1000).unwrap();
        let mut camera = Camera::free(data.model());
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        for geom in scene.geoms().take(data.model().ngeom()) {
            assert_eq!(sorting_radius(geom), geom.modelrbound());
        }
        let mut scene = Scene::new(data.model(), 10).unwrap();
        for (geom, radius) in [
            (NewGeom::sphere(2.0), 2.0),
            (NewGeom::capsule(0.5, 2.0), 2.5),
            (NewGeom::cylinder(3.0, 4.0), 5.0),
            (NewGeom::cuboid([2.0, 3.0, 6.0]), 7.0),
            (NewGeom::ellipsoid([1.0, 3.0, 2.0]), 3.0),
        ] {
            let index = scene.add_geom(&geom).unwrap();
            assert!((sorting_radius(scene.geom(index)) - radius).abs() < 1e-6);
        }
    }
}
