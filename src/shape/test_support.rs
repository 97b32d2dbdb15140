//! Geometric checks of triangle meshes for the tests of the shapes.

use std::collections::HashMap;

use super::{Tessellation, Triangles, face_normal};

type Point = [f32; 3];

/// Returns tessellations with few, odd and many subdivisions.
pub(crate) fn tessellations() -> [Tessellation; 5] {
    [(3, 2, 1), (4, 3, 2), (5, 7, 3), (28, 16, 4), (29, 17, 5)]
        .map(|(slices, stacks, quads)| Tessellation::new(slices, stacks, quads))
}

/// Applies a rigid transformation, which must not be a reflection.
pub(crate) fn transformed(triangles: &Triangles, transform: impl Fn(Point) -> Point) -> Triangles {
    let origin = transform([0.0; 3]);
    let mut triangles = triangles.clone();
    for vertex in &mut triangles.vertices {
        vertex.position = transform(vertex.position);
        let normal = transform(vertex.normal);
        vertex.normal = [0, 1, 2].map(|axis| normal[axis] - origin[axis]);
    }
    triangles
}

pub(crate) fn faces(triangles: &Triangles) -> impl Iterator<Item = [Point; 3]> + '_ {
    let (faces, rest) = triangles.indices.as_chunks::<3>();
    assert!(rest.is_empty());
    faces.iter().map(|face| face.map(|index| triangles.vertices[index as usize].position))
}

/// Counts the directed edges of all triangles.
fn edges<'a>(surfaces: impl IntoIterator<Item = &'a Triangles>) -> HashMap<[[u32; 3]; 2], i32> {
    let mut edges = HashMap::new();
    for [a, b, c] in surfaces.into_iter().flat_map(faces) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            // Convert negative zero to zero.
            let edge = [from, to].map(|point| point.map(|coordinate| (coordinate + 0.0).to_bits()));
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

/// Asserts that each edge occurs equally often in both directions: the surface has no hole and a
/// consistent orientation.
pub(crate) fn assert_closed(surfaces: &[&Triangles]) {
    let edges = edges(surfaces.iter().copied());
    assert!(!edges.is_empty());
    for ([from, to], count) in &edges {
        let back = edges.get(&[*to, *from]);
        let shown = [from, to].map(|point| point.map(f32::from_bits));
        assert_eq!(back, Some(count), "the edge {shown:?}");
    }
}

/// Returns the number of edges without a neighbouring triangle.
pub(crate) fn border_edges(triangles: &Triangles) -> usize {
    let edges = edges([triangles]);
    edges.iter().filter(|([from, to], count)| edges.get(&[*to, *from]).unwrap_or(&0) < *count).count()
}

/// Asserts that all vertex normals have unit length and deviate from the face normals by at most
/// `acos(least)`.
pub(crate) fn assert_normals_agree(triangles: &Triangles, least: f32) {
    for vertex in &triangles.vertices {
        let length = vertex.normal.iter().map(|component| component * component).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "{vertex:?}");
    }
    for face in triangles.indices.as_chunks::<3>().0 {
        let vertices = face.map(|index| triangles.vertices[index as usize]);
        let flat = face_normal(vertices.map(|vertex| vertex.position)).expect("finite");
        for vertex in vertices {
            let dot = vertex.normal.iter().zip(flat).map(|(a, b)| a * b).sum::<f32>();
            assert!(dot >= least - 1e-5, "{dot} at {vertex:?} of a triangle with normal {flat:?}");
        }
    }
}

/// Returns six times the signed volume between a triangle and the origin, and twice the area vector
/// of the triangle.
fn products([a, b, c]: [Point; 3]) -> (f64, [f64; 3]) {
    let [a, b, c] = [a, b, c].map(|point| point.map(f64::from));
    let cross =
        |u: [f64; 3], v: [f64; 3]| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let difference = |u: [f64; 3], v: [f64; 3]| [0, 1, 2].map(|axis| u[axis] - v[axis]);
    let volume = cross(b, c).iter().zip(a).map(|(product, coordinate)| product * coordinate).sum();
    (volume, cross(difference(b, a), difference(c, a)))
}

/// Returns the volume enclosed by a closed surface, from the divergence theorem.
pub(crate) fn volume(surfaces: &[&Triangles]) -> f64 {
    surfaces.iter().flat_map(|surface| faces(surface)).map(|face| products(face).0 / 6.0).sum()
}

pub(crate) fn area(triangles: &Triangles) -> f64 {
    faces(triangles).map(|face| products(face).1.iter().map(|part| part * part).sum::<f64>().sqrt() / 2.0).sum()
}

pub(crate) fn assert_finite(triangles: &Triangles) {
    assert!(triangles.indices.iter().all(|&index| (index as usize) < triangles.vertices.len()));
    for vertex in &triangles.vertices {
        let mut numbers = vertex.position.iter().chain(&vertex.normal).chain(&vertex.texcoord);
        assert!(numbers.all(|number| number.is_finite()), "{vertex:?}");
    }
}
