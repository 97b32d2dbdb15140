//! The correction of an estimate by a reading.

use std::ops::Range;

use super::chi_square::chi_square_quantile;
use super::covariance;
use super::measurement::Measurement;
use crate::error::Result;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::{dot, symmetrise};

/// Result of a correction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Update {
    /// Success, or the reason why the estimate is unchanged.
    pub status: UpdateStatus,
    /// Number of components that were used.
    pub used: usize,
    /// Number of components that the [gate](super::ExtendedKalmanFilter::with_gate) rejected.
    pub rejected: usize,
    /// Normalised square of the innovations that were used, `νᵀ S⁻¹ ν` (NIS). If the filter is
    /// consistent, it has the chi-square distribution with [`used`](Self::used) degrees of freedom.
    #[doc(alias = "normalised innovation squared")]
    pub nis: f64,
}

/// Status of a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum UpdateStatus {
    /// The estimate was corrected.
    Corrected,
    /// All components are missing or were rejected, so the estimate is unchanged.
    NoReadings,
    /// The corrected estimate or its covariance are beyond the range of floating-point numbers, so
    /// the estimate is unchanged.
    OutOfRange,
}

/// Use of a component of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ReadingOutcome {
    /// It corrected the estimate.
    Used,
    /// It was NaN.
    Missing,
    /// The [gate](super::ExtendedKalmanFilter::with_gate) rejected its sensor.
    Rejected,
}

/// Test of innovations.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    /// Largest normalised square for each number of components.
    bounds: Vec<f64>,
    /// The estimate and its covariance before a sensor.
    estimate: Vec<f64>,
    covariance: Matrix,
}

impl Gate {
    /// Creates a test for `nz` estimated numbers.
    pub(super) fn new(probability: f64, parts: &[Range<usize>], nz: usize) -> Result<Self> {
        let longest = parts.iter().map(Range::len).max().unwrap_or(0);
        let bounds = (0..=longest).map(|size| chi_square_quantile(probability, size.max(1)));
        Ok(Self { bounds: bounds.collect::<Result<_>>()?, estimate: vec![0.0; nz], covariance: Matrix::zeros(nz, nz) })
    }
}

/// Buffers of a correction, and its results.
#[derive(Clone, Debug)]
pub(super) struct Correction {
    /// `(ny)`
    pub(super) innovations: Vec<f64>,
    pub(super) outcomes: Vec<ReadingOutcome>,
    /// Deviation of the state and of the noise of the controls from the point of linearisation,
    /// `(nz)`.
    pub(super) estimate: Vec<f64>,
    /// `(ny, nz)`: gain of each component.
    pub(super) gains: Matrix,
    /// `(ny)`: innovation of each component relative to the estimate that the components before
    /// have corrected, and its variance.
    pub(super) residuals: Vec<[f64; 2]>,
    product: Vec<f64>,
}

impl Correction {
    /// Creates buffers for `nz` estimated numbers and `ny` readings.
    pub(super) fn new(nz: usize, ny: usize) -> Self {
        Self {
            innovations: vec![0.0; ny],
            outcomes: vec![ReadingOutcome::Missing; ny],
            estimate: vec![0.0; nz],
            gains: Matrix::zeros(ny, nz),
            residuals: vec![[0.0; 2]; ny],
            product: vec![0.0; nz],
        }
    }

    /// Corrects the estimate and its covariance `(nz, nz)` by the innovations at the point of
    /// linearisation, given the derivatives of the readings `(ny, nz)`.
    ///
    /// The noise of the components is independent, so they are processed one after another, without
    /// a factorisation. The result is that of all components together (Bar-Shalom and others, 2001,
    /// section 7.3). So is the normalised square of a sensor, which the gate bounds. A correction
    /// by a sensor that it rejects is undone.
    pub(super) fn run(
        &mut self,
        covariance: &mut Matrix,
        output: &Matrix,
        measurement: &Measurement,
        mut gate: Option<&mut Gate>,
    ) -> Update {
        let mut update = Update { status: UpdateStatus::NoReadings, used: 0, rejected: 0, nis: 0.0 };
        for part in &measurement.parts {
            if let Some(gate) = &mut gate {
                gate.estimate.copy_from_slice(&self.estimate);
                gate.covariance.as_mut_slice().copy_from_slice(covariance.as_slice());
            }
            let (mut count, mut square) = (0, 0.0);
            for index in part.clone() {
                self.outcomes[index] = ReadingOutcome::Missing;
                if !self.innovations[index].is_nan() {
                    self.outcomes[index] = ReadingOutcome::Used;
                    count += 1;
                    square += self.add(covariance, output.row(index), index, measurement.variances[index]);
                }
            }
            match &gate {
                // NaN passes, and makes the correction out of range.
                Some(gate) if square > gate.bounds[count] => {
                    self.estimate.copy_from_slice(&gate.estimate);
                    covariance.as_mut_slice().copy_from_slice(gate.covariance.as_slice());
                    let used =
                        self.outcomes[part.clone()].iter_mut().filter(|outcome| **outcome == ReadingOutcome::Used);
                    used.for_each(|outcome| *outcome = ReadingOutcome::Rejected);
                    update.rejected += count;
                }
                _ => (update.used, update.nis) = (update.used + count, update.nis + square),
            }
        }
        if update.used > 0 {
            symmetrise(covariance);
            let is_finite = update.nis.is_finite() && covariance::is_finite(&self.estimate);
            update.status = if is_finite { UpdateStatus::Corrected } else { UpdateStatus::OutOfRange };
        }
        update
    }

    /// Corrects by one component. Returns the normalised square of its innovation.
    fn add(&mut self, covariance: &mut Matrix, gradient: &[f64], index: usize, variance: f64) -> f64 {
        let total = covariance::variance_of(covariance, gradient, &mut self.product) + variance;
        let innovation = self.innovations[index] - dot(gradient, &self.estimate);
        let gains = self.gains.row_mut(index);
        for ((gain, product), estimate) in gains.iter_mut().zip(&self.product).zip(&mut self.estimate) {
            *gain = product / total;
            *estimate += *gain * innovation;
        }
        covariance::correct(covariance, gradient, gains, &self.product, variance);
        self.residuals[index] = [innovation, total];
        innovation * innovation / total
    }
}
