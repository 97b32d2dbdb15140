//! Derivatives of inverse dynamics in closed form.
//!
//! The forces of inverse dynamics are
//!
//! ```text
//! f = M a + c − passive − Jᵀ f(J a − aref)    [− actuator],
//! ```
//!
//! the residual of the equations of motion (`mod.rs`) without applied forces. Here q, v and a are
//! independent, and the constraint forces are explicit functions of them, so no system of equations
//! is solved: `∂f/∂q` and `∂f/∂v` are sums of the same terms, and `∂f/∂a = M + Jᵀ 𝒦 J` is the
//! matrix H of `newton.rs`. Sensors have the derivatives of `sensors/` with a as a third input.

use super::constraint::Constraints;
use super::inertia;
use super::rigid_body::RigidBodies;
use super::sensors::{Point, Sensors};
use super::tendon::Tendons;
use super::tree::Tree;
use super::{Analytic, Fallback, Outcome};
use crate::data::{Data, SensorUpdate, Stage};
use crate::derivative::{InverseForce, InverseOutputs};
use crate::error::Result;
use crate::matrix::Matrix;
use crate::model::Model;

/// Buffers for the derivatives of inverse dynamics.
#[derive(Debug)]
pub(super) struct Inverse {
    /// Derivatives by positions, velocities and accelerations.
    sensors: Sensors,
    /// `(nv, 3 nv)`: minus the derivatives of the accelerations by these inputs.
    deceleration: Matrix,
}

impl Inverse {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        let mut deceleration = Matrix::zeros(nv, 3 * nv);
        (0..nv).for_each(|dof| deceleration[(dof, 2 * nv + dof)] = -1.0);
        Self { sensors: Sensors::new(model, 3 * nv), deceleration }
    }

    /// Differentiates the sensors by positions, velocities and accelerations, after the derivatives
    /// of the forces were computed: all of them, or only those that depend on accelerations, while
    /// the rows of the others are zero.
    pub(super) fn differentiate(
        &mut self,
        data: &Data,
        tree: &Tree,
        bodies: &RigidBodies,
        tendons: &Tendons,
        constraints: &Constraints,
        only_by_accelerations: bool,
    ) {
        let point = Point {
            data,
            tree,
            bodies,
            tendons,
            forces: &constraints.force_sensors,
            interactions: &constraints.interactions,
            deceleration: &self.deceleration,
            has_actuators: false,
        };
        self.sensors.differentiate(point, only_by_accelerations);
    }

    /// Returns the derivatives of a reading by positions, velocities and accelerations.
    pub(super) fn row(&self, address: usize) -> &[f64] {
        self.sensors.row(address)
    }

    /// Returns the flags of the readings in closed form, `(nsensordata)`.
    pub(super) fn in_closed_form(&self) -> &[bool] {
        self.sensors.in_closed_form()
    }
}

impl Analytic {
    /// Differentiates inverse dynamics at the present positions, velocities and accelerations, and
    /// the sensors that have a formula, if they are wanted.
    pub(in crate::derivative) fn differentiate_inverse(
        &mut self,
        data: &mut Data,
        force: InverseForce,
        wants_sensors: bool,
    ) -> Result<Outcome> {
        data.inverse_skip(Stage::None, SensorUpdate::Skip)?;
        if force == InverseForce::WithoutActuators {
            data.fwd_actuation()?;
        }
        self.newton.hessian(data)?;
        let differenced = match self.differentiate_forces(data, Some(force), wants_sensors)? {
            Ok(differenced) => differenced,
            Err(reason) => return Ok(Err(reason)),
        };
        let Self { tree, bodies, tendons, constraints, inverse, derivative, .. } = self;
        if !derivative.as_slice().iter().all(|value| value.is_finite()) {
            return Ok(Err(Fallback::Singular));
        }
        if wants_sensors {
            let inverse = inverse.get_or_insert_with(|| Inverse::new(data.model()));
            inverse.differentiate(data, tree, bodies, tendons, constraints, false);
        }
        Ok(Ok(differenced))
    }

    /// Returns `true` if the last call of [`differentiate_inverse`](Self::differentiate_inverse)
    /// has differentiated all sensors.
    pub(in crate::derivative) fn has_all_inverse_sensors(&self) -> bool {
        self.inverse.as_ref().is_some_and(|inverse| inverse.sensors.in_closed_form().iter().all(|&closed| closed))
    }

    /// Writes the derivatives that [`differentiate_inverse`](Self::differentiate_inverse) has
    /// computed, except for sensors without a formula.
    pub(in crate::derivative) fn write_inverse(&self, data: &Data, outputs: &mut InverseOutputs<'_>) {
        let nv = data.model().nv();
        let InverseOutputs { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq } = outputs;
        for (output, first) in [(df_dq, 0), (df_dv, nv)] {
            if let Some(output) = output {
                for dof in 0..nv {
                    let values = &self.derivative.row(dof)[first..first + nv];
                    values.iter().enumerate().for_each(|(input, value)| output[(input, dof)] = *value);
                }
            }
        }
        if let Some(df_da) = df_da {
            for row in 0..nv {
                for column in 0..=row {
                    let value = self.newton.factor[(row, column)];
                    (df_da[(row, column)], df_da[(column, row)]) = (value, value);
                }
            }
        }
        if let Some(inverse) = &self.inverse {
            for (output, first) in [(ds_dq, 0), (ds_dv, nv), (ds_da, 2 * nv)] {
                if let Some(output) = output {
                    inverse.sensors.write_transposed(first..first + nv, output);
                }
            }
        }
        if let Some(dm_dq) = dm_dq {
            inertia::differentiate(data, &self.tree, &self.bodies, dm_dq);
        }
    }
}
