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
            if !(row > 0.0 && column > 0.0 && row.is_normal() && column.is_normal()) {
                continue;
            }
            // Row and column are squared norms. The factor scales one up and the other down.
            let exponent = ((column / row).log2() / 4.0).round();
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
