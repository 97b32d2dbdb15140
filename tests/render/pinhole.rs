//! Pinhole cameras and point clouds agree with the engine's poses, fields of view and rays.

use mujoco_safe::data::RayOptions;
use mujoco_safe::element::Object;
use mujoco_safe::render::{RenderError, Renderer, RendererOptions, SegmentationImage};
use mujoco_safe::scene::{Camera, PinholeCamera, Scene, Transform};
use mujoco_safe::{Data, Error, Model, sample};

use crate::stage;

const SIZE: [usize; 2] = [160, 120];
/// Relative error of depth at viewing angles of 15° or more.
const PRECISION: f64 = 1.0 / 3000.0;
/// A tilted camera beside a finite floor with a box and a sphere.
const TABLE: &str = r#"<mujoco>
    <visual><global fovy="38"/></visual>
    <worldbody>
      <camera name="tilted" pos="-1.2 -2 1.6" xyaxes="2.2 -1.85 -.55 3.8 2.255 7.615" fovy="50"/>
      <geom name="floor" type="plane" size="2 2 .1"/>
      <geom name="box" type="box" pos=".4 -.3 .25" size=".3 .2 .25" euler="0 0 30"/>
      <geom name="sphere" type="sphere" pos="-.4 .4 .3" size=".3"/>
    </worldbody>
  </mujoco>"#;

/// Pose and intrinsics of a camera, computed without the scene.
struct Eye {
    pos: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    forward: [f64; 3],
    /// Horizontal and vertical focal length, pixels; pixels per metre if the camera is
    /// orthographic.
    focal: [f64; 2],
    /// Principal point, pixels from the upper left.
    principal: [f64; 2],
    orthographic: bool,
}

impl Eye {
    fn of_model(data: &Data, name: &str) -> Self {
        let id = data.model().camera(name).unwrap().id();
        let mat = data.cam_xmat()[id.index()];
        let column = |column: usize| [0, 3, 6].map(|row| mat[row + column]);
        let (pos, fovy) = (data.cam_xpos()[id.index()], data.model().cam_fovy()[id.index()]);
        let eye = Self { pos, right: column(0), up: column(1), forward: column(2).map(|part| -part), ..Self::ahead() };
        Self { focal: [focal_length(fovy); 2], ..eye }
    }

    /// Returns an eye whose principal point is the centre of the image.
    fn ahead() -> Self {
        Self {
            pos: [0.0; 3],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            forward: [0.0, 0.0, -1.0],
            focal: [1.0; 2],
            principal: SIZE.map(|length| length as f64 / 2.0),
            orthographic: false,
        }
    }

    fn of_free(model: &Model, camera: &Camera) -> Self {
        let (sin, cos) = camera.azimuth.to_radians().sin_cos();
        let (down, along) = camera.elevation.to_radians().sin_cos();
        let forward = [along * cos, along * sin, down];
        let pos = [0, 1, 2].map(|axis| camera.lookat[axis] - camera.distance * forward[axis]);
        let focal = [focal_length(f64::from(model.visual().global.fovy)); 2];
        Self { pos, right: [sin, -cos, 0.0], up: [-down * cos, -down * sin, along], forward, focal, ..Self::ahead() }
    }

    /// Returns the origin and the direction of the ray through the centre of a pixel. The direction
    /// is scaled so that distance is depth.
    fn ray(&self, [x, y]: [usize; 2]) -> [[f64; 3]; 2] {
        let x = (x as f64 + 0.5 - self.principal[0]) / self.focal[0];
        let y = (self.principal[1] - y as f64 - 0.5) / self.focal[1];
        let aside = [0, 1, 2].map(|axis| x * self.right[axis] + y * self.up[axis]);
        let moved = |vector: [f64; 3]| [0, 1, 2].map(|axis| vector[axis] + aside[axis]);
        if self.orthographic { [moved(self.pos), self.forward] } else { [self.pos, moved(self.forward)] }
    }

