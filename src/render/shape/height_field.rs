//! A height field of the model, with its sides and its bottom.

use super::Triangles;
use crate::error::Result;
use crate::id::HeightFieldId;
use crate::model::Model;

/// A height field in its own frame: flat triangles on top, four sides down to its base, and the base.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `most` corners.
pub(crate) fn height_field(model: &Model, id: HeightFieldId, most: usize) -> Result<Triangles> {
    let field = model.height_field(id);
    let (rows, columns) = (field.nrow(), field.ncol());
    let mut triangles = Triangles::default();
    if rows < 2 || columns < 2 {
        return Ok(triangles);
    }
    let cells = (rows - 1).saturating_mul(columns - 1);
    let border = 2 * (rows - 1) + 2 * (columns - 1);
    let vertices = cells.saturating_mul(6).saturating_add(9 * border);
    Triangles::check_room(|| format!("{field:?}"), vertices, most)?;
    triangles.vertices.reserve(vertices);
    triangles.indices.reserve(vertices);

    let [half_x, half_y, height, depth] = field.size().map(|length| length as f32);
    let elevations = field.data();
    let x = |column: usize| half_x * (2.0 * column as f64 / (columns - 1) as f64 - 1.0) as f32;
    let y = |row: usize| half_y * (2.0 * row as f64 / (rows - 1) as f64 - 1.0) as f32;
    let top = |[row, column]: [usize; 2]| [x(column), y(row), elevations[row * columns + column] * height];
    let base = |[row, column]: [usize; 2]| [x(column), y(row), -depth];
    let mut flat = |corners| triangles.flat(corners, [[0.0; 2]; 3]);

    // Each cell is cut from its corner of least x and y to that of most, as it is for collisions.
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let corners = [[row, column], [row, column + 1], [row + 1, column + 1], [row + 1, column]].map(top);
            flat([corners[0], corners[1], corners[2]]);
            flat([corners[0], corners[2], corners[3]]);
        }
    }
    // Once around the border, counterclockwise from above.
    let (last_row, last_column) = (rows - 1, columns - 1);
    let front = (0..last_column).map(|column| [0, column]);
    let right = (0..last_row).map(|row| [row, last_column]);
    let back = (0..last_column).map(|column| [last_row, last_column - column]);
    let left = (0..last_row).map(|row| [last_row - row, 0]);
    let around = front.chain(right).chain(back).chain(left);
    for (from, to) in around.clone().zip(around.cycle().skip(1)) {
        flat([base(from), base(to), top(to)]);
        flat([base(from), top(to), top(from)]);
        flat([base(to), base(from), [0.0, 0.0, -depth]]);
    }
    Ok(triangles)
}
