//! Triangles of the model's height fields.

use super::Triangles;
use crate::error::Result;
use crate::id::HeightFieldId;
use crate::model::Model;

/// Generates the flat-shaded triangles of a height field in its local frame: the top surface, four
/// sides down to the base, and the base.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `max_vertices` vertices.
pub(crate) fn height_field(model: &Model, id: HeightFieldId, max_vertices: usize) -> Result<Triangles> {
    let field = model.height_field(id);
    let (rows, columns) = (field.nrow(), field.ncol());
    let mut triangles = Triangles::default();
    if rows < 2 || columns < 2 {
        return Ok(triangles);
    }
    let cells = (rows - 1).saturating_mul(columns - 1);
    let border = 2 * (rows - 1) + 2 * (columns - 1);
    let vertices = cells.saturating_mul(6).saturating_add(9 * border);
    Triangles::check_size(|| format!("{field:?}"), vertices, max_vertices)?;
    triangles.vertices.reserve(vertices);
    triangles.indices.reserve(vertices);

    let [half_x, half_y, height, depth] = field.size().map(|length| length as f32);
    let elevations = field.data();
    let x = |column: usize| half_x * (2.0 * column as f64 / (columns - 1) as f64 - 1.0) as f32;
    let y = |row: usize| half_y * (2.0 * row as f64 / (rows - 1) as f64 - 1.0) as f32;
    let top = |[row, column]: [usize; 2]| [x(column), y(row), elevations[row * columns + column] * height];
    let base = |[row, column]: [usize; 2]| [x(column), y(row), -depth];
    let mut triangle = |corners, parities: [f32; 3]| {
        let first = triangles.vertices.len();
        triangles.flat(corners, [[0.0; 2]; 3]);
        for (vertex, parity) in triangles.vertices[first..].iter_mut().zip(parities) {
            vertex.parity = parity;
        }
    };

    // The diagonal of each cell connects the corners of least and of greatest x and y, as in
    // collision detection.
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let corners = [[row, column], [row, column + 1], [row + 1, column + 1], [row + 1, column]].map(top);
            triangle([corners[0], corners[1], corners[2]], [0.0; 3]);
            triangle([corners[0], corners[2], corners[3]], [0.0; 3]);
        }
    }
    // The border, counterclockwise from above.
    let (last_row, last_column) = (rows - 1, columns - 1);
    let front = (0..last_column).map(|column| [0, column]);
    let right = (0..last_row).map(|row| [row, last_column]);
    let back = (0..last_column).map(|column| [last_row, last_column - column]);
    let left = (0..last_row).map(|row| [last_row - row, 0]);
    let around = front.chain(right).chain(back).chain(left);
    for (from, to) in around.clone().zip(around.cycle().skip(1)) {
        // A quadrilateral, whose diagonal has ends of the same parity.
        triangle([base(from), base(to), top(to)], [1.0, -1.0, 1.0]);
        triangle([base(from), top(to), top(from)], [1.0, 1.0, -1.0]);
        triangle([base(to), base(from), [0.0, 0.0, -depth]], [0.0; 3]);
    }
    triangles.has_quads = true;
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::super::Vertex;
    use super::super::test_support::{assert_closed, assert_finite, assert_normals_agree, volume};
    use super::height_field;
    use crate::Model;
    use crate::id::HeightFieldId;

    fn model(rows: usize, columns: usize, elevation: impl Fn(usize) -> f32) -> (Model, HeightFieldId) {
        let mut model = Model::from_xml_str(&format!(
            "<mujoco><asset><hfield name='h' nrow='{rows}' ncol='{columns}' size='2 3 0.5 0.25'/></asset></mujoco>"
        ))
        .unwrap();
        let mut edit = model.edit();
        for (index, value) in edit.height_field_mut("h").unwrap().data_mut().iter_mut().enumerate() {
            *value = elevation(index);
        }
        let id = model.height_field("h").unwrap().id();
        (model, id)
    }

    #[test]
    fn a_height_field_is_closed_and_has_the_volume_of_its_prisms() {
        for (rows, columns) in [(2, 2), (3, 2), (4, 7), (9, 5)] {
            let (model, id) = model(rows, columns, |index| ((index * 7) % 5) as f32 / 4.0);
            let shape = height_field(&model, id, usize::MAX).unwrap();
            assert_closed(&[&shape]);
            assert_normals_agree(&shape, 1.0);
            let elevation = |row: usize, column: usize| {
                0.5 * f64::from(model.height_field(id).data()[row * columns + column]) + 0.25
            };
            let half_cell = (4.0 / (columns - 1) as f64) * (6.0 / (rows - 1) as f64) / 2.0;
            let mut expected = 0.0;
            for row in 0..rows - 1 {
                for column in 0..columns - 1 {
                    // Both triangles of the cell contain the two corners on the diagonal.
                    let diagonal = elevation(row, column) + elevation(row + 1, column + 1);
                    let others = elevation(row, column + 1) + elevation(row + 1, column);
                    expected += half_cell / 3.0 * (2.0 * diagonal + others);
                }
            }
            assert!((volume(&[&shape]) - expected).abs() < 1e-4 * expected, "{rows} x {columns}");
        }
    }

    /// The engine draws the sides as quadrilaterals, and the other faces as triangles.
    #[test]
    fn only_the_sides_have_diagonals_without_lines() {
        let (model, id) = model(4, 7, |index| ((index * 7) % 5) as f32 / 4.0);
        let shape = height_field(&model, id, usize::MAX).unwrap();
        assert!(shape.has_quads);
        let mut hidden = 0;
        for corners in shape.indices.as_chunks::<3>().0 {
            let [a, b, c] = corners.map(|index| &shape.vertices[index as usize]);
            let edges = [[a, b], [b, c], [c, a]];
            let is_hidden = |[one, other]: &&[&Vertex; 2]| one.parity.abs() == 1.0 && one.parity == other.parity;
            let diagonals = edges.iter().filter(is_hidden).count();
            assert_eq!(diagonals, usize::from(a.normal[2] == 0.0));
            hidden += diagonals;
        }
        assert_eq!(hidden, 2 * 2 * (3 + 6));
    }

    #[test]
    fn non_finite_elevations_leave_holes() {
        for elevation in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (model, id) = model(3, 3, |index| if index == 4 { elevation } else { 0.5 });
            let shape = height_field(&model, id, usize::MAX).unwrap();
            assert_finite(&shape);
            // Six of the eight triangles of the top surface contain the centre point.
            assert_eq!(shape.indices.len(), 3 * (2 + 3 * 8));
        }
        let (model, id) = model(2, 2, |_| f32::MAX);
        assert_finite(&height_field(&model, id, usize::MAX).unwrap());
    }

    #[test]
    fn a_field_that_is_too_large_is_an_error_that_names_it() {
        let (model, id) = model(3, 4, |_| 0.0);
        let needed = 6 * 6 + 9 * 10;
        assert_eq!(height_field(&model, id, needed).unwrap().vertices.len(), needed);
        let error = height_field(&model, id, needed - 1).unwrap_err();
        assert!(error.to_string().contains("height field 0 'h' has 126 vertices"), "{error}");
    }
}
