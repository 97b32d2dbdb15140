//! Length ranges of actuators, computed by simulation.
//!
//! The engine's function drives an actuator to both ends of its range, and steps until a given
//! time. An unstable step resets the time to zero, which 2.2.2 does not detect, so the function may
//! never return. This module implements the same algorithm and does not call that function. If the
//! compilation of a text may call the engine's function, the text is first compiled with that
//! function disabled. Then [`MuscleSimulation`] runs the algorithm on the resulting model.

use mujoco_sys::{self as sys, mjBIAS_MUSCLE, mjBIAS_USER, mjGAIN_MUSCLE, mjGAIN_USER};
use mujoco_sys::{mjTRN_JOINT, mjTRN_JOINTINPARENT, mjTRN_TENDON};

use super::{Data, Warning};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::IntoId;
use crate::kind;
use crate::macros::with_methods;
use crate::model::{DisableFlags, Model, ModelMut};

/// Actuators that [`ModelMut::set_length_range`] processes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LengthRangeMode {
    /// None.
    #[doc(alias = "mjLRMODE_NONE")]
    None,
    /// Muscles.
    #[doc(alias = "mjLRMODE_MUSCLE")]
    Muscle,
    /// Muscles, and actuators with a user-defined gain or bias.
    #[doc(alias = "mjLRMODE_MUSCLEUSER")]
    MuscleUser,
    /// All.
    #[doc(alias = "mjLRMODE_ALL")]
    All,
}

/// Options of [`ModelMut::set_length_range`]. The defaults are the engine's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LengthRangeOptions {
    /// Actuators to process.
    pub mode: LengthRangeMode,
    /// `true` to keep an existing range.
    pub useexisting: bool,
    /// `true` to use the limits of the joint or tendon, if it is limited.
    pub uselimit: bool,
    /// Target acceleration, from which the force is computed.
    pub accel: f64,
    /// Largest force; 0 for no limit.
    pub maxforce: f64,
    /// Time constant by which velocities are damped, s; at least 0.01.
    pub timeconst: f64,
    /// Simulated time for each end of the range, s.
    pub inttotal: f64,
    /// Evaluation interval at the end of the simulated time, s.
    pub inteval: f64,
    /// Largest variation of the length in the evaluation interval, as a fraction of the range.
    pub tolrange: f64,
}

impl Default for LengthRangeOptions {
    fn default() -> Self {
        Self {
            mode: LengthRangeMode::Muscle,
            useexisting: true,
            uselimit: false,
            accel: 20.0,
            maxforce: 0.0,
            timeconst: 1.0,
            inttotal: 10.0,
            inteval: 2.0,
            tolrange: 0.05,
        }
    }
}

with_methods!(LengthRangeOptions {
    with_mode(mode: LengthRangeMode),
    with_useexisting(useexisting: bool),
    with_uselimit(uselimit: bool),
    with_accel(accel: f64),
    with_maxforce(maxforce: f64),
    with_timeconst(timeconst: f64),
    with_inttotal(inttotal: f64),
    with_inteval(inteval: f64),
    with_tolrange(tolrange: f64),
});

/// Limit on the number of steps of one call, which take minutes for a small model.
const MOST_STEPS: f64 = 1e7;
/// Limit on the total number of steps for all actuators of a text. It is lower, because the program
/// has not requested these simulations explicitly.
const MOST_STEPS_OF_A_TEXT: f64 = 1e6;

impl LengthRangeOptions {
    fn check(&self, timestep: f64) -> Result<()> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let not_negative = |value: f64| value >= 0.0 && value.is_finite();
        let fields = [
            ("accel", self.accel, positive(self.accel), "positive"),
            ("maxforce", self.maxforce, not_negative(self.maxforce), "not negative"),
            ("timeconst", self.timeconst, not_negative(self.timeconst), "not negative"),
            ("inttotal", self.inttotal, positive(self.inttotal), "positive"),
            (
                "inteval",
                self.inteval,
                positive(self.inteval) && self.inteval <= self.inttotal,
                "positive and at most inttotal",
            ),
            ("tolrange", self.tolrange, not_negative(self.tolrange), "not negative"),
            ("inttotal", self.inttotal, self.inttotal / timestep <= MOST_STEPS, "at most ten million time steps"),
        ];
        fields.into_iter().find(|(_, _, allowed, _)| !allowed).map_or(Ok(()), |(field, value, _, expected)| {
            Err(Error::out_of_range(format!("{field} of the options of set_length_range"), value, expected))
        })
    }
}

impl Model {
    fn is_excluded(&self, index: usize, mode: LengthRangeMode) -> bool {
        let is = |gain: u32, bias: u32| {
            self.actuator_gaintype()[index] == gain as i32 || self.actuator_biastype()[index] == bias as i32
        };
        let muscle = is(mjGAIN_MUSCLE, mjBIAS_MUSCLE);
        match mode {
            LengthRangeMode::None => true,
            LengthRangeMode::Muscle => !muscle,
            LengthRangeMode::MuscleUser => !muscle && !is(mjGAIN_USER, mjBIAS_USER),
            LengthRangeMode::All => false,
        }
    }