    fn assert_equals(&self, camera: &PinholeCamera) {
        for (actual, expected) in [camera.fx, camera.fy].into_iter().zip(self.focal) {
            assert!((actual - expected).abs() < 1e-6 * expected, "{camera:?} has not the focal length {expected}");
        }
        for (actual, expected) in [camera.cx, camera.cy].into_iter().zip(self.principal) {
            assert!((actual - expected).abs() < 1e-4, "{camera:?} has not the principal point {:?}", self.principal);
        }
        assert_eq!(camera.orthographic, self.orthographic);
        let Self { pos, right, up, forward, .. } = self;
        for axis in 0..3 {
            assert!((camera.pos[axis] - pos[axis]).abs() < 1e-6, "{camera:?}");
            let row = [right[axis], up[axis], -forward[axis]];
            assert!((0..3).all(|column| (camera.mat[3 * axis + column] - row[column]).abs() < 1e-6), "{camera:?}");
        }
    }
}

/// Returns the focal length for a vertical field of view in degrees, pixels.
fn focal_length(fovy: f64) -> f64 {
    SIZE[1] as f64 / (2.0 * (fovy.to_radians() / 2.0).tan())
}

fn table() -> (Data, Renderer) {
    rendered(TABLE)
}

fn rendered(xml: &str) -> (Data, Renderer) {
    let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    data.forward().unwrap();
    let options = RendererOptions::default().with_samples(1).with_shadow_size(64);
    let [width, height] = SIZE;
    let renderer = Renderer::on(stage::gpu(), data.model(), width, height, options).unwrap();
    (data, renderer)
}

fn free(model: &Model) -> Camera {
    Camera { lookat: [0.2, 0.1, 0.1], distance: 2.7, azimuth: 140.0, elevation: -42.0, ..Camera::free(model) }
}

#[test]
fn intrinsics_and_pose_follow_from_the_field_of_view_and_the_camera() {
    let (mut data, mut renderer) = table();
    let camera = renderer.snapshot(&mut data, "tilted").unwrap().pinhole_camera().unwrap();
    assert_eq!([camera.width, camera.height], SIZE);
    Eye::of_model(&data, "tilted").assert_equals(&camera);
    let mut free = free(data.model());
    let camera = renderer.snapshot(&mut data, &mut free).unwrap().pinhole_camera().unwrap();
    Eye::of_free(data.model(), &free).assert_equals(&camera);
}

#[test]
fn points_of_a_depth_image_are_where_rays_hit() {
    let (mut data, mut renderer) = table();
    let free = free(data.model());
    let eyes = [Eye::of_model(&data, "tilted"), Eye::of_free(data.model(), &free)];
    let fixed = Camera::fixed(data.model(), "tilted").unwrap();
    for (eye, mut camera) in eyes.iter().zip([fixed, free]) {
        assert_images_equal_hits(&mut data, &mut renderer, eye, &mut camera);
    }
}

/// Asserts that the pinhole camera, the points of the depth image and the segmentation are those of
/// the eye.
fn assert_images_equal_hits(data: &mut Data, renderer: &mut Renderer, eye: &Eye, camera: &mut Camera) {
    let mut snapshot = renderer.snapshot(data, camera).unwrap();
    let (depth, segmentation) = (snapshot.depth().unwrap(), snapshot.segmentation().unwrap());
    let camera = snapshot.pinhole_camera().unwrap();
    eye.assert_equals(&camera);
    assert_points_equal_hits(data, eye, &depth.points(&camera).collect::<Vec<_>>(), &segmentation);
    for ([x, y], point) in depth.points(&camera) {
        let [u, v] = camera.project(point).unwrap();
        assert!((u - x as f64 - 0.5).abs() < 1e-9 && (v - y as f64 - 0.5).abs() < 1e-9, "[{x}, {y}]: [{u}, {v}]");
    }
}

