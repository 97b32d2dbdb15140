//! The parts of the pipeline, called one by one.
//!
//! [`Data::forward`] calls all of them in a valid order. A part that is called alone returns [`Error::NotComputed`] unless its
//! inputs have been computed for the present model. All results that depend on its own count as not computed afterwards.
//!
//! The crate tracks the order of the calls. It does not track numbers that a program writes, such as `qpos`: start again with
//! [`kinematics`](Data::kinematics) after a change of positions.
//!
//! A method has the prefix `compute_` if a field or an element has its plain name.
//!
//! | part | engine | computes | reads the results of |
//! |---|---|---|---|
//! | [`kinematics`](Data::kinematics) | `mj_kinematics` | poses | |
//! | [`com_pos`](Data::com_pos) | `mj_comPos` | centres of mass, `cinert`, `cdof` | `kinematics` |
//! | [`camlight`](Data::camlight) | `mj_camlight` | poses of cameras and lights | `com_pos` |
//! | [`compute_tendon`](Data::compute_tendon) | `mj_tendon` | lengths and Jacobians of tendons | `com_pos` |
//! | [`compute_crb`](Data::compute_crb) | `mj_crb` | `crb`, the inertia matrix `qM` | `com_pos` |
//! | [`factor_m`](Data::factor_m) | `mj_factorM` | its factorisation | `compute_crb` |
//! | [`collision`](Data::collision) | `mj_collision` | contacts | `kinematics` |
//! | [`make_constraint`](Data::make_constraint) | `mj_makeConstraint` | the rows of the constraints | `compute_tendon`, `collision` |
//! | [`transmission`](Data::transmission) | `mj_transmission` | lengths and moments of actuators | `compute_tendon`; `make_constraint` where an actuator is of adhesion |
//! | [`project_constraint`](Data::project_constraint) | `mj_projectConstraint` | `efc_AR`, for PGS and the no-slip solver | `factor_m`, `make_constraint` |
//! | [`compute_ten_velocity`](Data::compute_ten_velocity) | | `ten_velocity` | `compute_tendon` |
//! | [`compute_actuator_velocity`](Data::compute_actuator_velocity) | | `actuator_velocity` | `transmission` |
//! | [`com_vel`](Data::com_vel) | `mj_comVel` | `cvel`, `cdof_dot` | `com_pos` |
//! | [`passive`](Data::passive) | `mj_passive` | `qfrc_passive` | `com_vel`, `compute_ten_velocity` |
//! | [`reference_constraint`](Data::reference_constraint) | `mj_referenceConstraint` | `efc_vel`, `efc_aref` | `make_constraint` |
//! | [`compute_qfrc_bias`](Data::compute_qfrc_bias) | `mj_rne` | `qfrc_bias` | `com_vel` |
//! | [`fwd_actuation`](Data::fwd_actuation) | `mj_fwdActuation` | actuator forces, `act_dot` | `compute_actuator_velocity` |
//! | [`fwd_acceleration`](Data::fwd_acceleration) | `mj_fwdAcceleration` | `qacc_smooth` | `factor_m`, `passive`, `compute_qfrc_bias`, `fwd_actuation` |
//! | [`fwd_constraint`](Data::fwd_constraint) | `mj_fwdConstraint` | constraint forces, `qacc` | `project_constraint`, `reference_constraint`, `fwd_acceleration` |
//! | [`sensor_pos`](Data::sensor_pos), [`sensor_vel`](Data::sensor_vel), [`sensor_acc`](Data::sensor_acc) | `mj_sensorPos`, … | readings of the sensors of a stage | all of the stage |
//!
//! Not part of `forward`:
//!
//! | part | engine | computes | reads the results of |
//! |---|---|---|---|
//! | [`subtree_vel`](Data::subtree_vel) | `mj_subtreeVel` | `subtree_linvel`, `subtree_angmom` | `com_vel` |
//! | [`rne_post_constraint`](Data::rne_post_constraint) | `mj_rnePostConstraint` | `cacc`, `cfrc_int`, `cfrc_ext` | `com_vel`, `fwd_constraint` |
//!
//! Positions in one call are [`fwd_position`](Data::fwd_position), velocities [`fwd_velocity`](Data::fwd_velocity).

