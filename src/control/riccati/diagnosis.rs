//! Diagnosis of equations without a stabilising solution, by the Popov–Belevitch–Hautus tests. Runs
//! only after a failure.

use nalgebra::{Complex, DMatrix, SVD, Schur};

use super::error::{RiccatiError, modulus};

/// Maximum number of iterations of nalgebra's eigenvalue solvers, so that they terminate.
pub(super) const MAX_EIGENVALUE_ITERATIONS: usize = 10_000;

/// `A`, `B`, and without the cross term `A − BR⁻¹Sᵀ` and `Q − SR⁻¹Sᵀ`.
pub(super) type Matrices = [DMatrix<f64>; 4];

/// Tolerances of the tests.
#[derive(Clone, Copy)]
struct Tolerances {
    /// Distance from the unit circle below which an eigenvalue counts as on it. An error of the
    /// matrices moves an eigenvalue of multiplicity `j` by its `j`-th root, and free bodies have
    /// double eigenvalues at one.
    unit_circle: f64,
    /// Relative distance from an uncontrollable system below which a system counts as
    /// uncontrollable.
    uncontrollable: f64,
}

/// Tolerances for matrices in closed form, which have rounding errors.
const ROUNDING: Tolerances = Tolerances { unit_circle: 1e-6, uncontrollable: 1e-8 };

/// Tolerances for matrices by differences, whose errors give a control a minute effect on a mode
/// that it does not reach.
const DIFFERENCES: Tolerances = Tolerances { unit_circle: 1e-3, uncontrollable: 1e-5 };

/// Returns the mode that prevents a stabilising solution, if there is one.
pub(super) fn diagnose(matrices: Option<&Matrices>) -> Option<RiccatiError> {
    diagnose_within(matrices, ROUNDING)
}

/// Returns the mode that explains best why no solution was found, for matrices that may be
/// differences. The equation has a solution in theory, with gains as large as the reciprocal of the
/// error.
pub(super) fn diagnose_failure(matrices: Option<&Matrices>) -> Option<RiccatiError> {
    diagnose_within(matrices, ROUNDING).or_else(|| diagnose_within(matrices, DIFFERENCES))
}

fn diagnose_within(matrices: Option<&Matrices>, tolerances: Tolerances) -> Option<RiccatiError> {
    let [a, b, a_without_s, q_without_s] = matrices?;
    let Tolerances { unit_circle, uncontrollable } = tolerances;
    let outside = |modulus: f64| modulus >= 1.0 - unit_circle;
    if let Some((eigenvalue, distance)) = uncontrollable_mode(a, b, outside, uncontrollable) {
        return Some(RiccatiError::UncontrollableMode { eigenvalue, distance });
    }
    // A mode is unobservable if it is uncontrollable in the transposed system.
    let on_circle = |modulus: f64| (modulus - 1.0).abs() <= unit_circle;
    let transpose = a_without_s.transpose();
    uncontrollable_mode(&transpose, q_without_s, on_circle, uncontrollable)
        .map(|(eigenvalue, distance)| RiccatiError::UnobservableMode { eigenvalue, distance })
}

/// Returns the least controllable eigenvalue of `a` among those with a `relevant` modulus, and its
/// distance. Returns `None` if that eigenvalue is farther than `tolerance` from an uncontrollable
/// one.
fn uncontrollable_mode(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    relevant: impl Fn(f64) -> bool,
    tolerance: f64,
) -> Option<(Complex<f64>, f64)> {
    let finite = a.iter().chain(b).all(|entry| entry.is_finite());
    if !finite || a.is_empty() {
        return None;
    }
    Schur::try_new(a.clone(), f64::EPSILON, MAX_EIGENVALUE_ITERATIONS)?
        .complex_eigenvalues()
        .iter()
        .filter(|eigenvalue| relevant(modulus(**eigenvalue)) && eigenvalue.im >= 0.0)
        .filter_map(|&eigenvalue| Some((eigenvalue, distance(a, b, eigenvalue)?)))
        .min_by(|(_, left), (_, right)| left.total_cmp(right))
        .filter(|&(_, distance)| distance <= tolerance)
}

/// Returns the smallest singular value of `[A − λI, B]`, with `A` and `B` scaled to unit norm,
/// unless it overflows.
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
    // Norms and eigenvalues of finite matrices may overflow.
    if !pencil.iter().all(|entry| entry.re.is_finite() && entry.im.is_finite()) {
        return None;
    }
    // Unordered, because nalgebra panics when it sorts a singular value that is NaN.
    let decomposition = SVD::try_new_unordered(pencil, false, false, f64::EPSILON, MAX_EIGENVALUE_ITERATIONS)?;
    let smallest = decomposition.singular_values.iter().copied().min_by(f64::total_cmp)?;
    decomposition.singular_values.iter().all(|value| value.is_finite()).then_some(smallest)
}
