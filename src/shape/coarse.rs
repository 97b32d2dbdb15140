//! Coarser versions of meshes whose triangles are small on the screen, by vertex clustering
//! (Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993).

use std::collections::HashMap;

use super::{Triangles, Vertex};

/// Maximum number of coarser levels of a mesh.
pub(crate) const MESH_LEVELS: usize = 6;

/// Cosine of the angle from which two normals of a cluster stay apart, as at an edge.
const SAME_NORMAL: f64 = 0.8;

/// Returns coarser levels of a mesh, each with the width of its cells: the largest distance between
/// vertices that it merges, along an axis. Each level has at most two thirds of the triangles of
/// the one before. They have no texture coordinates, which jump where a texture has a seam.
pub(crate) fn coarse_levels(mesh: &Triangles) -> Vec<(f32, Triangles)> {
    /// A mesh with fewer triangles is drawn in little time.
    const MIN_TRIANGLES: usize = 128;
    let mut levels: Vec<(f32, Triangles)> = Vec::new();
    let mut cell = mean_edge(mesh);
    if !cell.is_normal() {
        return levels;
    }
    let places = Places::new(mesh);
    for _ in 0..2 * MESH_LEVELS {
        let finer = levels.last().map_or(mesh, |(_, level)| level);
        if finer.indices.len() < 3 * MIN_TRIANGLES || levels.len() == MESH_LEVELS {
            break;
        }
        cell *= std::f32::consts::SQRT_2;
        let coarser = clustered(mesh, &places, cell);
        if 3 * coarser.indices.len() <= 2 * finer.indices.len() {
            levels.push((cell, coarser));
        }
    }
    levels
}

/// Returns the mean length of the edges.
fn mean_edge(mesh: &Triangles) -> f32 {
    let (faces, _) = mesh.indices.as_chunks::<3>();
    let at = |index: u32| mesh.vertices[index as usize].position;
    let lengths = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[from, to]| {
        let [from, to] = [at(from), at(to)];
        (0..3).map(|axis| f64::from(to[axis] - from[axis]).powi(2)).sum::<f64>().sqrt()
    });
    (lengths.sum::<f64>() / mesh.indices.len().max(1) as f64) as f32
}

/// Merges the vertices in each cell of a cubic grid whose normals are in the same octant, and omits
/// the triangles that collapse. A closed mesh stays closed: vertices at the same place stay
/// together.
fn clustered(mesh: &Triangles, places: &Places, cell: f32) -> Triangles {
    let clusters = Clusters::new(places, cell);
    let mut coarse = Triangles::default();
    // The vertices of each cluster: the first, and the next after each. They differ in their
    // normals.
    let mut first = vec![u32::MAX; clusters.positions.len()];
    let mut next: Vec<u32> = Vec::new();
    let mut cluster_of_vertex = Vec::new();
    let vertices: Vec<u32> = mesh
        .vertices
        .iter()
        .zip(&places.of_vertex)
        .map(|(vertex, &place)| {
            let cluster = clusters.of_place[place as usize];
            let mut known = first[cluster as usize];
            while known != u32::MAX && !have_same_normal(&coarse.vertices[known as usize], vertex) {
                known = next[known as usize];
            }
            if known == u32::MAX {
                known = coarse.vertices.len() as u32;
                coarse.vertices.push(Vertex {
                    position: clusters.positions[cluster as usize],
                    texcoord: [0.0; 2],
                    ..*vertex
                });
                cluster_of_vertex.push(cluster);
                next.push(std::mem::replace(&mut first[cluster as usize], known));
            }
            known
        })
        .collect();
    for face in mesh.indices.as_chunks::<3>().0 {
        let corners = face.map(|index| vertices[index as usize]);
        let [a, b, c] = corners.map(|index| cluster_of_vertex[index as usize]);
        if a != b && b != c && c != a {
            coarse.indices.extend(corners);
        }
    }
    average_normals(&mut coarse, mesh, &vertices);
    coarse
}

/// The normals of a model may have any length. Double precision has no overflow.
fn have_same_normal(a: &Vertex, b: &Vertex) -> bool {
    let [a, b] = [a, b].map(|vertex| vertex.normal.map(f64::from));
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(a, b) >= SAME_NORMAL * (dot(a, a) * dot(b, b)).sqrt()
}

/// Replaces each normal by the mean of the normals that it replaces. `vertices` has the coarse
/// vertex of each vertex of the mesh.
fn average_normals(coarse: &mut Triangles, mesh: &Triangles, vertices: &[u32]) {
    let mut sums = vec![[0.0; 3]; coarse.vertices.len()];
    for (vertex, &at) in mesh.vertices.iter().zip(vertices) {
        add(&mut sums[at as usize], vertex.normal);
    }
    for (vertex, sum) in coarse.vertices.iter_mut().zip(sums) {
        let length = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
        if length > 0.0 {
            vertex.normal = sum.map(|part| (part / length) as f32);
        }
    }
}

fn add(sum: &mut [f64; 3], vector: [f32; 3]) {
    for (sum, part) in sum.iter_mut().zip(vector) {
        *sum += f64::from(part);
    }
}

/// Distinct positions of the vertices of a mesh.
struct Places {
    positions: Vec<[f32; 3]>,
    /// Sum of the normals of the vertices at each position.
    normals: Vec<[f64; 3]>,
    of_vertex: Vec<u32>,
}

