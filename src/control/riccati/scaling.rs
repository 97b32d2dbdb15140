//! Units for the states in which the matrices are of one size.
//!
//! With `x = D⁻¹ z` for a diagonal `D` the equation keeps its form: `A` becomes `D A D⁻¹`, `G` becomes `D G D` and `H` becomes
//! `D⁻¹ H D⁻¹`, and its solution `P` is `D` times the one found times `D`. The entries of `D` are chosen as for the balancing of eigenvalue
//! problems, so that row `i` of `[A, G]` and column `i` of `A` above `H` have about the same norm. They are powers of two, so nothing
//! is rounded on the way there and back.
//!
//! (B. N. Parlett and C. Reinsch, *Balancing a matrix for calculation of eigenvalues and eigenvectors*, Numerische Mathematik 13
//! (1969) 293–304; applied to symplectic pencils: P. Benner, *Symplectic balancing of Hamiltonian matrices*, SIAM Journal on
//! Scientific Computing 22 (2001) 1885–1904.)

use super::lanes::BLOCK;
use super::panels::Panels;

/// Sweeps over all states. The first does nearly all of it.
const SWEEPS: usize = 3;

/// Largest power of two in `D`, and least. No physical units are further apart.
const LARGEST_POWER: f64 = 64.0;

/// The diagonal of `D` for `A`, `G` and `H`. The other arguments are room for the squares of the entries.
pub(super) fn units(
    a: &Panels,
    g: &Panels,
    h: &Panels,
    transpose: &mut Panels,
    (d, squares, reciprocals): (&mut Vec<f64>, &mut Vec<f64>, &mut Vec<f64>),
) {
    let states = a.rows();
    for values in [&mut *d, &mut *squares, &mut *reciprocals] {
        values.clear();
        values.resize(a.size(), 1.0);
    }
    transpose.transpose_from(a);
    // The cost has a unit of its own, in which G and H are of one size.
    let (of_g, of_h) = (g.norm(), h.norm());
    let unit = if of_g > 0.0 && of_h > 0.0 { of_h / of_g } else { 1.0 };
    if !(unit.is_normal() && a.norm().is_finite()) {
        return;
    }
    for _ in 0..SWEEPS {
        let mut same = true;
        for state in 0..states {
            let own = a.get(state, state).powi(2);
            let row =
                sum(a, state, reciprocals) * squares[state] - own + sum(g, state, squares) * squares[state] * unit;
            let column = sum(transpose, state, squares) * reciprocals[state] - own
                + sum(h, state, reciprocals) * reciprocals[state] / unit;
            if !(row > 0.0 && column > 0.0 && row.is_normal() && column.is_normal()) {
                continue;
            }
            // Row and column are squares; the factor makes one as much larger as the other smaller.
            let power = ((column / row).log2() / 4.0).round();
            let present = d[state].log2();
            let power = (present + power).clamp(-LARGEST_POWER, LARGEST_POWER);
            if power != present {
                same = false;
                d[state] = power.exp2();
                squares[state] = d[state] * d[state];
                reciprocals[state] = 1.0 / squares[state];
            }
        }
        if same {
            break;
        }
    }
}

/// The sum of the squares in a row of a square matrix, with weights.
fn sum(matrix: &Panels, row: usize, weights: &[f64]) -> f64 {
    let panels = matrix.lanes().chunks_exact(matrix.size()).zip(weights.as_chunks::<BLOCK>().0);
    let mut sums = [0.0; BLOCK];
    for (panel, weights) in panels {
        for ((sum, entry), weight) in sums.iter_mut().zip(panel[row].0).zip(weights) {
            *sum += entry * entry * weight;
        }
    }
    sums.iter().sum()
}
