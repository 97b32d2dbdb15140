//! Errors of the Riccati equation and recursion.

use std::fmt;

use nalgebra::Complex;

use crate::error::debug_as_display;

/// Matrix of a Riccati equation or recursion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RiccatiMatrix {
    /// State transition `A`.
    A,
    /// Control matrix `B`.
    B,
    /// Cost of the state `Q`.
    Q,
    /// Cost of the control `R`.
    R,
    /// Cross term of the cost `S`.
    S,
    /// Terminal cost `P` of a finite number of steps.
    P,
}

/// Error of [`Riccati::solve`](super::Riccati::solve) or of a
/// [`RiccatiRecursion`](super::RiccatiRecursion). Rows and columns are counted from zero.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub enum RiccatiError {
    /// The shape of a matrix does not match the number of rows of `A` (states) and of columns of
    /// `B` (controls).
    WrongShape {
        /// Offending matrix.
        matrix: RiccatiMatrix,
        /// Expected rows and columns.
        expected: (usize, usize),
        /// Actual rows and columns.
        found: (usize, usize),
    },
    /// An entry is infinite or not a number.
    NotFinite {
        /// Offending matrix.
        matrix: RiccatiMatrix,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Value of the entry.
        value: f64,
    },
    /// `Q` or `R` differs from its transpose by more than rounding explains.
    NotSymmetric {
        /// Offending matrix.
        matrix: RiccatiMatrix,
        /// Row of the entry above the diagonal.
        row: usize,
        /// Column of the entry above the diagonal.
        column: usize,
        /// Entry above the diagonal.
        value: f64,
        /// Corresponding entry below the diagonal.
        mirror: f64,
    },
    /// `R` is not positive semidefinite: some control has a negative cost.
    ControlCostNotPositive {
        /// Smallest eigenvalue of `R`.
        smallest_eigenvalue: f64,
    },
    /// Some combination of controls has no cost and no effect, so the optimal control is not
    /// unique: `R` and `BᵀB` have a common null vector, and the pencil with the eigenvalues of the
    /// closed loop is singular.
    SingularPencil,
    /// The cost over a finite number of steps has no minimum: `R + BᵀPB` is not positive definite
    /// in some step, so the cost is unbounded below. With a positive definite `R`, the cause is a
    /// `Q` or a terminal `P` that is not positive semidefinite.
    NoLeastCost {
        /// Smallest eigenvalue of `R + BᵀPB`.
        smallest_eigenvalue: f64,
    },
    /// No control stabilises the system: a mode on or outside the unit circle is uncontrollable.
    UncontrollableMode {
        /// Eigenvalue of the mode, of `A`.
        eigenvalue: Complex<f64>,
        /// Smallest singular value of `[A − λI, B]`, each block scaled to unit norm. It is zero for
        /// an uncontrollable mode, up to rounding, or up to the error of differences, with which a
        /// control seems to have a minute effect on the mode.
        distance: f64,
    },
    /// A mode on the unit circle has no cost, so the optimal control leaves it there and no
    /// solution is stabilising.
    ///
    /// Any positive cost suffices: with a weight of 10⁻¹⁰ next to weights of 10⁵, the closed loop
    /// is slow but stable, and the equation is solved.
    UnobservableMode {
        /// Eigenvalue of the mode, of `A − BR⁻¹Sᵀ`.
        eigenvalue: Complex<f64>,
        /// Smallest singular value of `A − BR⁻¹Sᵀ − λI` stacked on `Q − SR⁻¹Sᵀ`, each block scaled
        /// to unit norm. It is zero for a mode without cost, up to rounding or up to the error of
        /// differences.
        distance: f64,
    },
    /// The doubling did not converge, and no single mode explains it: the problem may be badly
    /// scaled, or `Q − SR⁻¹Sᵀ` not positive semidefinite.
    NoConvergence {
        /// Number of doublings.
        iterations: usize,
    },
    /// The residual of the solution exceeds the tolerance.
    Inaccurate {
        /// Residual of the solution, as in
        /// [`RiccatiSolution`](super::RiccatiSolution::relative_residual).
        relative_residual: f64,
        /// Tolerance of the residual.
        tolerance: f64,
    },
}

impl fmt::Display for RiccatiMatrix {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, formatter)
    }
}

impl fmt::Display for RiccatiError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongShape { matrix, expected: (rows, columns), found: (found_rows, found_columns) } => write!(
                formatter,
                "{matrix} is {found_rows} by {found_columns}; to match the other matrices it should be {rows} by {columns}"
            ),
            Self::NotFinite { matrix, row, column, value } => write!(
                formatter,
                "the entry of {matrix} in row {row}, column {column} is {value}; every entry should be a finite number"
            ),
            Self::NotSymmetric { matrix, row, column, value, mirror } => write!(
                formatter,
                "{matrix} is not symmetric: {value} in row {row}, column {column} but {mirror} in row {column}, column {row}"
            ),
            Self::ControlCostNotPositive { smallest_eigenvalue } => write!(
                formatter,
                "R has the eigenvalue {smallest_eigenvalue:e}; it should be positive semidefinite, so that no control has a negative cost"
            ),
            Self::SingularPencil => formatter.write_str(
                "a combination of controls has no cost and no effect, so the optimal control is not unique; give it a positive \
                 weight in R, or remove it",
            ),
            Self::NoLeastCost { smallest_eigenvalue } => write!(
                formatter,
                "the cost has no minimum: R + BᵀPB has the eigenvalue {smallest_eigenvalue:e} in a step; R should be positive \
                 definite, and Q and the terminal P positive semidefinite"
            ),
            Self::UncontrollableMode { eigenvalue, distance } => write!(
                formatter,
                "no control stabilises the system: the mode of A with eigenvalue {eigenvalue} (modulus {:.9}) is not inside the \
                 unit circle and uncontrollable by B (distance {distance:.1e}); add an actuator for it, or remove it from the state",
                modulus(*eigenvalue)
            ),
            Self::UnobservableMode { eigenvalue, distance } => write!(
                formatter,
                "no solution is stabilising: the mode with eigenvalue {eigenvalue} (modulus {:.9}) is on the unit circle and has \
                 no cost (distance {distance:.1e}); give it a positive weight in Q",
                modulus(*eigenvalue)
            ),
            Self::NoConvergence { iterations } => write!(
                formatter,
                "no convergence after {iterations} doublings, and no single mode explains it; check the scaling of the states, and \
                 that Q − SR⁻¹Sᵀ is positive semidefinite"
            ),
            Self::Inaccurate { relative_residual, tolerance } => write!(
                formatter,
                "the relative residual of the solution is {relative_residual:.1e}, above the tolerance of {tolerance:.1e}; choose \
                 units of the states in which the entries of A and of Q have similar sizes"
            ),
        }
    }
}

debug_as_display!(RiccatiError);

impl std::error::Error for RiccatiError {}

/// Returns the modulus, without the overflow of squaring.
pub(super) fn modulus(number: Complex<f64>) -> f64 {
    number.re.hypot(number.im)
}
