//! Derivatives of the forces of a constraint by its parameters, at constant state and acceleration.
//!
//! The residual `jar = J a − aref` of a row with the velocity `J v` has the derivative
//!
//! ```text
//! ∂jar = ∂B J v + ∂(K I) (pos − margin) + (∂J)(a + B v).
//! ```
//!
//! The inertia D of the first row is `I/(1 − I)` times a constant, except at the engine's limit, so
//! `∂ln D = ∂I/(I (1 − I))`. In the quadratic zone `f = −D jar`, so `∂f = −D ∂jar + f ∂ln D`. With
//! the friction μ₁, μ₂, … of a contact:
//!
//! - **Pyramid:** the rows are `J₀ ± μ_k J_k`, and D of all rows is proportional to
//!   `1/(μ₁² (1 + μ₁²))`. As `2 μ_k J_k` is the difference of two rows, `(∂J)(a + B v)` and
//!   `(∂J)ᵀ f` are combinations of these two rows.
//! - **Elliptic cone, quadratic zone:** `D_k` is proportional to `(μ_k/μ₁)²`.
//! - **Elliptic cone, middle zone:** with `m = μ₁/√impratio` and `T = |(μ_k jar_k)|`,
//!
//! ```text
//! f₀ = −D (jar₀ − T)/(1 + m²),        f_k = −f₀ μ_k² jar_k/T.
//! ```

use mujoco_sys::{
    mjCNSTR_CONTACT_ELLIPTIC, mjCNSTR_CONTACT_PYRAMIDAL, mjCNSTRSTATE_CONE, mjCNSTRSTATE_QUADRATIC, mjContact, mjMINVAL,
};

use super::curve::Curve;
use super::sources::SolverParameters;
use crate::data::Data;
use crate::derivative::analytic::constraint::MAX_ROWS;
use crate::derivative::newton::{constraint_row, contacts};
use crate::ffi;

/// Derivatives of the numbers of the rows of a constraint.
struct Rows<'a> {
    data: &'a Data,
    first: usize,
    count: usize,
    /// ∂jar
    residual: [f64; MAX_ROWS],
    /// ∂ln D of a row that is not at the engine's limit.
    log_inertia: f64,
}

/// Returns the changes of the forces of the rows that have the same effect as the change of
/// `Jᵀ f`.
pub(super) fn changes(
    data: &Data,
    first: usize,
    count: usize,
    curve: &Curve,
    change: &SolverParameters,
) -> [f64; MAX_ROWS] {
    let Curve { stiffness, damping, impedance } = curve;
    let of_position = stiffness.change * impedance.value + stiffness.value * impedance.change;
    let mut rows = Rows {
        data,
        first,
        count,
        residual: [0.0; MAX_ROWS],
        log_inertia: impedance.change / (impedance.value * (1.0 - impedance.value)),
    };
    for (row, residual) in (first..first + count).zip(&mut rows.residual) {
        let beyond = data.efc_pos()[row] - data.efc_margin()[row];
        *residual = damping.change * data.efc_vel()[row] + of_position * beyond;
    }
    let contact = || &contacts(data)[ffi::size(data.efc_id()[first])];
    #[expect(non_upper_case_globals, reason = "the engine's constants")]
    match data.efc_type()[first] as u32 {
        mjCNSTR_CONTACT_PYRAMIDAL => rows.of_pyramid(contact(), &change.friction),
        mjCNSTR_CONTACT_ELLIPTIC if rows.state(0) == mjCNSTRSTATE_CONE => rows.of_cone(contact(), &change.friction),
        mjCNSTR_CONTACT_ELLIPTIC => rows.of_ellipse(contact(), &change.friction),
        _ => rows.quadratic(|row| rows.log_inertia_at(data.efc_R()[first + row])),
    }
}

