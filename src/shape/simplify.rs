//! Simplification of meshes by [meshoptimizer](https://meshoptimizer.org): collapses of edges in
//! the order of their quadric errors (Garland and Heckbert, "Surface simplification using quadric
//! error metrics", 1997).

use meshopt::SimplifyOptions;

/// Part of the error that the library receives. It estimates a distance as a root mean square, and
/// the largest distance of the meshes in the tests is up to 2.1 times the estimate.
const ESTIMATE: f64 = 0.4;

/// Vertices and triangles of a mesh.
pub(crate) type Surface = (Vec<[f32; 3]>, Vec<[i32; 3]>);

/// Returns a mesh whose surface is at most about `error` apart, m. `None` for a mesh that is not
/// simplified: without room for fewer triangles, or with an index or a coordinate that only an
/// edited model can have.
pub(crate) fn simplified(vertices: &[[f32; 3]], faces: &[[i32; 3]], error: f64) -> Option<Surface> {
    // The library does not check them.
    let is_finite = vertices.as_flattened().iter().all(|coordinate| coordinate.abs() <= 1e15);
    let index = |&index: &i32| u32::try_from(index).ok().filter(|&index| (index as usize) < vertices.len());
    let indices = faces.as_flattened().iter().map(index).collect::<Option<Vec<u32>>>()?;
    let target = (ESTIMATE * error) as f32;
    if !is_finite || !target.is_normal() {
        return None;
    }
    let options = SimplifyOptions::ErrorAbsolute;
    let simple = meshopt::simplify_decoder(&indices, vertices, 0, target, options, None);
    if simple.is_empty() || simple.len() >= indices.len() {
        return None;
    }
    // Triangles and vertices in the order of the surface need fewer bytes.
    let mut ordered = meshopt::optimize_vertex_cache(&simple, vertices.len());
    let vertices = meshopt::optimize_vertex_fetch(&mut ordered, vertices);
    let faces = ordered.as_chunks().0.iter().map(|face| face.map(u32::cast_signed)).collect();
    Some((vertices, faces))
}

#[cfg(test)]
mod tests {
    use super::{Surface, simplified};

    type Point = [f64; 3];

    fn minus(a: Point, b: Point) -> Point {
        std::array::from_fn(|axis| a[axis] - b[axis])
    }

    fn dot(a: Point, b: Point) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    fn along(from: Point, direction: Point, part: f64) -> Point {
        std::array::from_fn(|axis| from[axis] + part * direction[axis])
    }

    /// Distance of a point to a triangle: to its plane, if the foot is inside, or to its sides.
    fn distance(point: Point, [a, b, c]: [Point; 3]) -> f64 {
        let sides = [minus(b, a), minus(c, a)];
        let from_corner = minus(point, a);
        let [uu, uv, vv] = [[0, 0], [0, 1], [1, 1]].map(|[i, j]| dot(sides[i], sides[j]));
        let [wu, wv] = sides.map(|side| dot(from_corner, side));
        let determinant = uu * vv - uv * uv;
        let parts = [(wu * vv - wv * uv) / determinant, (wv * uu - wu * uv) / determinant];
        if parts.iter().all(|part| *part >= 0.0) && parts[0] + parts[1] <= 1.0 {
            let away = minus(point, along(along(a, sides[0], parts[0]), sides[1], parts[1]));
            return dot(away, away).sqrt();
        }
        [[a, b], [b, c], [c, a]]
            .map(|[from, to]| {
                let side = minus(to, from);
                let part = dot(minus(point, from), side) / dot(side, side).max(1e-300);
                let away = minus(point, along(from, side, part.clamp(0.0, 1.0)));
                dot(away, away).sqrt()
            })
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    fn triangles(vertices: &[[f32; 3]], faces: &[[i32; 3]]) -> Vec<[Point; 3]> {
        faces.iter().map(|face| face.map(|index| vertices[index as usize].map(f64::from))).collect()
    }

    /// Largest distance of samples of a surface, corners and centres, to another one.
    fn largest_distance(from: &[[Point; 3]], to: &[[Point; 3]]) -> f64 {
        let step = (from.len() / 40).max(1);
        let samples = from.iter().step_by(step).flat_map(|[a, b, c]| {
            let centre = std::array::from_fn(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
            [*a, centre]
        });
        let nearest = |point| to.iter().map(|&triangle| distance(point, triangle)).fold(f64::INFINITY, f64::min);
        samples.map(nearest).fold(0.0, f64::max)
    }

    /// Surface of a body of revolution about z with dents, of `2 * rings * slices` triangles.
    fn body(rings: u32, slices: u32, dents: f32) -> (Vec<[f32; 3]>, Vec<[i32; 3]>) {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for ring in 0..=rings {
            for slice in 0..slices {
                let along = ring as f32 / rings as f32;
                let around = std::f32::consts::TAU * slice as f32 / slices as f32;
                let dent = 1.0 + dents * (9.0 * along).sin() * (5.0 * around).cos();
                let radius = dent * (0.01 + (std::f32::consts::PI * along).sin()) * 0.05;
                vertices.push([radius * around.cos(), radius * around.sin(), 0.2 * along]);
                if ring < rings {
                    let next = (slice + 1) % slices;
                    let [a, b, c, d] = [(ring, slice), (ring, next), (ring + 1, next), (ring + 1, slice)]
                        .map(|(ring, slice)| (ring * slices + slice) as i32);
                    faces.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
        (vertices, faces)
    }

    #[test]
    fn the_surfaces_are_at_most_the_error_apart() {
        for (rings, slices, dents) in [(24, 24, 0.0), (24, 24, 0.2), (40, 12, 0.4)] {
            let (vertices, faces) = body(rings, slices, dents);
            let fine = triangles(&vertices, &faces);
            for error in [3e-4, 2e-3] {
                let (vertices, simple): Surface = simplified(&vertices, &faces, error).unwrap();
                let coarse = triangles(&vertices, &simple);
                let apart = largest_distance(&fine, &coarse).max(largest_distance(&coarse, &fine));
                println!("{} to {} triangles: {:.2} of {error}", fine.len(), coarse.len(), apart / error);
                assert!(apart <= error, "{apart} for {error}");
                assert!(apart > 0.1 * error, "a larger error leaves fewer triangles: {apart} for {error}");
                assert!(coarse.len() < fine.len());
            }
        }
    }

    #[test]
    fn an_error_of_zero_and_wrong_meshes_are_left_as_they_are() {
        let (vertices, faces) = body(20, 20, 0.0);
        for error in [0.0, f64::NAN, 1e300] {
            assert!(simplified(&vertices, &faces, error).is_none());
        }
        for index in [-1, i32::MAX, vertices.len() as i32] {
            let mut faces = faces.clone();
            faces[7][1] = index;
            assert!(simplified(&vertices, &faces, 1e-3).is_none());
        }
        for coordinate in [f32::NAN, f32::INFINITY, f32::MAX] {
            let mut vertices = vertices.clone();
            vertices[7][1] = coordinate;
            assert!(simplified(&vertices, &faces, 1e-3).is_none());
        }
        assert!(simplified(&[], &[], 1e-3).is_none());
        // Without an extent.
        let flat = vec![[1.0; 3]; vertices.len()];
        assert!(simplified(&flat, &faces, 1e-3).is_none_or(|(_, faces)| faces.len() < 800));
    }
}
