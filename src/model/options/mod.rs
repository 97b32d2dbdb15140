//! The physics options and statistics.

use bitflags::bitflags;
use mujoco_sys::{self as sys, mjOption};

use super::Model;
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::error::{Error, Result};

bitflags! {
    /// Standard features that are switched off.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[doc(alias = "mjtDisableBit")]
    pub struct DisableFlags: u32 {
        /// The entire constraint solver.
        const CONSTRAINT = sys::mjDSBL_CONSTRAINT;
        /// Equality constraints.
        const EQUALITY = sys::mjDSBL_EQUALITY;
        /// Friction loss of joints and tendons.
        const FRICTIONLOSS = sys::mjDSBL_FRICTIONLOSS;
        /// Limits of joints and tendons.
        const LIMIT = sys::mjDSBL_LIMIT;
        /// Contacts.
        const CONTACT = sys::mjDSBL_CONTACT;
        /// Springs, dampers and fluid forces.
        const PASSIVE = sys::mjDSBL_PASSIVE;
        /// Gravity.
        const GRAVITY = sys::mjDSBL_GRAVITY;
        /// Clamping of controls to their ranges.
        const CLAMPCTRL = sys::mjDSBL_CLAMPCTRL;
        /// Starting the solver from the last solution.
        const WARMSTART = sys::mjDSBL_WARMSTART;
        /// The exclusion of collisions between a body and its parent.
        const FILTERPARENT = sys::mjDSBL_FILTERPARENT;
        /// Actuator forces.
        const ACTUATION = sys::mjDSBL_ACTUATION;
        /// The lower bound of twice the timestep on constraint time constants.
        const REFSAFE = sys::mjDSBL_REFSAFE;
        /// Sensors.
        const SENSOR = sys::mjDSBL_SENSOR;
    }
}

bitflags! {
    /// Optional features that are switched on.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[doc(alias = "mjtEnableBit")]
    pub struct EnableFlags: u32 {
        /// The contact parameters of the options override those of the geoms.
        const OVERRIDE = sys::mjENBL_OVERRIDE;
        /// Potential and kinetic energy are computed.
        const ENERGY = sys::mjENBL_ENERGY;
        /// Forward and inverse dynamics are compared.
        const FWDINV = sys::mjENBL_FWDINV;
        /// Noise is added to sensor readings.
        const SENSORNOISE = sys::mjENBL_SENSORNOISE;
        /// Several contact points between convex shapes.
        const MULTICCD = sys::mjENBL_MULTICCD;
    }
}

/// The physics options of a model. A copy: read it with [`Model::options`], change it with
/// [`ModelMut::options`](super::ModelMut::options).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[doc(alias = "mjOption")]
pub struct Options {
    /// Duration of a step, s. Positive.
    pub timestep: f64,
    /// Ratio of the impedance of friction to that of the normal direction in contacts. Positive.
    pub impratio: f64,
    /// At which improvement the main solver stops. Not negative.
    pub tolerance: f64,
    /// At which improvement the no-slip solver stops. Not negative.
    pub noslip_tolerance: f64,
    /// At which precision the convex collision solver stops. Not negative.
    pub mpr_tolerance: f64,
    /// Acceleration of gravity, m/s², world frame.
    pub gravity: [f64; 3],
    /// Velocity of the medium, m/s, world frame.
    pub wind: [f64; 3],
    /// Magnetic flux, world frame.
    pub magnetic: [f64; 3],
    /// Density of the medium, kg/m³. Not negative.
    pub density: f64,
    /// Viscosity of the medium, Pa·s. Not negative.
    pub viscosity: f64,
    /// Contact margin where [`EnableFlags::OVERRIDE`] is set, m.
    pub o_margin: f64,
    /// Contact `solref` where [`EnableFlags::OVERRIDE`] is set.
    pub o_solref: [f64; 2],
    /// Contact `solimp` where [`EnableFlags::OVERRIDE`] is set.
    pub o_solimp: [f64; 5],
    /// How a step advances the state.
    pub integrator: Integrator,
    /// Which pairs of geoms are tested for collision.
    pub collision: Collision,
    /// The friction cone of contacts.
    pub cone: Cone,
    /// How the constraint Jacobian is stored.
    pub jacobian: JacobianStorage,
    /// The constraint solver.
    pub solver: Solver,
    /// Iterations of the main solver at most. Up to a million, so that a step ends.
    pub iterations: usize,
    /// Iterations of the no-slip solver at most.
    pub noslip_iterations: usize,
    /// Iterations of the convex collision solver at most.
    pub mpr_iterations: usize,
    /// Standard features that are switched off.
    pub disable: DisableFlags,
    /// Optional features that are switched on.
    pub enable: EnableFlags,
}

impl Options {
    /// The most iterations that are accepted.
    const MOST_ITERATIONS: usize = 1_000_000;