    /// Returns the limits of the joint or tendon on which an actuator acts.
    fn limit_of_transmission(&self, index: usize) -> Option<[f64; 2]> {
        let target = ffi::size(self.actuator_trnid()[index][0]);
        let transmission = self.actuator_trntype()[index] as u32;
        if [mjTRN_JOINT, mjTRN_JOINTINPARENT].contains(&transmission) {
            (self.jnt_limited()[target] != 0).then(|| self.jnt_range()[target])
        } else if transmission == mjTRN_TENDON {
            (self.tendon_limited()[target] != 0).then(|| self.tendon_range()[target])
        } else {
            None
        }
    }

    /// Returns `true` if the engine's function takes the limits of an actuator from another joint
    /// or tendon than it acts on. Before 4.0 it reads the id in entry `index` of `actuator_trnid`,
    /// which has two entries for each actuator. The id is right for the first actuator only; for
    /// the second it is usually -1, which is before the start of `jnt_limited`.
    fn uses_wrong_limit(&self, index: usize) -> bool {
        let has_limit =
            [mjTRN_JOINT, mjTRN_JOINTINPARENT, mjTRN_TENDON].contains(&(self.actuator_trntype()[index] as u32));
        let ids = self.actuator_trnid();
        cfg!(not(engine_since = "4.0.0")) && has_limit && ids.as_flattened()[index] != ids[index][0]
    }
}

/// # Length ranges of actuators
impl ModelMut<'_> {
    /// Computes the length range of an actuator by driving it to both ends in simulation, writes it
    /// to `actuator_lengthrange`, and returns it. If the options exclude the actuator, returns the
    /// existing range.
    ///
    /// The algorithm is the engine's. The engine's own function is not called, because in 2.2.2 it
    /// does not return for some models whose simulation is unstable, and before 4.0 it uses the
    /// limits of the wrong joint for all actuators except the first. When the compiler computes
    /// length ranges, it disables contacts, friction loss, passive forces, gravity and actuation;
    /// this function uses the options of the model.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for options out of range, [`Error::Unstable`] if the simulation is
    /// unstable, [`Error::Unsupported`] if the range is empty or the length does not settle, and
    /// the errors of [`Data::step1`]. In these cases the range is unchanged.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::model::{DisableFlags, LengthRangeMode, LengthRangeOptions};
    /// use mujoco_safe::Model;
    ///
    /// let mut model = Model::from_xml_str(
    ///     r#"<mujoco>
    ///          <option><flag gravity="disable"/></option>
    ///          <worldbody><body>
    ///            <joint name="slide" type="slide" axis="1 0 0" limited="true" range="-1 2"/><geom size="0.1"/>
    ///          </body></worldbody>
    ///          <actuator><motor name="motor" joint="slide" gear="3"/></actuator>
    ///        </mujoco>"#,
    /// )?;
    /// let motor = model.actuator("motor")?.id();
    /// let options = LengthRangeOptions::default().with_mode(LengthRangeMode::All);
    /// let [shortest, longest] = model.edit().set_length_range(motor, &options)?;
    /// assert!((shortest + 3.0).abs() < 0.1 && (longest - 6.0).abs() < 0.1); // three times the range of the joint
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_setLengthRange")]
    pub fn set_length_range(
        &mut self,
        actuator: impl IntoId<kind::Actuator>,
        options: &LengthRangeOptions,
    ) -> Result<[f64; 2]> {
        let index = actuator.id_in(&**self)?.index();
        let output = self.first_output(index);
        options.check(self.timestep())?;
        if self.is_excluded(index, options.mode) {
            return Ok(self.actuator_lengthrange()[output]);
        }
        let [low, high] = self.actuator_lengthrange()[output];
        if options.useexisting && low < high {
            return Ok([low, high]);
        }
        let range = match self.limit_of_transmission(index).filter(|_| options.uselimit) {
            Some(limit) => limit,
            None => self.simulated_range(index, options)?,
        };
        self.actuator_lengthrange_mut()[output] = range;
        Ok(range)
    }

    fn simulated_range(&self, index: usize, options: &LengthRangeOptions) -> Result<[f64; 2]> {
        let mut data = Data::new(self.try_clone()?)?;
        let mut ends = [[0.0; 2]; 2];
        for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
            *end = drive(&mut data, index, sign, options)?;
        }
        let [[shortest, short_max], [long_min, longest]] = ends;
        let has_settled = |min: f64, max: f64| max - min <= options.tolrange * (longest - shortest);
        let problem = if longest <= shortest {
            "is empty"
        } else if !has_settled(shortest, short_max) || !has_settled(long_min, longest) {
            "does not settle"
        } else {
            return Ok([shortest, longest]);
        };
        Err(Error::Unsupported(format!(
            "the length range of actuator {index} {problem}: from [{shortest}, {short_max}] to [{long_min}, {longest}]"
        )))
    }
}

