//! Separate calls of the parts of the pipeline.
//!
//! [`Data::forward`] calls all parts in a valid order. A part that is called separately returns
//! [`Error::NotComputed`] unless its inputs have been computed for the present model. All results
//! that depend on the new results count as not computed afterwards.
//!
//! The crate tracks the order of the calls. It does not track writes to the arrays, such as `qpos`:
//! start again with [`kinematics`](Data::kinematics) after a change of positions.
//!
//! In a model with the option `sleep`, [`kinematics`](Data::kinematics),
//! [`inv_position`](Data::inv_position), `inverse` and [`make_constraint`](Data::make_constraint)
//! wake all bodies, because the engine does not wake those that the call needs. If one slept, all
//! earlier results count as not computed.
//!
//! Features of newer engines add inputs to some parts. Where the engine exports no function for a
//! computation between two parts, the parts that it would be missing from return
//! [`Error::Unsupported`]: see the second table.
//!
//! A method has the prefix `compute_` if the plain name belongs to a field or an element.
//!
//! | part | engine | computes | inputs |
//! |---|---|---|---|
//! | [`kinematics`](Data::kinematics) | `mj_kinematics` | poses | |
//! | [`com_pos`](Data::com_pos) | `mj_comPos` | centres of mass, `cinert`, `cdof`; vertices and edges of flexes (`mj_flex`) | `kinematics` |
//! | [`camlight`](Data::camlight) | `mj_camlight` | poses of cameras and lights | `com_pos` |
//! | [`compute_tendon`](Data::compute_tendon) | `mj_tendon` | lengths and Jacobians of tendons | `com_pos` |
//! | [`compute_crb`](Data::compute_crb) | `mj_crb`, newer engines `mj_makeM` | `crb`, the inertia matrix `qM` | `com_pos` |
//! | [`factor_m`](Data::factor_m) | `mj_factorM` | its factorisation | `compute_crb` |
//! | [`collision`](Data::collision) | `mj_collision` | contacts | `kinematics` |
//! | [`make_constraint`](Data::make_constraint) | `mj_makeConstraint` | the rows of the constraints | `compute_tendon`, `collision`; from 3.3 to 3.11 again after `factor_m` |
//! | [`transmission`](Data::transmission) | `mj_transmission` | lengths and moments of actuators | `compute_tendon` |
//! | [`project_constraint`](Data::project_constraint) | `mj_projectConstraint` | `efc_AR`, for PGS and the no-slip solver | `factor_m`, `make_constraint` |
//! | [`compute_ten_velocity`](Data::compute_ten_velocity) | | `ten_velocity` | `compute_tendon` |
//! | [`compute_actuator_velocity`](Data::compute_actuator_velocity) | | `actuator_velocity` | `transmission` |
//! | [`com_vel`](Data::com_vel) | `mj_comVel` | `cvel`, `cdof_dot` | `com_pos` |
//! | [`passive`](Data::passive) | `mj_passive` | `qfrc_passive` | `com_vel`, `compute_ten_velocity` |
//! | [`reference_constraint`](Data::reference_constraint) | `mj_referenceConstraint` | `efc_vel`, `efc_aref` | `make_constraint`; since 3.6 `com_vel` |
//! | [`compute_qfrc_bias`](Data::compute_qfrc_bias) | `mj_rne` | `qfrc_bias` | `com_vel` |
//! | [`fwd_actuation`](Data::fwd_actuation) | `mj_fwdActuation` | actuator forces, `act_dot` | `compute_actuator_velocity` |
//! | [`fwd_acceleration`](Data::fwd_acceleration) | `mj_fwdAcceleration` | `qacc_smooth` | `factor_m`, `passive`, `compute_qfrc_bias`, `fwd_actuation` |
//! | [`fwd_constraint`](Data::fwd_constraint) | `mj_fwdConstraint` | constraint forces, `qacc` | `project_constraint`, `reference_constraint`, `fwd_acceleration` |
//! | [`sensor_pos`](Data::sensor_pos), [`sensor_vel`](Data::sensor_vel), [`sensor_acc`](Data::sensor_acc) | `mj_sensorPos`, … | readings of the sensors of a stage | all parts of the stage |
//!
//! Exceptions for features of a model:
//!
//! | feature | further inputs | only in `fwd_position`, `fwd_velocity`, `forward`, `step` and their inverse counterparts |
//! |---|---|---|
//! | adhesion actuators | `transmission`: `make_constraint` | |
//! | adhesion of geoms or pairs | `passive`: `make_constraint` | |
//! | flexes | `collision`: `com_pos` | `passive` |
//! | `armature` of tendons, or of actuators on tendons | `compute_crb`: `compute_tendon` | `compute_qfrc_bias` |
//! | `actuatorgravcomp` | `fwd_actuation`: `passive` | |
//! | integrator `discrete` | | `collision`, `make_constraint`, `project_constraint`, `passive`, `reference_constraint`, `compute_qfrc_bias`, `fwd_acceleration`, `fwd_constraint`, `inv_constraint` |
//! | sensors `e_kinetic` | their readings count as not computed after `com_vel`: call `sensor_pos` again | |
//!
//! Jacobians such as [`jac_site`](Data::jac_site) need `com_pos`, the inertia matrix
//! [`full_m`](Data::full_m) the whole position stage.
//!
//! Not part of `forward`:
//!
//! | part | engine | computes | inputs |
//! |---|---|---|---|
//! | [`subtree_vel`](Data::subtree_vel) | `mj_subtreeVel` | `subtree_linvel`, `subtree_angmom` | `com_vel` |
//! | [`rne_post_constraint`](Data::rne_post_constraint) | `mj_rnePostConstraint` | `cacc`, `cfrc_int`, `cfrc_ext` | `com_vel`, `fwd_constraint` |
//!
//! [`fwd_position`](Data::fwd_position) and [`fwd_velocity`](Data::fwd_velocity) compute all parts
//! of their stages in one call.

