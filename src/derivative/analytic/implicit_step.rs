//! The matrices Q and W of the implicit integrator (`integrator.rs`), and the derivatives of `Q s`.
//!
//! Q consists of damping, of the velocity gains of actuators, which may depend on controls and
//! activations, and of −∂c/∂v for the Coriolis and centrifugal forces c. These are quadratic in v,
//! c(v) = b(v, v) with a symmetric b, so `(∂c/∂v) s = 2 b(v, s)`, and its derivatives follow from
//! the derivatives of inverse dynamics (`rigid_body.rs`) without accelerations and gravity, at
//! other velocities:
//!
//! ```text
//! ∂q (∂c/∂v s) = ∂q c(v + s) − ∂q c(v) − ∂q c(s),        ∂v (∂c/∂v s) = (∂c/∂v)(s).
//! ```
//!
//! The engine omits entries of Q for two degrees of freedom of which neither moves the other. In
//! 2.2.2 it takes neither limits of controls nor limits of forces into account, since 3.5 the
//! latter, and in 3.17 both.

use std::ops::Range;

use super::actuators::site_of;
use super::actuators::velocity_gain;
use super::rigid_body::RigidBodies;
use super::tendon::{is_fixed, tendon_of};
use super::tree::Tree;
use crate::data::Data;
use crate::enums::{ActuatorGain, Integrator};
use crate::error::Result;
use crate::layout::Row;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::{add, dot, factor_lu, solve_lu};

/// Matrices of the integrator, with its buffers.
#[derive(Debug)]
pub(super) struct ImplicitStep {
    /// `(nv, nv)`: Q, and the LU factors of W.
    pub(super) forces: Matrix,
    pub(super) factor: Matrix,
    /// `(nv, 2 nv)`: derivatives of inverse dynamics.
    bias: Matrix,
}

/// Returns `true` if the model uses the integrator.
pub(super) fn is_used(model: &Model) -> bool {
    Integrator::of_field(model.raw().opt.integrator) == Integrator::Implicit
}

/// Returns the damping of a tendon in Q. 2.2.2 does not have a negative one there.
pub(super) fn tendon_damping(model: &Model, tendon: usize) -> f64 {
    let damping = model.tendon_damping()[tendon];
    if cfg!(engine_since = "3.5.0") { damping } else { damping.max(0.0) }
}

/// Returns `true` if the model uses a similar integrator of newer engines, or uses this one and Q
/// depends on the state by terms without a formula: forces of a medium, muscles, spatial tendons,
/// and actuators on sites.
pub(in crate::derivative) fn is_obstacle(model: &Model) -> bool {
    let integrator = Integrator::of_field(model.raw().opt.integrator);
    if matches!(integrator, Integrator::ImplicitFast | Integrator::Discrete) {
        return true;
    }
    let is_spatial = |tendon: usize| !is_fixed(model, tendon);
    let has_muscle = model.actuator_gaintype().contains(&ActuatorGain::Muscle.raw());
    let options = &model.raw().opt;
    let has_terms = options.density > 0.0
        || options.viscosity > 0.0
        || has_muscle
        || (0..model.ntendon()).any(|tendon| is_spatial(tendon) && tendon_damping(model, tendon) != 0.0)
        || (0..model.nactuator())
            .any(|actuator| tendon_of(model, actuator).is_some_and(is_spatial) || site_of(model, actuator).is_some());
    is_used(model) && has_terms
}

