//! Derivatives of a step by parameters from the engine's steps alone: extrapolated central
//! differences with edited models, and a solver that iterates to convergence.

use mujoco_safe::derivative::ModelParameter;
use mujoco_safe::{Data, Model, Result, StateSpec};

/// Steps of the differences, relative to the value of the parameter or to [`LEAST`].
const WIDTHS: [f64; 6] = [2e-3, 2e-2, 2e-4, 2e-1, 2e-5, 2e-6];
const LEAST: f64 = 0.05;

/// Rounding error of a step, relative to the largest number of its result.
const ROUNDING: f64 = 2e-15;

/// Parameters whose derivative at zero is the one to the right.
const NOT_NEGATIVE: [&str; 8] =
    ["damping", "frictionloss", "armature", "stiffness", "geom_friction", "geom_margin", "mass of", "geom_size"];

pub(super) struct Oracle {
    data: Data,
    state: Vec<f64>,
}

/// An extrapolated derivative, and the estimate of its error: its last change.
pub(super) struct Estimate {
    pub(super) column: Vec<f64>,
    pub(super) error: f64,
    /// Largest number of the samples, at least 1.
    pub(super) size: f64,
}

impl Oracle {
    pub(super) fn new(data: &Data) -> Self {
        let mut data = data.clone();
        data.edit_model(|model| {
            model.edit_options(|options| {
                options.tolerance = 0.0;
                options.iterations = options.iterations.max(200);
            })
        })
        .unwrap();
        Self { state: data.state(StateSpec::INTEGRATION), data }
    }

    /// Returns a simulation at the base state whose model has another value.
    pub(super) fn varied(&self, parameter: ModelParameter, by: f64) -> Option<Data> {
        let mut data = self.data.clone();
        let value = parameter.value(data.model()).unwrap();
        set(&mut data, parameter, value + by).ok()?;
        data.set_state(StateSpec::INTEGRATION, &self.state).unwrap();
        Some(data)
    }

    /// Returns the next state and the sensors.
    fn step(&self, parameter: ModelParameter, by: f64) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut data = self.varied(parameter, by)?;
        data.step().ok()?;
        Some((data.physics_state(), data.sensordata().to_vec()))
    }

    /// Returns a difference quotient, the bound of its rounding error, and the size of the samples.
    fn quotient(&self, parameter: ModelParameter, [from, to]: [f64; 2]) -> Option<(Vec<f64>, [f64; 2])> {
        let ((left, left_sensors), (right, right_sensors)) = (self.step(parameter, from)?, self.step(parameter, to)?);
        let (model, width) = (self.data.model(), to - from);
        let (nq, nv) = (model.nq(), model.nv());
        let mut column = vec![0.0; nv];
        model.differentiate_pos_into(width, &left[..nq], &right[..nq], &mut column).unwrap();
        let rest = right[nq..].iter().zip(&left[nq..]).chain(right_sensors.iter().zip(&left_sensors));
        column.extend(rest.map(|(right, left)| (right - left) / width));
        let largest = right.iter().chain(&right_sensors).fold(1.0, |largest: f64, value| largest.max(value.abs()));
        Some((column, [ROUNDING * largest / width, largest]))
    }

    /// Computes estimates with several steps, one after another. Those of a parameter at zero that
    /// cannot be negative are one-sided.
    pub(super) fn estimates(&self, parameter: ModelParameter) -> impl Iterator<Item = Estimate> {
        let model: &Model = self.data.model();
        let (value, name) = (parameter.value(model).unwrap(), parameter.name(model).unwrap());
        let is_relative = ["solref", "solimp", "friction["].iter().any(|part| name.contains(part));
        let size = if is_relative && value != 0.0 { value.abs() } else { value.abs().max(LEAST) };
        let ends_at_zero = NOT_NEGATIVE.iter().any(|part| name.contains(part));
        let of_width = move |width: f64| {
            let width = width * size;
            let is_central = self.varied(parameter, -width).is_some() && !(ends_at_zero && value < width);
            let slopes: Option<Vec<(Vec<f64>, [f64; 2])>> = [1.0, 0.5, 0.25]
                .map(|part| {
                    let right = part * width;
                    self.quotient(parameter, [if is_central { -right } else { 0.0 }, right])
                })
                .into_iter()
                .collect();
            let slopes = slopes?;
            let (base, [mut error, size]) = (if is_central { 4.0 } else { 2.0 }, slopes[2].1);
            let column = (0..slopes[0].0.len()).map(|at| {
                let [coarse, middle, fine] = [0, 1, 2].map(|part: usize| slopes[part].0[at]);
                let better = |fine: f64, coarse: f64, order: f64| (order * fine - coarse) / (order - 1.0);
                let (first, second) = (better(middle, coarse, base), better(fine, middle, base));
                let third = better(second, first, if is_central { 16.0 } else { 4.0 });
                error = error.max((third - second).abs());
                third
            });
            let column = column.collect();
            Some(Estimate { column, error, size })
        };
        WIDTHS.into_iter().filter_map(of_width)
    }
}

/// Changes a parameter with the inertias that depend on it, and no other derived constants.
pub(super) fn set(data: &mut Data, parameter: ModelParameter, value: f64) -> Result<()> {
    let base = data.model().clone();
    data.edit_model(|model| {
        parameter.set(model, value)?;
        if changes_inertia(&parameter.name(&base)?) {
            model.update_constants()?;
            model.body_invweight0_mut().copy_from_slice(base.body_invweight0());
            model.dof_invweight0_mut().copy_from_slice(base.dof_invweight0());
            model.tendon_invweight0_mut().copy_from_slice(base.tendon_invweight0());
            model.actuator_acc0_mut().copy_from_slice(base.actuator_acc0());
        }
        Ok(())
    })
}

/// Returns `true` for a parameter of the inertia matrix.
fn changes_inertia(name: &str) -> bool {
    ["mass", "inertia", "inertial", "log-Cholesky", "body_i", "armature"].iter().any(|part| name.contains(part))
}
