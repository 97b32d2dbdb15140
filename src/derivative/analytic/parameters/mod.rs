//! Derivatives of a step and of inverse dynamics by parameters of the model.
//!
//! With ∂g and ∂(M w), ∂Q of a parameter (`effects.rs`), `∂a = −H⁻¹ ∂g = −X`, which the integrator
//! (`../integrator.rs`) converts to the derivative of the next state. For a function with the
//! gradients λ by the next state and ζ by the sensors, the gradient by any number of parameters
//! takes one solution with each matrix:
//!
//! ```text
//! ℓ = λ_v + h (∂⊕/∂v)ᵀ λ_q,    η = W⁻ᵀ ℓ,    μ = H⁻¹ (h (ℓ + h Qᵀ η) + (∂y/∂a)ᵀ ζ),
//! ∂θ = −μ · ∂g + h η · (∂M w + h ∂Q s) + λ_a · ∂act' + ζ · ∂y.
//! ```

mod columns;
mod effects;
mod solver;

use self::columns::{Column, Columns};
use self::effects::Point;
use super::inverse::Inverse;
use super::sensors::explicit;
use super::{Analytic, actuators, constraint, passive};
use crate::data::{Data, SensorUpdate, Stage};
use crate::derivative::InverseForce;
use crate::derivative::method::Fallback;
use crate::derivative::parameter::{Effect, Resolved};
use crate::error::Result;
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::linear_algebra::{add, add_product, solve_cholesky};

/// Derivatives by parameters, with their buffers.
#[derive(Debug)]
pub(in crate::derivative) struct Parameters {
    pub(in crate::derivative) columns: Columns,
    /// `(nv, 1)`: μ and h η, the columns that they weigh, and their products, `(n)`.
    weights: [Matrix; 2],
    weighted: Columns,
    pub(in crate::derivative) gradient: Vec<f64>,
}

/// Success, or the reason why there is no closed form.
pub(in crate::derivative) type Preparation = std::result::Result<(), Fallback>;

impl Parameters {
    pub(super) fn new(model: &Model) -> Self {
        let column = Matrix::zeros(model.nv(), 1);
        Self {
            columns: Columns::default(),
            weights: [column.clone(), column],
            weighted: Columns::default(),
            gradient: Vec::new(),
        }
    }
}

impl Analytic {
    /// Computes what the derivatives of all parameters at the present state need: the accelerations
    /// and the factor of H, the integrator, and the derivatives of the sensors by the accelerations
    /// if they are wanted. `is_linearised` is true directly after a
    /// [linearisation](Self::linearise) for this purpose, which has done all of this except for the
    /// integrator.
    pub(in crate::derivative) fn prepare_parameters(
        &mut self,
        data: &mut Data,
        resolved: &[Resolved],
        wants_sensors: bool,
        is_linearised: bool,
    ) -> Result<Preparation> {
        if !is_linearised && let Err(reason) = self.prepare_point(data, wants_sensors)? {
            return Ok(Err(reason));
        }
        let Some(kinks) = solver::examine(data, resolved) else { return Ok(Err(Fallback::Constraint)) };
        self.kinks |= kinks;
        let Self { tree, bodies, integrator, .. } = self;
        let changes_damping = resolved.iter().any(|resolved| matches!(resolved.effect, Effect::Damping(_)));
        integrator.prepare(data, tree, bodies, changes_damping)?;
        if resolved.iter().any(|resolved| matches!(resolved.effect, Effect::Inertial { .. })) {
            integrator.compute_motions(data, tree, bodies);
        }
        Ok(Ok(()))
    }

    /// Computes the accelerations and the factor of H, and the derivatives of the sensors by the
    /// accelerations if they are wanted.
    fn prepare_point(&mut self, data: &mut Data, wants_sensors: bool) -> Result<Preparation> {
        if !self.newton.solve_accelerations(data, &mut self.row)? {
            return Ok(Err(Fallback::NotConverged));
        }
        if wants_sensors {
            if let Err(reason) = self.differentiate_forces(data, None, true)? {
                return Ok(Err(reason));
            }
            self.differentiate_readings(data);
        } else {
            let jar = &self.newton.jar;
            let of_forces = actuators::kinks_of_forces(data);
            self.kinks = of_forces | passive::kinks(data) | constraint::kinks_of_state(data, jar);
        }
        Ok(Ok(()))
    }

    /// Differentiates the sensors by the accelerations, after the derivatives of the forces.
    pub(super) fn differentiate_readings(&mut self, data: &Data) {
        let Self { tree, bodies, tendons, constraints, inverse, .. } = self;
        let inverse = inverse.get_or_insert_with(|| Inverse::new(data.model()));
        inverse.differentiate(data, tree, bodies, tendons, constraints, true);
    }

    /// Computes the terms of all columns that have formulas, after the preparation.
    pub(in crate::derivative) fn differentiate_terms(
        &mut self,
        data: &Data,
        resolved: &[Resolved],
        wants_sensors: bool,
    ) {
        let Self { tree, integrator, parameters: Parameters { columns, .. }, .. } = self;
        columns.clear(data.model(), resolved.len(), wants_sensors);
        let point = Point { data, tree, integrator: Some(integrator), wants_sensors, has_actuators: true };
        add_all(point, resolved, columns);
    }