fn assert_points_equal_hits(
    data: &Data,
    eye: &Eye,
    points: &[([usize; 2], [f64; 3])],
    segmentation: &SegmentationImage,
) {
    let [width, height] = SIZE;
    let hit = |pixel: [usize; 2]| {
        let [origin, direction] = eye.ray(pixel);
        data.ray(origin, direction, &RayOptions::default()).unwrap()
    };
    let hits: Vec<_> = (0..width * height).map(|index| hit([index % width, index / width])).collect();
    let mut found = vec![None; hits.len()];
    for &([x, y], point) in points {
        found[y * width + x] = Some(point);
    }
    let mut counts = [0; 4]; // sky, floor, box, sphere
    for (y, x) in (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| (y, x))) {
        let geom = |index: usize| hits[index].map(|hit| hit.geom);
        let index = y * width + x;
        let around = (0..9).map(|place| (y + place / 3 - 1) * width + x + place % 3 - 1);
        if around.into_iter().any(|neighbour| geom(neighbour) != geom(index)) {
            continue; // an outline
        }
        let seen = segmentation.pixel(x, y).map(|segment| segment.object.unwrap());
        assert_eq!(seen, hits[index].map(|hit| Object::Geom(hit.geom)), "[{x}, {y}]");
        let Some(hit) = hits[index] else {
            assert_eq!(found[index], None, "sky at [{x}, {y}]");
            counts[0] += 1;
            continue;
        };
        let [origin, direction] = eye.ray([x, y]);
        let expected = [0, 1, 2].map(|axis| origin[axis] + hit.distance * direction[axis]);
        let length = |vector: [f64; 3]| vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        let name = data.geom(hit.geom).name().unwrap();
        if name == "sphere" {
            let center = data.geom(hit.geom).xpos();
            let slope: f64 = (0..3).map(|axis| (expected[axis] - center[axis]) * direction[axis]).sum();
            if slope.abs() / (0.3 * length(direction)) < 15_f64.to_radians().sin() {
                continue;
            }
        }
        let point = found[index].unwrap_or_else(|| panic!("no point on the {name} at [{x}, {y}]"));
        let error = length([0, 1, 2].map(|axis| point[axis] - expected[axis]));
        let limit = PRECISION * hit.distance * length(direction);
        assert!(error <= limit, "{name} at [{x}, {y}]: {point:?}, the ray hits {expected:?}");
        counts[["", "floor", "box", "sphere"].iter().position(|geom| *geom == name).unwrap()] += 1;
    }
    assert!(counts.iter().all(|&count| count > 100), "pixels of sky, floor, box and sphere: {counts:?}");
}

#[test]
fn pinhole_camera_of_an_unsuitable_scene_is_an_error() {
    let (mut data, mut renderer) = table();
    let is_invalid = |result| matches!(result, Err(Error::Invalid { .. }));
    assert!(is_invalid(Scene::new(data.model(), 1).unwrap().pinhole_camera(4, 3)), "never updated");
    let mut snapshot = renderer.snapshot(&mut data, "tilted").unwrap();
    assert!(is_invalid(snapshot.scene().pinhole_camera(0, 3)) && is_invalid(snapshot.scene().pinhole_camera(4, 0)));
    let transform = Transform { translate: [0.0; 3], rotate: [1.0, 0.0, 0.0, 0.0], scale: 2.0 };
    snapshot.scene_mut().set_transform(Some(transform)).unwrap();
    let error = snapshot.pinhole_camera().unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::Invalid { .. })), "{error}");
}

#[test]
fn camera_with_two_eyes_has_the_pinhole_model_of_the_image() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    data.edit_model(|model| model.cam_ipd_mut().fill(0.2)).unwrap();
    data.forward().unwrap();
    let renderer = Renderer::on(stage::gpu(), data.model(), 160, 120, RendererOptions::default());
    let camera = renderer.unwrap().snapshot(&mut data, "side").unwrap().pinhole_camera().unwrap();
    Eye::of_model(&data, "side").assert_equals(&camera);
}

/// Returns the centroid of the pixels that show a geom, pixels from the upper left corner.
#[cfg(engine_since = "3.2.0")]
fn centroid(segmentation: &SegmentationImage, data: &Data, name: &str) -> [f64; 2] {
    let id = data.model().geom(name).unwrap().id();
    let width = segmentation.width();
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for (index, segment) in segmentation.pixels().enumerate() {
        if segment.and_then(|segment| segment.object) == Some(Object::Geom(id)) {
            sum = [sum[0] + (index % width) as f64 + 0.5, sum[1] + (index / width) as f64 + 0.5];
            count += 1.0;
        }
    }
    assert!(count > 20.0, "{count} pixels show {name}");
    sum.map(|sum| sum / count)
}