/// Simulates an actuator that pulls (`sign` -1) or pushes (1), and returns the smallest and the
/// largest length in the evaluation interval.
fn drive(data: &mut Data, index: usize, sign: f64, options: &LengthRangeOptions) -> Result<[f64; 2]> {
    data.reset()?;
    let (nv, output) = (data.model().nv(), data.model().first_output(index));
    // As in the engine, a time constant that is NaN remains.
    let timeconst = if options.timeconst < 0.01 { 0.01 } else { options.timeconst };
    let decay = (-data.model().timestep() / timeconst).exp();
    let (mut moment, mut unit) = (vec![0.0; nv], vec![0.0; nv]);
    // SAFETY: in both calls below, the argument is a vector of nv numbers.
    let norm = |vector: &[f64]| unsafe { sys::mju_norm(vector.as_ptr(), nv as i32) }.max(sys::mjMINVAL);
    let mut lengths: Option<[f64; 2]> = None;
    while data.time() < options.inttotal {
        data.qvel_mut().iter_mut().for_each(|velocity| *velocity *= decay);
        data.step1()?;
        // Compute the force that results in the acceleration `accel`.
        data.moment_row(output).write_into(&mut moment);
        data.solve_m_into(&moment, &mut unit)?;
        let scale = sign * options.accel / norm(&unit);
        let force = data.qfrc_applied_mut();
        force.iter_mut().zip(&moment).for_each(|(force, moment)| *force = moment * scale);
        let size = norm(force);
        if options.maxforce > 0.0 && size > options.maxforce {
            for force in force {
                *force *= options.maxforce / size;
            }
        }
        data.step2()?;
        let length = data.actuator_length()[output];
        if data.time() > options.inttotal - options.inteval {
            let [low, high] = lengths.unwrap_or([length; 2]);
            lengths = Some([low.min(length), high.max(length)]);
        }
    }
    Ok(lengths.unwrap_or_default())
}

/// Settings of a text for the simulations in which the compiler computes length ranges.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MuscleSimulation {
    pub(crate) options: LengthRangeOptions,
    /// Time step, s. If it is not positive, the model's time step applies.
    pub(crate) timestep: f64,
}

impl Default for MuscleSimulation {
    fn default() -> Self {
        Self { options: LengthRangeOptions::default(), timestep: 0.01 }
    }
}

impl MuscleSimulation {
    /// Runs the simulations on a model that was compiled without them. Returns a message if one of
    /// them fails or is too long.
    pub(crate) fn check(&self, model: &mut Model) -> Result<(), String> {
        let Self { options, timestep } = self;
        let is_computed = |&index: &usize| {
            let [low, high] = model.actuator_lengthrange()[model.first_output(index)];
            let is_known = options.useexisting && low < high;
            !is_known && !model.is_excluded(index, options.mode)
        };
        let mut actuators: Vec<usize> = (0..model.nactuator()).filter(is_computed).collect();
        if options.uselimit {
            if let Some(actuator) = actuators.iter().find(|&&index| model.uses_wrong_limit(index)) {
                return Err(format!(
                    "with uselimit, this engine takes the lengthrange of actuator {actuator} from the wrong joint or tendon; set it \
                     in the XML"
                ));
            }
            actuators.retain(|&index| model.limit_of_transmission(index).is_none());
        }
        if actuators.is_empty() {
            return Ok(());
        }
        // Recompute the statistics: at this point the compiler has not yet replaced them by the
        // user's values.
        model.edit().update_constants().map_err(|error| error.to_string())?;
        // Bypass the check of `ModelMut::edit_options`, because the other options of the text are
        // irrelevant here.
        let option = &mut model.raw_mut().opt;
        option.disableflags = (sys::mjDSBL_FRICTIONLOSS
            | sys::mjDSBL_CONTACT
            | DisableFlags::PASSIVE.bits()
            | sys::mjDSBL_GRAVITY
            | sys::mjDSBL_ACTUATION) as i32;
        if *timestep > 0.0 {
            option.timestep = *timestep;
        }
        let steps = 2.0 * actuators.len() as f64 * options.inttotal / option.timestep;
        // If the number of steps is NaN, the compiler's loop terminates at once.
        if steps > MOST_STEPS_OF_A_TEXT || option.timestep <= 0.0 {
            return Err(format!("the lengthrange of the muscles needs {steps:e} steps; at most a million are allowed"));
        }
        let mut data = model.try_clone().and_then(Data::new).map_err(|error| error.to_string())?;
        for actuator in actuators {
            for sign in [-1.0, 1.0] {
                drive(&mut data, actuator, sign, options).map_err(|error| match error {
                    Error::Unstable(_) => format!(
                        "the simulation for the lengthrange of actuator {actuator} is unstable; set its lengthrange in the XML"
                    ),
                    error => error.to_string(),
                })?;
                // The compiler repeats the simulation, in which nothing handles such constraints.
                if cfg!(engine_since = "2.3.0") && data.warning(Warning::ConstraintFull).number > 0 {
                    let message =
                        "the memory in <size> is too small for the constraints in the simulation for a lengthrange";
                    return Err(message.to_owned());
                }
            }
        }
        Ok(())
    }
}