impl Places {
    fn new(mesh: &Triangles) -> Self {
        let mut places = Self { positions: Vec::new(), normals: Vec::new(), of_vertex: Vec::new() };
        let mut known = HashMap::new();
        for vertex in &mesh.vertices {
            // Adding zero converts negative zero.
            let bits = vertex.position.map(|coordinate| (coordinate + 0.0).to_bits());
            let place = *known.entry(bits).or_insert_with(|| {
                places.positions.push(vertex.position);
                places.normals.push([0.0; 3]);
                places.positions.len() as u32 - 1
            });
            add(&mut places.normals[place as usize], vertex.normal);
            places.of_vertex.push(place);
        }
        places
    }
}

/// Positions that are merged.
struct Clusters {
    /// Means of the positions.
    positions: Vec<[f32; 3]>,
    of_place: Vec<u32>,
}

impl Clusters {
    fn new(places: &Places, cell: f32) -> Self {
        let mut known = HashMap::new();
        let mut sums: Vec<([f64; 3], f64)> = Vec::new();
        let mut of_place = Vec::with_capacity(places.positions.len());
        for (position, normal) in places.positions.iter().zip(&places.normals) {
            // As bits, because f32 is no key. Adding zero converts negative zero.
            let at = position.map(|coordinate| ((coordinate / cell).floor() + 0.0).to_bits());
            let octant = normal.map(|part| part < 0.0);
            let cluster = *known.entry((at, octant)).or_insert_with(|| {
                sums.push(([0.0; 3], 0.0));
                sums.len() as u32 - 1
            });
            let (sum, count) = &mut sums[cluster as usize];
            add(sum, *position);
            *count += 1.0;
            of_place.push(cluster);
        }
        let positions = sums.into_iter().map(|(sum, count)| sum.map(|sum| (sum / count) as f32)).collect();
        Self { positions, of_place }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{assert_closed, assert_finite, faces, volume};
    use super::super::{Tessellation, Triangles, cuboid, sphere};
    use super::{MESH_LEVELS, coarse_levels};

    fn fine_sphere() -> Triangles {
        sphere(Tessellation::new(120, 60, 1))
    }

    #[test]
    fn coarser_levels_of_a_closed_mesh_are_closed_and_have_its_volume() {
        let sphere = fine_sphere();
        let levels = coarse_levels(&sphere);
        assert!((3..=MESH_LEVELS).contains(&levels.len()), "{}", levels.len());
        let mut finer = &sphere;
        for (cell, level) in &levels {
            assert_closed(&[level]);
            assert!(3 * level.indices.len() <= 2 * finer.indices.len());
            let error = 1.0 - volume(&[level]) / volume(&[&sphere]);
            assert!(error.abs() < 0.5 * f64::from(*cell), "{error} with cells of {cell}");
            finer = level;
        }
    }

    #[test]
    fn coarser_levels_have_the_positions_and_normals_of_the_surface() {
        for (cell, level) in coarse_levels(&fine_sphere()) {
            for vertex in &level.vertices {
                let cosine: f32 = vertex.normal.iter().zip(vertex.position).map(|(n, p)| n * p).sum();
                // Vertices in a cell are at most the square root of three cells apart.
                assert!((1.0 - cell * cell..=1.0 + 1e-5).contains(&cosine), "{cosine} with cells of {cell}");
            }
        }
    }

    #[test]
    fn the_sides_of_a_box_stay_flat_and_apart() {
        let mut cuboid = cuboid(20);
        for vertex in &mut cuboid.vertices {
            // A plate, thinner than the coarse cells.
            vertex.position[2] *= 0.001;
        }
        let levels = coarse_levels(&cuboid);
        assert!(!levels.is_empty());
        for (_, level) in levels {
            assert_closed(&[&level]);
            for vertex in &level.vertices {
                assert!(vertex.normal.iter().any(|part| part.abs() == 1.0), "{vertex:?}");
            }
            let heights: Vec<f32> = faces(&level).flatten().map(|[_, _, z]| z).collect();
            let (low, high) =
                (heights.iter().copied().fold(0.0, f32::min), heights.iter().copied().fold(0.0, f32::max));
            assert!((low + 0.001).abs() < 1e-6 && (high - 0.001).abs() < 1e-6, "{low} to {high}");
        }
    }

    #[test]
    fn normals_of_any_length_and_huge_positions_are_merged() {
        let counts = |mesh: &Triangles| -> Vec<usize> {
            let count = |(_, level): (f32, Triangles)| {
                assert_finite(&level);
                level.vertices.len()
            };
            coarse_levels(mesh).into_iter().map(count).collect()
        };
        let sphere = fine_sphere();
        for (of_normal, of_position) in [(0.85, 1.0), (f32::MAX, 1.0), (1.0, 2f32.powi(125))] {
            let mut scaled = sphere.clone();
            for vertex in &mut scaled.vertices {
                vertex.normal = vertex.normal.map(|part| part * of_normal);
                vertex.position = vertex.position.map(|part| part * of_position);
            }
            assert_eq!(counts(&scaled), counts(&sphere), "{of_normal} {of_position}");
        }
    }

    #[test]
    fn coarser_levels_have_no_texture_coordinates() {
        let sphere = fine_sphere();
        assert!(sphere.vertices.iter().any(|vertex| vertex.texcoord != [0.0; 2]));
        for (_, level) in coarse_levels(&sphere) {
            assert!(level.vertices.iter().all(|vertex| vertex.texcoord == [0.0; 2]));
        }
    }

    #[test]
    fn meshes_with_few_triangles_have_no_coarser_level() {
        assert!(coarse_levels(&Triangles::default()).is_empty());
        assert!(coarse_levels(&sphere(Tessellation::new(8, 4, 1))).is_empty());
    }
}
