//! Floating-point values from which newer engines compute addresses.
//!
//! The data of a strain constraint contain the indices of a cell. Some parameters of PID
//! controllers and DC motors add an activation to those that a step reads and writes, if they are
//! positive. The arrays also contain plain numbers, so they are writable, and the values are
//! checked when a model is loaded and before a simulation uses an edited model.

use mujoco_sys::{mjBIAS_DCMOTOR, mjDYN_DCMOTOR, mjDYN_PID, mjEQ_FLEXSTRAIN, mjGAIN_DCMOTOR, mjGAIN_PID};

use super::{Model, ModelMut};
use crate::error::{Error, Result};
use crate::kind::Kind;

const EQUALITY_DATA: usize = mujoco_sys::mjNEQDATA as usize;

/// Versions whose rules are known. The elements exist since 3.6 and 3.7.
const IS_KNOWN: bool = cfg!(engine_since = "3.17.0");

impl Model {
    /// Returns `true` if the model has a strain constraint, a PID controller or a DC motor.
    pub(super) fn find_addresses(&self) -> bool {
        let has = |types: &[i32], sought: &[u32]| types.iter().any(|&found| sought.contains(&(found as u32)));
        cfg!(engine_since = "3.6.0")
            && (has(self.eq_type(), &[mjEQ_FLEXSTRAIN])
                || has(self.actuator_dyntype(), &[mjDYN_PID, mjDYN_DCMOTOR])
                || has(self.actuator_gaintype(), &[mjGAIN_PID, mjGAIN_DCMOTOR])
                || has(self.actuator_biastype(), &[mjBIAS_DCMOTOR]))
    }

    /// Checks that the engine finds the cells of strain constraints and the activations of
    /// actuators inside the model's arrays.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] with the first value that would lead outside, [`Error::Unsupported`] if
    /// the rules of the engine are not known.
    pub(crate) fn check_addresses(&self) -> Result<()> {
        if !self.has_addresses {
            return Ok(());
        }
        if !IS_KNOWN {
            let what = "strain constraints, PID controllers and DC motors with MuJoCo 3.6 to 3.16";
            return Err(Error::Unsupported(what.to_owned()));
        }
        (0..self.neq()).try_for_each(|equality| self.check_cell(equality))?;
        (0..self.nactuator()).try_for_each(|actuator| self.check_activations(actuator))
    }

    /// Checks the cell of a strain constraint.
    #[cfg(engine_since = "3.17.0")]
    fn check_cell(&self, equality: usize) -> Result<()> {
        if self.eq_type()[equality] as u32 != mjEQ_FLEXSTRAIN {
            return Ok(());
        }
        let flex = crate::ffi::size(self.eq_obj1id()[equality]);
        let cells = self.flex_cellnum()[flex];
        let [x, y, z] = cells;
        // The cells of a shell are the faces of the grid.
        let faces = [2 * (x * y + y * z + z * x)];
        let counts = if self.flex_interp()[flex] < 0 { &faces[..] } else { &cells[..] };
        for (axis, (&cell, &count)) in self.eq_data()[equality].iter().zip(counts).enumerate() {
            if !((0.0..f64::from(count)).contains(&cell) && cell.fract() == 0.0) {
                let constraint = self.described(Kind::Equality, equality);
                let what = format!("eq_data[{equality}][{axis}], an index of the cell that {constraint} strains,");
                return Err(Error::out_of_range(what, cell, format!("a whole number from 0 to {}", count - 1)));
            }
        }
        Ok(())
    }

    #[cfg(not(engine_since = "3.17.0"))]
    #[allow(clippy::unused_self, clippy::unnecessary_wraps, reason = "newer engines have cells")]
    fn check_cell(&self, _: usize) -> Result<()> {
        Ok(())
    }

