//! Residuals of the centre of mass of a subtree, of its velocity, and of the angular momentum.
//!
//! Degree of freedom j moves a part of the subtree: all of it, or the bodies below j. Let I be the
//! inertia of this part, and h its momentum, about the reference point of the tree. With the axis
//! S_j, the change ψ_j of velocities, the mass m, the centre of mass c and the linear momentum p of
//! the whole subtree,
//!
//! ```text
//! ∂h/∂q_j = S_j ×* h + I ψ_j,      ∂h/∂v_j = I S_j,      ∂c/∂q_j = (I S_j)_linear/m
//! ```
//!
//! The velocity is h_linear/m. The angular momentum about c is `h_angular − r × h_linear`, with r
//! from the reference point to c, and changes also by `−∂c × p`. (D. Orin, A. Goswami and S.-H.
//! Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 2013.)

use super::{Needs, Residual, ResidualJacobian, subtract};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, IntoId};
use crate::kind;
use crate::model::Model;
use crate::numerics::spatial::{Vec3, add, angular, cross, cross_force, linear, momentum, scale, sub};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    Com,
    Velocity,
    AngularMomentum,
}

/// Centre of mass of a body and all bodies below it, the velocity of the centre of mass, or the
/// angular momentum about it. Three components, minus a target, world frame.
///
/// ```
/// use mujoco_safe::control::ilqr::TrajectoryCost;
/// use mujoco_safe::control::residual::{ResidualCost, Subtree, Term};
/// use mujoco_safe::sample;
///
/// // Penalise the height of the centre of mass alone, relative to 0.9 m.
/// let model = std::sync::Arc::new(sample::humanoid());
/// let com = Subtree::com(&model, "torso")?.with_target([0.0, 0.0, 0.9]);
/// let cost = ResidualCost::new(&model, [Term::new("height", com).with_scales([0.0, 0.0, 1.0])])?;
/// let state = [model.qpos0(), &vec![0.0; model.nv()]].concat();
/// assert!(cost.value(0, &state, None)? < 0.1);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Subtree {
    quantity: Quantity,
    body: BodyId,
    target: [f64; 3],
    /// Degrees of freedom that move the subtree, each with the root of the part that it moves.
    dofs: Vec<(usize, usize)>,
}

impl Subtree {
    /// Creates the residual of the centre of mass, m. The target is the origin of the world.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown body, [`Error::Invalid`] for
    /// a subtree without mass.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn com(model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        Self::new(Quantity::Com, model, body)
    }

    /// Creates the residual of the velocity of the centre of mass, m/s. The target is zero.
    ///
    /// # Errors
    ///
    /// As for [`com`](Self::com).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn velocity(model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        Self::new(Quantity::Velocity, model, body)
    }

    /// Creates the residual of the angular momentum about the centre of mass, kg·m²/s. The target
    /// is zero.
    ///
    /// # Errors
    ///
    /// As for [`com`](Self::com).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn angular_momentum(model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        Self::new(Quantity::AngularMomentum, model, body)
    }

    fn new(quantity: Quantity, model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        let body = body.id_in(model)?;
        let mass = model.body_subtreemass()[body.index()];
        // The engine has other formulas for a subtree without mass.
        if mass < mujoco_sys::mjMINVAL {
            return Err(Error::out_of_range(format!("the mass of the subtree of {body}"), mass, "above zero"));
        }
        Ok(Self { quantity, body, target: [0.0; 3], dofs: moving_dofs(model, body.index()) })
    }

    /// Sets the target, in the unit of the quantity, world frame.
    #[must_use]
    pub fn with_target(mut self, target: [f64; 3]) -> Self {
        self.target = target;
        self
    }
}

/// Returns the degrees of freedom that move a subtree, each with the root of the part of the
/// subtree that it moves.
fn moving_dofs(model: &Model, root: usize) -> Vec<(usize, usize)> {
    let parents = model.body_parentid();
    // Parents have smaller indices.
    let is_below = |mut body: usize, root: usize| {
        while body > root {
            body = ffi::size(parents[body]);
        }
        body == root
    };
    let parts = model.dof_bodyid().iter().enumerate().filter_map(|(dof, &body)| {
        let body = ffi::size(body);
        let part = if is_below(body, root) { Some(body) } else { is_below(root, body).then_some(root) };
        part.map(|part| (dof, part))
    });
    parts.collect()
}

impl Residual for Subtree {
    fn size(&self) -> usize {
        3
    }

    fn needs(&self) -> Needs {
        if self.quantity == Quantity::Com { Needs::Poses } else { Needs::Velocities }
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        let body = data.body(self.body);
        let value = match self.quantity {
            Quantity::Com => body.subtree_com(),
            Quantity::Velocity => body.subtree_linvel()?,
            Quantity::AngularMomentum => body.subtree_angmom()?,
        };
        subtract(value, &self.target, residual);
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        if self.quantity == Quantity::Com {
            data.jac_subtree_com_into(self.body, &mut jacobian.linear)?;
            jacobian.copy_linear();
            return Ok(());
        }
        jacobian.momenta.compute(data);
        let (model, body) = (data.model(), data.body(self.body).index());
        let inverse_mass = 1.0 / model.body_subtreemass()[body];
        let nv = model.nv();
        for &(dof, part) in &self.dofs {
            let (axis, momenta) = (&data.cdof()[dof], &jacobian.momenta);
            let by_velocity = momentum(&momenta.inertias[part], axis);
            let change = momentum(&momenta.inertias[part], &momenta.changes[dof]);
            let by_position = add(&cross_force(axis, &momenta.sums[part]), &change);
            let [by_position, by_velocity]: [Vec3; 2] = if self.quantity == Quantity::Velocity {
                [&by_position, &by_velocity].map(|change| scale(&linear(change), inverse_mass))
            } else {
                let root = ffi::size(model.body_rootid()[part]);
                let arm = sub(&data.subtree_com()[body], &data.subtree_com()[root]);
                let about_centre = |change| sub(&angular(change), &cross(&arm, &linear(change)));
                let shift = scale(&linear(&by_velocity), inverse_mass);
                let carried = cross(&shift, &linear(&momenta.sums[body]));
                [sub(&about_centre(&by_position), &carried), about_centre(&by_velocity)]
            };
            for component in 0..3 {
                let row = jacobian.by_state_mut(component);
                row[dof] = by_position[component];
                row[nv + dof] = by_velocity[component];
            }
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