/// Looks down on two small spheres with the camera of this XML, and returns the centroids of `a`
/// and `b`, and the pinhole camera. Each point of the depth image is on a sphere.
#[cfg(engine_since = "3.2.0")]
fn spheres(camera: &str) -> ([[f64; 2]; 2], PinholeCamera) {
    let xml = format!(
        r#"<mujoco><worldbody><light pos="0 0 3"/><camera name="c" pos="0 0 2" {camera}/>
             <geom name="a" size=".03" pos=".3 .2 .5"/><geom name="b" size=".03" pos="-.35 -.25 0"/></worldbody></mujoco>"#
    );
    let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
    data.forward().unwrap();
    let mut renderer = Renderer::on(stage::gpu(), data.model(), 320, 240, RendererOptions::default()).unwrap();
    let mut snapshot = renderer.snapshot(&mut data, "c").unwrap();
    let (depth, segmentation) = (snapshot.depth().unwrap(), snapshot.segmentation().unwrap());
    let camera = snapshot.pinhole_camera().unwrap();
    let distance =
        |point: [f64; 3], centre: [f64; 3]| (0..3).map(|axis| (point[axis] - centre[axis]).powi(2)).sum::<f64>().sqrt();
    for (pixel, point) in depth.points(&camera) {
        let [a, b] = [[0.3, 0.2, 0.5], [-0.35, -0.25, 0.0]].map(|centre| distance(point, centre));
        assert!((a.min(b) - 0.03).abs() < 2e-3, "{pixel:?}: {point:?}");
        let [u, v] = camera.project(point).unwrap();
        assert!((u - pixel[0] as f64 - 0.5).abs() < 1e-9 && (v - pixel[1] as f64 - 0.5).abs() < 1e-9);
        let (origin, direction) = (camera.origin([u, v]), camera.direction([u, v]));
        let depth = f64::from(depth.metres(pixel[0], pixel[1]));
        assert!((0..3).all(|axis| (origin[axis] + depth * direction[axis] - point[axis]).abs() < 1e-9));
    }
    (["a", "b"].map(|name| centroid(&segmentation, &data, name)), camera)
}

#[cfg(engine_since = "3.2.0")]
#[test]
fn a_camera_with_a_sensor_has_its_focal_lengths_and_principal_point() {
    let sensor = r#"sensorsize=".0064 .0048" focal=".006 .004" principal="-.001 -.0012" resolution="320 240""#;
    let ([a, b], camera) = spheres(sensor);
    // Measured in the images of the official bindings: those of 3.5.0 have the principal point
    // mirrored vertically.
    let mirrored = cfg!(not(engine_since = "3.17.0"));
    let expected = [300.0, 200.0, 210.0, if mirrored { 60.0 } else { 180.0 }];
    for (actual, expected) in [camera.fx, camera.fy, camera.cx, camera.cy].into_iter().zip(expected) {
        assert!((actual - expected).abs() < 1e-3, "{camera:?}");
    }
    // 1.5 m and 2 m below the camera.
    let heights = if mirrored { [33.3, 85.0] } else { [153.3, 205.0] };
    for (at, expected) in [(a, [270.0, heights[0]]), (b, [157.5, heights[1]])] {
        assert!((0..2).all(|axis| (at[axis] - expected[axis]).abs() < 0.5), "{at:?} is not {expected:?}");
    }
}

