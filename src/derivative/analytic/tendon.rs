//! Curvature of spatial tendons: derivatives of their moment arms.
//!
//! A spatial tendon is a path of straight segments between sites. A segment from p₁ to p₂ with the
//! length l, the unit vector n, and the divisor d of a pulley contributes `J = nᵀ (Jp₂ − Jp₁)/d`: a
//! unit tension has the same generalised force as the force `φ = n/d` on the second body at p₂ and
//! −φ on the first at p₁. As for a contact, degree of freedom j changes the force vectors by
//!
//! ```text
//! ∂(r × φ, φ) = (∂p × φ + r × ∂φ, ∂φ),      ∂φ = (1 − n nᵀ) (∂p₂ − ∂p₁)/(l d),
//! ```
//!
//! which gives `K = ∂J/∂q`, `(nv, nv)`. A tension T adds `K T` to the derivatives of the
//! generalised forces. Velocities w have the derivative `(∂J) w = Kᵀ w`. The moment arms of a fixed
//! tendon are constant.
//!
//! Paths around spheres and cylinders have no formula here while they touch them.

use mujoco_sys::{mjCNSTR_FRICTION_TENDON, mjCNSTR_LIMIT_TENDON};

use super::constraint::Chains;
use super::tree::Tree;
use crate::data::Data;
use crate::derivative::newton::add_row;
use crate::enums::{EqualityType, TransmissionType, WrapType};
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::{add, add_product};
use crate::numerics::spatial::{Spatial, Vec3, add_scaled, cross, dot, scale, sub, velocity_at, wrench};

/// Smallest length of a segment whose direction is differentiable, m.
const MIN_LENGTH: f64 = 1e-9;

/// Derivatives of the moment arms of spatial tendons, with their buffers.
#[derive(Debug)]
pub(super) struct Tendons {
    chains: Chains,
    /// `(nv, nv)`: K of one tendon.
    curvature: Matrix,
    /// `(nv)`: J of one tendon, and a row of the Jacobian of constraints.
    row: Vec<f64>,
    constraint: Vec<f64>,
    /// `(ntendon, nv)`: `Kᵀ q̇` and `Kᵀ q̈`. Zero for fixed tendons.
    velocity: Matrix,
    acceleration: Matrix,
}

