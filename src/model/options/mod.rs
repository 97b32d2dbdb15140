//! Settings of a model as a whole: physics options, visualiser settings and statistics. Each is a struct of plain values. Reading
//! returns a copy, and writing checks the values.

mod fields;
mod statistics;
mod visual;
mod visual_ranges;

use bitflags::bitflags;
use mujoco_sys::adapted::{self, AdaptedOptions};
use mujoco_sys::{self as sys, mjOption};

#[cfg(feature = "viewer")]
pub(crate) use self::fields::SettingMut;
use self::fields::{Checks, Mirror};
pub use self::statistics::Statistics;
pub use self::visual::{Visual, VisualGlobal, VisualHeadlight, VisualMap, VisualQuality, VisualRgba, VisualScale};
use super::Model;
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::error::{Error, Result};
use crate::field_docs::field_docs;

/// Physics options of a model.
///
/// The struct is a copy of the engine's values: [`Model::options`] reads them, [`ModelMut::edit_options`](super::ModelMut::edit_options)
/// changes them. The defaults are those of the engine, for a model whose XML has no `<option>`.
///
/// ```
/// use mujoco_safe::enums::Integrator;
/// use mujoco_safe::Options;
///
/// let options = Options::default();
/// assert_eq!((options.timestep, options.gravity), (0.002, [0.0, 0.0, -9.81]));
/// assert_eq!(options.integrator, Integrator::Euler);
/// ```
///
/// With the feature `serde` it can be serialised. Missing fields have their defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
#[non_exhaustive]
#[allow(
    clippy::unsafe_derive_deserialize,
    reason = "the unsafe calls copy plain numbers, which any value of the struct has"
)]
pub struct Options {
    /// Duration of a step, s. Positive.
    pub timestep: f64,
    /// Update rate for remote clients, Hz. The engine stores the value and does not use it. Not negative.
    pub apirate: f64,
    /// Ratio of the impedance of friction to that of the normal direction in contacts. Positive.
    pub impratio: f64,
    /// Tolerance of the main solver, which stops when an iteration improves the scaled cost by less than this. Not negative.
    pub tolerance: f64,
    /// Tolerance of the no-slip solver, which stops when an iteration improves the scaled cost by less than this. Not negative.
    pub noslip_tolerance: f64,
    /// Precision at which the convex collision solver stops. Not negative.
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
    /// Numerical integrator.
    pub integrator: Integrator,
    /// Selection of the pairs of geoms that are tested for collision.
    pub collision: Collision,
    /// Friction cone of contacts.
    pub cone: Cone,
    /// Storage of the constraint Jacobian.
    pub jacobian: JacobianStorage,
    /// Constraint solver.
    pub solver: Solver,
    /// Largest number of iterations of the main solver. At most a million, so that a step terminates.
    pub iterations: usize,
    /// Largest number of iterations of the no-slip solver. At most a million.
    pub noslip_iterations: usize,
    /// Largest number of iterations of the convex collision solver. At most a million, and at least 1 with engines from 3.0.
    pub mpr_iterations: usize,
    /// Standard features that are disabled.
    #[doc(alias = "disableflags")]
    pub disable: DisableFlags,
    /// Optional features that are enabled.
    #[doc(alias = "enableflags")]
    pub enable: EnableFlags,
}

impl Default for Options {
    #[doc(alias = "mj_defaultOption")]
    fn default() -> Self {
        Self {
            timestep: 0.002,
            apirate: 100.0,
            impratio: 1.0,
            tolerance: 1e-8,
            noslip_tolerance: 1e-6,
            mpr_tolerance: 1e-6,
            gravity: [0.0, 0.0, -9.81],
            wind: [0.0; 3],
            magnetic: [0.0, -0.5, 0.0],
            density: 0.0,
            viscosity: 0.0,
            o_margin: 0.0,
            o_solref: [0.02, 1.0],
            o_solimp: [0.9, 0.95, 0.001, 0.5, 2.0],
            integrator: Integrator::Euler,
            collision: Collision::All,
            cone: Cone::Pyramidal,
            jacobian: JacobianStorage::Auto,
            solver: Solver::Newton,
            iterations: 100,
            noslip_iterations: 0,
            mpr_iterations: 50,
            disable: DisableFlags::empty(),
            enable: EnableFlags::empty(),
        }
    }
}

