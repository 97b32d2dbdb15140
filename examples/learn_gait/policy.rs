//! Linear policy on normalised observations, and its file.

use std::error::Error;
use std::path::Path;

use mujoco_safe::{Matrix, MatrixView};
use serde_json::{Value, json};

/// Controls as a linear function of normalised observations: `W (observation − mean) / deviation`,
/// clamped to ±1.
#[derive(Clone, Debug, PartialEq)]
pub struct Policy {
    /// Weights `W` `(nu, nobs)`.
    pub weights: Matrix,
    /// Mean of each observation.
    pub mean: Vec<f64>,
    /// Standard deviation of each observation.
    pub deviation: Vec<f64>,
}

impl Policy {
    /// Creates a policy with weights of zero that does not normalise observations.
    pub fn zero(nu: usize, nobs: usize) -> Self {
        Self { weights: Matrix::zeros(nu, nobs), mean: vec![0.0; nobs], deviation: vec![1.0; nobs] }
    }

    /// Computes the controls `(n, nu)` for observations `(n, nobs)`, with the weights `(nu, nobs)`
    /// of each row.
    pub fn act_with<'w>(
        &self,
        weights: impl Fn(usize) -> &'w [f64],
        observations: MatrixView<'_>,
        controls: &mut [f64],
    ) {
        let nobs = self.mean.len();
        let mut normalised = vec![0.0; nobs];
        let rows = observations.rows().zip(controls.chunks_exact_mut(self.weights.nrows()));
        for (index, (observation, controls)) in rows.enumerate() {
            for (entry, value) in normalised.iter_mut().enumerate() {
                *value = (observation[entry] - self.mean[entry]) / self.deviation[entry];
            }
            for (control, weights) in controls.iter_mut().zip(weights(index).chunks_exact(nobs)) {
                let sum: f64 = weights.iter().zip(&normalised).map(|(weight, value)| weight * value).sum();
                *control = sum.clamp(-1.0, 1.0);
            }
        }
    }

    /// Computes the controls `(n, nu)` for observations `(n, nobs)`.
    pub fn act(&self, observations: MatrixView<'_>, controls: &mut [f64]) {
        self.act_with(|_| self.weights.as_slice(), observations, controls);
    }

    /// Writes the policy to a JSON file.
    pub fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let weights: Vec<&[f64]> = self.weights.rows().collect();
        let file = json!({ "weights": weights, "mean": self.mean, "deviation": self.deviation });
        std::fs::write(path, file.to_string()).map_err(|error| format!("{}: {error}", path.display()).into())
    }

    /// Reads a policy with `nu` controls and `nobs` observations from a file that
    /// [`save`](Self::save) has written.
    pub fn load(path: &Path, nu: usize, nobs: usize) -> Result<Self, Box<dyn Error>> {
        let name = path.display();
        let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
        let file: Value = serde_json::from_str(&text).map_err(|error| format!("{name}: {error}"))?;
        let numbers = |value: &Value| -> Option<Vec<f64>> {
            let numbers: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
            (numbers.len() == nobs).then_some(numbers)
        };
        let weights = || -> Option<Vec<f64>> {
            let rows: Vec<Vec<f64>> = file["weights"].as_array()?.iter().map(numbers).collect::<Option<_>>()?;
            (rows.len() == nu).then(|| rows.concat())
        };
        match (weights(), numbers(&file["mean"]), numbers(&file["deviation"])) {
            (Some(weights), Some(mean), Some(deviation)) => {
                Ok(Self { weights: Matrix::from_row_major(nu, nobs, weights), mean, deviation })
            }
            _ => Err(format!("{name} is not a policy with {nu} controls and {nobs} observations").into()),
        }
    }
}