impl Tendons {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        let rates = Matrix::zeros(model.ntendon(), nv);
        Self {
            chains: Chains::new(nv),
            curvature: Matrix::zeros(nv, nv),
            row: vec![0.0; nv],
            constraint: vec![0.0; nv],
            velocity: rates.clone(),
            acceleration: rates,
        }
    }

    /// Returns the derivative of the velocity of a tendon by the position, `(nv)`.
    pub(super) fn velocity_change(&self, tendon: usize) -> &[f64] {
        self.velocity.row(tendon)
    }

    /// Returns the derivative of `J q̈` of a tendon by the position, `(nv)`.
    pub(super) fn acceleration_change(&self, tendon: usize) -> &[f64] {
        self.acceleration.row(tendon)
    }

    /// Computes the derivatives of the moment arms. Subtracts the derivatives of the forces of all
    /// tensions, at constant tension, from the derivatives of the residual. The tensions of
    /// actuators count if the residual contains them. Returns `false` if a tendon has no formula.
    pub(super) fn differentiate(
        &mut self,
        data: &Data,
        tree: &Tree,
        has_actuators: bool,
        residual: &mut Matrix,
    ) -> bool {
        let model = data.model();
        let nv = model.nv();
        for tendon in (0..model.ntendon()).filter(|&tendon| !is_fixed(model, tendon)) {
            self.curvature.as_mut_slice().fill(0.0);
            if !self.add_path(data, tree, tendon) {
                return false;
            }
            let Some(tension) = self.tension(data, tendon, has_actuators) else { return false };
            for (rates, values) in [(&mut self.velocity, data.qvel()), (&mut self.acceleration, data.qacc())] {
                rates.row_mut(tendon).fill(0.0);
                add_product(rates.row_mut(tendon), &self.curvature, values, 1.0);
            }
            if tension != 0.0 {
                for dof in 0..nv {
                    add(&mut residual.row_mut(dof)[..nv], self.curvature.row(dof), -tension);
                }
            }
        }
        true
    }

    /// Adds the segments of a tendon to K. Returns `false` if one has no formula.
    fn add_path(&mut self, data: &Data, tree: &Tree, tendon: usize) -> bool {
        let model = data.model();
        let wraps = ffi::size(data.ten_wrapadr()[tendon]);
        let points = data.wrap_obj().as_flattened().iter().skip(wraps).take(ffi::size(data.ten_wrapnum()[tendon]));
        if points.into_iter().any(|&geom| geom >= 0) {
            return false;
        }
        let first = ffi::size(model.tendon_adr()[tendon]);
        let (mut previous, mut divisor) = (None, 1.0);
        for at in first..first + ffi::size(model.tendon_num()[tendon]) {
            match WrapType::from_raw(model.wrap_type()[at]) {
                Some(WrapType::Site) => {
                    let site = ffi::size(model.wrap_objid()[at]);
                    if let Some(previous) = previous.replace(site)
                        && !self.add_segment(data, tree, [previous, site], divisor)
                    {
                        return false;
                    }
                }
                Some(WrapType::Pulley) => (previous, divisor) = (None, model.wrap_prm()[at]),
                // The path does not touch the geom.
                _ => {}
            }
        }
        true
    }

    fn add_segment(&mut self, data: &Data, tree: &Tree, sites: [usize; 2], divisor: f64) -> bool {
        let model = data.model();
        let bodies = sites.map(|site| ffi::size(model.site_bodyid()[site]));
        if bodies[0] == bodies[1] {
            return true;
        }
        let points = sites.map(|site| data.site_xpos()[site]);
        let line = sub(&points[1], &points[0]);
        let length = dot(&line, &line).sqrt();
        if length < MIN_LENGTH {
            return false;
        }
        let direction = scale(&line, 1.0 / length);
        let force = scale(&direction, 1.0 / divisor);
        let arms: [Vec3; 2] = std::array::from_fn(|side| {
            sub(&points[side], &data.subtree_com()[ffi::size(model.body_rootid()[bodies[side]])])
        });
        let wrenches = arms.map(|arm| wrench(&[0.0; 3], &force, &arm));
        self.chains.set(tree, data.cdof(), bodies, |_| 0.0);
        for moving in &self.chains.dofs {
            let shifts: [Vec3; 2] =
                std::array::from_fn(
                    |side| {
                        if moving.moves[side] { velocity_at(&moving.axis, &arms[side]) } else { [0.0; 3] }
                    },
                );
            let mut turned = sub(&shifts[1], &shifts[0]);
            let along = dot(&direction, &turned);
            add_scaled(&mut turned, &direction, -along);
            let force_change = scale(&turned, 1.0 / (length * divisor));
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                let change: Spatial = wrench(&cross(&shifts[side], &force), &force_change, &arms[side]);
                // `subtract_force` subtracts, hence the opposite sign.
                let forces = (&wrenches[side], &change);
                self.chains.subtract_force(tree, moving, side, -sign, forces, &mut self.curvature);
            }
        }
        true
    }

    /// Returns the sum of all tensions of a tendon: of its spring and damper, its actuators as
    /// requested, and its constraints. Returns `None` for an equality constraint, which has no
    /// formula.
    fn tension(&mut self, data: &Data, tendon: usize, has_actuators: bool) -> Option<f64> {
        let model = data.model();
        let mut tension = 0.0;
        if model.raw().opt.disableflags as u32 & DisableFlags::PASSIVE.bits() == 0 {
            tension -= model.tendon_stiffness()[tendon] * stretch(data, tendon);
            tension -= model.tendon_damping()[tendon] * data.ten_velocity()[tendon];
        }
        for (actuator, &force) in data.actuator_force().iter().enumerate() {
            if has_actuators && tendon_of(model, actuator) == Some(tendon) {
                tension += model.actuator_gear()[actuator][0] * force;
            }
        }
        for equality in 0..model.neq() {
            let objects = [model.eq_obj1id()[equality], model.eq_obj2id()[equality]];
            let is_tendon = EqualityType::from_raw(model.eq_type()[equality]) == Some(EqualityType::Tendon);
            if is_tendon && data.is_equality_enforced(equality) && objects.contains(&(tendon as i32)) {
                return None;
            }
        }
        for row in 0..data.nefc() {
            let is_tendon = [mjCNSTR_LIMIT_TENDON, mjCNSTR_FRICTION_TENDON].contains(&(data.efc_type()[row] as u32));
            if is_tendon && ffi::size(data.efc_id()[row]) == tendon {
                tension += self.sign(data, tendon, row) * data.efc_force()[row];
            }
        }
        Some(tension)
    }

    /// Returns the sign of the moment arms of a tendon in the Jacobian of a constraint: −1 for an
    /// upper limit.
    pub(super) fn sign(&mut self, data: &Data, tendon: usize, row: usize) -> f64 {
        data.tendon_row(tendon).write_into(&mut self.row);
        self.constraint.fill(0.0);
        add_row(data, row, 1.0, &mut self.constraint);
        let product: f64 = self.row.iter().zip(&self.constraint).map(|(row, constraint)| row * constraint).sum();
        if product < 0.0 { -1.0 } else { 1.0 }
    }
}

/// Returns `true` if the length of a tendon is a linear function of joint positions.
pub(super) fn is_fixed(model: &Model, tendon: usize) -> bool {
    let first = ffi::size(model.tendon_adr()[tendon]);
    model.wrap_type().get(first).copied().and_then(WrapType::from_raw) == Some(WrapType::Joint)
}

/// Returns the distance of a tendon's length from the range in which its spring is at rest.
pub(super) fn stretch(data: &Data, tendon: usize) -> f64 {
    let (length, [low, high]) = (data.ten_length()[tendon], data.model().tendon_rest_length(tendon));
    length - length.max(low).min(high)
}

/// Returns the tendon on which an actuator acts, if it acts on one.
pub(super) fn tendon_of(model: &Model, actuator: usize) -> Option<usize> {
    let is_tendon = model.actuator_trntype()[actuator] == TransmissionType::Tendon.raw();
    is_tendon.then(|| ffi::size(model.actuator_trnid()[actuator][0]))
}