bitflags! {
    /// Standard features of the physics that are disabled.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
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
        const PASSIVE = PASSIVE;
        /// Gravity.
        const GRAVITY = sys::mjDSBL_GRAVITY;
        /// Clamping of controls to their ranges.
        const CLAMPCTRL = sys::mjDSBL_CLAMPCTRL;
        /// Warm start of the solver from the previous solution.
        const WARMSTART = sys::mjDSBL_WARMSTART;
        /// The filter that excludes collisions between a body and its parent.
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
    /// Optional features of the physics that are enabled.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    pub struct EnableFlags: u32 {
        /// Override of the contact parameters of the geoms by those of the options.
        const OVERRIDE = sys::mjENBL_OVERRIDE;
        /// Computation of potential and kinetic energy.
        const ENERGY = sys::mjENBL_ENERGY;
        /// Comparison of forward and inverse dynamics.
        const FWDINV = sys::mjENBL_FWDINV;
        /// Noise in sensor readings.
        const SENSORNOISE = sys::mjENBL_SENSORNOISE;
        /// Several contact points between convex shapes.
        const MULTICCD = sys::mjENBL_MULTICCD;
    }
}

/// The flag, or in newer engines the two flags, that disable springs and dampers.
const PASSIVE: u32 =
    if sys::mjDSBL_PASSIVE == ABSENT_PASSIVE { sys::mjDSBL_SPRING | sys::mjDSBL_DAMPER } else { sys::mjDSBL_PASSIVE };
const ABSENT_PASSIVE: u32 = 1 << 28;

impl Options {
    /// Rejects options that only other versions of the engine have.
    fn check_supported(&self) -> Result<()> {
        let is_absent = |value: u32, constant: u32, first: u32| constant >= first && value & constant == constant;
        let absent = [
            (self.integrator == Integrator::ImplicitFast && self.integrator.raw() < 0, "the integrator ImplicitFast"),
            (self.collision != Collision::All && self.collision.raw() < 0, "a selection of collisions"),
            (is_absent(self.enable.bits(), sys::mjENBL_SENSORNOISE, 1 << 29), "sensor noise"),
            (is_absent(self.enable.bits(), sys::mjENBL_MULTICCD, 1 << 29), "the flag MULTICCD"),
        ];
        match absent.into_iter().find(|(is_absent, _)| *is_absent) {
            Some((_, what)) => {
                Err(Error::Unsupported(format!("MuJoCo {} does not have {what}", crate::built_against())))
            }
            None => Ok(()),
        }
    }

    /// Limit on the iterations of each solver.
    const MOST_ITERATIONS: usize = 1_000_000;

    fn read(raw: &mjOption) -> Self {
        let mut adapted = AdaptedOptions::default();
        // SAFETY: valid structures, of which the function copies numbers.
        unsafe { adapted::get_options(raw, &raw mut adapted) };
        Self {
            timestep: raw.timestep,
            apirate: adapted.apirate,
            impratio: raw.impratio,
            tolerance: raw.tolerance,
            noslip_tolerance: raw.noslip_tolerance,
            mpr_tolerance: adapted.ccd_tolerance,
            gravity: raw.gravity,
            wind: raw.wind,
            magnetic: raw.magnetic,
            density: raw.density,
            viscosity: raw.viscosity,
            o_margin: raw.o_margin,
            o_solref: raw.o_solref,
            o_solimp: raw.o_solimp,
            integrator: Integrator::of_field(raw.integrator),
            collision: Collision::of_field(adapted.collision),
            cone: Cone::of_field(raw.cone),
            jacobian: JacobianStorage::of_field(raw.jacobian),
            solver: Solver::of_field(raw.solver),
            iterations: Mirror::read(raw.iterations),
            noslip_iterations: Mirror::read(raw.noslip_iterations),
            mpr_iterations: Mirror::read(adapted.ccd_iterations),
            disable: DisableFlags::from_bits_truncate(raw.disableflags as u32),
            enable: EnableFlags::from_bits_truncate(raw.enableflags as u32),
        }
    }

