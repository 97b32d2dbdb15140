//! Flat shapes: a square and a cube, subdivided into cells.

use super::{Tessellation, Triangles};

/// Generates the square from -1 to 1 in x and y with normal +z, subdivided into `cells` by `cells` cells.
pub(crate) fn plane(cells: u32) -> Triangles {
    let lines = uniform_lines(cells.clamp(1, Tessellation::MAX));
    plane_with_lines([&lines, &lines])
}

/// Generates the square from -1 to 1 with grid lines at these x and y, each in ascending order.
pub(crate) fn plane_with_lines(lines: [&[f32]; 2]) -> Triangles {
    let mut triangles = Triangles::default();
    grid(&mut triangles, lines, |u, v| [u, v, 0.0], [0.0, 0.0, 1.0]);
    triangles
}

/// Returns the lines from -1 to 1 that bound `cells` equal cells.
pub(crate) fn uniform_lines(cells: u32) -> Vec<f32> {
    // Exact at both ends and in the middle, so that adjacent grids have no gap.
    (0..=cells).map(|index| (2.0 * f64::from(index) / f64::from(cells) - 1.0) as f32).collect()
}

/// Generates the cube from -1 to 1, with each face subdivided into `cells` by `cells` cells. The +z face is the first.
pub(crate) fn cuboid(cells: u32) -> Triangles {
    let lines = uniform_lines(cells.clamp(1, Tessellation::MAX));
    let mut triangles = Triangles::default();
    let faces: [fn(f32, f32) -> [f32; 3]; 6] = [
        |u, v| [u, v, 1.0],
        |u, v| [u, -v, -1.0],
        |u, v| [1.0, u, v],
        |u, v| [-1.0, -u, v],
        |u, v| [-u, 1.0, v],
        |u, v| [u, -1.0, v],
    ];
    for face in faces {
        grid(&mut triangles, [&lines, &lines], face, face(0.0, 0.0));
    }
    // Convert negative zero to zero.
    for vertex in &mut triangles.vertices {
        vertex.normal = vertex.normal.map(|component| component + 0.0);
    }
    triangles
}

/// Appends a subdivided square with grid lines at these u and v. `at` maps (u, v) from -1 to 1 to a position; seen from the front, u
/// increases to the right and v upwards.
fn grid(triangles: &mut Triangles, lines: [&[f32]; 2], at: impl Fn(f32, f32) -> [f32; 3], normal: [f32; 3]) {
    let first = triangles.vertices.len() as u32;
    for &v in lines[1] {
        for &u in lines[0] {
            triangles.vertex(at(u, v), normal);
        }
    }
    let width = lines[0].len() as u32;
    for row in 1..lines[1].len() as u32 {
        for column in 1..width {
            let corner = first + (row - 1) * width + column - 1;
            triangles.quad([corner, corner + 1, corner + width + 1, corner + width]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{area, assert_closed, assert_normals_agree, border_edges, volume};
    use super::{Tessellation, cuboid, plane};

    #[test]
    fn a_plane_is_a_square_with_normal_z() {
        for cells in [1, 2, 7, 100] {
            let plane = plane(cells);
            assert_eq!(plane.indices.len(), 6 * (cells * cells) as usize);
            assert!((area(&plane) - 4.0).abs() < 1e-5);
            assert_eq!(border_edges(&plane), 4 * cells as usize, "a hole");
            assert_normals_agree(&plane, 1.0);
            assert!(plane.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
        }
    }

    #[test]
    fn the_number_of_cells_is_clamped() {
        assert_eq!(plane(0), plane(1));
        assert_eq!(plane(u32::MAX).indices.len(), plane(Tessellation::MAX).indices.len());
    }

    #[test]
    fn a_cube_is_closed_and_has_its_volume() {
        for cells in [1, 2, 4, 9] {
            let cube = cuboid(cells);
            assert_closed(&[&cube]);
            assert_normals_agree(&cube, 1.0);
            assert!((volume(&[&cube]) - 8.0).abs() < 1e-5);
            assert!((area(&cube) - 24.0).abs() < 1e-4);
        }
    }
}
