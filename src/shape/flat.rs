//! Flat shapes: a square and a cube, subdivided into cells.

use std::ops::Range;

use super::{Tessellation, Triangles};

/// Generates the square from -1 to 1 in x and y with normal +z, subdivided into `cells` by `cells`
/// cells.
pub(crate) fn plane(cells: u32) -> Triangles {
    let lines = uniform_lines(cells.clamp(1, Tessellation::MAX));
    plane_with_lines([&lines, &lines])
}

/// Generates the square from -1 to 1 with grid lines at these x and y, each in ascending order.
pub(crate) fn plane_with_lines(lines: [&[f32]; 2]) -> Triangles {
    let mut triangles = Triangles::default();
    grid(&mut triangles, lines, |u, v| [u, v, 0.0], [0, 1], [0.0, 0.0, 1.0]);
    triangles
}

/// Generates the triangle of the origin and the ends of the unit vectors along x and y, with normal
/// +z.
pub(crate) fn triangle() -> Triangles {
    let mut triangles = Triangles::default();
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
        let vertex = triangles.vertex([x, y, 0.0], [0.0, 0.0, 1.0], [x, 1.0 - y]);
        triangles.indices.push(vertex);
    }
    triangles
}

/// Returns the lines from -1 to 1 that bound `cells` equal cells.
pub(crate) fn uniform_lines(cells: u32) -> Vec<f32> {
    // Exact at both ends and in the middle, so that adjacent grids have no gap.
    (0..=cells).map(|index| (2.0 * f64::from(index) / f64::from(cells) - 1.0) as f32).collect()
}

/// Cells along each edge of a block.
const BLOCK: usize = 5;

/// Returns the largest length of the cells of a block, for these grid lines.
pub(crate) fn longest_block(lines: &[f32]) -> f32 {
    let lengths = lines.windows(BLOCK + 1).map(|block| block[BLOCK] - block[0]);
    lengths.fold(0.0, f32::max)
}

/// Generates the triangles of a range of columns and rows of a plane with `width` grid lines in x,
/// in blocks of five by five cells. All grid points on the border of the range are vertices, so
/// that the triangles fit to the triangles of adjacent cells. `None` for a range of one block.
pub(crate) fn blocks(columns: Range<usize>, rows: Range<usize>, width: usize) -> Option<Vec<u32>> {
    if columns.len() <= BLOCK || rows.len() <= BLOCK {
        return None;
    }
    let mut indices = Vec::new();
    let limits = |range: &Range<usize>| {
        let end = range.end;
        range.clone().step_by(BLOCK).map(move |first| [first, (first + BLOCK).min(end)])
    };
    for [bottom, top] in limits(&rows) {
        for [left, right] in limits(&columns) {
            // The steps between vertices on the four sides: one cell on the border of the range.
            let step = |is_border: bool| if is_border { 1 } else { BLOCK };
            let [below, above] = [step(bottom == rows.start), step(top == rows.end)];
            let [before, after] = [step(left == columns.start), step(right == columns.end)];
            // Counterclockwise, without the last vertex of each side.
            let mut corners: Vec<[usize; 2]> = (left..right).step_by(below).map(|x| [x, bottom]).collect();
            corners.extend((bottom..top).step_by(after).map(|y| [right, y]));
            corners.extend((0..right - left).step_by(above).map(|x| [right - x, top]));
            corners.extend((0..top - bottom).step_by(before).map(|y| [left, top - y]));
            // A fan around a corner of the block, neither of whose sides has further vertices.
            let hub = [if before == 1 { right } else { left }, if below == 1 { top } else { bottom }];
            let first = corners.iter().position(|&corner| corner == hub)?;
            corners.rotate_left(first);
            let index = |[x, y]: [usize; 2]| (y * width + x) as u32;
            indices.extend(corners[1..].windows(2).flat_map(|pair| [index(hub), index(pair[0]), index(pair[1])]));
        }
    }
    Some(indices)
}

/// Points of a face from two coordinates, and the axes of its texture.
type Face = (fn(f32, f32) -> [f32; 3], [usize; 2]);

