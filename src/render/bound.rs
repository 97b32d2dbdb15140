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

/// How high a point is over a plane, m.
pub(crate) fn height([x, y, z]: [f32; 3], plane: &[f32; 4]) -> f32 {
    plane[0] * x + plane[1] * y + plane[2] * z + plane[3]
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

#[cfg(test)]
mod tests {
    use super::{Bounds, Reach, Sphere, sorting_radius};
    use crate::scene::{Camera, Categories, Connector, NewGeom, Scene, SceneOptions};
    use crate::{Data, Model, sample};

    fn model() -> Model {
        Model::from_xml_str(
            "<mujoco><asset><mesh name='m' vertex='0 0 0  1 0 0  0 1 0  0 0 4'/>
               <hfield name='h' nrow='3' ncol='3' size='2 3 0.5 0.25'/></asset></mujoco>",
        )
        .unwrap()
    }

    fn pushed(model: &Model, geom: &NewGeom) -> Reach {
        let mut scene = Scene::new(model, 1).unwrap();
        scene.push(geom).unwrap();
        Bounds::new(model).reach(scene.geom(0))
    }

    /// Everything is within the sphere, and the sphere is not much larger than it must be.
    fn assert_around(reach: Reach, points: &[[f32; 3]]) {
        let Reach::Within(Sphere { centre, radius }) = reach else { panic!("{reach:?}") };
        let distance = |point: &[f32; 3]| (0..3).map(|axis| (point[axis] - centre[axis]).powi(2)).sum::<f32>().sqrt();
        let farthest = points.iter().map(distance).fold(0.0, f32::max);
        assert!(farthest <= radius && radius <= 1.1 * farthest, "{radius} around {farthest}");
    }

    #[test]
    fn every_shape_is_within_its_sphere() {
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
            assert_around(pushed(&model, &geom.pos(pos).mat(mat)), &points);
        }
        let field = NewGeom::height_field(model.height_field("h").unwrap().id());
        assert_around(pushed(&model, &field.pos(pos).mat(mat)), &ends(&[[2.0, 3.0, -0.25], [-2.0, -3.0, 0.0]]));
    }

    #[test]
    fn a_field_that_was_raised_reaches_farther() {
        let mut model = model();
        let mut bounds = Bounds::new(&model);
        model.edit().height_field_mut("h").unwrap().data_mut()[4] = 20.0;
        let id = model.height_field("h").unwrap().id();
        let mut scene = Scene::new(&model, 1).unwrap();
        scene.push(&NewGeom::height_field(id)).unwrap();
        let reaches = |bounds: &Bounds, z: f32| {
            let Reach::Within(Sphere { centre, radius }) = bounds.reach(scene.geom(0)) else { panic!() };
            centre[2] + radius >= z
        };
        assert!(!reaches(&bounds, 10.0));
        bounds.update_height_field(&model, id);
        assert!(reaches(&bounds, 10.0));
    }

    #[test]
    fn connectors_are_within_their_spheres() {
        let (from, to) = ([0.0, 0.0, 0.0], [0.0, 3.0, 4.0]);
        for shape in [Connector::Arrow, Connector::Arrow1, Connector::Line, Connector::Cylinder] {
            let reach = pushed(&model(), &NewGeom::connector(shape, 0.01, from, to));
            assert_around(reach, &[[0.0; 3], [0.0, 3.0, 4.0]]);
        }
    }

    #[test]
    fn what_has_no_end_is_everywhere_and_what_has_no_shape_nowhere() {
        let model = model();
        assert_eq!(pushed(&model, &NewGeom::plane([0.0, 0.0])), Reach::Everywhere);
        assert_eq!(pushed(&model, &NewGeom::plane([1.0, 0.0])), Reach::Everywhere);
        assert_eq!(pushed(&model, &NewGeom::text("here").unwrap()), Reach::Nowhere);
        assert_eq!(pushed(&model, &NewGeom::sphere(f64::from(f32::MAX))), Reach::Everywhere);
    }

    #[test]
    fn a_matrix_that_stretches_is_allowed_for() {
        let stretched = NewGeom::sphere(1.0).mat([5.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        let Reach::Within(Sphere { radius, .. }) = pushed(&model(), &stretched) else { panic!() };
        assert!(radius >= 5.0);
    }

    #[test]
    fn the_order_of_transparent_geoms_is_the_engines() {
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
            let index = scene.push(&geom).unwrap();
            assert!((sorting_radius(scene.geom(index)) - radius).abs() < 1e-6);
        }
    }
}
