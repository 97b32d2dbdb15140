//! Derivatives of the forces of a constraint by its parameters, at constant state and acceleration.
//!
//! The residual `jar = J a − aref` of a row with the velocity `J v` has the derivative
//!
//! ```text
//! ∂jar = ∂B J v + ∂(K I) (pos − margin) + (∂J)(a + B v).
//! ```
//!
//! The inertia D of the first row is `I/(1 − I)` times a constant, except at the engine's limit. In
//! the quadratic zone `f = −D jar`. With the friction μ₁, μ₂, … of a contact:
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

use std::array;

use mujoco_sys::{
    mjCNSTR_CONTACT_ELLIPTIC, mjCNSTR_CONTACT_PYRAMIDAL, mjCNSTRSTATE_CONE, mjCNSTRSTATE_QUADRATIC, mjMINVAL,
};

use super::curve::Curve;
use super::dual::Dual;
use super::sources::SolverParameters;
use crate::data::Data;
use crate::derivative::analytic::constraint::MAX_ROWS;
use crate::derivative::newton::{constraint_row, contacts};
use crate::ffi;

/// Numbers of the rows of a constraint.
struct Rows<'a> {
    data: &'a Data,
    first: usize,
    count: usize,
    friction: [Dual; 5],
    jar: [Dual; MAX_ROWS],
    /// `I/(1 − I)`
    odds: Dual,
}

/// Returns the changes of the forces of the rows that have the same effect as the change of
/// `Jᵀ f`.
pub(super) fn changes(
    data: &Data,
    first: usize,
    count: usize,
    curve: &Curve,
    parameters: &SolverParameters,
) -> [f64; MAX_ROWS] {
    let Curve { stiffness, damping, impedance } = *curve;
    let jar = array::from_fn(|row| {
        if row >= count {
            return Dual::default();
        }
        let row = first + row;
        let reference =
            data.efc_vel()[row] * damping + (data.efc_pos()[row] - data.efc_margin()[row]) * (stiffness * impedance);
        let acceleration: f64 = constraint_row(data, row).iter().map(|(dof, arm)| arm * data.qacc()[dof]).sum();
        Dual { value: acceleration - data.efc_aref()[row], change: reference.change }
    });
    let odds = impedance / (Dual::constant(1.0) - impedance);
    let mut rows = Rows { data, first, count, friction: parameters.friction, jar, odds };
    #[expect(non_upper_case_globals, reason = "the engine's constants")]
    match data.efc_type()[first] as u32 {
        mjCNSTR_CONTACT_PYRAMIDAL => rows.of_pyramid(),
        mjCNSTR_CONTACT_ELLIPTIC if rows.state(0) == mjCNSTRSTATE_CONE => rows.of_cone(),
        mjCNSTR_CONTACT_ELLIPTIC => rows.of_ellipse(),
        _ => rows.quadratic(|row| rows.inertia(data.efc_R()[first + row])),
    }
}

impl Rows<'_> {
    fn state(&self, row: usize) -> u32 {
        self.data.efc_state()[self.first + row] as u32
    }

    /// Returns a number proportional to D of a row with a regularisation, which is constant at the
    /// engine's limit.
    fn inertia(&self, regularisation: f64) -> Dual {
        if regularisation > mjMINVAL { self.odds } else { Dual::constant(1.0) }
    }

    /// Returns the changes of the forces of the rows in the quadratic zone, for numbers
    /// proportional to D.
    fn quadratic(&self, inertia: impl Fn(usize) -> Dual) -> [f64; MAX_ROWS] {
        array::from_fn(|row| {
            if row >= self.count || self.state(row) != mjCNSTRSTATE_QUADRATIC {
                return 0.0;
            }
            let inertia = inertia(row).scaled_to(self.data.efc_D()[self.first + row]);
            -(inertia * self.jar[row]).change
        })
    }

    fn of_pyramid(&mut self) -> [f64; MAX_ROWS] {
        let friction = self.friction[0];
        let square = friction * friction;
        let contact = &contacts(self.data)[ffi::size(self.data.efc_id()[self.first])];
        let normal = self.data.efc_R()[self.first] / (2.0 * contact.mu * contact.mu);
        let mut inertia = self.inertia(normal) / square;
        if normal > mjMINVAL {
            inertia = inertia / (Dual::constant(1.0) + square);
        }
        let mut turned = [0.0; MAX_ROWS];
        for edge in 0..self.count / 2 {
            let (row, factor) = (2 * edge, 0.5 * self.friction[edge].change / self.friction[edge].value);
            let tangential = factor * (self.jar[row].value - self.jar[row + 1].value);
            self.jar[row].change += tangential;
            self.jar[row + 1].change -= tangential;
            let force = &self.data.efc_force()[self.first + row..];
            turned[row] = factor * (force[0] - force[1]);
            turned[row + 1] = -turned[row];
        }
        let forces = self.quadratic(|_| inertia);
        array::from_fn(|row| forces[row] + turned[row])
    }

    fn of_ellipse(&self) -> [f64; MAX_ROWS] {
        let normal = self.inertia(self.data.efc_R()[self.first]);
        self.quadratic(|row| {
            let ratio = if row == 0 { Dual::constant(1.0) } else { self.friction[row - 1] / self.friction[0] };
            normal * ratio * ratio
        })
    }

    fn of_cone(&self) -> [f64; MAX_ROWS] {
        let contact = &contacts(self.data)[ffi::size(self.data.efc_id()[self.first])];
        let mu = self.friction[0].scaled_to(contact.mu);
        let scaled: [Dual; MAX_ROWS] = array::from_fn(|row| {
            if (1..self.count).contains(&row) { self.friction[row - 1] * self.jar[row] } else { Dual::default() }
        });
        let tangent = scaled.iter().fold(Dual::default(), |sum, &number| sum + number * number).sqrt();
        let inertia = self.inertia(self.data.efc_R()[self.first]).scaled_to(self.data.efc_D()[self.first]);
        let normal = inertia * (tangent - self.jar[0]) / (Dual::constant(1.0) + mu * mu);
        array::from_fn(|row| match row {
            0 => normal.change,
            _ if row < self.count => -(normal * self.friction[row - 1] * scaled[row] / tangent).change,
            _ => 0.0,
        })
    }
}
