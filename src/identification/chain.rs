//! Elimination of the states at the starts of segments.
//!
//! The model of the cost is quadratic in the unknowns θ and in the states of each experiment, of
//! which only neighbours interact: a block tridiagonal matrix with a border. Cholesky elimination
//! from the first state to the last one leaves a model in θ alone; the states follow backwards.

use nalgebra::{Cholesky, DMatrix, DVector, DVectorView, Dyn};

use super::plan::Plan;

/// Least diagonal entry for the damping.
const LEAST_DIAGONAL: f64 = 1e-12;

/// States of one experiment in the model of the cost.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain(Vec<Block>);

/// One state.
#[derive(Clone, Debug)]
struct Block {
    /// `(n, n)`.
    diagonal: DMatrix<f64>,
    /// With the next state, `(next, n)`.
    coupling: DMatrix<f64>,
    /// With the unknowns, and the gradient: `(n, unknowns + 1)`.
    border: DMatrix<f64>,
    /// Results of the elimination.
    factor: Option<Cholesky<f64, Dyn>>,
    reduced: DMatrix<f64>,
}

impl Chain {
    /// Creates a chain of states with these numbers of coordinates.
    pub(super) fn new(plan: &Plan, unknowns: usize) -> Self {
        let size = |segment: usize| if segment < plan.segments() { plan.states(segment).len() } else { 0 };
        let blocks = (0..plan.segments()).map(|segment| (size(segment), size(segment + 1))).map(|(size, next)| Block {
            diagonal: DMatrix::zeros(size, size),
            coupling: DMatrix::zeros(next, size),
            border: DMatrix::zeros(size, unknowns + 1),
            factor: None,
            reduced: DMatrix::zeros(size, unknowns + 1),
        });
        Self(blocks.collect())
    }

    /// Adds `½ [x; θ; 1]ᵀ M [x; θ; 1]` for the state x at a place. `total` has the part without x.
    pub(super) fn add(&mut self, place: usize, matrix: &DMatrix<f64>, total: &mut DMatrix<f64>) {
        let Block { diagonal, border, .. } = &mut self.0[place];
        let (n, rest) = (diagonal.nrows(), border.ncols());
        *diagonal += matrix.view((0, 0), (n, n));
        *border += matrix.view((0, n), (n, rest));
        *total += matrix.view((n, n), (rest, rest));
    }

    /// Adds `½ ‖W (J [x; θ; 1] − y)‖²` for the state x at a place and the next one, y.
    pub(super) fn add_gap(&mut self, place: usize, end: &DMatrix<f64>, weights: &[f64], total: &mut DMatrix<f64>) {
        let squares = DVector::from_iterator(weights.len(), weights.iter().map(|weight| weight * weight));
        let weighted = DMatrix::from_fn(end.nrows(), end.ncols(), |row, column| squares[row] * end[(row, column)]);
        self.add(place, &end.tr_mul(&weighted), total);
        let n = self.0[place].diagonal.nrows();
        self.0[place].coupling -= weighted.columns(0, n);
        let next = &mut self.0[place + 1];
        for (row, square) in squares.iter().enumerate() {
            next.diagonal[(row, row)] += square;
        }
        next.border -= weighted.columns(n, end.ncols() - n);
    }

    /// Adds the square of an error with this slope by a coordinate of the first state.
    pub(super) fn add_prior(&mut self, coordinate: usize, error: f64, slope: f64) {
        let Block { diagonal, border, .. } = &mut self.0[0];
        diagonal[(coordinate, coordinate)] += slope * slope;
        let gradient = border.ncols() - 1;
        border[(coordinate, gradient)] += slope * error;
    }

    /// Eliminates the states from the model, with a damping of their diagonal. Returns `false` if
    /// they have no minimum.
    pub(super) fn eliminate(&mut self, damping: f64, total: &mut DMatrix<f64>) -> bool {
        // What the elimination of the previous state adds to this one.
        let mut carried: Option<(DMatrix<f64>, DMatrix<f64>)> = None;
        for block in &mut self.0 {
            let mut diagonal = block.diagonal.clone();
            let largest = diagonal.diagonal().amax();
            for index in 0..diagonal.nrows() {
                let entry = &mut diagonal[(index, index)];
                *entry += damping * entry.max(LEAST_DIAGONAL * largest);
            }
            block.reduced.copy_from(&block.border);
            if let Some((by_state, by_border)) = carried.take() {
                diagonal -= by_state;
                block.reduced -= by_border;
            }
            if !diagonal.iter().chain(block.reduced.iter()).all(|value| value.is_finite()) {
                return false;
            }
            block.factor = Cholesky::new(diagonal);
            let Some(factor) = &block.factor else { return false };
            let solved = factor.solve(&block.reduced);
            *total -= block.reduced.tr_mul(&solved);
            if block.coupling.nrows() > 0 {
                let across = factor.solve(&block.coupling.transpose());
                carried = Some((&block.coupling * across, &block.coupling * solved));
            }
        }
        true
    }

    /// Returns the changes of the states that belong to a change of the unknowns, after
    /// [`eliminate`](Self::eliminate).
    pub(super) fn states(&self, unknowns: &[f64]) -> Vec<DVector<f64>> {
        let step = DVectorView::from_slice(unknowns, unknowns.len()).push(1.0);
        let mut states: Vec<DVector<f64>> = Vec::new();
        for block in self.0.iter().rev() {
            let mut right = &block.reduced * &step;
            if let Some(next) = states.last() {
                right += block.coupling.tr_mul(next);
            }
            let factor = block.factor.as_ref().expect("Bug: states before their elimination");
            states.push(-factor.solve(&right));
        }
        states.reverse();
        states
    }
}
