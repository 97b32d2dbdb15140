//! Why there is no solution.

use std::fmt;

use nalgebra::Complex;

/// One of the matrices that state a Riccati equation or recursion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RiccatiMatrix {
    /// The state transition `A`.
    A,
    /// The control's effect `B`.
    B,
    /// The cost of the state `Q`.
    Q,
    /// The cost of the control `R`.
    R,
    /// The cross term of the cost `S`.
    S,
    /// The cost to go `P` at the end of a finite number of steps.
    P,
}

/// Why [`Riccati::solve`](super::Riccati::solve) or a [`RiccatiRecursion`](super::RiccatiRecursion) returned no solution. Rows and columns are counted from zero.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RiccatiError {
    /// A matrix has another shape than the number of `A`'s rows (states) and of `B`'s columns (controls) demand.
    WrongShape {
        /// The matrix at fault.
        matrix: RiccatiMatrix,
        /// The rows and columns that it should have.
        expected: (usize, usize),
        /// The rows and columns that it has.
        got: (usize, usize),
    },
    /// An entry is infinite or not a number.
    NotFinite {
        /// The matrix at fault.
        matrix: RiccatiMatrix,
        /// The entry's row.
        row: usize,
        /// The entry's column.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// `Q` or `R` differs from its transpose by more than rounding explains.
    NotSymmetric {
        /// The matrix at fault.
        matrix: RiccatiMatrix,
        /// The row of the entry above the diagonal.
        row: usize,
        /// The column of the entry above the diagonal.
        column: usize,
        /// The entry above the diagonal.
        value: f64,
        /// Its mirror image below the diagonal.
        mirror: f64,
    },
    /// `R` is not positive semidefinite: some control costs less than nothing.
    ControlCostNotPositive {
        /// The smallest eigenvalue of `R`.
        smallest_eigenvalue: f64,
    },
    /// Some combination of controls costs nothing and does nothing, so that it could be anything: `R` and `BᵀB` have a common null
    /// vector, and the pencil whose eigenvalues are those of the closed loop is singular.
    SingularPencil,
    /// Over a finite number of steps there is no least cost: `R + BᵀPB` is not positive definite in some step, where a control of
    /// no end would cost less than nothing. With a positive definite `R` this takes a `Q` or a `P` at the end that is not positive
    /// semidefinite.
    NoLeastCost {
        /// The smallest eigenvalue of `R + BᵀPB`.
        smallest_eigenvalue: f64,
    },
    /// No control stabilises the system: a mode on or outside the unit circle is out of the controls' reach.
    UncontrollableMode {
        /// The mode's eigenvalue of `A`.
        eigenvalue: Complex<f64>,
        /// The smallest singular value of `[A − λI, B]`, each block scaled to unit norm. For a mode out of reach it is zero but for rounding.
        distance: f64,
    },
    /// A mode on the unit circle costs nothing, so the best control leaves it there and no solution is stabilising.
    ///
    /// Nothing means nothing: a weight of 10⁻¹⁰ beside others of 10⁵ makes a slow closed loop, but a stable one, and is solved.
    UnobservableMode {
        /// The mode's eigenvalue of `A − BR⁻¹Sᵀ`.
        eigenvalue: Complex<f64>,
        /// The smallest singular value of `A − BR⁻¹Sᵀ − λI` above `Q − SR⁻¹Sᵀ`, each block scaled to unit norm.
        /// For a mode that costs nothing it is zero but for rounding.
        distance: f64,
    },
    /// The doubling did not converge, and no single mode explains it: the problem may be too badly scaled, or `Q − SR⁻¹Sᵀ` not positive semidefinite.
    NoConvergence {
        /// The number of doublings that were made.
        iterations: usize,
    },
    /// A solution was found, but it satisfies the equation less well than asked for.
    Inaccurate {
        /// The residual reached, as in [`RiccatiSolution`](super::RiccatiSolution::relative_residual).
        relative_residual: f64,
        /// The residual asked for.
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
            Self::WrongShape { matrix, expected: (rows, columns), got: (got_rows, got_columns) } => write!(
                formatter,
                "{matrix} is {got_rows} by {got_columns}; beside the other matrices it should be {rows} by {columns}"
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
                "R has the eigenvalue {smallest_eigenvalue:e}; it should be positive semidefinite, so that no control costs less than nothing"
            ),
            Self::SingularPencil => formatter.write_str(
                "a combination of controls costs nothing and does nothing, so the best control is not determined; give it a \
                 weight in R, however small, or leave it out",
            ),
            Self::NoLeastCost { smallest_eigenvalue } => write!(
                formatter,
                "there is no least cost: R + BᵀPB has the eigenvalue {smallest_eigenvalue:e} in a step; R should be positive definite, \
                 and Q and the P at the end positive semidefinite"
            ),
            Self::UncontrollableMode { eigenvalue, distance } => write!(
                formatter,
                "no control stabilises the system: the mode of A with eigenvalue {eigenvalue} (modulus {:.9}) is not inside the \
                 unit circle and out of reach of B (distance {distance:.1e}); give it an actuator, or leave it out of the state",
                modulus(*eigenvalue)
            ),
            Self::UnobservableMode { eigenvalue, distance } => write!(
                formatter,
                "no solution is stabilising: the mode with eigenvalue {eigenvalue} (modulus {:.9}) is on the unit circle and costs \
                 nothing (distance {distance:.1e}); give it a weight in Q, however small",
                modulus(*eigenvalue)
            ),
            Self::NoConvergence { iterations } => write!(
                formatter,
                "no convergence after {iterations} doublings, and no single mode explains it; the scaling of the states and whether \
                 Q − SR⁻¹Sᵀ is positive semidefinite are worth a look"
            ),
            Self::Inaccurate { relative_residual, tolerance } => write!(
                formatter,
                "the solution's relative residual is {relative_residual:.1e}, above the tolerance of {tolerance:.1e}; states \
                 in units that make the entries of A and Q more alike would help"
            ),
        }
    }
}

impl std::error::Error for RiccatiError {}

/// The modulus, without the overflow of squaring.
pub(super) fn modulus(number: Complex<f64>) -> f64 {
    number.re.hypot(number.im)
}