    /// Converts the terms to derivatives of the next velocities and of the sensors.
    pub(in crate::derivative) fn finish_columns(&mut self, data: &Data, wants_sensors: bool) -> &mut Columns {
        let Self { tree, integrator, parameters: Parameters { columns, .. }, newton, inverse, .. } = self;
        solve_cholesky(&newton.factor, &mut columns.residual);
        if wants_sensors {
            columns.deceleration.as_mut_slice().copy_from_slice(columns.residual.as_slice());
            let nv = data.model().nv();
            let inverse = inverse.as_ref().expect("Bug: sensors are not differentiated");
            for address in 0..data.model().nsensordata() {
                let by_acceleration = &inverse.row(address)[2 * nv..];
                for (dof, &slope) in by_acceleration.iter().enumerate() {
                    if slope != 0.0 {
                        add(columns.reading.row_mut(address), columns.deceleration.row(dof), -slope);
                    }
                }
            }
        }
        integrator.finish(data, tree, &mut columns.residual, &mut columns.spread);
        columns
    }

    /// Returns `true` if the derivative of a reading by a parameter has a formula.
    pub(in crate::derivative) fn has_reading(&self, model: &Model, effect: &Effect, sensor: usize) -> bool {
        let address = ffi::size(model.sensor_adr()[sensor]);
        let is_closed = self.inverse.as_ref().is_some_and(|inverse| inverse.in_closed_form()[address]);
        is_closed && explicit::is_covered(model, effect, sensor)
    }

    /// Returns `true` if the derivatives of all readings with a weight have formulas.
    pub(in crate::derivative) fn has_readings(&self, model: &Model, effect: &Effect, weights: &[f64]) -> bool {
        let has_weight = |sensor: usize| {
            let first = ffi::size(model.sensor_adr()[sensor]);
            weights[first..].iter().take(ffi::size(model.sensor_dim()[sensor])).any(|&weight| weight != 0.0)
        };
        weights.is_empty()
            || (0..model.nsensor()).all(|sensor| !has_weight(sensor) || self.has_reading(model, effect, sensor))
    }

    /// Writes the derivatives of the next state, `(nx, n)`.
    pub(in crate::derivative) fn write_columns(&self, model: &Model, state: &mut Matrix) {
        let Columns { residual, activation, .. } = &self.parameters.columns;
        let width = residual.ncols();
        self.integrator.write(model.raw().opt.timestep, residual, 0..width, state);
        state.as_mut_slice()[2 * model.nv() * width..].copy_from_slice(activation.as_slice());
    }

    /// Computes the derivatives of a function by the parameters that have formulas, after the
    /// preparation, from its gradients by the next state, `(nx)`, and by the sensors,
    /// `(nsensordata)` or empty.
    pub(in crate::derivative) fn differentiate_function(
        &mut self,
        data: &Data,
        resolved: &[Resolved],
        by_state: &[f64],
        by_sensors: &[f64],
    ) {
        let Self { tree, integrator, parameters, newton, inverse, .. } = self;
        let Parameters { weights, weighted: columns, gradient, .. } = parameters;
        integrator.transpose(data, tree, by_state, weights);
        let nv = data.model().nv();
        if let Some(inverse) = inverse {
            for (address, &weight) in by_sensors.iter().enumerate().filter(|&(_, &weight)| weight != 0.0) {
                add(weights[0].as_mut_slice(), &inverse.row(address)[2 * nv..], weight);
            }
        }
        solve_cholesky(&newton.factor, &mut weights[0]);
        let wants_sensors = !by_sensors.is_empty();
        columns.clear(data.model(), resolved.len(), wants_sensors);
        let point = Point { data, tree, integrator: Some(integrator), wants_sensors, has_actuators: true };
        add_all(point, resolved, columns);
        gradient.clear();
        gradient.resize(resolved.len(), 0.0);
        add_product(gradient, &columns.residual, weights[0].as_slice(), -1.0);
        add_product(gradient, &columns.spread, weights[1].as_slice(), 1.0);
        add_product(gradient, &columns.activation, &by_state[2 * nv..], 1.0);
        add_product(gradient, &columns.reading, by_sensors, 1.0);
    }

    /// Computes the derivatives of the forces of inverse dynamics at the present positions,
    /// velocities and accelerations, as far as they have formulas. Returns `None` if a constraint
    /// has none.
    pub(in crate::derivative) fn differentiate_inverse_terms(
        &mut self,
        data: &mut Data,
        resolved: &[Resolved],
        force: InverseForce,
    ) -> Result<Option<&mut Columns>> {
        let has_actuators = force == InverseForce::WithoutActuators;
        data.inverse_skip(Stage::None, SensorUpdate::Skip)?;
        data.fwd_actuation()?;
        // The forces are not valid after other actuation.
        self.newton.update_constraints(data)?;
        self.kinks = passive::kinks(data) | constraint::kinks_of_state(data, &[]);
        if has_actuators {
            self.kinks |= actuators::kinks_of_forces(data);
        }
        let Some(kinks) = solver::examine(data, resolved) else { return Ok(None) };
        self.kinks |= kinks;
        let Self { tree, parameters: Parameters { columns, .. }, .. } = self;
        columns.clear(data.model(), resolved.len(), false);
        let point = Point { data, tree, integrator: None, wants_sensors: false, has_actuators };
        add_all(point, resolved, columns);
        Ok(Some(columns))
    }
}

/// Adds the terms of all parameters that have formulas to their columns.
fn add_all(point: Point<'_>, resolved: &[Resolved], columns: &mut Columns) {
    let mut terms = None;
    for (index, resolved) in resolved.iter().enumerate() {
        effects::differentiate(point, &resolved.effect, &mut terms, &mut Column { columns, index });
    }
}