    /// Writes options that have passed [`check`](Self::check).
    pub(super) fn write(&self, raw: &mut mjOption) {
        let kept = [
            raw.disableflags as u32 & !DisableFlags::all().bits(),
            raw.enableflags as u32 & !EnableFlags::all().bits(),
        ];
        *raw = mjOption {
            timestep: self.timestep,
            impratio: self.impratio,
            tolerance: self.tolerance,
            noslip_tolerance: self.noslip_tolerance,
            gravity: self.gravity,
            wind: self.wind,
            magnetic: self.magnetic,
            density: self.density,
            viscosity: self.viscosity,
            o_margin: self.o_margin,
            o_solref: self.o_solref,
            o_solimp: self.o_solimp,
            integrator: self.integrator.raw(),
            cone: self.cone.raw(),
            jacobian: self.jacobian.raw(),
            solver: self.solver.raw(),
            iterations: self.iterations.write(),
            noslip_iterations: self.noslip_iterations.write(),
            disableflags: (self.disable.bits() | kept[0]) as i32,
            enableflags: (self.enable.bits() | kept[1]) as i32,
            // Fields of other versions: four are written below, and the others keep their values.
            ..*raw
        };
        let adapted = AdaptedOptions {
            apirate: self.apirate,
            ccd_tolerance: self.mpr_tolerance,
            ccd_iterations: self.mpr_iterations.write(),
            collision: self.collision.raw(),
        };
        // SAFETY: valid structures, between which the function copies numbers.
        unsafe { adapted::set_options(raw, &raw const adapted) };
    }

    /// Rejects values for which the engine would raise a fatal error, compute meaningless results, or not return.
    pub(super) fn check(&self) -> Result<()> {
        let option = Checks("the option ");
        option.positive("timestep", self.timestep)?;
        option.positive("impratio", self.impratio)?;
        for (name, value) in [
            ("apirate", self.apirate),
            ("tolerance", self.tolerance),
            ("noslip_tolerance", self.noslip_tolerance),
            ("mpr_tolerance", self.mpr_tolerance),
            ("density", self.density),
            ("viscosity", self.viscosity),
        ] {
            option.not_negative(name, value)?;
        }
        for (name, values) in [
            ("gravity", &self.gravity[..]),
            ("wind", &self.wind),
            ("magnetic", &self.magnetic),
            ("o_margin", &[self.o_margin]),
            ("o_solref", &self.o_solref),
            ("o_solimp", &self.o_solimp),
        ] {
            option.finite(name, values)?;
        }
        for (name, value) in [
            ("iterations", self.iterations),
            ("noslip_iterations", self.noslip_iterations),
            ("mpr_iterations", self.mpr_iterations),
        ] {
            option.require(value <= Self::MOST_ITERATIONS, name, value, "at most a million")?;
        }
        // The collision solver of newer engines has no space for its first polytope if it may not iterate.
        if cfg!(engine_since = "3.0.0") {
            option.require(self.mpr_iterations > 0, "mpr_iterations", self.mpr_iterations, "at least 1")?;
        }
        self.check_supported()?;
        // `from_bits_retain` can create flags that the engine does not have.
        let unknown =
            (self.disable.bits() & !DisableFlags::all().bits(), self.enable.bits() & !EnableFlags::all().bits());
        let value = format_args!("a set with the unknown bits {unknown:?}");
        option.require(unknown == (0, 0), "disable or enable", value, "a set of known flags")
    }
}

/// # Physics options
impl Model {
    /// Returns a copy of the physics options.
    #[doc(alias = "opt")]
    pub fn options(&self) -> Options {
        Options::read(&self.raw().opt)
    }

    /// Returns the duration of a step, s.
    #[inline]
    pub fn timestep(&self) -> f64 {
        self.raw().opt.timestep
    }
}

field_docs!(model::Options, "Option", "apirate", "update rate for remote API (Hz)", 24);
field_docs!(model::Visual, "Visual", "global.fovy", "y-field of view for free camera (degrees)", 68);
field_docs!(model::Statistics, "Statistic", "extent", "spatial extent", 5);