impl ImplicitStep {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        let square = Matrix::zeros(nv, nv);
        Self { forces: square.clone(), factor: square, bias: Matrix::zeros(nv, 2 * nv) }
    }

    /// Computes Q, the factors of W, and w, `(nv, 1)`. `zeros` has nv of them.
    pub(super) fn prepare(
        &mut self,
        data: &Data,
        tree: &Tree,
        bodies: &mut RigidBodies,
        zeros: &[f64],
        spread: &mut Matrix,
    ) -> Result<()> {
        let h = data.model().raw().opt.timestep;
        self.bias.as_mut_slice().fill(0.0);
        bodies.differentiate(data, tree, [0.0; 3], (data.qvel(), zeros), &mut self.bias);
        self.assemble(data, tree);
        data.full_m_into(&mut self.factor)?;
        add(self.factor.as_mut_slice(), self.forces.as_slice(), -h);
        factor_lu(&mut self.factor);
        for (spread, forces) in spread.as_mut_slice().iter_mut().zip(self.forces.rows()) {
            *spread = -h * dot(forces, data.qacc());
        }
        solve_lu(&self.factor, spread);
        Ok(())
    }

    /// Adds the derivatives of `h Q s` by positions, velocities, activations and controls, after
    /// the preparation, for the vectors v + s, s, and zeros.
    pub(super) fn add_changes(
        &mut self,
        data: &Data,
        tree: &Tree,
        bodies: &mut RigidBodies,
        [velocity, acceleration, zeros]: [&[f64]; 3],
        sum: &mut Matrix,
    ) {
        let nv = data.model().nv();
        let h = data.model().raw().opt.timestep;
        let bias = &mut self.bias;
        let mut add_bias = |bias: &Matrix, factor: f64, columns: Range<usize>| {
            for dof in 0..nv {
                add(&mut sum.row_mut(dof)[columns.clone()], &bias.row(dof)[columns.clone()], factor);
            }
        };
        // The derivatives at the present velocity are in `bias`.
        add_bias(bias, h, 0..nv);
        for (velocity, factor) in [(velocity, -h), (acceleration, h)] {
            bias.as_mut_slice().fill(0.0);
            bodies.differentiate(data, tree, [0.0; 3], (velocity, zeros), bias);
            add_bias(bias, factor, 0..nv);
        }
        add_bias(bias, -h, nv..2 * nv);
        add_gains(data, tree, acceleration, sum);
    }

    /// Assembles Q from the derivatives of the bias forces.
    fn assemble(&mut self, data: &Data, tree: &Tree) {
        let model = data.model();
        let nv = model.nv();
        let has_passive = model.raw().opt.disableflags as u32 & DisableFlags::PASSIVE.bits() == 0;
        for dof in 0..nv {
            let row = self.forces.row_mut(dof);
            row.iter_mut().zip(&self.bias.row(dof)[nv..]).for_each(|(force, bias)| *force = -bias);
            if has_passive {
                row[dof] -= model.dof_damping()[dof];
            }
        }
        let mut add_product = |row: Row<'_>, slope: f64| {
            if slope != 0.0 {
                for_each_product(tree, row, |dof, other, product| self.forces[(dof, other)] += slope * product);
            }
        };
        if has_passive {
            (0..model.ntendon())
                .for_each(|tendon| add_product(data.tendon_row(tendon), -tendon_damping(model, tendon)));
        }
        for actuator in 0..model.nactuator() {
            add_product(data.moment_row(actuator), velocity_gain(data, actuator).total);
        }
    }
}

/// Calls a function for the entries of `row rowᵀ` for which one degree of freedom moves the other.
pub(super) fn for_each_product(tree: &Tree, row: Row<'_>, mut call: impl FnMut(usize, usize, f64)) {
    for (dof, arm) in row.iter().filter(|&(_, arm)| arm != 0.0) {
        call(dof, dof, arm * arm);
        for above in tree.chain(tree.parent[dof]) {
            if let Some((_, other)) = row.iter().find(|&(other, _)| other == above) {
                call(dof, above, arm * other);
                call(above, dof, arm * other);
            }
        }
    }
}

/// Adds the derivatives of `h Q s` by activations and controls, on which velocity gains depend.
fn add_gains(data: &Data, tree: &Tree, acceleration: &[f64], sum: &mut Matrix) {
    let model = data.model();
    let (nv, na, h) = (model.nv(), model.na(), model.raw().opt.timestep);
    for actuator in 0..model.nactuator() {
        let by_input = velocity_gain(data, actuator).by_input;
        if by_input == 0.0 {
            continue;
        }
        let column = match model.activation_of(actuator) {
            Some(activation) => 2 * nv + activation,
            None => 2 * nv + na + actuator,
        };
        for_each_product(tree, data.moment_row(actuator), |dof, other, product| {
            sum[(dof, column)] += h * by_input * product * acceleration[other];
        });
    }
}