    fn read(raw: &mjOption) -> Self {
        let iterations = |raw: i32| usize::try_from(raw).unwrap_or(0);
        Self {
            timestep: raw.timestep,
            impratio: raw.impratio,
            tolerance: raw.tolerance,
            noslip_tolerance: raw.noslip_tolerance,
            mpr_tolerance: raw.mpr_tolerance,
            gravity: raw.gravity,
            wind: raw.wind,
            magnetic: raw.magnetic,
            density: raw.density,
            viscosity: raw.viscosity,
            o_margin: raw.o_margin,
            o_solref: raw.o_solref,
            o_solimp: raw.o_solimp,
            integrator: Integrator::of_field(raw.integrator),
            collision: Collision::of_field(raw.collision),
            cone: Cone::of_field(raw.cone),
            jacobian: JacobianStorage::of_field(raw.jacobian),
            solver: Solver::of_field(raw.solver),
            iterations: iterations(raw.iterations),
            noslip_iterations: iterations(raw.noslip_iterations),
            mpr_iterations: iterations(raw.mpr_iterations),
            disable: DisableFlags::from_bits_truncate(raw.disableflags as u32),
            enable: EnableFlags::from_bits_truncate(raw.enableflags as u32),
        }
    }

    /// What [`check`](Self::check) has found to be in range.
    pub(super) fn write(&self, raw: &mut mjOption) {
        raw.timestep = self.timestep;
        raw.impratio = self.impratio;
        raw.tolerance = self.tolerance;
        raw.noslip_tolerance = self.noslip_tolerance;
        raw.mpr_tolerance = self.mpr_tolerance;
        raw.gravity = self.gravity;
        raw.wind = self.wind;
        raw.magnetic = self.magnetic;
        raw.density = self.density;
        raw.viscosity = self.viscosity;
        raw.o_margin = self.o_margin;
        raw.o_solref = self.o_solref;
        raw.o_solimp = self.o_solimp;
        raw.integrator = self.integrator.raw();
        raw.collision = self.collision.raw();
        raw.cone = self.cone.raw();
        raw.jacobian = self.jacobian.raw();
        raw.solver = self.solver.raw();
        raw.iterations = self.iterations as i32;
        raw.noslip_iterations = self.noslip_iterations as i32;
        raw.mpr_iterations = self.mpr_iterations as i32;
        raw.disableflags = self.disable.bits() as i32;
        raw.enableflags = self.enable.bits() as i32;
    }

    /// Refuses what the engine would answer with a fatal error, with nonsense, or by never returning.
    pub(super) fn check(&self) -> Result<()> {
        let fail = |what: &str, value: String, expected: &str| {
            Err(Error::Invalid { what: format!("the option {what}"), value, expected: expected.to_owned() })
        };
        for (what, value) in [("timestep", self.timestep), ("impratio", self.impratio)] {
            if !(value.is_finite() && value > 0.0) {
                return fail(what, value.to_string(), "positive and finite");
            }
        }
        for (what, value) in [
            ("tolerance", self.tolerance),
            ("noslip_tolerance", self.noslip_tolerance),
            ("mpr_tolerance", self.mpr_tolerance),
            ("density", self.density),
            ("viscosity", self.viscosity),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return fail(what, value.to_string(), "finite and not negative");
            }
        }
        for (what, values) in [
            ("gravity", &self.gravity[..]),
            ("wind", &self.wind),
            ("magnetic", &self.magnetic),
            ("o_margin", &[self.o_margin]),
            ("o_solref", &self.o_solref),
            ("o_solimp", &self.o_solimp),
        ] {
            if !values.iter().all(|value| value.is_finite()) {
                return fail(what, format!("{values:?}"), "finite");
            }
        }
        for (what, value) in [
            ("iterations", self.iterations),
            ("noslip_iterations", self.noslip_iterations),
            ("mpr_iterations", self.mpr_iterations),
        ] {
            if value > Self::MOST_ITERATIONS {
                return fail(what, value.to_string(), "a million at most");
            }
        }
        // `from_bits_retain` can make flags that the engine does not know.
        let unknown =
            (self.disable.bits() & !DisableFlags::all().bits(), self.enable.bits() & !EnableFlags::all().bits());
        if unknown != (0, 0) {
            return fail(
                "disable or enable",
                format!("made of unknown bits {unknown:?}"),
                "made of the flags that there are",
            );
        }
        Ok(())
    }
}

/// Figures of the model at `qpos0`, which set its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[doc(alias = "mjStatistic")]
pub struct Statistics {
    /// Mean of the inertia matrix's diagonal.
    pub meaninertia: f64,
    /// Mean mass of a body, kg.
    pub meanmass: f64,
    /// Mean size of a body, m.
    pub meansize: f64,
    /// Extent of the model, m.
    pub extent: f64,
    /// Its centre, m, world frame.
    pub center: [f64; 3],
}

impl Model {
    /// The physics options, as a copy.
    #[doc(alias = "opt")]
    pub fn options(&self) -> Options {
        Options::read(&self.raw().opt)
    }

    /// The duration of a step, s.
    #[inline]
    pub fn timestep(&self) -> f64 {
        self.raw().opt.timestep
    }

    /// Figures of the model at `qpos0`.
    #[doc(alias = "stat")]
    pub fn statistics(&self) -> Statistics {
        let raw = &self.raw().stat;
        Statistics {
            meaninertia: raw.meaninertia,
            meanmass: raw.meanmass,
            meansize: raw.meansize,
            extent: raw.extent,
            center: raw.center,
        }
    }
}
