//! Result of an identification.

use std::fmt;

use nalgebra::{DMatrix, DVectorView};

use super::column::Values;
use super::shooting::{Point, Residuals, Shooting};
use super::{Experiment, Identification, MeasurementError, Options, Unknown};
use crate::error::{Error, InvalidKind, Result};
use crate::least_squares::{LeastSquaresOutcome, LeastSquaresStatus};
use crate::matrix::Matrix;
use crate::model::{IntoModel, Model};

/// Quantile of the normal distribution for an interval of 95 %.
const QUANTILE: f64 = 1.959_963_984_540_054;
/// Eigenvalue of the information in units of its diagonal, below which the data do not determine a
/// combination: the accuracy of differences squared.
const UNDETERMINED: f64 = 1e-10;
/// Change of the residuals by a change of an unknown that matters, below which it has no influence.
const NO_INFLUENCE: f64 = 1e-6;
/// Part of the largest factor below which an unknown does not belong to a combination.
const SMALL_PART: f64 = 0.02;

/// Result of an [`Identification`]: values with their uncertainty, and the errors of the
/// measurements.
#[derive(Clone, Debug)]
pub struct Fit {
    pub(super) identification: Identification,
    outcome: LeastSquaresOutcome,
    costs: Vec<f64>,
    coordinates: Vec<f64>,
    estimates: Vec<Estimate>,
    covariance: Matrix,
    undetermined: Vec<Combination>,
    errors: Vec<MeasurementError>,
    noise: f64,
    gap: f64,
}

/// Value of an unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the unknown.
    pub name: String,
    /// Value that the search started from.
    pub first: f64,
    /// Value.
    pub value: f64,
    /// Standard deviation; infinite if the data do not determine the value.
    pub deviation: f64,
    /// Confidence interval of 95 %, cut at the bounds.
    pub interval: [f64; 2],
    /// `true` if the value is at a bound. It then counts as known for the others.
    pub is_at_bound: bool,
}

/// Combination of unknowns that the data do not determine: all values can change together by
/// multiples of these factors, and the readings stay.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// Names and factors; the largest is 1.
    pub terms: Vec<(String, f64)>,
}

impl Fit {
    pub(super) fn new(
        identification: &Identification,
        problem: &Shooting<'_>,
        hessian: &Matrix,
        outcome: LeastSquaresOutcome,
        errors: Vec<MeasurementError>,
    ) -> Self {
        let Point { coordinates, .. } = &problem.present;
        let unknowns = &identification.unknowns;
        let values = Values { unknowns, coordinates, version: 0 };
        let Residuals { count, squares, gap } = problem.residuals;
        let states: usize = problem.plans.iter().map(|plan| plan.states(0).len()).sum();
        let freedom = count.saturating_sub(unknowns.len() + states).max(1) as f64;
        let noise = (squares / freedom).sqrt();
        let is_at_bound: Vec<bool> = unknowns
            .iter()
            .zip(coordinates)
            .map(|(unknown, &coordinate)| {
                let close = 1e-9 * unknown.coordinate_scale();
                unknown.bounds().iter().any(|bound| (bound - coordinate).abs() <= close)
            })
            .collect();
        let scales: Vec<f64> = unknowns.iter().map(|unknown| unknown.coordinate_scale()).collect();
        let slopes: Vec<f64> = (0..unknowns.len()).map(|index| values.slope(index)).collect();
        let information = Information::new(hessian, &scales, &slopes, &is_at_bound);
        let covariance = information.covariance(unknowns.len(), noise);
        let quantile = quantile(freedom);
        let estimates = unknowns
            .iter()
            .enumerate()
            .map(|(index, unknown)| {
                let value = values.value(index);
                let deviation = covariance[(index, index)].sqrt();
                let half = quantile * deviation;
                let ends = if unknown.is_logarithmic {
                    let factor = (half / value).exp();
                    [value / factor, value * factor]
                } else {
                    [value - half, value + half]
                };
                let interval = [ends[0].max(unknown.lower), ends[1].min(unknown.upper)];
                let (name, first) = (unknown.name.clone(), unknown.first);
                Estimate { name, first, value, deviation, interval, is_at_bound: is_at_bound[index] }
            })
            .collect();
        let undetermined = information.undetermined(unknowns);
        Self {
            identification: identification.clone(),
            outcome,
            costs: problem.costs.clone(),
            coordinates: coordinates.clone(),
            estimates,
            covariance,
            undetermined,
            errors,
            noise,
            gap,
        }
    }

    /// Returns the reason for which the search ended.
    pub fn status(&self) -> LeastSquaresStatus {
        self.outcome.status
    }

