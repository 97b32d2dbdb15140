//! 4 × 4 matrices, column-major, in double precision; uniforms are converted to single precision
//! last.

use crate::numerics::spatial::{cross, dot, norm};

/// Column-major matrix: an array of columns.
pub(crate) type Matrix4 = [[f64; 4]; 4];

pub(crate) const IDENTITY: Matrix4 =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// Returns the matrix product `a b`.
pub(crate) fn product(a: &Matrix4, b: &Matrix4) -> Matrix4 {
    b.map(|column| apply(a, column))
}

/// Returns the product of a matrix and a column vector.
pub(crate) fn apply(a: &Matrix4, v: [f64; 4]) -> [f64; 4] {
    [0, 1, 2, 3].map(|row| (0..4).map(|k| a[k][row] * v[k]).sum())
}

/// Returns a row of a matrix.
pub(crate) fn row(a: &Matrix4, row: usize) -> [f64; 4] {
    a.map(|column| column[row])
}

/// Converts a matrix to single precision.
pub(crate) fn to_f32(a: &Matrix4) -> [[f32; 4]; 4] {
    a.map(|column| column.map(|number| number as f32))
}

/// Normalises a vector; returns the z-axis for a vector of zero or non-finite length.
pub(crate) fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = norm(&vector);
    if length > 1e-10 && length.is_finite() { vector.map(|component| component / length) } else { [0.0, 0.0, 1.0] }
}

/// Returns the view matrix of a right-handed camera: x to the right, y up, viewing direction -z.
pub(crate) fn look_to(eye: [f64; 3], forward: [f64; 3], up: [f64; 3]) -> Matrix4 {
    let forward = unit(forward);
    let right = unit(cross(&forward, &up));
    let up = unit(cross(&right, &forward));
    let mut matrix = IDENTITY;
    for axis in 0..3 {
        matrix[axis] = [right[axis], up[axis], -forward[axis], 0.0];
    }
    matrix[3] = [-dot(&right, &eye), -dot(&up, &eye), dot(&forward, &eye), 1.0];
    matrix
}

/// Returns the perspective projection of a frustum, given by its extent in the near plane, to clip
/// space with depth from 0 to 1.
pub(crate) fn perspective([left, right]: [f64; 2], [bottom, top]: [f64; 2], [near, far]: [f64; 2]) -> Matrix4 {
    let (width, height, depth) = (right - left, top - bottom, far - near);
    [
        [2.0 * near / width, 0.0, 0.0, 0.0],
        [0.0, 2.0 * near / height, 0.0, 0.0],
        [(right + left) / width, (top + bottom) / height, -far / depth, -1.0],
        [0.0, 0.0, -near * far / depth, 0.0],
    ]
}

/// Returns the orthographic projection of a box to clip space with depth from 0 to 1.
pub(crate) fn orthographic([left, right]: [f64; 2], [bottom, top]: [f64; 2], [near, far]: [f64; 2]) -> Matrix4 {
    let (width, height, depth) = (right - left, top - bottom, far - near);
    [
        [2.0 / width, 0.0, 0.0, 0.0],
        [0.0, 2.0 / height, 0.0, 0.0],
        [0.0, 0.0, -1.0 / depth, 0.0],
        [-(right + left) / width, -(top + bottom) / height, -near / depth, 1.0],
    ]
}

/// Returns the reflection at a plane, given by a point and a unit normal.
pub(crate) fn reflection(point: [f64; 3], normal: [f64; 3]) -> Matrix4 {
    let mut matrix = IDENTITY;
    for column in 0..3 {
        for row in 0..3 {
            matrix[column][row] -= 2.0 * normal[column] * normal[row];
        }
    }
    let distance = 2.0 * dot(&normal, &point);
    matrix[3] = [distance * normal[0], distance * normal[1], distance * normal[2], 1.0];
    matrix
}

/// Returns a similarity transformation: a rotation by a quaternion `[w, x, y, z]`, then a scale,
/// then a translation.
#[allow(clippy::many_single_char_names, reason = "conventional names of quaternion components")]
pub(crate) fn similarity(quat: [f64; 4], scale: f64, translation: [f64; 3]) -> Matrix4 {
    let length = norm(&quat);
    let [w, x, y, z] = if length > 1e-10 { quat.map(|part| part / length) } else { [1.0, 0.0, 0.0, 0.0] };
    let [a, b, c] = translation;
    [
        [scale * (1.0 - 2.0 * (y * y + z * z)), scale * 2.0 * (x * y + w * z), scale * 2.0 * (x * z - w * y), 0.0],
        [scale * 2.0 * (x * y - w * z), scale * (1.0 - 2.0 * (x * x + z * z)), scale * 2.0 * (y * z + w * x), 0.0],
        [scale * 2.0 * (x * z + w * y), scale * 2.0 * (y * z - w * x), scale * (1.0 - 2.0 * (x * x + y * y)), 0.0],
        [a, b, c, 1.0],
    ]
}

#[cfg(test)]
mod tests {
    use super::{IDENTITY, apply, look_to, orthographic, perspective, product, reflection, similarity};

    fn assert_close(a: [f64; 4], b: [f64; 4]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} is not {b:?}");
    }

    #[test]
    fn projections_map_corners_to_the_corners_of_clip_space() {
        let matrix = perspective([-1.0, 3.0], [-2.0, 1.0], [0.5, 8.0]);
        let corner = |x: f64, y: f64, z: f64| {
            let scale = z / 0.5;
            let [x, y, z, w] = apply(&matrix, [x * scale, y * scale, -z, 1.0]);
            [x / w, y / w, z / w, 1.0]
        };
        assert_close(corner(-1.0, -2.0, 0.5), [-1.0, -1.0, 0.0, 1.0]);
        assert_close(corner(3.0, 1.0, 8.0), [1.0, 1.0, 1.0, 1.0]);
        let matrix = orthographic([-1.0, 3.0], [-2.0, 1.0], [0.5, 8.0]);
        assert_close(apply(&matrix, [-1.0, 1.0, -0.5, 1.0]), [-1.0, 1.0, 0.0, 1.0]);
        assert_close(apply(&matrix, [3.0, -2.0, -8.0, 1.0]), [1.0, -1.0, 1.0, 1.0]);
    }

    #[test]
    fn camera_view_direction_is_minus_z() {
        let matrix = look_to([1.0, 2.0, 3.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]);
        assert_close(apply(&matrix, [1.0, 7.0, 4.0, 1.0]), [0.0, 1.0, -5.0, 1.0]);
    }

    #[test]
    fn reflection_is_an_involution_and_keeps_the_plane() {
        let matrix = reflection([0.0, 0.0, 2.0], [0.6, 0.0, 0.8]);
        for (column, expected) in product(&matrix, &matrix).iter().zip(IDENTITY) {
            assert_close(*column, expected);
        }
        assert_close(apply(&matrix, [0.8, 5.0, 1.4, 1.0]), [0.8, 5.0, 1.4, 1.0]);
        assert_close(apply(&matrix, [0.6, 0.0, 2.8, 1.0]), [-0.6, 0.0, 1.2, 1.0]);
    }

    #[test]
    fn similarity_applies_rotation_scale_and_translation() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let matrix = similarity([half, 0.0, 0.0, half], 2.0, [0.0, 0.0, 5.0]);
        assert_close(apply(&matrix, [1.0, 0.0, 1.0, 1.0]), [0.0, 2.0, 7.0, 1.0]);
    }
}
