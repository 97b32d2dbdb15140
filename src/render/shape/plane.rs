//! A square.

use super::{Detail, Triangles};

/// The square from -1 to 1 along x and y, facing along z, of `cells` by `cells` smaller ones.
pub(crate) fn plane(cells: u32) -> Triangles {
    let cells = cells.clamp(1, Detail::MOST);
    let mut triangles = Triangles::default();
    grid(&mut triangles, cells, |u, v| [u, v, 0.0], [0.0, 0.0, 1.0]);
    triangles
}

/// Adds a square, whose points `at` gives for numbers from -1 to 1 that grow to the right and upwards to one who looks at it.
pub(super) fn grid(triangles: &mut Triangles, cells: u32, at: impl Fn(f32, f32) -> [f32; 3], normal: [f32; 3]) {
    let first = triangles.vertices.len() as u32;
    // The ends are exact, and the middle too: neighbours meet.
    let coordinate = |index: u32| (2.0 * f64::from(index) / f64::from(cells) - 1.0) as f32;
    for row in 0..=cells {
        for column in 0..=cells {
            triangles.vertex(at(coordinate(column), coordinate(row)), normal);
        }
    }
    let width = cells + 1;
    for row in 0..cells {
        for column in 0..cells {
            let corner = first + row * width + column;
            triangles.rectangle([corner, corner + 1, corner + width + 1, corner + width]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{area, assert_normals_agree, border};
    use super::plane;

    #[test]
    fn a_plane_is_the_square_and_faces_upwards() {
        for cells in [1, 2, 7, 100] {
            let plane = plane(cells);
            assert_eq!(plane.indices.len(), 6 * (cells * cells) as usize);
            assert!((area(&plane) - 4.0).abs() < 1e-5);
            assert_eq!(border(&plane), 4 * cells as usize, "a hole");
            assert_normals_agree(&plane, 1.0);
            assert!(plane.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
        }
    }

    #[test]
    fn any_number_of_cells_is_brought_into_range() {
        assert_eq!(plane(0), plane(1));
        assert_eq!(plane(u32::MAX).indices.len(), plane(super::Detail::MOST).indices.len());
    }
}