    /// Returns the number of iterations and the costs.
    pub fn outcome(&self) -> LeastSquaresOutcome {
        self.outcome
    }

    /// Returns the cost at the first point and after each iteration. With segments, the weight of
    /// the gaps between them grows during the search, and the cost with it.
    pub fn costs(&self) -> &[f64] {
        &self.costs
    }

    /// Returns the values, in the order of the unknowns.
    pub fn estimates(&self) -> &[Estimate] {
        &self.estimates
    }

    /// Returns the value of an unknown by its name.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] without such an unknown; the message has the names that there are.
    pub fn value(&self, name: &str) -> Result<f64> {
        let found = self.estimates.iter().find(|estimate| estimate.name == name);
        found.map(|estimate| estimate.value).ok_or_else(|| {
            let names: Vec<&str> = self.estimates.iter().map(|estimate| &*estimate.name).collect();
            Error::invalid(InvalidKind::Unknown, "the name of an unknown", name, format!("one of {}", names.join(", ")))
        })
    }

    /// Returns the covariance of the values, `(n, n)`, without those at bounds, whose rows are
    /// zero. It is that of the linearised model, with the standard deviations of the measurements
    /// multiplied by [`noise`](Self::noise). Infinite for values that the data do not determine.
    pub fn covariance(&self) -> &Matrix {
        &self.covariance
    }

    /// Returns the combinations of unknowns that the data do not determine.
    pub fn undetermined(&self) -> &[Combination] {
        &self.undetermined
    }

    /// Returns the root mean square of the residuals in units of the standard deviations of the
    /// measurements: about 1 if these are right and the model can explain the data.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Returns the largest difference, in m, rad and their rates, between the end of a segment and
    /// the start of the next one.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Returns the errors of all measurements.
    pub fn errors(&self) -> &[MeasurementError] {
        &self.errors
    }

    /// Simulates experiments with these values, and returns the errors of their measurements: for
    /// experiments that were not used in the search. Uncertain states at their starts are
    /// identified.
    ///
    /// # Errors
    ///
    /// As for [`Identification::with_experiment`] and [`Identification::solve`].
    pub fn validate(&self, experiments: impl IntoIterator<Item = Experiment>) -> Result<Vec<MeasurementError>> {
        let known = self.identification.unknowns.iter().zip(&self.estimates);
        let known = known.map(|(unknown, estimate)| {
            let value = estimate.value;
            let mut unknown = unknown.clone().starting_at(value).between(value, value);
            unknown.prior = None;
            unknown
        });
        let mut identification = Identification::new(known.collect())?;
        for experiment in experiments {
            identification = identification.with_experiment(experiment)?;
        }
        identification.has_all_measurements = false;
        Ok(identification.solve(Options::default())?.errors)
    }

    /// Returns a copy of a model with the identified values of its parameters. The model is that of
    /// the experiments, or an edited copy of it.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for another model, [`Error::Unsupported`] for an edited copy with an
    /// inertia of which the identified numbers cannot be a part, and the errors of closures and of
    /// [`update_constants`](crate::ModelMut::update_constants).
    pub fn model(&self, model: impl IntoModel) -> Result<Model> {
        let model = model.into_model();
        if let Some(experiment) = self.identification.experiments.first() {
            experiment.model.relation(&model).check("the model for an identification")?;
        }
        let mut copy = Model::clone(&model);
        let values = Values { unknowns: &self.identification.unknowns, coordinates: &self.coordinates, version: 0 };
        if values.write(None, &model, &mut copy.edit())? {
            return Ok(copy);
        }
        Err(Error::Unsupported("the identified inertias are not possible together with those of this model".to_owned()))
    }
}

/// Information about the free unknowns, in units in which its diagonal is one.
struct Information {
    free: Vec<usize>,
    /// These units of the values of the unknowns.
    units: Vec<f64>,
    eigenvalues: Vec<f64>,
    eigenvectors: DMatrix<f64>,
}

