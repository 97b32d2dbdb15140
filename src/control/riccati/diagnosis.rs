//! Why an equation has no stabilising solution, by the tests of Popov, Belevitch and Hautus. Asked only after a failure.

use nalgebra::{Complex, DMatrix, SVD, Schur};

use super::error::{RiccatiError, modulus};
use super::problem::{MOST_EIGENVALUE_ITERATIONS, Problem};

/// How far from the unit circle an eigenvalue may be and still pass for one on it. Rounding moves an eigenvalue that repeats `j` times
/// by the `j`-th root of the precision, and free bodies have pairs of ones.
const ON_THE_CIRCLE: f64 = 1e-6;

/// The relative distance from an uncontrollable system below which one passes for uncontrollable.
const OUT_OF_REACH: f64 = 1e-8;

/// The mode that stands in the way of a stabilising solution, if there is one.
pub(super) fn diagnose(problem: &mut Problem) -> Option<RiccatiError> {
    let [a, b, a_without_s, q_without_s] = problem.matrices()?;
    let outside = |modulus: f64| modulus >= 1.0 - ON_THE_CIRCLE;
    if let Some((eigenvalue, distance)) = mode_out_of_reach(&a, &b, outside) {
        return Some(RiccatiError::UncontrollableMode { eigenvalue, distance });
    }
    // A mode is unobservable if it is uncontrollable in the transposed system.
    let on_circle = |modulus: f64| (modulus - 1.0).abs() <= ON_THE_CIRCLE;
    let transpose = a_without_s.transpose();
    mode_out_of_reach(&transpose, &q_without_s, on_circle)
        .map(|(eigenvalue, distance)| RiccatiError::UnobservableMode { eigenvalue, distance })
}

/// Among the eigenvalues of `a` whose modulus is `relevant`, the one that `b` controls least, if it controls it not at all.
fn mode_out_of_reach(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    relevant: impl Fn(f64) -> bool,
) -> Option<(Complex<f64>, f64)> {
    let finite = a.iter().chain(b).all(|entry| entry.is_finite());
    if !finite {
        return None;
    }
    Schur::try_new(a.clone(), f64::EPSILON, MOST_EIGENVALUE_ITERATIONS)?
        .complex_eigenvalues()
        .iter()
        .filter(|eigenvalue| relevant(modulus(**eigenvalue)) && eigenvalue.im >= 0.0)
        .filter_map(|&eigenvalue| Some((eigenvalue, distance(a, b, eigenvalue)?)))
        .min_by(|(_, left), (_, right)| left.total_cmp(right))
        .filter(|&(_, distance)| distance <= OUT_OF_REACH)
}

/// The smallest singular value of `[A − λI, B]`, with `A` and `B` scaled to unit norm, unless arithmetic does not hold it.
fn distance(a: &DMatrix<f64>, b: &DMatrix<f64>, eigenvalue: Complex<f64>) -> Option<f64> {
    let (size, controls) = b.shape();
    let (norm_of_a, norm_of_b) = (a.norm(), b.norm());
    let unless_zero = |norm: f64| if norm > 0.0 { norm } else { 1.0 };
    let pencil = DMatrix::from_fn(size, size + controls, |row, column| {
        if column >= size {
            return Complex::from(b[(row, column - size)] / unless_zero(norm_of_b));
        }
        let shift = if row == column { eigenvalue } else { Complex::default() };
        (Complex::from(a[(row, column)]) - shift) / unless_zero(norm_of_a)
    });
    // Norms and eigenvalues of numbers that are finite may overflow.
    if !pencil.iter().all(|entry| entry.re.is_finite() && entry.im.is_finite()) {
        return None;
    }
    // Unordered, because nalgebra panics at a singular value that is not a number when it orders them.
    let decomposition = SVD::try_new_unordered(pencil, false, false, f64::EPSILON, MOST_EIGENVALUE_ITERATIONS)?;
    let smallest = decomposition.singular_values.iter().copied().min_by(f64::total_cmp)?;
    decomposition.singular_values.iter().all(|value| value.is_finite()).then_some(smallest)
}
