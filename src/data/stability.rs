//! States that the engine would silently reset.

use std::fmt;

use mujoco_sys::{mjMAXVAL, mjWARN_BADQACC, mjWARN_BADQPOS, mjWARN_BADQVEL};

use super::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::Kind;

/// What has left the range in which the engine computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// A number in `qpos`.
    Position,
    /// A number in `qvel`.
    Velocity,
    /// A number in `qacc`: the state itself was in range.
    Acceleration,
    /// A number in `ctrl`. (The engine would set all controls to zero for one step.)
    Control,
}

/// A number of the simulation that is not a number, or beyond ±10¹⁰. The engine itself would reset the simulation, print a
/// warning and go on.
///
/// A position, velocity or control that is out of range is found before the engine is called. The data is as it was, and a
/// program can correct the number. An acceleration that is out of range, and a control that a
/// [closure](crate::Callbacks::control) sets, are found in the middle of the call. The data is poisoned then:
/// see [`Error::Poisoned`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Instability {
    /// What is out of range.
    pub quantity: Quantity,
    /// Where: the index in `qpos`, `qvel`, `qacc` or `ctrl`.
    pub index: usize,
    /// The joint or actuator that it belongs to, if it has a name.
    pub name: Option<String>,
    /// The number. Unknown for an acceleration, which the engine has overwritten.
    pub value: Option<f64>,
    /// When: the simulated time, s.
    pub time: f64,
}

impl std::error::Error for Instability {}

impl fmt::Display for Instability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (array, kind) = match self.quantity {
            Quantity::Position => ("qpos", Kind::Joint),
            Quantity::Velocity => ("qvel", Kind::Joint),
            Quantity::Acceleration => ("qacc", Kind::Joint),
            Quantity::Control => ("ctrl", Kind::Actuator),
        };
        let stable = if self.quantity == Quantity::Control {
            "the controls are not usable"
        } else {
            "the simulation is unstable"
        };
        write!(f, "{stable} at time {} s: {array}[{}]", self.time, self.index)?;
        if let Some(name) = &self.name {
            write!(f, " of {kind} '{name}'")?;
        }
        match self.value {
            Some(value) => write!(f, " is {value}, beyond ±1e10"),
            None => write!(
                f,
                " is not a number or beyond ±1e10; a smaller timestep, or softer or better damped parts, may help"
            ),
        }
    }
}

/// Whether the engine takes this for a good number: one within ±10¹⁰.
#[inline]
fn is_good(value: f64) -> bool {
    // Without their sign, numbers are in the order of their bits, and what is no number comes after all others.
    value.to_bits() << 1 <= mjMAXVAL.to_bits() << 1
}

impl Data {
    /// Refuses a state or controls that the engine would reset, before it does.
    #[inline]
    pub(crate) fn check_inputs(&self) -> Result<()> {
        let (raw, model) = (self.raw(), self.model());
        // SAFETY: the engine allocated each array with this length, and `self` is borrowed.
        let good = unsafe {
            ffi::all(raw.qpos, model.nq(), is_good)
                && ffi::all(raw.qvel, model.nv(), is_good)
                && ffi::all(raw.ctrl, model.nu(), is_good)
        };
        if !good {
            return Err(self.bad_input());
        }
        if self.model().has_rangefinder_and_height_field() { self.check_field_poses() } else { Ok(()) }
    }

    #[cold]
    fn bad_input(&self) -> Error {
        [(Quantity::Position, self.qpos()), (Quantity::Velocity, self.qvel()), (Quantity::Control, self.ctrl())]
            .into_iter()
            .find_map(|(quantity, values)| {
                let index = values.iter().position(|&value| !is_good(value))?;
                Some(self.instability(quantity, index, Some(values[index]), self.time()).into())
            })
            .expect("Bug: no bad number among bad inputs")
    }

    /// What the engine found, from its warning.
    #[cold]
    pub(super) fn reset_by_engine(&self, time: f64) -> Instability {
        let warning = |warning: u32| &self.raw().warning[warning as usize];
        let (quantity, warning) = [
            (Quantity::Acceleration, warning(mjWARN_BADQACC)),
            (Quantity::Velocity, warning(mjWARN_BADQVEL)),
            (Quantity::Position, warning(mjWARN_BADQPOS)),
        ]
        .into_iter()
        .find(|(_, warning)| warning.number > 0)
        .unwrap_or((Quantity::Acceleration, warning(mjWARN_BADQACC)));
        self.instability(quantity, usize::try_from(warning.lastinfo).unwrap_or(0), None, time)
    }

    fn instability(&self, quantity: Quantity, index: usize, value: Option<f64>, time: f64) -> Instability {
        let model = self.model();
        // The last joint that starts at or before the index.
        let joint = |starts: &[i32]| {
            starts
                .iter()
                .rposition(|&start| ffi::size(start) <= index)
                .and_then(|joint| model.name_at(Kind::Joint, joint))
        };
        let name = match quantity {
            Quantity::Position => joint(model.jnt_qposadr()),
            Quantity::Velocity | Quantity::Acceleration => joint(model.jnt_dofadr()),
            Quantity::Control => model.name_at(Kind::Actuator, index),
        };
        Instability { quantity, index, name: name.map(str::to_owned), value, time }
    }
}

#[cfg(test)]
mod tests {
    use mujoco_sys::mjMAXVAL;

    use crate::{Data, sample};

    #[test]
    fn only_a_number_beyond_the_limit_is_refused() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.ctrl_mut().fill(-mjMAXVAL);
        assert!(data.check_inputs().is_ok());
        for bad in [mjMAXVAL.next_up(), -mjMAXVAL.next_up(), f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -f64::NAN] {
            for index in [0, 7, data.ctrl().len() - 1] {
                data.ctrl_mut().fill(0.0);
                data.ctrl_mut()[index] = bad;
                assert!(data.check_inputs().is_err(), "{bad} at {index}");
            }
            data.ctrl_mut().fill(0.0);
            let last = data.qvel().len() - 1;
            data.qvel_mut()[last] = bad;
            assert!(data.check_inputs().is_err(), "{bad} in qvel");
            data.qvel_mut()[last] = 0.0;
            let last = data.qpos().len() - 1;
            let before = std::mem::replace(&mut data.qpos_mut()[last], bad);
            assert!(data.check_inputs().is_err(), "{bad} in qpos");
            data.qpos_mut()[last] = before;
        }
        assert!(data.check_inputs().is_ok());
    }
}
