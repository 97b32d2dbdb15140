//! What the pictures of depth and of segmentation say is what rays through the same pixels meet.
//!
//! The engine's rays meet the exact shapes. What is drawn differs from these in two ways, and both have bounds that follow from how it
//! is drawn:
//!
//! - Round shapes are polyhedra with their corners on the shape. They lie between the shape and a smaller one: a polygon of `n`
//!   corners lies outside of the circle of `cos(π / n)` times its radius. So whatever a picture shows at a pixel is no nearer than what
//!   the ray meets, and no farther than what it meets after all round shapes have been made smaller by that.
//! - A graphics card rounds corners to a grid of 1/256 pixel. So the place that a pixel shows is within that of its middle: each pixel
//!   is looked at by nine rays, through its middle and around it, and what is seen is between the nearest and the farthest of them.
//!
//! Where all of these rays agree on the geom, the picture must show it. Where they do not, at the edges of things, it must show one
//! of those that are within the bounds.
//!
//! One thing is let pass, where a pixel shows the very edge of a round geom, which some of its rays meet and some miss once it is
//! smaller: a triangle is seen edge-on there, and its depth changes without bound from pixel to pixel. A card that computes it for the
//! middle of a pixel from corners that it has rounded, as Mesa's software rasteriser does, may find it nearer than the whole geom, and
//! show it through others. There are few such pixels, and they are counted.

use std::cell::Cell;
use std::f64::consts::PI;
use std::path::Path;