/// Attributes of an orthographic camera.
#[cfg(engine_since = "3.2.0")]
const ORTHOGRAPHIC: &str =
    if cfg!(engine_since = "3.5.0") { r#"projection="orthographic""# } else { r#"orthographic="true""# };

#[cfg(engine_since = "3.2.0")]
#[test]
fn points_of_cameras_with_any_intrinsics_are_where_rays_hit() {
    let [width, height] = SIZE.map(|length| length as f64);
    // Sensor, focal length and principal point, m.
    for [sensor, focal, principal] in [
        [[0.0064, 0.0048], [0.006, 0.004], [0.0, 0.0]],
        [[0.0064, 0.0048], [0.006, 0.004], [-0.0008, -0.0004]],
        [[0.0064, 0.0048], [0.004, 0.006], [0.0009, 0.0006]],
        [[0.006, 0.006], [0.005, 0.005], [0.0006, -0.0007]],
        [[0.01, 0.004], [0.008, 0.003], [0.0015, 0.0003]],
        [[0.003, 0.009], [0.003, 0.007], [-0.0003, 0.001]],
    ] {
        let list = |[x, y]: [f64; 2]| format!("{x} {y}");
        let (sensor_text, focal_text, principal_text) = (list(sensor), list(focal), list(principal));
        let sensor_camera = format!(
            r#"sensorsize="{sensor_text}" focal="{focal_text}" principal="{principal_text}" resolution="160 120""#
        );
        let (mut data, mut renderer) = rendered(&TABLE.replace(r#"fovy="50""#, &sensor_camera));
        // See above: the principal point of 3.5.0 is mirrored vertically.
        let upwards = if cfg!(engine_since = "3.17.0") { 1.0 } else { -1.0 };
        let eye = Eye {
            focal: [width * focal[0] / sensor[0], height * focal[1] / sensor[1]],
            principal: [width * (0.5 - principal[0] / sensor[0]), height * (0.5 - upwards * principal[1] / sensor[1])],
            ..Eye::of_model(&data, "tilted")
        };
        let mut camera = Camera::fixed(data.model(), "tilted").unwrap();
        assert_images_equal_hits(&mut data, &mut renderer, &eye, &mut camera);
    }
}

#[cfg(engine_since = "3.2.0")]
#[test]
fn points_of_orthographic_cameras_are_where_rays_hit() {
    let xml = TABLE.replace(r#"fovy="50""#, &format!(r#"{ORTHOGRAPHIC} fovy="2.4""#));
    let (mut data, mut renderer) = rendered(&xml.replace(r#"fovy="38""#, r#"orthographic="true" fovy="3.5""#));
    let free = free(data.model());
    let orthographic = |eye: Eye, length: f64| Eye { focal: [SIZE[1] as f64 / length; 2], orthographic: true, ..eye };
    let fixed = Camera::fixed(data.model(), "tilted").unwrap();
    let eyes = [(Eye::of_model(&data, "tilted"), 2.4, fixed), (Eye::of_free(data.model(), &free), 3.5, free)];
    for (eye, length, mut camera) in eyes {
        assert_images_equal_hits(&mut data, &mut renderer, &orthographic(eye, length), &mut camera);
    }
}

#[cfg(engine_since = "3.2.0")]
#[test]
fn the_image_of_a_square_sensor_is_stretched() {
    let ([a, _], camera) = spheres(r#"sensorsize=".006 .006" focal=".006 .006" resolution="320 240""#);
    assert!((camera.fx - 320.0).abs() < 1e-3 && (camera.fy - 240.0).abs() < 1e-3, "{camera:?}");
    assert!((a[0] - 224.0).abs() < 0.5 && (a[1] - 88.0).abs() < 0.5, "{a:?}");
}

#[cfg(engine_since = "3.2.0")]
#[test]
fn an_orthographic_camera_has_the_same_scale_at_every_depth() {
    let ([a, b], camera) = spheres(&format!(r#"{ORTHOGRAPHIC} fovy="1.2""#));
    // 240 pixels are 1.2 m.
    assert!(camera.orthographic && (camera.fx - 200.0).abs() < 1e-3 && (camera.fy - 200.0).abs() < 1e-3, "{camera:?}");
    for (at, expected) in [(a, [220.0, 80.0]), (b, [90.0, 170.0])] {
        assert!((0..2).all(|axis| (at[axis] - expected[axis]).abs() < 0.3), "{at:?} is not {expected:?}");
    }
}
