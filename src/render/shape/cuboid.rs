//! A cube.

use super::plane::grid;
use super::{Detail, Triangles};

/// The cube from -1 to 1, each face of `cells` by `cells` squares. The face whose normal is z comes first.
pub(crate) fn cuboid(cells: u32) -> Triangles {
    let cells = cells.clamp(1, Detail::MOST);
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
        grid(&mut triangles, cells, face, face(0.0, 0.0));
    }
    // A zero that has been negated is a zero.
    for vertex in &mut triangles.vertices {
        vertex.normal = vertex.normal.map(|component| component + 0.0);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::super::check::{area, assert_closed, assert_normals_agree, volume};
    use super::cuboid;

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