impl Rows<'_> {
    fn state(&self, row: usize) -> u32 {
        self.data.efc_state()[self.first + row] as u32
    }

    fn force(&self, row: usize) -> f64 {
        self.data.efc_force()[self.first + row]
    }

    /// Returns jar of a row.
    fn jar(&self, row: usize) -> f64 {
        let (row, qacc) = (self.first + row, self.data.qacc());
        let acceleration: f64 = constraint_row(self.data, row).iter().map(|(dof, moment)| moment * qacc[dof]).sum();
        acceleration - self.data.efc_aref()[row]
    }

    /// Returns `∂ln D` of a row with a regularisation, which is constant at the engine's limit.
    fn log_inertia_at(&self, regularisation: f64) -> f64 {
        if regularisation > mjMINVAL { self.log_inertia } else { 0.0 }
    }

    /// Returns the changes of the forces of the rows in the quadratic zone, for their `∂ln D`.
    fn quadratic(&self, log_inertia: impl Fn(usize) -> f64) -> [f64; MAX_ROWS] {
        let mut forces = [0.0; MAX_ROWS];
        for (row, force) in forces.iter_mut().enumerate().take(self.count) {
            if self.state(row) == mjCNSTRSTATE_QUADRATIC {
                let inertia = self.data.efc_D()[self.first + row];
                *force = -inertia * self.residual[row] + self.force(row) * log_inertia(row);
            }
        }
        forces
    }

    fn of_pyramid(mut self, contact: &mjContact, change: &[f64; 5]) -> [f64; MAX_ROWS] {
        let (friction, rate) = (contact.friction[0], change[0] / contact.friction[0]);
        let normal = self.data.efc_R()[self.first] / (2.0 * contact.mu * contact.mu);
        let mut log_inertia = self.log_inertia_at(normal) - 2.0 * rate;
        if normal > mjMINVAL {
            log_inertia -= 2.0 * friction * change[0] / (1.0 + friction * friction);
        }
        let mut turned = [0.0; MAX_ROWS];
        for edge in (0..self.count / 2).filter(|&edge| change[edge] != 0.0) {
            let (row, factor) = (2 * edge, 0.5 * change[edge] / contact.friction[edge]);
            let tangential = factor * (self.jar(row) - self.jar(row + 1));
            self.residual[row] += tangential;
            self.residual[row + 1] -= tangential;
            turned[row] = factor * (self.force(row) - self.force(row + 1));
            turned[row + 1] = -turned[row];
        }
        let mut forces = self.quadratic(|_| log_inertia);
        forces.iter_mut().zip(turned).for_each(|(force, turned)| *force += turned);
        forces
    }

    fn of_ellipse(&self, contact: &mjContact, change: &[f64; 5]) -> [f64; MAX_ROWS] {
        let normal = self.log_inertia_at(self.data.efc_R()[self.first]);
        let rate = |at: usize| change[at] / contact.friction[at];
        self.quadratic(|row| if row == 0 { normal } else { normal + 2.0 * (rate(row - 1) - rate(0)) })
    }

    fn of_cone(&self, contact: &mjContact, change: &[f64; 5]) -> [f64; MAX_ROWS] {
        let (friction, mu) = (&contact.friction, contact.mu);
        let jar: [f64; MAX_ROWS] = std::array::from_fn(|row| if row < self.count { self.jar(row) } else { 0.0 });
        let scaled = |row: usize| friction[row - 1] * jar[row];
        let scaled_change = |row: usize| change[row - 1] * jar[row] + friction[row - 1] * self.residual[row];
        let tangent = (1..self.count).map(|row| scaled(row).powi(2)).sum::<f64>().sqrt();
        let tangent_change = (1..self.count).map(|row| scaled(row) * scaled_change(row)).sum::<f64>() / tangent;

        let normal = self.force(0);
        let log_factor = self.log_inertia_at(self.data.efc_R()[self.first])
            - 2.0 * mu * mu * change[0] / (friction[0] * (1.0 + mu * mu));
        let slope = self.data.efc_D()[self.first] / (1.0 + mu * mu);
        let mut forces = [0.0; MAX_ROWS];
        forces[0] = normal * log_factor - slope * (self.residual[0] - tangent_change);
        for row in 1..self.count {
            // The force is −normal · ratio.
            let ratio = friction[row - 1] * scaled(row) / tangent;
            let ratio_change = (change[row - 1] * scaled(row) + friction[row - 1] * scaled_change(row)
                - ratio * tangent_change)
                / tangent;
            forces[row] = -forces[0] * ratio - normal * ratio_change;
        }
        forces
    }
}