impl Information {
    fn new(hessian: &Matrix, scales: &[f64], slopes: &[f64], is_at_bound: &[bool]) -> Self {
        let free: Vec<usize> = (0..scales.len()).filter(|&index| !is_at_bound[index]).collect();
        let root = |index: usize| hessian[(index, index)].max(0.0).sqrt();
        let has_influence = |index: usize| root(index) * scales[index] > NO_INFLUENCE;
        let relative = DMatrix::from_fn(free.len(), free.len(), |row, column| {
            let (row, column) = (free[row], free[column]);
            if has_influence(row) && has_influence(column) {
                hessian[(row, column)] / (root(row) * root(column))
            } else {
                0.0
            }
        });
        // The decomposition of an empty matrix panics, and that of a NaN does not end.
        let (eigenvalues, eigenvectors) = if !free.is_empty() && relative.iter().all(|value| value.is_finite()) {
            let eigen = relative.symmetric_eigen();
            (eigen.eigenvalues.as_slice().to_vec(), eigen.eigenvectors)
        } else {
            (vec![0.0; free.len()], DMatrix::identity(free.len(), free.len()))
        };
        let unit =
            |&index: &usize| slopes[index] * if has_influence(index) { root(index).recip() } else { scales[index] };
        Self { units: free.iter().map(unit).collect(), free, eigenvalues, eigenvectors }
    }

    /// Returns the covariance of all unknowns.
    fn covariance(&self, unknowns: usize, noise: f64) -> Matrix {
        let mut covariance = Matrix::zeros(unknowns, unknowns);
        for (vector, &value) in self.eigenvectors.column_iter().zip(&self.eigenvalues) {
            let largest = vector.amax();
            for (row, column) in (0..vector.len()).flat_map(|row| (0..vector.len()).map(move |column| (row, column))) {
                let entry = &mut covariance[(self.free[row], self.free[column])];
                if value > UNDETERMINED {
                    let product = vector[row] * vector[column] * self.units[row] * self.units[column];
                    *entry += noise * noise * product / value;
                } else if row == column && vector[row].abs() > SMALL_PART * largest {
                    *entry = f64::INFINITY;
                }
            }
        }
        covariance
    }

    /// Returns the undetermined combinations.
    fn undetermined(&self, unknowns: &[Unknown]) -> Vec<Combination> {
        let vectors = self.eigenvectors.column_iter().zip(&self.eigenvalues);
        let combination = |vector: DVectorView<'_, f64>| {
            let parts = vector.iter().enumerate().filter(|(_, part)| part.abs() > SMALL_PART * vector.amax());
            let term = |(at, part): (usize, &f64)| (unknowns[self.free[at]].name.clone(), part * self.units[at]);
            let mut terms: Vec<(String, f64)> = parts.map(term).collect();
            let larger = |one: f64, other: f64| if other.abs() > one.abs() { other } else { one };
            let largest = terms.iter().map(|term| term.1).fold(0.0, larger);
            for term in &mut terms {
                term.1 /= largest;
            }
            Combination { terms }
        };
        vectors.filter(|(_, value)| **value <= UNDETERMINED).map(|(vector, _)| combination(vector)).collect()
    }
}

/// Returns the quantile of Student's distribution for an interval of 95 % (M. Abramowitz and I. A.
/// Stegun, *Handbook of Mathematical Functions*, 26.7.5).
fn quantile(freedom: f64) -> f64 {
    let z = QUANTILE;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + first / freedom + second / freedom.powi(2) + third / freedom.powi(3)
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, factor)) in self.terms.iter().enumerate() {
            let sign = match (index, *factor < 0.0) {
                (0, false) => "",
                (0, true) => "−",
                (_, false) => " + ",
                (_, true) => " − ",
            };
            write!(f, "{sign}{:.3} ({name})", factor.abs())?;
        }
        Ok(())
    }
}

impl fmt::Display for Fit {
    /// Writes a table of the values, what the data do not determine, and the errors of the
    /// measurements.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LeastSquaresOutcome { status, iterations, first_cost, cost } = self.outcome;
        writeln!(f, "{status:?} after {iterations} iterations, cost {first_cost:.4e} → {cost:.4e}")?;
        let width = self.estimates.iter().map(|estimate| estimate.name.chars().count()).max().unwrap_or(0);
        for Estimate { name, first, value, interval: [low, high], is_at_bound, .. } in &self.estimates {
            // Two digits of the interval's width.
            let digits = (1.0 - (high - low).log10().floor()).clamp(0.0, 12.0) as usize;
            let digits = if (high - low).is_finite() && high > low { digits } else { 6 };
            write!(f, "{name:width$}  {first} → {value:.digits$}  ")?;
            if *is_at_bound {
                writeln!(f, "at a bound")?;
            } else {
                writeln!(f, "95 % [{low:.digits$}, {high:.digits$}]")?;
            }
        }
        for combination in &self.undetermined {
            writeln!(f, "not determined: {combination}")?;
        }
        for MeasurementError { experiment, measurement, count, rms, .. } in &self.errors {
            writeln!(f, "{experiment}, {measurement}: {count} readings, rms error {rms:.4e}")?;
        }
        Ok(())
    }
}