    /// Checks that an actuator has the activations for which its parameters ask.
    fn check_activations(&self, actuator: usize) -> Result<()> {
        let (dynamics, gain, bias) = (
            self.actuator_dyntype()[actuator] as u32,
            self.actuator_gaintype()[actuator] as u32,
            self.actuator_biastype()[actuator] as u32,
        );
        let (dynprm, gainprm) = (&self.actuator_dynprm()[actuator], &self.actuator_gainprm()[actuator]);
        let mut needed = Vec::new();
        if dynamics == mjDYN_PID || gain == mjGAIN_PID {
            needed.extend([("dynprm[1]", dynprm[1]), ("gainprm[0]", gainprm[0])]);
        }
        if dynamics == mjDYN_DCMOTOR || gain == mjGAIN_DCMOTOR || bias == mjBIAS_DCMOTOR {
            needed.extend([("dynprm[0]", dynprm[0]), ("dynprm[2]", dynprm[2]), ("dynprm[5]", dynprm[5])]);
            needed.extend([("dynprm[7]", dynprm[7]), ("gainprm[5]", gainprm[5])]);
        }
        needed.retain(|&(_, value)| value > 0.0);
        let count = self.activations_of(actuator).len();
        // Other dynamics have activations that do not depend on parameters.
        let fits =
            if [mjDYN_PID, mjDYN_DCMOTOR].contains(&dynamics) { needed.len() == count } else { needed.len() <= count };
        if fits {
            return Ok(());
        }
        let names: Vec<&str> = needed.iter().map(|&(name, _)| name).collect();
        let value = if names.is_empty() { "zero".to_owned() } else { format!("positive in {}", names.join(", ")) };
        let expected = format!("positive in as many parameters as the actuator has activations, {count}");
        Err(Error::out_of_range(
            format!("the list of states of {}", self.described(Kind::Actuator, actuator)),
            value,
            expected,
        ))
    }

    /// Returns the kind and the name of an element, or its index if it has none.
    pub(crate) fn described(&self, kind: Kind, index: usize) -> String {
        self.name_at(kind, index).map_or(format!("{kind} {index}"), |name| format!("{kind} '{name}'"))
    }
}

/// Values before an edit, of the elements from which the engine computes addresses.
#[derive(Default)]
struct Saved {
    equalities: Vec<[f64; EQUALITY_DATA]>,
    dynamics: Vec<[f64; 10]>,
    gains: Vec<[f64; 10]>,
}

/// Edit of a model that belongs to a simulation. Undoes changes of addresses that would lead
/// outside of the model's arrays, also if the closure of the edit panics.
pub(crate) struct CheckedEdit<'m> {
    edit: ModelMut<'m>,
    /// Empty, without allocation, for a model without such values.
    saved: Saved,
}

impl<'m> CheckedEdit<'m> {
    pub(crate) fn new(model: &'m mut Model) -> Self {
        let saved = if model.has_addresses {
            Saved {
                equalities: model.eq_data().to_vec(),
                dynamics: model.actuator_dynprm().to_vec(),
                gains: model.actuator_gainprm().to_vec(),
            }
        } else {
            Saved::default()
        };
        Self { edit: model.edit(), saved }
    }

    pub(crate) fn model(&mut self) -> &mut ModelMut<'m> {
        &mut self.edit
    }

    /// Ends the edit: computes the bounds for collision detection that it has loosened.
    ///
    /// # Errors
    ///
    /// As [`check_addresses`](Model::check_addresses).
    pub(crate) fn finish(mut self) -> Result<()> {
        self.edit.tighten_bounds();
        self.edit.check_addresses()
    }
}

impl Drop for CheckedEdit<'_> {
    fn drop(&mut self) {
        if self.edit.check_addresses().is_err() {
            self.edit.eq_data_mut().copy_from_slice(&self.saved.equalities);
            self.edit.actuator_dynprm_mut().copy_from_slice(&self.saved.dynamics);
            self.edit.actuator_gainprm_mut().copy_from_slice(&self.saved.gains);
        }
    }
}