use mujoco_safe::render::{Renderer, RendererOptions, Segment};
use mujoco_safe::scene::{Camera, Categories, Scene, SceneGeom, SceneObject, SceneOptions, Viewpoint, VisualFlags};
use mujoco_safe::{Data, GeomId, GeomType, Model, RayHit, RayOptions, math, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stage;

const SIZE: [u32; 2] = [640, 480];
const PIXELS: usize = 1000;
/// 1 mm at 3 m.
const PRECISION: f64 = 1e-3 / 3.0;
/// The grid that corners are rounded to, pixels.
const GRID: f64 = 1.0 / 256.0;

/// A model of the engine's package, how many steps it is left to itself, and the free camera: the point that it looks at, its
/// distance, m, its azimuth and elevation, degrees.
struct Subject(&'static str, usize, [f64; 3], f64, f64, f64);

/// The models of the comparison with the engine's own pictures, seen as there.
const SUBJECTS: [Subject; 11] = [
    Subject("humanoid/humanoid.xml", 0, [0.0, 0.0, 1.0], 4.0, 150.0, -15.0),
    Subject("humanoid/humanoid.xml", 300, [0.2, 0.0, 0.4], 3.0, 120.0, -25.0),
    Subject("humanoid/22_humanoids.xml", 60, [0.0, 0.0, 1.0], 8.0, 130.0, -20.0),
    Subject("humanoid100/humanoid100.xml", 20, [0.0, 0.0, 1.0], 6.0, 130.0, -20.0),
    Subject("hammock/hammock.xml", 100, [0.0, 0.0, 1.0], 4.5, 135.0, -20.0),
    Subject("composite/cloth.xml", 100, [0.0, 0.0, 0.7], 3.5, 135.0, -20.0),
    Subject("composite/softbox.xml", 100, [0.0, 0.0, 0.4], 3.0, 135.0, -20.0),
    Subject("mug/mug.xml", 0, [0.0, 0.0, 0.05], 0.4, 120.0, -25.0),
    Subject("tendon_arm/arm26.xml", 50, [0.3, 0.0, 0.0], 1.6, 90.0, -60.0),
    Subject("slider_crank/slider_crank.xml", 100, [0.0, 0.0, 0.1], 1.0, 135.0, -25.0),
    Subject("adhesion/active_adhesion.xml", 100, [0.0, 0.0, 0.15], 0.8, 135.0, -20.0),
];

#[test]
fn pictures_of_depth_and_segmentation_show_what_rays_meet() {
    if sample::system_models().is_empty() {
        println!("skipped: no models under {} (package libmujoco-samples)", sample::SYSTEM_MODELS);
        return;
    }
    for subject in &SUBJECTS {
        compare(subject);
    }
}

fn compare(&Subject(name, steps, lookat, distance, azimuth, elevation): &Subject) {
    let model = Model::from_xml_path(Path::new(sample::SYSTEM_MODELS).join(name)).unwrap();
    let mut data = Data::new(model).unwrap();
    for _ in 0..steps {
        data.step().unwrap();
    }
    data.forward().unwrap();

    let mut scene = Scene::new(data.model(), 20_000).unwrap();
    let mut camera = Camera { lookat, distance, azimuth, elevation, ..Camera::default() };
    scene.update(&mut data, &geoms_only(), None, &mut camera, Categories::STATIC | Categories::DYNAMIC).unwrap();
    let mut renderer = Renderer::on(stage::gpu(), data.model(), SIZE[0], SIZE[1], &RendererOptions::default()).unwrap();
    let depth = renderer.depth(&scene).unwrap();
    let segmentation = renderer.segmentation(&scene).unwrap();

    // What is transparent has no depth.
    let is_transparent = |geom: &SceneGeom<'_>| geom.rgba()[3] < 0.995;
    let transparent: Vec<GeomId> = scene.geoms().filter(is_transparent).filter_map(of_model).collect();
    let rays = Rays::new(&data, scene.viewpoint(), &[]);
    let solid = (!transparent.is_empty()).then(|| Rays::new(&data, scene.viewpoint(), &transparent));
    let edges = Cell::new(0);
    let check = |pixel: [usize; 2]| {
        // The rods of cranks are drawn whatever is to be shown, and no ray meets them.
        let segment = segmentation.pixel(pixel[0], pixel[1]);
        if matches!(segment, Some(Segment { object: Some(SceneObject::Actuator(_)), .. })) {
            return false;
        }
        let met = rays.meet(pixel);
        let deep = solid.as_ref().map_or(met.range, |rays| rays.meet(pixel).range);
        let found = f64::from(depth.metres(pixel[0], pixel[1]));
        let seen = segment.map(|segment| of_model(scene.geom(segment.geom)).expect("nothing but geoms"));
        if !(is_within(found, deep) && rays.agree(&met, seen)) {
            let is_edge = seen.is_some_and(|geom| rays.is_edge(geom, &met));
            assert!(
                is_edge,
                "{name} at {pixel:?}: {seen:?} at {found} m, but rays meet {:?} at {:?} m",
                met.first, met.range
            );
            edges.set(edges.get() + 1);
        }
        met.agree
    };
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2022);
    let mut certain = 0;
    for _ in 0..PIXELS {
        let pixel = SIZE.map(|length| random.random_range(0..length) as usize);
        certain += usize::from(check(pixel));
    }
    println!("{name} after {steps} steps: at {certain} of {PIXELS} pixels there is no doubt what is seen");
    assert!(certain > PIXELS * 3 / 4, "{name}: only {certain} of {PIXELS} pixels are away from edges");

    // Most of a picture is floor. Again, of all that stands on it.
    let things: Vec<[usize; 2]> = (0..SIZE[1] as usize)
        .flat_map(|y| (0..SIZE[0] as usize).map(move |x| [x, y]))
        .filter(|&[x, y]| segmentation.pixel(x, y).is_some_and(|segment| scene.geom(segment.geom).plane().is_none()))
        .collect();
    assert!(things.len() > PIXELS, "{name}: only {} pixels show more than the floor", things.len());
    for _ in 0..PIXELS {
        check(things[random.random_range(0..things.len())]);
    }
    assert!(edges.get() <= PIXELS / 100, "{name}: edges of round geoms are too near at {} pixels", edges.get());
}

/// All geoms, and as little else as possible: what rays meet.
fn geoms_only() -> SceneOptions {
    let mut options = SceneOptions { flags: VisualFlags::STATIC, geomgroup: [true; 6], ..SceneOptions::default() };
    options.sitegroup = [false; 6];
    options
}

/// The geom of the model that one of a scene stands for.
fn of_model(geom: SceneGeom<'_>) -> Option<GeomId> {
    match geom.object()? {
        SceneObject::Geom(geom) => Some(geom),
        _ => None,
    }
}

/// Two simulations in the same state: with the shapes as they are, and with round ones that are inside of what is drawn.
struct Rays {
    outer: Data,
    inner: Data,
    viewpoint: Viewpoint,
}

/// What the rays through a pixel meet.
struct Met {
    /// The least and the greatest depth that it can have.
    range: [f64; 2],
    /// What one of them meets, and whether they all do.
    first: Option<GeomId>,
    agree: bool,
    /// The directions of the rays.
    directions: Vec<[f64; 3]>,
}

impl Rays {
    /// Geoms that are absent are put where nobody looks.
    fn new(data: &Data, viewpoint: Viewpoint, absent: &[GeomId]) -> Self {
        let mut outer = data.clone();
        outer
            .edit_model(|model| {
                for geom in absent {
                    model.geom_pos_mut()[geom.index()] = [1e6; 3];
                }
            })
            .unwrap();
        outer.forward().unwrap();
        let quality = outer.model().visual().quality;
        // A circle is cut into slices, and a half circle from pole to pole into stacks, an even number of them.
        let around = (PI / quality.numslices as f64).cos();
        let along = (PI / (4 * (quality.numstacks / 2)) as f64).cos();
        let mut inner = outer.clone();
        inner
            .edit_model(|model| {
                let types: Vec<GeomType> = model.geoms().map(|geom| geom.geom_type()).collect();
                for (size, geom_type) in model.geom_size_mut().iter_mut().zip(types) {
                    match geom_type {
                        GeomType::Sphere | GeomType::Capsule => size[0] *= around * along,
                        GeomType::Ellipsoid => *size = size.map(|radius| radius * around * along),
                        GeomType::Cylinder => size[0] *= around,
                        _ => {}
                    }
                }
            })
            .unwrap();
        inner.forward().unwrap();
        // Quaternions were scaled to length one once more.
        let places = inner.geom_xpos().as_flattened().iter().zip(outer.geom_xpos().as_flattened());
        assert!(places.into_iter().all(|(a, b)| (a - b).abs() < 1e-9));
        Self { outer, inner, viewpoint }
    }

    fn eye(&self) -> [f64; 3] {
        self.viewpoint.pos.map(f64::from)
    }

    /// The direction through a place of the picture, in pixels from its upper left corner, for which distance is depth.
    fn direction(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let Viewpoint { forward, up, frustum_center, frustum_bottom, frustum_top, frustum_near, .. } = self.viewpoint;
        let [forward, up] = [forward, up].map(|axis| axis.map(f64::from));
        let right = math::cross(&forward, &up);
        let [width, height] = SIZE.map(f64::from);
        let [bottom, top] = [frustum_bottom, frustum_top].map(f64::from);
        let to_right = f64::from(frustum_center) + (x / width - 0.5) * (top - bottom) * width / height;
        let upwards = top - y / height * (top - bottom);
        let near = f64::from(frustum_near);
        [0, 1, 2].map(|axis| forward[axis] + (right[axis] * to_right + up[axis] * upwards) / near)
    }

    fn meet(&self, [x, y]: [usize; 2]) -> Met {
        let middle = [x as f64 + 0.5, y as f64 + 0.5];
        let steps = [-GRID, 0.0, GRID];
        let places = steps.iter().flat_map(|dx| steps.map(|dy| [middle[0] + dx, middle[1] + dy]));
        let directions: Vec<_> = places.map(|place| self.direction(place)).collect();
        let far = f64::from(self.viewpoint.frustum_far);
        let cast = |data: &Data, direction, far| -> Option<RayHit> {
            data.ray(self.eye(), direction, &RayOptions::default()).unwrap().filter(|hit| hit.distance <= far)
        };
        // What is at the far side of the frustum may be seen or not.
        let [before, beyond] = [far * (1.0 - PRECISION), far * (1.0 + PRECISION)];
        let outer: Vec<_> = directions.iter().map(|&direction| cast(&self.outer, direction, beyond)).collect();
        let inner: Vec<_> = directions.iter().map(|&direction| cast(&self.inner, direction, before)).collect();
        let distance = |hit: &Option<RayHit>| hit.map_or(f64::INFINITY, |hit| hit.distance);
        let range = [
            outer.iter().map(distance).fold(f64::INFINITY, f64::min),
            inner.iter().map(distance).fold(f64::NEG_INFINITY, f64::max),
        ];
        let first = outer[0].map(|hit| hit.geom);
        let agree = outer.iter().chain(&inner).all(|hit| hit.map(|hit| hit.geom) == first);
        Met { range, first, agree, directions }
    }

    /// How far away a ray meets a geom that others may hide.
    fn distance(&self, data: &Data, geom: GeomId, direction: [f64; 3]) -> Option<f64> {
        let (model, index) = (data.model(), geom.index());
        match model.geom(geom).geom_type() {
            GeomType::Mesh => data.ray_mesh(geom, self.eye(), direction).unwrap(),
            GeomType::HeightField => data.ray_hfield(geom, self.eye(), direction).unwrap(),
            geom_type => {
                let (pos, mat, size) = (data.geom_xpos()[index], data.geom_xmat()[index], model.geom_size()[index]);
                math::ray_geom(&pos, &mat, &size, &self.eye(), &direction, geom_type).unwrap()
            }
        }
    }

    /// Whether a picture may show this geom, or nothing, where rays meet that.
    fn agree(&self, met: &Met, seen: Option<GeomId>) -> bool {
        let far = met.range[1] * (1.0 + PRECISION);
        // At an edge, or where two surfaces are closer to each other than to what is drawn of them.
        let is_near =
            |geom| met.directions.iter().any(|&ray| self.distance(&self.outer, geom, ray).is_some_and(|at| at <= far));
        (met.agree && met.first == seen) || seen.map_or(far == f64::INFINITY, is_near)
    }

    /// Whether a geom's edge is at a pixel: some of its rays meet it, and some miss it once it is smaller.
    fn is_edge(&self, geom: GeomId, met: &Met) -> bool {
        met.directions.iter().any(|&ray| self.distance(&self.outer, geom, ray).is_some())
            && met.directions.iter().any(|&ray| self.distance(&self.inner, geom, ray).is_none())
    }
}

/// Whether a depth is between two, as precise as it must be.
fn is_within(depth: f64, [near, far]: [f64; 2]) -> bool {
    depth >= near * (1.0 - PRECISION) && (depth == far || depth <= far * (1.0 + PRECISION))
}
