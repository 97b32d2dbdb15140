//! The simulation with which the compiler finds the range of a muscle's length.
//!
//! The engine pulls at each muscle from both sides, and steps until a time is reached. An unstable step puts the time back to
//! zero, and 2.2.2 does not see it: it would go on for ever. So a text in which it may come to that is compiled without the
//! simulation first, and the simulation is made here, where an unstable step ends it.

use std::ptr;

use mujoco_sys::{self as sys, guard, mjData, mjModel};

use super::Model;
use crate::error::{Error, Result};
use crate::ffi;

/// Steps of all the simulations of a text.
const MOST_STEPS: f64 = 1e6;

/// Which muscles are simulated, and how: `mjLROpt`, as the text has it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LengthRange {
    pub(super) mode: Mode,
    pub(super) useexisting: bool,
    pub(super) uselimit: bool,
    pub(super) accel: f64,
    pub(super) maxforce: f64,
    pub(super) timeconst: f64,
    pub(super) timestep: f64,
    pub(super) inttotal: f64,
}

/// `mjtLRMode`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    None,
    Muscle,
    MuscleUser,
    All,
}

impl Default for LengthRange {
    fn default() -> Self {
        Self {
            mode: Mode::Muscle,
            useexisting: true,
            uselimit: false,
            accel: 20.0,
            maxforce: 0.0,
            timeconst: 1.0,
            timestep: 0.01,
            inttotal: 10.0,
        }
    }
}

impl LengthRange {
    /// Makes the simulations that the compiler would make, on a model that was compiled without them.
    ///
    /// The message of the error says which of them does not come to an end.
    pub(super) fn check(&self, model: &mut Model) -> std::result::Result<(), String> {
        let actuators: Vec<usize> = (0..model.nu()).filter(|&actuator| self.is_simulated(model, actuator)).collect();
        if actuators.is_empty() {
            return Ok(());
        }
        // The compiler has not yet put the user's statistics in the place of its own.
        model.edit().update_constants().map_err(|error| error.to_string())?;
        let option = &mut model.raw_mut().opt;
        option.disableflags = (sys::mjDSBL_FRICTIONLOSS
            | sys::mjDSBL_CONTACT
            | sys::mjDSBL_PASSIVE
            | sys::mjDSBL_GRAVITY
            | sys::mjDSBL_ACTUATION) as i32;
        if self.timestep > 0.0 {
            option.timestep = self.timestep;
        }
        let steps = 2.0 * actuators.len() as f64 * self.inttotal / option.timestep;
        // What is not a number ends the compiler's loop at once.
        if steps > MOST_STEPS || option.timestep <= 0.0 {
            return Err(format!("the lengthrange of the muscles needs {steps:e} steps; a million is allowed"));
        }
        let mut data = Scratch::new(model).map_err(|error| error.to_string())?;
        for actuator in actuators {
            for side in [-1.0, 1.0] {
                let settled = self.simulate(model, &mut data, actuator, side).map_err(|error| error.to_string())?;
                if !settled {
                    return Err(format!(
                        "the simulation for the lengthrange of actuator {actuator} is unstable; give it a lengthrange"
                    ));
                }
            }
        }
        Ok(())
    }

    fn is_simulated(&self, model: &Model, actuator: usize) -> bool {
        let is = |gain: u32, bias: u32| {
            model.actuator_gaintype()[actuator] == gain as i32 || model.actuator_biastype()[actuator] == bias as i32
        };
        let muscle = is(sys::mjGAIN_MUSCLE, sys::mjBIAS_MUSCLE);
        let selected = match self.mode {
            Mode::None => false,
            Mode::Muscle => muscle,
            Mode::MuscleUser => muscle || is(sys::mjGAIN_USER, sys::mjBIAS_USER),
            Mode::All => true,
        };
        let [low, high] = model.actuator_lengthrange()[actuator];
        selected && !(self.useexisting && low < high) && !(self.uselimit && has_limit(model, actuator))
    }

    /// Whether the simulation of one side comes to its end.
    fn simulate(&self, model: &Model, data: &mut Scratch, actuator: usize, side: f64) -> Result<bool> {
        let (nv, m, d) = (model.raw().nv, model.as_ptr(), data.0);
        data.reset(m)?;
        // SAFETY: of the scratch data, which is valid until it is dropped.
        let time = || unsafe { (*d).time };
        while time() < self.inttotal {
            let before = time();
            // SAFETY: a model and a data that was made for it. The vectors have the length nv, and `actuator_moment` nv numbers
            // for each of the actuators, of which this is one.
            unsafe {
                let moment = (*d).actuator_moment.add(actuator * ffi::size(nv));
                let decay = (-model.timestep() / self.timeconst.max(0.01)).exp();
                sys::mju_scl((*d).qvel, (*d).qvel, decay, nv);
                ffi::check("mj_step1", guard::mj_step1(m, d))?;
                ffi::check("mj_solveM", guard::mj_solve_m(m, d, (*d).qfrc_applied, moment, 1))?;
                let force = sys::mju_norm((*d).qfrc_applied, nv);
                sys::mju_scl((*d).qfrc_applied, moment, side * self.accel / force.max(sys::mjMINVAL), nv);
                let force = sys::mju_norm((*d).qfrc_applied, nv);
                if self.maxforce > 0.0 && force > self.maxforce {
                    sys::mju_scl((*d).qfrc_applied, (*d).qfrc_applied, self.maxforce / force.max(sys::mjMINVAL), nv);
                }
                ffi::check("mj_step2", guard::mj_step2(m, d))?;
            }
            if time() <= before {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Whether the limits of the actuator's joint or tendon are its length range.
fn has_limit(model: &Model, actuator: usize) -> bool {
    let target = model.actuator_trnid()[actuator][0];
    let limited = |limited: &[u8]| usize::try_from(target).is_ok_and(|target| limited[target] != 0);
    match model.actuator_trntype()[actuator] as u32 {
        sys::mjTRN_JOINT | sys::mjTRN_JOINTINPARENT => limited(model.jnt_limited()),
        sys::mjTRN_TENDON => limited(model.tendon_limited()),
        _ => false,
    }
}

/// A data for the simulations.
struct Scratch(*mut mjData);

impl Scratch {
    fn new(model: &Model) -> Result<Self> {
        let mut made = ptr::null_mut();
        // SAFETY: a valid model, a place for the result.
        ffi::check("mj_makeData", unsafe { guard::mj_make_data(model.as_ptr(), &raw mut made) })?;
        if made.is_null() { Err(Error::OutOfMemory { function: "mj_makeData" }) } else { Ok(Self(made)) }
    }

    fn reset(&mut self, model: *const mjModel) -> Result<()> {
        // SAFETY: the model that it was made for.
        ffi::check("mj_resetData", unsafe { guard::mj_reset_data(model, self.0) })?;
        // SAFETY: valid, and ours. A counter that is not zero keeps the engine from printing a warning through a buffer that all
        // threads share.
        for warning in unsafe { &mut (*self.0).warning } {
            warning.number = 1;
        }
        Ok(())
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // SAFETY: made above, and used no more.
        unsafe { sys::mj_deleteData(self.0) };
    }
}