/// Generates the cube from -1 to 1, with each face subdivided into `cells` by `cells` cells.
pub(crate) fn cuboid(cells: u32) -> Triangles {
    let cells = cells.clamp(1, Tessellation::MAX);
    let lines = uniform_lines(cells);
    let mut triangles = Triangles::default();
    let faces: [Face; 6] = [
        (|u, v| [u, v, 1.0], [0, 1]),
        (|u, v| [u, -v, -1.0], [0, 1]),
        (|u, v| [1.0, u, v], [1, 2]),
        (|u, v| [-1.0, -u, v], [1, 2]),
        (|u, v| [u, -1.0, v], [0, 2]),
        (|u, v| [-u, 1.0, v], [0, 2]),
    ];
    for (face, axes) in faces {
        grid(&mut triangles, [&lines, &lines], face, axes, face(0.0, 0.0));
    }
    // The engine blends one cell of each face after the other, along both axes of the faces.
    let last = cells as usize - 1;
    let quads = triangles.indices.as_chunks::<6>().0.to_vec();
    let ordered = (0..=last).flat_map(|x| (0..=last).flat_map(move |y| (0..6).map(move |face| (x, y, face))));
    let at = |(x, y, face): (usize, usize, usize)| {
        let column = if matches!(face, 3 | 5) { last - x } else { x };
        let row = if face == 1 { last - y } else { y };
        quads[(face * (last + 1) + row) * (last + 1) + column]
    };
    triangles.indices = ordered.flat_map(at).collect();
    // Convert negative zero to zero.
    for vertex in &mut triangles.vertices {
        vertex.normal = vertex.normal.map(|component| component + 0.0);
    }
    triangles
}

/// Appends a subdivided square with grid lines at these u and v. `at` maps (u, v) from -1 to 1 to a
/// position; seen from the front, u increases to the right and v upwards. The texture coordinates
/// are the same as in the engine from 3.12: along the first of `axes`, and against the second, from
/// 0 to 1.
fn grid(
    triangles: &mut Triangles,
    lines: [&[f32]; 2],
    at: impl Fn(f32, f32) -> [f32; 3],
    axes: [usize; 2],
    normal: [f32; 3],
) {
    let first = triangles.vertices.len() as u32;
    for (row, &v) in (0..).zip(lines[1]) {
        for (column, &u) in (0..).zip(lines[0]) {
            let position = at(u, v);
            let [right, up] = axes.map(|axis| 0.5 + 0.5 * position[axis]);
            let vertex = triangles.vertex(position, normal, [right, 1.0 - up]);
            triangles.set_parity(vertex, [row, column]);
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
    use super::super::Triangles;
    use super::super::test_support::{area, assert_closed, assert_normals_agree, border_edges, volume};
    use super::{Tessellation, blocks, cuboid, longest_block, plane, uniform_lines};

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
    fn blocks_cover_their_cells_and_have_all_vertices_of_the_border() {
        for (columns, rows) in [(0..10, 0..10), (3..10, 2..14), (1..9, 4..10), (0..20, 5..16)] {
            let all = plane(20);
            let indices = blocks(columns.clone(), rows.clone(), 21).unwrap();
            let part = Triangles { indices, ..all };
            let cells = (columns.len() * rows.len()) as f64;
            assert!((area(&part) - 4.0 * cells / 400.0).abs() < 1e-5, "{columns:?} {rows:?}: {}", area(&part));
            // Each vertex on the border begins one edge of the border.
            assert_eq!(border_edges(&part), 2 * (columns.len() + rows.len()), "{columns:?} {rows:?}");
            assert_normals_agree(&part, 1.0);
            assert!(part.indices.len() < 6 * columns.len() * rows.len(), "no reduction");
        }
        assert_eq!(blocks(0..5, 0..20, 21), None);
    }

    #[test]
    fn a_block_has_at_most_the_longest_length() {
        assert!((longest_block(&uniform_lines(20)) - 0.5).abs() < 1e-6);
        assert!((longest_block(&[-1.0, -0.9, -0.8, -0.7, -0.2, 0.3, 1.0]) - 1.9).abs() < 1e-6);
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