use std::ffi::c_int;

use mujoco_sys::{self as sys, guard, mjSTAGE_NONE, mjSTAGE_POS, mjSTAGE_VEL};

use super::{Computed, Data, Needs, Stage};
use crate::error::{Error, Result};

type C = Computed;

/// Methods that are one call of the engine: what it reads, and what it computes.
macro_rules! parts {
    ($($(#[$doc:meta])* $method:ident = $function:ident($alias:literal) reads $reads:expr, computes $gives:expr;)*) => {
        impl Data {$(
            $(#[$doc])*
            ///
            /// # Errors
            ///
            /// [`Error::NotComputed`] if what it reads has not been computed, [`Error::Unstable`] if a position, velocity or
            /// control is not a number or huge, [`Error::Engine`] if the engine fails, [`Error::Poisoned`] after such a failure.
            #[doc(alias = $alias)]
            pub fn $method(&mut self) -> Result<()> {
                const READS: Computed = $reads;
                const GIVES: Computed = $gives;
                self.check_parts(stringify!($method), READS)?;
                self.check_inputs()?;
                self.prepare(GIVES);
                self.run($alias, self.after(GIVES), |m, d| {
                    // SAFETY: `run` passes a model and a data that go together, and what the function reads of what others
                    // compute has been computed for this model, so that its counts and addresses are those of its arrays.
                    unsafe { guard::$function(m, d) }
                })
            }
        )*}
    };
}

parts! {
    /// Poses of bodies, joints, geoms and sites, from `qpos` and the poses of mocap bodies. Normalises the quaternions in
    /// `qpos`.
    kinematics = mj_kinematics("mj_kinematics")
        reads C::empty(), computes C::KINEMATICS.union(C::CURRENT);
    /// Centres of mass of subtrees, inertias `cinert` about them, motion axes `cdof`.
    com_pos = mj_com_pos("mj_comPos")
        reads C::KINEMATICS, computes C::COM_POS;
    /// Poses of cameras and lights.
    camlight = mj_camlight("mj_camlight")
        reads C::COM_POS, computes C::CAMLIGHT;
    /// Paths, lengths and Jacobians of tendons.
    compute_tendon = mj_tendon("mj_tendon")
        reads C::COM_POS, computes C::TENDON;
    /// The inertia matrix `qM`, by the composite rigid body algorithm (Featherstone, Rigid Body Dynamics Algorithms, chapter 6).
    compute_crb = mj_crb("mj_crb")
        reads C::COM_POS, computes C::CRB;
    /// The factorisation `LᵀDL` of the inertia matrix (Featherstone, chapter 8.5).
    factor_m = mj_factor_m("mj_factorM")
        reads C::CRB, computes C::FACTOR_M;
    /// Finds the contacts. The rows of the contacts before count as not computed.
    collision = mj_collision("mj_collision")
        reads C::KINEMATICS, computes C::COLLISION;
    /// The rows of all active constraints: equalities, friction, limits, contacts.
    make_constraint = mj_make_constraint("mj_makeConstraint")
        reads C::TENDON.union(C::COLLISION), computes C::CONSTRAINT;
    /// The matrix `efc_AR`, which PGS and the no-slip solver work on; nothing with the other solvers.
    project_constraint = mj_project_constraint("mj_projectConstraint")
        reads C::FACTOR_M.union(C::CONSTRAINT), computes C::PROJECTION;
    /// Velocities `cvel` of bodies, and how the motion axes change, `cdof_dot`.
    com_vel = mj_com_vel("mj_comVel")
        reads C::COM_POS.union(C::CURRENT), computes C::COM_VEL;
    /// Forces of springs, dampers and the medium, `qfrc_passive`.
    passive = mj_passive("mj_passive")
        reads C::COM_VEL.union(C::TENDON_VELOCITY).union(C::CURRENT), computes C::PASSIVE;
    /// Velocities `efc_vel` and reference accelerations `efc_aref` of the constraints.
    reference_constraint = mj_reference_constraint("mj_referenceConstraint")
        reads C::CONSTRAINT.union(C::CURRENT), computes C::REFERENCE;
    /// Linear velocities and angular momenta of subtrees, `subtree_linvel` and `subtree_angmom`.
    subtree_vel = mj_subtree_vel("mj_subtreeVel")
        reads C::COM_VEL, computes C::SUBTREE_VEL;

    /// Everything that depends on positions.
    fwd_position = mj_fwd_position("mj_fwdPosition")
        reads C::empty(), computes C::POSITION.union(C::PROJECTION).union(C::CURRENT);
    /// Everything that depends on velocities.
    fwd_velocity = mj_fwd_velocity("mj_fwdVelocity")
        reads C::TRANSMISSION.union(C::CONSTRAINT).union(C::CURRENT), computes C::VELOCITY.difference(C::POSITION);
    /// Actuator forces, and the time derivatives of activations, from `ctrl` and `act`.
    fwd_actuation = mj_fwd_actuation("mj_fwdActuation")
        reads C::ACTUATOR_VELOCITY.union(C::CURRENT), computes C::ACTUATION;
    /// Sums all forces but those of constraints, and divides them by the inertia matrix: `qfrc_smooth`, `qacc_smooth`.
    fwd_acceleration = mj_fwd_acceleration("mj_fwdAcceleration")
        reads C::FACTOR_M.union(C::PASSIVE).union(C::BIAS).union(C::ACTUATION), computes C::ACCELERATION;
    /// Solves for the constraint forces: `efc_force`, `qfrc_constraint`, `qacc`.
    fwd_constraint = mj_fwd_constraint("mj_fwdConstraint")
        reads C::PROJECTION.union(C::REFERENCE).union(C::ACCELERATION), computes C::FORCE;

    /// Everything that inverse dynamics needs of positions: [`fwd_position`](Self::fwd_position) without the projection.
    inv_position = mj_inv_position("mj_invPosition")
        reads C::empty(), computes C::POSITION.union(C::CURRENT);
    /// Everything that inverse dynamics needs of velocities.
    inv_velocity = mj_inv_velocity("mj_invVelocity")
        reads C::TRANSMISSION.union(C::CONSTRAINT).union(C::CURRENT), computes C::VELOCITY.difference(C::POSITION);
    /// The constraint forces that belong to the accelerations in `qacc`.
    inv_constraint = mj_inv_constraint("mj_invConstraint")
        reads C::REFERENCE, computes C::FORCE;
    /// Compares forward with inverse dynamics: norms of the differences, of constraint forces and of applied forces, in
    /// `solver_fwdinv`.
    compare_fwd_inv = mj_compare_fwd_inv("mj_compareFwdInv")
        reads C::FORCES.union(C::ACTUATION), computes C::empty();

    /// The sensors of positions.
    sensor_pos = mj_sensor_pos("mj_sensorPos")
        reads C::POSITION.union(C::CURRENT), computes C::SENSOR_POS;
    /// The sensors of velocities.
    sensor_vel = mj_sensor_vel("mj_sensorVel")
        reads C::VELOCITY.union(C::CURRENT), computes C::SENSOR_VEL;
    /// The sensors of accelerations and forces.
    sensor_acc = mj_sensor_acc("mj_sensorAcc")
        reads C::FORCES, computes C::SENSOR_ACC;
    /// The potential energy. Zero unless [`EnableFlags::ENERGY`](crate::EnableFlags::ENERGY) is set.
    energy_pos = mj_energy_pos("mj_energyPos")
        reads C::TENDON.union(C::CURRENT), computes C::empty();
    /// The kinetic energy. Not touched unless [`EnableFlags::ENERGY`](crate::EnableFlags::ENERGY) is set.
    energy_vel = mj_energy_vel("mj_energyVel")
        reads C::CRB.union(C::CURRENT), computes C::empty();
    /// Accelerations `cacc` of bodies, and the forces on them, `cfrc_int` and `cfrc_ext`, constraints included.
    rne_post_constraint = mj_rne_post_constraint("mj_rnePostConstraint")
        reads C::COM_VEL.union(C::FORCE), computes C::POST_CONSTRAINT;
}

impl Data {
    /// Lengths and moments of actuators.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    #[doc(alias = "mj_transmission")]
    pub fn transmission(&mut self) -> Result<()> {
        // Adhesion acts through the constraints of contacts.
        let needs = if self.model().has_adhesion() { C::TENDON | C::CONSTRAINT } else { C::TENDON };
        self.check_parts("transmission", needs)?;
        self.check_inputs()?;
        self.run("mj_transmission", self.after(C::TRANSMISSION), |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_transmission(m, d) }
        })
    }

    /// Velocities of tendons, `ten_velocity`. The engine has no function for it alone; it is in
    /// [`fwd_velocity`](Self::fwd_velocity).
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    pub fn compute_ten_velocity(&mut self) -> Result<()> {
        self.check_parts("compute_ten_velocity", C::TENDON | C::CURRENT)?;
        self.check_inputs()?;
        let nv = self.model().nv();
        let sparse = self.model().is_sparse();
        for tendon in 0..self.model().ntendon() {
            let velocity = if sparse {
                let start = self.ten_J_rowadr()[tendon] as usize;
                let row = start..start + self.ten_J_rownnz()[tendon] as usize;
                let dofs = &self.ten_J_colind()[row.clone()];
                let products = self.ten_J().as_slice()[row]
                    .iter()
                    .zip(dofs)
                    .map(|(value, &dof)| value * self.qvel()[dof as usize]);
                products.fold(0.0, |sum, product| sum + product)
            } else {
                // SAFETY: the row and the velocity have nv numbers each.
                unsafe { sys::mju_dot(self.ten_J().row(tendon).as_ptr(), self.qvel().as_ptr(), nv as c_int) }
            };
            self.ten_velocity_mut()[tendon] = velocity;
        }
        self.computed = self.after(C::TENDON_VELOCITY);
        Ok(())
    }

    /// Velocities of actuators, `actuator_velocity`. The engine has no function for it alone; it is in
    /// [`fwd_velocity`](Self::fwd_velocity).
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    pub fn compute_actuator_velocity(&mut self) -> Result<()> {
        self.check_parts("compute_actuator_velocity", C::TRANSMISSION | C::CURRENT)?;
        self.check_inputs()?;
        let (nu, nv) = (self.model().nu() as c_int, self.model().nv() as c_int);
        let raw = self.raw();
        // SAFETY: the engine's own arrays: nu numbers, nu × nv, nv.
        unsafe { sys::mju_mulMatVec(raw.actuator_velocity, raw.actuator_moment, raw.qvel, nu, nv) };
        self.computed = self.after(C::ACTUATOR_VELOCITY);
        Ok(())
    }

    /// Forces of Coriolis, centrifuge and gravity, `qfrc_bias`: the recursive Newton–Euler algorithm without accelerations.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics).
    #[doc(alias = "mj_rne")]
    pub fn compute_qfrc_bias(&mut self) -> Result<()> {
        self.check_parts("compute_qfrc_bias", C::COM_VEL | C::CURRENT)?;
        self.check_inputs()?;
        self.run("mj_rne", self.after(C::BIAS), |m, d| {
            // SAFETY: as for the other parts; the result is the engine's own array of nv numbers.
            unsafe { guard::mj_rne(m, d, 0, (*d).qfrc_bias) }
        })
    }

    /// As [`forward`](Self::forward), but takes what depends on positions
    /// ([`Stage::Position`]), or on velocities too ([`Stage::Velocity`]), from the calls before. [`Stage::Acceleration`] skips as
    /// much as [`Stage::Velocity`].
    ///
    /// # Errors
    ///
    /// As for [`forward`](Self::forward), and [`Error::NotComputed`] if what is skipped has not been computed.
    #[doc(alias = "mj_forwardSkip")]
    pub fn forward_skip(&mut self, skip: Stage, skip_sensors: bool) -> Result<()> {
        let (stage, needs) = match skip {
            Stage::Nothing => (mjSTAGE_NONE, C::empty()),
            Stage::Position => (mjSTAGE_POS, C::POSITION | C::PROJECTION | C::CURRENT),
            Stage::Velocity | Stage::Acceleration => (mjSTAGE_VEL, C::FIRST_HALF),
        };
        self.check_parts("forward_skip", needs)?;
        self.check_inputs()?;
        let sensors = self.computed.sensors_after(skip, skip_sensors);
        self.run("mj_forwardSkip", C::FORWARD | sensors, |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_forward_skip(m, d, stage as c_int, skip_sensors.into()) }
        })
    }

    /// As [`inverse`](Self::inverse), but takes what depends on positions ([`Stage::Position`]), or on velocities too
    /// ([`Stage::Velocity`]), from the calls before. [`Stage::Acceleration`] skips as much as [`Stage::Velocity`].
    ///
    /// # Errors
    ///
    /// As for [`inverse`](Self::inverse), and [`Error::NotComputed`] if what is skipped has not been computed.
    #[doc(alias = "mj_inverseSkip")]
    pub fn inverse_skip(&mut self, skip: Stage, skip_sensors: bool) -> Result<()> {
        let (stage, needs, gives) = match skip {
            Stage::Nothing => (mjSTAGE_NONE, C::empty(), C::FORCES | C::CURRENT),
            Stage::Position => (mjSTAGE_POS, C::POSITION | C::CURRENT, C::FORCES - C::POSITION),
            Stage::Velocity | Stage::Acceleration => (mjSTAGE_VEL, C::VELOCITY | C::CURRENT, C::FORCE),
        };
        self.check_parts("inverse_skip", needs)?;
        self.check_inputs()?;
        self.prepare(gives);
        let computes = (self.after(gives) - C::SENSORS) | self.computed.sensors_after(skip, skip_sensors);
        self.run("mj_inverseSkip", computes, |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_inverse_skip(m, d, stage as c_int, skip_sensors.into()) }
        })
    }

    /// Advances state and time by an Euler step, semi-implicit in velocity, along the accelerations that were computed.
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics). The state must not have been advanced since.
    #[doc(alias = "mj_Euler")]
    pub fn euler(&mut self) -> Result<()> {
        self.check_parts("euler", C::CRB | C::ACTUATION | C::ACCELERATION | C::FORCE | C::CURRENT)?;
        self.check_inputs()?;
        self.run("mj_Euler", self.computed - C::CURRENT, |m, d| {
            // SAFETY: as for the other parts.
            unsafe { guard::mj_euler(m, d) }
        })
    }

    /// Advances state and time by a Runge–Kutta step of the fourth order, of which [`forward`](Self::forward) was the first
    /// evaluation. (The engine has no other order.)
    ///
    /// # Errors
    ///
    /// As for the other parts, such as [`kinematics`](Self::kinematics). The state must not have been advanced since.
    #[doc(alias = "mj_RungeKutta")]
    pub fn runge_kutta(&mut self) -> Result<()> {
        self.check_parts("runge_kutta", C::FORWARD)?;
        self.check_inputs()?;
        // It reads no sensors.
        let computes = (C::FORWARD - C::CURRENT) | (self.computed & C::SENSORS);
        self.run("mj_RungeKutta", computes, |m, d| {
            // SAFETY: as for the other parts, and the order is the one that there is.
            unsafe { guard::mj_runge_kutta(m, d, 4) }
        })
    }

    /// Refuses positions, velocities and controls that the engine would reset or replace.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] if one is not a number or beyond ±10¹⁰.
    #[doc(alias = "mj_checkPos")]
    #[doc(alias = "mj_checkVel")]
    pub fn check_state(&self) -> Result<()> {
        self.check_inputs()
    }

    /// Rejects a call that needs results that have not been computed.
    #[inline]
    pub(crate) fn check_parts(&self, call: &'static str, needs: Computed) -> Result<()> {
        self.check_usable()?;
        let missing = needs - self.computed;
        if missing.is_empty() { Ok(()) } else { Err(Error::NotComputed { call, needs: Needs::parts(missing) }) }
    }

    /// What is computed after a call that computes `gives`.
    pub(super) fn after(&self, gives: Computed) -> Computed {
        self.computed.after(gives, self.model().has_adhesion())
    }

    /// Clears what the engine would take over from an earlier call.
    fn prepare(&mut self, gives: Computed) {
        if gives.contains(C::POSITION) && !gives.contains(C::PROJECTION) {
            self.forget_old_contacts();
        }
        if gives == C::CONSTRAINT {
            self.forget_old_rows();
        }
    }
}
