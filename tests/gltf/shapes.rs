//! Volumes, bounds and normals of the triangles.

use std::f64::consts::PI;

use mujoco_safe::Model;
use mujoco_safe::nalgebra::Vector3;

use crate::file::{SHAPES, Triangles, still};

fn vectors(triangles: &Triangles, [a, b, c]: [usize; 3]) -> [Vector3<f64>; 3] {
    [a, b, c].map(|at| Vector3::from(triangles.positions[at].map(f64::from)))
}

fn volume(triangles: &Triangles) -> f64 {
    triangles
        .indices
        .iter()
        .map(|&corners| vectors(triangles, corners))
        .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
        .sum()
}

/// Returns the sum of the areas as vectors, which is zero for a closed surface.
fn opening(triangles: &Triangles) -> Vector3<f64> {
    triangles.indices.iter().map(|&corners| vectors(triangles, corners)).map(|[a, b, c]| (b - a).cross(&(c - a))).sum()
}

#[test]
fn shapes_have_the_volumes_and_bounds_of_the_engine() {
    let mut model = Model::from_xml_str(SHAPES).unwrap();
    for (index, elevation) in model.edit().height_field_mut("hill").unwrap().data_mut().iter_mut().enumerate() {
        *elevation = (index as f32).sin().abs();
    }
    let elevations: Vec<f64> =
        model.height_field("hill").unwrap().data().iter().map(|&value| f64::from(value)).collect();
    // Mean of the elevations at the corners of the triangles, whose diagonals join the corners of
    // least and of greatest coordinates.
    let mean: f64 = (0..2)
        .flat_map(|row| (0..3).map(move |column| [row, column]))
        .map(|[row, column]| {
            let at = |i: usize, j: usize| elevations[4 * (row + i) + column + j];
            (2.0 * at(0, 0) + 2.0 * at(1, 1) + at(0, 1) + at(1, 0)) / 6.0
        })
        .sum::<f64>()
        / 6.0;
    let file = still(&model);
    // The exact volume, and the part of it that 24 slices and 12 stacks have at least.
    for (name, exact, part, half) in [
        ("sphere", 4.0 / 3.0 * PI * 1e-3, 0.96, [0.1, 0.1, 0.1]),
        ("ellipsoid", 4.0 / 3.0 * PI * 6e-3, 0.96, [0.1, 0.2, 0.3]),
        ("box", 8.0 * 6e-3, 1.0, [0.1, 0.2, 0.3]),
        ("capsule", PI * 0.01 * 0.4 + 4.0 / 3.0 * PI * 1e-3, 0.97, [0.1, 0.1, 0.3]),
        ("cylinder", PI * 0.01 * 0.4, 0.98, [0.1, 0.1, 0.2]),
        ("site", 4.0 / 3.0 * PI * 0.05_f64.powi(3), 0.96, [0.05, 0.05, 0.05]),
        ("prism", 0.4 * 0.3 * 0.2 / 6.0, 1.0, [f64::NAN; 3]),
        ("hill", 2.0 * 4.0 * (0.1 + 0.5 * mean), 1.0, [1.0, 2.0, f64::NAN]),
    ] {
        let node = file.shown(name);
        let triangles = file.triangles(&node);
        let found = volume(&triangles) / exact;
        assert!(found <= 1.0 + 1e-5 && found >= part - 1e-5, "{name}: {found}");
        assert!(opening(&triangles).norm() < 1e-5, "{name} is closed: {}", opening(&triangles));
        let bounds = node.mesh().unwrap().primitives().next().unwrap().bounding_box();
        for axis in (0..3).filter(|&axis| half[axis].is_finite()) {
            let expected = half[axis] as f32;
            assert_eq!([bounds.min[axis], bounds.max[axis]], [-expected, expected], "{name}");
        }
        // A mesh with texture coordinates is smooth at all edges.
        let least = if name == "prism" { -1e-6 } else { 0.7 };
        for &corners in &triangles.indices {
            let [a, b, c] = vectors(&triangles, corners);
            let face = (b - a).cross(&(c - a)).normalize();
            for corner in corners {
                let normal = Vector3::from(triangles.normals[corner].map(f64::from));
                assert!((normal.norm() - 1.0).abs() < 1e-5 && normal.dot(&face) > least, "{name}: {normal} {face}");
            }
        }
    }
}

#[test]
fn an_infinite_plane_ends_beyond_all_bodies() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let file = still(&model);
    let bounds = file.shown("plane").mesh().unwrap().primitives().next().unwrap().bounding_box();
    let extent = model.statistics().extent as f32;
    assert!(bounds.max[0] > 5.0 * extent && bounds.max[0] < 5.0 * extent + 10.0, "{bounds:?} {extent}");
}

#[test]
fn equal_shapes_share_their_vertices() {
    let spheres = "<body pos='1 0 0'><geom size='.1'/></body>".repeat(50);
    let model = |bodies: &str| {
        Model::from_xml_str(&format!("<mujoco><worldbody><geom size='.1'/>{bodies}</worldbody></mujoco>")).unwrap()
    };
    let [one, many] = [model(""), model(&spheres)].map(|model| still(&model));
    assert_eq!(many.gltf.meshes().len(), 1);
    assert_eq!(many.gltf.blob.as_ref().unwrap().len(), one.gltf.blob.as_ref().unwrap().len());
}
