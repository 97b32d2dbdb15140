//! Balancing: units of the states in which the matrices have entries of similar size.
//!
//! The substitution `x = D⁻¹ z` with a diagonal `D` preserves the form of the equation: `A` becomes
//! `D A D⁻¹`, `G` becomes `D G D`, `H` becomes `D⁻¹ H D⁻¹`, and the solution is `P = D P' D` for
//! the balanced solution `P'`. As in the balancing of eigenvalue problems, `D` is chosen such that
//! row `i` of `[A, G]` and column `i` of `[A; H]` have about the same norm. Its entries are powers
//! of two, so the substitution causes no rounding errors.
//!
//! (B. N. Parlett and C. Reinsch, *Balancing a matrix for calculation of eigenvalues and
//! eigenvectors*, Numerische Mathematik 13 (1969) 293–304; applied to symplectic pencils: P.
//! Benner, *Symplectic balancing of Hamiltonian matrices*, SIAM Journal on Scientific Computing 22
//! (2001) 1885–1904.)

use crate::numerics::dense::PackedMatrix;

/// Maximum number of sweeps over all states. Sweeps after the first change little.
const SWEEPS: usize = 3;

/// Largest magnitude of the exponents of two in `D`. The ratios of physical units are smaller.
const MAX_EXPONENT: f64 = 64.0;

/// Computes the diagonal of `D` for `A`, `G` and `H`. The other arguments are buffers.
pub(super) fn units(
    a: &PackedMatrix,
    g: &PackedMatrix,
    h: &PackedMatrix,
    transpose: &mut PackedMatrix,
    (d, squares, reciprocals): (&mut Vec<f64>, &mut Vec<f64>, &mut Vec<f64>),
) {
    let states = a.rows();
    for values in [&mut *d, &mut *squares, &mut *reciprocals] {
        values.clear();
        values.resize(a.padded_rows(), 1.0);
    }
    transpose.transpose_from(a);
    // The unit of the cost is arbitrary. This choice makes the norms of G and H equal.
    let (of_g, of_h) = (g.norm(), h.norm());
    let unit = if of_g > 0.0 && of_h > 0.0 { of_h / of_g } else { 1.0 };
    if !(unit.is_normal() && a.norm().is_finite()) {
        return;
    }
    for _ in 0..SWEEPS {
        let mut same = true;
        for state in 0..states {
            let own = a.get(state, state).powi(2);
            let row = a.weighted_row_square_sum(state, reciprocals) * squares[state] - own
                + g.weighted_row_square_sum(state, squares) * squares[state] * unit;
            let column = transpose.weighted_row_square_sum(state, squares) * reciprocals[state] - own
                + h.weighted_row_square_sum(state, reciprocals) * reciprocals[state] / unit;
            // Row and column are squared norms. The factor scales one up and the other down.
            let exponent = ((column / row).log2() / 4.0).round();
            if !exponent.is_finite() {
                continue;
            }
            let present = d[state].log2();
            let exponent = (present + exponent).clamp(-MAX_EXPONENT, MAX_EXPONENT);
            if exponent != present {
                same = false;
                d[state] = exponent.exp2();
                squares[state] = d[state] * d[state];
                reciprocals[state] = 1.0 / squares[state];
            }
        }
        if same {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::units;
    use crate::numerics::dense::PackedMatrix;

    const STATES: usize = 5;

    type Square = [[f64; STATES]; STATES];

    fn packed(matrix: &Square) -> PackedMatrix {
        let mut packed = PackedMatrix::default();
        packed.copy_rows(STATES, STATES, matrix.as_flattened());
        packed
    }

    fn norm(matrix: &Square) -> f64 {
        matrix.as_flattened().iter().map(|entry| entry * entry).sum::<f64>().sqrt()
    }

    /// Returns the largest ratio of the norms of row `i` of `[A, G]` and column `i` of `[A; H]` in
    /// the units `d`, without the diagonal of `A`, which does not depend on the units.
    fn worst_ratio(a: &Square, g: &Square, h: &Square, unit: f64, d: &[f64]) -> f64 {
        let ratio = |i: usize| {
            let others = (0..STATES).filter(|&j| j != i);
            let row: f64 = others.clone().map(|j| (d[i] * a[i][j] / d[j]).powi(2)).sum();
            let column: f64 = others.map(|j| (d[j] * a[j][i] / d[i]).powi(2)).sum();
            let row = row + (0..STATES).map(|j| (d[i] * g[i][j] * d[j]).powi(2)).sum::<f64>() * unit;
            let column = column + (0..STATES).map(|j| (h[i][j] / d[i] / d[j]).powi(2)).sum::<f64>() / unit;
            (row / column).max(column / row).sqrt()
        };
        (0..STATES).map(ratio).fold(1.0, f64::max)
    }

    #[test]
    fn rows_and_columns_have_similar_norms_in_the_balanced_units() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        for [of_a, of_g, of_h] in
            [[1.0, 1.0, 1.0], [1e-2, 1e-9, 1.0], [1e-2, 1.0, 1e-9], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
        {
            // In other units of the states.
            let unit = |state: usize| 4.0_f64.powi(3 * state as i32 - 6);
            let mut entries = |factor: f64, scale: &dyn Fn(usize, usize) -> f64| -> Square {
                std::array::from_fn(|i| std::array::from_fn(|j| factor * scale(i, j) * random.random_range(0.5..1.0)))
            };
            let a = entries(of_a, &|i, j| unit(i) / unit(j));
            let g = entries(of_g, &|i, j| unit(i) * unit(j));
            let h = entries(of_h, &|i, j| 1.0 / (unit(i) * unit(j)));
            let (mut d, mut buffers) = (Vec::new(), (Vec::new(), Vec::new(), PackedMatrix::default()));
            units(&packed(&a), &packed(&g), &packed(&h), &mut buffers.2, (&mut d, &mut buffers.0, &mut buffers.1));

            assert!(d[..STATES].iter().all(|entry| entry.log2().fract() == 0.0), "{d:?}");
            let unit = if of_g > 0.0 && of_h > 0.0 { norm(&h) / norm(&g) } else { 1.0 };
            let [before, after] = [&[1.0; STATES][..], &d].map(|d| worst_ratio(&a, &g, &h, unit, d));
            assert!(before > 1e6 && after < 10.0, "A {of_a}, G {of_g}, H {of_h}: {before:e}, {after}, {d:?}");
        }
    }
}
