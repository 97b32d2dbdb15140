//! Derivatives of the constraint forces `Jᵀ f`, one constraint after another.
//!
//! Each kind of constraint contributes the derivatives of its Jacobian and its position
//! (`contact.rs`, `limit.rs`, `equality.rs`); `rows.rs` converts them to the derivatives of the
//! forces. At a kink, for example when two geoms begin to touch, the derivatives are taken on the
//! present side.

mod chains;
mod contact;
mod contact_differences;
mod contact_geometry;
mod equality;
mod force_sensors;
mod interactions;
mod kinks;
mod limit;
mod rows;
mod tendon;

use mujoco_sys::{
    mjCNSTR_CONTACT_ELLIPTIC, mjCNSTR_CONTACT_FRICTIONLESS, mjCNSTR_CONTACT_PYRAMIDAL, mjCNSTR_EQUALITY,
    mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON, mjCNSTR_LIMIT_JOINT, mjCNSTR_LIMIT_TENDON, mjCNSTRSTATE_SATISFIED,
    mjMINVAL,
};

pub(super) use self::chains::Chains;
pub(super) use self::force_sensors::ForceSensors;
pub(super) use self::interactions::Interactions;
pub(super) use self::kinks::of_state as kinks_of_state;
pub(super) use self::rows::MAX_ROWS;
use self::rows::Rows;
use super::tendon::Tendons;
use super::tree::Tree;
use crate::data::Data;
use crate::derivative::method::{DifferencedTerms, Kinks};
use crate::derivative::newton::contacts;
use crate::error::Result;
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::Model;

/// Derivatives of constraint forces, with their buffers.
#[derive(Debug)]
pub(super) struct Constraints {
    chains: Chains,
    rows: Rows,
    /// `(nv)`: Jacobian of the second object of an equality constraint.
    row: Vec<f64>,
    pub(super) force_sensors: ForceSensors,
    pub(super) interactions: Interactions,
}

impl Constraints {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        let (force_sensors, interactions) = (ForceSensors::new(model), Interactions::new(model));
        Self { chains: Chains::new(nv), rows: Rows::new(nv), row: vec![0.0; nv], force_sensors, interactions }
    }

    /// Subtracts the derivatives of the constraint forces by positions and velocities from the
    /// derivatives of the residual. Returns the terms that were differenced, or `None` if an active
    /// constraint has no formula. Adds the kinks, for residuals `jar` of the rows. Also
    /// differentiates sensors of constraint forces, if they are wanted.
    pub(super) fn differentiate(
        &mut self,
        data: &mut Data,
        tree: &Tree,
        tendons: &mut Tendons,
        wants_sensors: bool,
        residual: &mut Matrix,
        (jar, kinks): (&[f64], &mut Kinks),
    ) -> Result<Option<DifferencedTerms>> {
        *kinks |= kinks::of_state(data, jar);
        let mut differenced = DifferencedTerms::empty();
        self.force_sensors.clear();
        self.interactions.clear(wants_sensors);
        let mut row = 0;
        while row < data.nefc() {
            let count = row_count(data, row);
            if is_active(data, row, count) {
                // D of this row is at the engine's limit, so it does not depend on the position.
                if data.efc_D()[row] * mjMINVAL >= 1.0 {
                    return Ok(None);
                }
                let constraint = data.efc_type()[row] as u32;
                #[expect(non_upper_case_globals, reason = "the engine's constants")]
                let is_covered = match constraint {
                    mjCNSTR_EQUALITY => equality::differentiate(self, data, tree, row, residual),
                    mjCNSTR_FRICTION_DOF | mjCNSTR_FRICTION_TENDON => {
                        self.rows.load(data, row, count, None);
                        tendon::differentiate(&mut self.rows, data, tendons, row);
                        true
                    }
                    mjCNSTR_LIMIT_JOINT | mjCNSTR_LIMIT_TENDON => {
                        limit::differentiate(&mut self.rows, data, row, residual);
                        tendon::differentiate(&mut self.rows, data, tendons, row);
                        true
                    }
                    _ => {
                        let contact = contacts(data)[ffi::size(data.efc_id()[row])];
                        let Some((geometry, terms, found)) = contact_differences::geometry(data, &contact)? else {
                            return Ok(None);
                        };
                        differenced |= terms;
                        *kinks |= found;
                        contact::differentiate(self, data, tree, row, count, &geometry, residual)
                    }
                };
                if !is_covered {
                    return Ok(None);
                }
                self.rows.subtract_from(data, residual);
                if wants_sensors {
                    self.force_sensors.add(data, &mut self.rows);
                    self.interactions.finish(data, &mut self.rows);
                }
            }
            row += count;
        }
        Ok(Some(differenced))
    }
}

/// Returns the number of rows of the constraint that starts at a row.
pub(super) fn row_count(data: &Data, row: usize) -> usize {
    let id = ffi::size(data.efc_id()[row]);
    #[expect(non_upper_case_globals, reason = "the engine's constants")]
    match data.efc_type()[row] as u32 {
        mjCNSTR_EQUALITY => equality::row_count(data.model(), id),
        mjCNSTR_CONTACT_ELLIPTIC => contact::dimension(data, id),
        mjCNSTR_CONTACT_PYRAMIDAL => 2 * (contact::dimension(data, id) - 1),
        _ => 1,
    }
}

/// Returns the violation of a constraint, of which its impedance is a function. The rows of an
/// equality constraint share the norm of their positions; those of a contact have the violation of
/// the first row.
pub(super) fn violation(data: &Data, row: usize, count: usize) -> f64 {
    if data.efc_type()[row] as u32 == mjCNSTR_EQUALITY && count > 1 {
        return equality::violation(data, row, count);
    }
    (data.efc_pos()[row] - data.efc_margin()[row]).abs()
}

/// Returns `true` for a type of rows of contacts.
fn is_contact(kind: u32) -> bool {
    [mjCNSTR_CONTACT_FRICTIONLESS, mjCNSTR_CONTACT_PYRAMIDAL, mjCNSTR_CONTACT_ELLIPTIC].contains(&kind)
}

/// Returns `true` if a constraint has a force, or can have one after a small change of the state.
pub(super) fn is_active(data: &Data, row: usize, count: usize) -> bool {
    data.efc_state()[row..row + count].iter().any(|&state| state as u32 != mjCNSTRSTATE_SATISFIED)
}
