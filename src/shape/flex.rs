//! Triangles of flexes in the world frame, which change in every frame: faces, cylinders along the
//! edges, and spheres at the vertices.

use std::ops::Range;

use super::{Tessellation, Triangles, Vertex, cylinder, finite_or_zero, sphere};
use crate::scene::SceneFlex;

/// Largest number of vertices of the edges and vertices of a flex that have the tessellation of the
/// model. It keeps the cost of a frame of large flexes low.
const MAX_VERTICES: usize = 1 << 18;

/// Subdivisions of the cylinders and spheres of larger flexes.
const SMALL: Tessellation = Tessellation { slices: 8, stacks: 4, quads: 1 };

/// Generates the triangles of some of the faces of a flex.
pub(crate) fn flex_faces(flex: &SceneFlex<'_>, faces: Range<usize>) -> Triangles {
    let mut triangles = Triangles::default();
    let faces = flex.faces.iter().zip(flex.normals).zip(flex.texcoords).skip(faces.start).take(faces.len());
    for ((positions, normals), texcoords) in faces {
        let corners = positions.iter().zip(normals).zip(texcoords);
        if !positions.as_flattened().iter().chain(normals.as_flattened()).all(|number| number.is_finite()) {
            continue;
        }
        for ((&position, &normal), &texcoord) in corners {
            triangles.indices.push(triangles.vertices.len() as u32);
            triangles.vertices.push(Vertex { position, normal, texcoord: texcoord.map(finite_or_zero), parity: 0.0 });
        }
    }
    triangles
}

/// Generates the triangles of the edges and vertices of a flex, if the scene shows them.
pub(crate) fn flex_skeleton(flex: &SceneFlex<'_>, radius: f32, tessellation: Tessellation) -> Triangles {
    let mut triangles = Triangles::default();
    if !(radius.is_finite() && radius > 0.0) {
        return triangles;
    }
    let shapes =
        usize::from(flex.shows_edges) * flex.edges.len() + usize::from(flex.shows_vertices) * flex.vertices.len();
    let vertices_of_shape = (tessellation.slices as usize + 1) * (tessellation.stacks as usize + 1);
    let is_small = shapes.saturating_mul(vertices_of_shape) <= MAX_VERTICES;
    let (round, stacks) = if is_small { (tessellation, tessellation.stacks) } else { (SMALL, 1) };
    let position = |vertex: i32| usize::try_from(vertex).ok().and_then(|vertex| flex.vertices.get(vertex)).copied();
    if flex.shows_edges {
        let side = cylinder(round.slices, stacks);
        for &[start, end] in flex.edges {
            let Some((start, end)) = position(start).zip(position(end)) else { continue };
            triangles.extend_along(&side, start, end, radius);
        }
    }
    if flex.shows_vertices {
        let ball = sphere(round);
        for &centre in flex.vertices.iter().filter(|position| position.iter().all(|number| number.is_finite())) {
            triangles.extend_by(
                &ball,
                |at| std::array::from_fn(|axis| centre[axis] + radius * at[axis]),
                |normal| normal,
            );
        }
    }
    triangles
}