use std::ffi::c_int;

use mujoco_sys::{self as sys, guard, mjSTAGE_NONE, mjSTAGE_POS, mjSTAGE_VEL};

use super::{Data, MissingResults, PipelineFlags, SensorUpdate, Stage};
use crate::error::{Error, Result};

type C = PipelineFlags;

/// Defines methods that make one engine call each, from the results of the call, and from its
/// inputs if they differ from [`PipelineFlags::inputs`].
macro_rules! parts {
    (@inputs $results:expr) => { $results.inputs() };
    (@inputs $results:expr, $inputs:expr) => { $inputs };
    ($($(#[$doc:meta])* $method:ident = $function:ident($alias:literal) computes $results:expr $(, reads $inputs:expr)?;)*) => {
        /// # Parts of a step
        impl Data {$(
            $(#[$doc])*
            ///
            /// # Errors
            ///
            /// [`Error::NotComputed`] if the inputs have not been computed, [`Error::Unsupported`]
            /// if the engine computes the part only in whole stages for this model (see
            /// [`pipeline`](crate::data::pipeline)), [`Error::Unstable`] if a position, velocity or
            /// control is NaN or beyond ±10¹⁰, [`Error::Engine`] if the engine fails,
            /// [`Error::Poisoned`] after such a failure.
            #[doc(alias = $alias)]
            pub fn $method(&mut self) -> Result<()> {
                const RESULTS: PipelineFlags = $results;
                const INPUTS: PipelineFlags = parts!(@inputs RESULTS $(, $inputs)?);
                self.check_is_single(stringify!($method), RESULTS)?;
                self.wake_before(RESULTS);
                self.check_inputs_of(stringify!($method), INPUTS, RESULTS)?;
                self.clear_stale_inputs(RESULTS);
                self.run($alias, self.after(RESULTS), |m, d| {
                    // SAFETY: `run` passes a model and a data of this model. The inputs of the
                    // function have been computed for this model, so their counts and addresses
                    // match the arrays.
                    unsafe { guard::$function(m, d) }
                })
            }
        )*}
    };
}

parts! {
    /// Computes poses of bodies, joints, geoms and sites, from `qpos` and the poses of mocap
    /// bodies. Normalises the quaternions in `qpos`.
    #[doc(alias = "forward kinematics")]
    kinematics = mj_kinematics("mj_kinematics")
        computes C::KINEMATICS.union(C::CURRENT);
    /// Computes centres of mass of subtrees, inertias `cinert` about them, and motion axes `cdof`.
    /// Also computes the vertices and edges of flexes.
    com_pos = mj_com_pos("mj_comPos")
        computes C::COM_POS;
    /// Computes poses of cameras and lights.
    camlight = mj_camlight("mj_camlight")
        computes C::CAMLIGHT;
    /// Computes paths, lengths and Jacobians of tendons.
    compute_tendon = mj_tendon("mj_tendon")
        computes C::TENDON;
    /// Computes the inertia matrix `qM` by the composite rigid body algorithm (Featherstone, Rigid
    /// Body Dynamics Algorithms, chapter 6), with the armature of tendons.
    compute_crb = mj_crb("mj_crb")
        computes C::CRB;
    /// Computes the factorisation `LᵀDL` of the inertia matrix (Featherstone, chapter 8.5).
    factor_m = mj_factor_m("mj_factorM")
        computes C::FACTOR_M;
    /// Detects collisions and creates the contacts. The constraint rows of earlier contacts count
    /// as not computed.
    collision = mj_collision("mj_collision")
        computes C::COLLISION;
    /// Creates the rows of all active constraints: equalities, friction, limits, contacts.
    make_constraint = mj_make_constraint("mj_makeConstraint")
        computes C::CONSTRAINT;
    /// Computes lengths and moments of actuators.
    transmission = mj_transmission("mj_transmission")
        computes C::TRANSMISSION;
    /// Computes the matrix `efc_AR` of the dual problem, for PGS and the no-slip solver. Does
    /// nothing for the other solvers.
    project_constraint = mj_project_constraint("mj_projectConstraint")
        computes C::PROJECTION;
    /// Computes velocities `cvel` of bodies, and time derivatives `cdof_dot` of the motion axes.
    com_vel = mj_com_vel("mj_comVel")
        computes C::COM_VEL;
    /// Computes the forces of springs, dampers and the medium, `qfrc_passive`.
    passive = mj_passive("mj_passive")
        computes C::PASSIVE;
    /// Computes velocities `efc_vel` and reference accelerations `efc_aref` of the constraints.
    reference_constraint = mj_reference_constraint("mj_referenceConstraint")
        computes C::REFERENCE;
    /// Computes linear velocities and angular momenta of subtrees, `subtree_linvel` and
    /// `subtree_angmom`.
    subtree_vel = mj_subtree_vel("mj_subtreeVel")
        computes C::SUBTREE_VEL;

    /// Computes all quantities that depend on positions.
    fwd_position = mj_fwd_position("mj_fwdPosition")
        computes C::POSITION.union(C::PROJECTION).union(C::CURRENT);
    /// Computes all quantities that depend on velocities.
    fwd_velocity = mj_fwd_velocity("mj_fwdVelocity")
        computes C::VELOCITY.difference(C::POSITION);
    /// Computes actuator forces, and the time derivatives of activations, from `ctrl` and `act`.
    fwd_actuation = mj_fwd_actuation("mj_fwdActuation")
        computes C::ACTUATION;
    /// Sums all forces except constraint forces in `qfrc_smooth`, and solves for the accelerations
    /// `qacc_smooth` with the factorised inertia matrix.
    fwd_acceleration = mj_fwd_acceleration("mj_fwdAcceleration")
        computes C::ACCELERATION;
    /// Solves for the constraint forces: `efc_force`, `qfrc_constraint`, `qacc`.
    fwd_constraint = mj_fwd_constraint("mj_fwdConstraint")
        computes C::SOLVER_COST.union(C::SOLVED);

    /// Computes the position-dependent inputs of inverse dynamics:
    /// [`fwd_position`](Self::fwd_position) without the projection.
    inv_position = mj_inv_position("mj_invPosition")
        computes C::POSITION.union(C::CURRENT);
    /// Computes the velocity-dependent inputs of inverse dynamics.
    inv_velocity = mj_inv_velocity("mj_invVelocity")
        computes C::VELOCITY.difference(C::POSITION);
    /// Computes the constraint forces for the accelerations in `qacc`.
    inv_constraint = mj_inv_constraint("mj_invConstraint")
        computes C::SOLVED, reads C::REFERENCE;
    /// Compares forward with inverse dynamics. Writes the norms of the differences of constraint
    /// forces and of applied forces to `solver_fwdinv`.
    compare_fwd_inv = mj_compare_fwd_inv("mj_compareFwdInv")
        computes C::empty(), reads C::FORCES.union(C::ACTUATION);

    /// Evaluates the sensors of the position stage, including the sensors of the kinetic energy.
    sensor_pos = mj_sensor_pos("mj_sensorPos")
        computes C::SENSOR_POS;
    /// Evaluates the sensors of the velocity stage.
    sensor_vel = mj_sensor_vel("mj_sensorVel")
        computes C::SENSOR_VEL;
    /// Evaluates the sensors of the acceleration stage.
    sensor_acc = mj_sensor_acc("mj_sensorAcc")
        computes C::SENSOR_ACC;
    /// Computes the potential energy. Sets it to zero unless
    /// [`EnableFlags::ENERGY`](crate::model::EnableFlags::ENERGY) is set.
    energy_pos = mj_energy_pos("mj_energyPos")
        computes C::empty(), reads C::TENDON.union(C::CURRENT);
    /// Computes the kinetic energy. Leaves it unchanged unless
    /// [`EnableFlags::ENERGY`](crate::model::EnableFlags::ENERGY) is set.
    energy_vel = mj_energy_vel("mj_energyVel")
        computes C::empty(), reads C::CRB.union(C::CURRENT);
    /// Computes accelerations `cacc` of bodies and the forces on them, `cfrc_int` and `cfrc_ext`,
    /// constraints included.
    rne_post_constraint = mj_rne_post_constraint("mj_rnePostConstraint")
        computes C::POST_CONSTRAINT;
}

/// # Partial steps and integrators
impl Data {
    /// Computes velocities of tendons, `ten_velocity`. The engine has no separate function; its
    /// [`fwd_velocity`](Self::fwd_velocity) includes this part.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    pub fn compute_ten_velocity(&mut self) -> Result<()> {
        self.check_inputs_of("compute_ten_velocity", C::TENDON_VELOCITY.inputs(), C::TENDON_VELOCITY)?;
        let nv = self.model().nv();
        for tendon in 0..self.model().ntendon() {
            let row = self.tendon_row(tendon);
            let velocity = if row.columns.is_some() {
                row.iter().fold(0.0, |sum, (dof, value)| sum + value * self.qvel()[dof])
            } else {
                // SAFETY: the dense row and the velocity have nv elements each.
                unsafe { sys::mju_dot(row.values.as_ptr(), self.qvel().as_ptr(), nv as c_int) }
            };
            self.ten_velocity_mut()[tendon] = velocity;
        }
        self.computed = self.after(C::TENDON_VELOCITY);
        Ok(())
    }

    /// Computes velocities of actuators, `actuator_velocity`. With newer engines they are zero if
    /// actuation is disabled. The engine has no separate function; its
    /// [`fwd_velocity`](Self::fwd_velocity) includes this part.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    pub fn compute_actuator_velocity(&mut self) -> Result<()> {
        self.check_inputs_of("compute_actuator_velocity", C::ACTUATOR_VELOCITY.inputs(), C::ACTUATOR_VELOCITY)?;
        // SAFETY: the model of this data, whose transmission was computed.
        unsafe { sys::adapted::actuator_velocity(self.model().as_ptr(), self.as_mut_ptr()) };
        self.computed = self.after(C::ACTUATOR_VELOCITY);
        Ok(())
    }

    /// Computes Coriolis, centrifugal and gravitational forces, `qfrc_bias`, by the recursive
    /// Newton–Euler algorithm without accelerations.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    #[doc(alias = "mj_rne")]
    pub fn compute_qfrc_bias(&mut self) -> Result<()> {
        self.check_is_single("compute_qfrc_bias", C::BIAS)?;
        self.check_inputs_of("compute_qfrc_bias", C::BIAS.inputs(), C::BIAS)?;
        self.run("mj_rne", self.after(C::BIAS), |m, d| {
            // SAFETY: as for the other parts; the result is an array of this data with nv elements.
            unsafe { guard::mj_rne(m, d, 0, (*d).qfrc_bias) }
        })
    }

    /// Computes forward dynamics like [`forward`](Self::forward), but reuses the results of earlier
    /// calls for the stages up to `skip`. [`Stage::Acceleration`] has the effect of
    /// [`Stage::Velocity`].
    ///
    /// # Errors
    ///
    /// As for [`forward`](Self::forward), and [`Error::NotComputed`] if the skipped stages have not
    /// been computed.
    #[doc(alias = "mj_forwardSkip")]
    pub fn forward_skip(&mut self, skip: Stage, sensors: SensorUpdate) -> Result<()> {
        let (stage, needs) = match skip {
            Stage::None => (mjSTAGE_NONE, C::empty()),
            Stage::Position => (mjSTAGE_POS, C::POSITION | C::PROJECTION | C::CURRENT),
            Stage::Velocity | Stage::Acceleration => (mjSTAGE_VEL, C::FIRST_HALF),
        };
        self.check_parts("forward_skip", needs)?;
        self.check_inputs()?;
        let results = C::FORWARD | self.computed.sensors_after(skip, sensors, self.model().features());
        self.run("mj_forwardSkip", results, |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_forward_skip(m, d, stage as c_int, (sensors == SensorUpdate::Skip).into()) }
        })
    }

    /// Computes inverse dynamics like [`inverse`](Self::inverse), but reuses the results of earlier
    /// calls for the stages up to `skip`. [`Stage::Acceleration`] has the effect of
    /// [`Stage::Velocity`].
    ///
    /// # Errors
    ///
    /// As for [`inverse`](Self::inverse), and [`Error::NotComputed`] if the skipped stages have not
    /// been computed.
    #[doc(alias = "mj_inverseSkip")]
    pub fn inverse_skip(&mut self, skip: Stage, sensors: SensorUpdate) -> Result<()> {
        let (stage, needs, results) = match skip {
            Stage::None => (mjSTAGE_NONE, C::empty(), C::VELOCITY | C::SOLVED | C::CURRENT),
            Stage::Position => (mjSTAGE_POS, C::POSITION | C::CURRENT, (C::VELOCITY | C::SOLVED) - C::POSITION),
            Stage::Velocity | Stage::Acceleration => (mjSTAGE_VEL, C::VELOCITY | C::CURRENT, C::SOLVED),
        };
        self.wake_before(results);
        self.check_parts("inverse_skip", needs)?;
        self.check_inputs()?;
        self.clear_stale_inputs(results);
        let computes =
            (self.after(results) - C::SENSORS) | self.computed.sensors_after(skip, sensors, self.model().features());
        self.run("mj_inverseSkip", computes, |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_inverse_skip(m, d, stage as c_int, (sensors == SensorUpdate::Skip).into()) }
        })
    }

    /// Advances state and time by an Euler step, semi-implicit in velocity, with the computed
    /// accelerations.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics). The state must not have
    /// been advanced since the accelerations were computed.
    #[doc(alias = "mj_Euler")]
    pub fn euler(&mut self) -> Result<()> {
        let needs = C::CRB | C::ACTUATION | C::ACCELERATION | C::FORCE | C::CURRENT;
        // The step evaluates delayed sensors of any stage, and all quantities that depend on
        // velocities if bodies fall asleep.
        let needs = if self.model().history_len() > 0 || self.model().has_sleep() { needs | C::FORWARD } else { needs };
        self.check_parts("euler", needs)?;
        self.check_inputs()?;
        self.run("mj_Euler", self.computed - C::CURRENT, |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_euler(m, d) }
        })
    }

    /// Advances state and time by a Runge–Kutta step of fourth order, whose first evaluation is a
    /// preceding [`forward`](Self::forward). (The engine has no other order.)
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics). The state must not have
    /// been advanced since `forward`.
    #[doc(alias = "mj_RungeKutta")]
    pub fn runge_kutta(&mut self) -> Result<()> {
        self.check_parts("runge_kutta", C::FORWARD)?;
        self.check_inputs()?;
        // The step does not evaluate sensors.
        let computes = (C::FORWARD - C::CURRENT) | (self.computed & C::SENSORS);
        self.run("mj_RungeKutta", computes, |m, d| {
            // SAFETY: as for the other parts, and the engine has a step of order 4.
            unsafe { guard::mj_runge_kutta(m, d, 4) }
        })
    }

    /// Returns an error if the engine computes these results only in whole stages for this model.
    fn check_is_single(&self, call: &'static str, results: PipelineFlags) -> Result<()> {
        let Some(feature) = results.only_in_stages(self.model().features()) else { return Ok(()) };
        Err(Error::Unsupported(format!(
            "{call} of a model with {feature}, for which the engine computes this part only together with others: call fwd_position and \
             fwd_velocity, forward or step"
        )))
    }

    /// Returns an error unless the inputs of a call that computes `results` are valid: `reads`, and
    /// those that depend on features of the model.
    fn check_inputs_of(&self, call: &'static str, reads: PipelineFlags, results: PipelineFlags) -> Result<()> {
        self.check_parts(call, reads | results.feature_inputs(self.model().features()))?;
        self.check_inputs()
    }

    /// Returns an error if parts of the pipeline that `call` needs have not been computed.
    #[inline]
    pub(crate) fn check_parts(&self, call: &'static str, needs: PipelineFlags) -> Result<()> {
        self.check_usable()?;
        let missing = needs - self.computed;
        if missing.is_empty() {
            Ok(())
        } else {
            Err(Error::NotComputed { call, missing: MissingResults::parts(missing) })
        }
    }

    /// Returns the readings of all sensors, which belong to the state before the last step, if
    /// there was one since.
    pub(crate) fn readings(&self, call: &'static str) -> Result<&[f64]> {
        self.check_parts(call, PipelineFlags::SENSORS)?;
        self.check_sensors_enabled()?;
        Ok(self.sensordata())
    }

    /// Returns `true` if the results have been computed for the present state: it has not been
    /// advanced since.
    #[cfg(feature = "mcap")]
    pub(crate) fn has_present_results(&self) -> bool {
        self.computed.contains(PipelineFlags::CURRENT)
    }

    /// Returns the readings of all sensors in the present state.
    pub(crate) fn present_readings(&self, call: &'static str) -> Result<&[f64]> {
        if self.computed.contains(PipelineFlags::CURRENT) {
            self.readings(call)
        } else {
            Err(Error::NotComputed { call, missing: MissingResults::SENSORS })
        }
    }

    /// Returns an error if the options of the model disable sensors.
    pub(crate) fn check_sensors_enabled(&self) -> Result<()> {
        if self.model().raw().opt.disableflags & sys::mjDSBL_SENSOR as i32 == 0 {
            return Ok(());
        }
        Err(Error::Unsupported("readings of sensors, which the options of the model disable".to_owned()))
    }

    /// Returns the valid results after a call that computes `results`.
    pub(super) fn after(&self, results: PipelineFlags) -> PipelineFlags {
        self.computed.after(results, self.model().features())
    }

    /// Clears contacts and rows of earlier calls that the computation of `results` would read.
    fn clear_stale_inputs(&mut self, results: PipelineFlags) {
        if results.contains(C::POSITION) && !results.contains(C::PROJECTION) {
            self.clear_stale_contacts();
        }
        if results == C::CONSTRAINT {
            self.clear_contact_rows();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::PipelineFlags;

    fn code_in(text: &str) -> impl Iterator<Item = &str> {
        text.split('`').skip(1).step_by(2)
    }

    #[test]
    fn documented_inputs_are_those_of_the_table() {
        let mut methods: BTreeSet<&str> = PipelineFlags::all().methods().collect();
        for row in include_str!("pipeline.rs").lines().filter_map(|line| line.strip_prefix("//! | [`")) {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let method = row.split('`').next().unwrap();
            // The sensors of all stages have one row.
            if method == "sensor_pos" {
                continue;
            }
            assert!(methods.remove(method), "{method}");
            let (inputs, newer) = cells[3].split_once("; since 3.6").unwrap_or((cells[3], ""));
            let inputs = inputs.split(';').next().unwrap();
            let newer = if cfg!(engine_since = "3.6.0") { newer } else { "" };
            let documented: BTreeSet<&str> = code_in(inputs).chain(code_in(newer)).collect();
            assert_eq!(documented, PipelineFlags::of_method(method).inputs().methods().collect(), "{method}");
        }
        assert_eq!(methods, BTreeSet::from(["sensor_acc", "sensor_pos", "sensor_vel"]));
    }
}