impl Triangles {
    /// Appends the cylinder with unit radius from z = -1 to 1, transformed to a radius and two
    /// ends. Skips non-finite and coinciding ends.
    fn extend_along(&mut self, cylinder: &Self, start: [f32; 3], end: [f32; 3], radius: f32) {
        let half: [f32; 3] = std::array::from_fn(|axis| 0.5 * (end[axis] - start[axis]));
        let middle: [f32; 3] = std::array::from_fn(|axis| start[axis] + half[axis]);
        let length = half.iter().map(|number| number * number).sum::<f32>().sqrt();
        if !(length.is_finite() && length > 0.0 && middle.iter().all(|number| number.is_finite())) {
            return;
        }
        let along = half.map(|number| number / length);
        // Derive the first radial direction from the coordinate axis that is farthest from the
        // edge.
        let axis = (0..3).min_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        let mut first: [f32; 3] = std::array::from_fn(|i| f32::from(i == axis) - along[axis] * along[i]);
        let norm = first.iter().map(|number| number * number).sum::<f32>().sqrt();
        first = first.map(|number| number / norm);
        let second: [f32; 3] = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            along[j] * first[k] - along[k] * first[j]
        });
        let combine = |[x, y, z]: [f32; 3], third: [f32; 3]| -> [f32; 3] {
            std::array::from_fn(|i| x * first[i] + y * second[i] + z * third[i])
        };
        self.extend_by(
            cylinder,
            |[x, y, z]| {
                let offset = combine([radius * x, radius * y, z], half);
                std::array::from_fn(|i| middle[i] + offset[i])
            },
            |normal| combine(normal, along),
        );
    }

    /// Appends another list with transformed positions and normals.
    pub(crate) fn extend_by(
        &mut self,
        other: &Self,
        position: impl Fn([f32; 3]) -> [f32; 3],
        normal: impl Fn([f32; 3]) -> [f32; 3],
    ) {
        let first = self.vertices.len() as u32;
        self.indices.extend(other.indices.iter().map(|index| first + index));
        self.vertices.extend(other.vertices.iter().map(|vertex| Vertex {
            position: position(vertex.position),
            normal: normal(vertex.normal),
            texcoord: [0.0; 2],
            parity: 0.0,
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{assert_closed, assert_finite, assert_normals_agree, volume};
    use super::{Tessellation, flex_faces, flex_skeleton};
    use crate::scene::SceneFlex;

    const ROUND: Tessellation = Tessellation { slices: 8, stacks: 4, quads: 1 };

    const FLEX: SceneFlex<'static> = SceneFlex {
        flex: 0,
        vertices: &[[1.0, 2.0, 3.0], [1.0, 2.0, 5.0]],
        edges: &[[0, 1], [1, 0], [0, 0], [0, 9]],
        faces: &[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[f32::NAN; 3]; 3]],
        normals: &[[[0.0, 0.0, 1.0]; 3]; 2],
        texcoords: &[[[0.0; 2], [1.0, 0.0], [f32::NAN, 1.0]]; 2],
        shows_vertices: false,
        shows_edges: false,
    };

    #[test]
    fn faces_are_triangles_and_non_finite_faces_are_skipped() {
        let triangles = flex_faces(&FLEX, 0..2);
        assert_eq!(triangles.indices, [0, 1, 2]);
        assert_normals_agree(&triangles, 1.0);
        assert_finite(&triangles);
        assert!(flex_faces(&FLEX, 1..9).indices.is_empty());
    }

    #[test]
    fn edges_are_cylinders_between_their_vertices() {
        let triangles = flex_skeleton(&SceneFlex { shows_edges: true, edges: &[[0, 1]], ..FLEX }, 0.1, ROUND);
        assert_normals_agree(&triangles, 0.9);
        for vertex in &triangles.vertices {
            let [x, y, z] = vertex.position;
            assert!(((x - 1.0).hypot(y - 2.0) - 0.1).abs() < 1e-6 && (3.0..=5.0).contains(&z), "{vertex:?}");
        }
        // Coinciding and nonexistent vertices have no cylinder.
        let all = flex_skeleton(&SceneFlex { shows_edges: true, ..FLEX }, 0.1, ROUND);
        assert_eq!(all.indices.len(), 2 * triangles.indices.len());
    }

    #[test]
    fn vertices_are_closed_spheres() {
        let triangles =
            flex_skeleton(&SceneFlex { shows_vertices: true, vertices: &[[1.0, 2.0, 3.0]], ..FLEX }, 0.5, ROUND);
        assert_closed(&[&triangles]);
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 0.125;
        assert!((0.7..1.0).contains(&(volume(&[&triangles]) / exact)), "{}", volume(&[&triangles]));
    }
}
