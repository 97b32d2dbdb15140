//! Settings of a model as a whole: physics options, visualiser settings and statistics. Each is a
//! struct of plain values. Reading returns a copy, and writing checks the values.

pub(super) mod fields;
mod statistics;
mod visual;
mod visual_ranges;

use std::mem::MaybeUninit;

use bitflags::bitflags;
use mujoco_sys::adapted::{self, AdaptedOptions};
use mujoco_sys::{self as sys, mjOption};

#[cfg(feature = "viewer")]
pub(crate) use self::fields::SettingMut;
use self::fields::{Checks, Mirror};
pub use self::statistics::Statistics;
pub use self::visual::{Visual, VisualGlobal, VisualHeadlight, VisualMap, VisualQuality, VisualRgba, VisualScale};
use super::{Model, ModelMut};
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::error::{Error, Result};
use crate::field_docs::field_docs;

/// Physics options of a model.
///
/// The struct is a copy of the engine's values: [`Model::options`] reads them,
/// [`ModelMut::edit_options`](super::ModelMut::edit_options) changes them. The defaults are the
/// engine's, for a model whose XML has no `<option>`.
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
    /// Update rate for remote clients, Hz. The engine stores the value and does not use it; engines
    /// from 3.3.7 do not have it. Not negative.
    pub apirate: f64,
    /// Ratio of the frictional to the normal impedance in contacts. Positive.
    pub impratio: f64,
    /// Tolerance of the main solver, which stops when an iteration improves the scaled cost by less
    /// than this. Not negative.
    pub tolerance: f64,
    /// Tolerance of the line search of the solvers CG and Newton, with engines from 3.0.0. Not
    /// negative.
    pub ls_tolerance: f64,
    /// Tolerance of the no-slip solver, which stops when an iteration improves the scaled cost by
    /// less than this. Not negative.
    pub noslip_tolerance: f64,
    /// Precision at which the convex collision solver stops. Not negative.
    #[doc(alias = "ccd_tolerance")]
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
    /// Contact margin if [`EnableFlags::OVERRIDE`] is set, m.
    pub o_margin: f64,
    /// Contact `solref` if [`EnableFlags::OVERRIDE`] is set.
    pub o_solref: [f64; 2],
    /// Contact `solimp` if [`EnableFlags::OVERRIDE`] is set.
    pub o_solimp: [f64; 5],
    /// Contact friction if [`EnableFlags::OVERRIDE`] is set, with engines from 3.0.0.
    pub o_friction: [f64; 5],
    /// Numerical integrator.
    pub integrator: Integrator,
    /// Selection of the pairs of geoms that are tested for collision. Engines from 3.0.0 only have
    /// [`Collision::All`].
    pub collision: Collision,
    /// Friction cone of contacts.
    pub cone: Cone,
    /// Storage of the constraint Jacobian. With engines from 3.0 to 3.10 it is always dense in a
    /// model with flexes in which a geom or a flex has contacts with torsional or rolling friction
    /// (`condim` 4 or 6): their rows in a sparse one would contain memory that the engine has not
    /// written.
    pub jacobian: JacobianStorage,
    /// Constraint solver.
    pub solver: Solver,
    /// Largest number of iterations of the main solver. At most a million, so that a step
    /// terminates.
    pub iterations: usize,
    /// Largest number of iterations of the line search of the solvers CG and Newton, with engines
    /// from 3.0.0. At most a million.
    pub ls_iterations: usize,
    /// Largest number of iterations of the no-slip solver. At most a million.
    pub noslip_iterations: usize,
    /// Largest number of iterations of the convex collision solver. At most a million, and at least
    /// 1 with engines from 3.0.
    #[doc(alias = "ccd_iterations")]
    pub mpr_iterations: usize,
    /// Number of starting points in collisions of signed distance fields, with engines from 3.0.0.
    /// From 1 to 50.
    pub sdf_initpoints: usize,
    /// Largest number of iterations in collisions of signed distance fields, with engines from
    /// 3.0.0. At most a million.
    pub sdf_iterations: usize,
    /// Groups of actuators that are disabled, with engines from 3.0.1: bit `i` disables group `i`,
    /// from 0 to 30.
    pub disableactuator: u32,
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
        let mut raw = MaybeUninit::<mjOption>::zeroed();
        // SAFETY: the function only sets fields of the structure, whose numbers have any value.
        let raw = unsafe {
            sys::mj_defaultOption(raw.as_mut_ptr());
            raw.assume_init()
        };
        Self::read(&raw)
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
        /// Springs, with engines from 3.3.6.
        const SPRING = sys::mjDSBL_SPRING;
        /// Dampers, with engines from 3.3.6.
        const DAMPER = sys::mjDSBL_DAMPER;
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
        /// The middle phase of collision detection, with engines from 2.3.3. A model always has
        /// this flag if a geom can collide that is not in the hierarchy of bounding boxes of its
        /// body, because its masks were zero when the model was compiled.
        const MIDPHASE = sys::mjDSBL_MIDPHASE;
        /// Implicit joint damping in the integrator [`Euler`](Integrator::Euler), with engines from
        /// 3.0.0.
        const EULERDAMP = sys::mjDSBL_EULERDAMP;
        /// The engine's convex collision solver, with engines from 3.3.0: they use libccd instead.
        const NATIVECCD = sys::mjDSBL_NATIVECCD;
        /// The division of the constraints into independent islands, with engines from 3.3.6. A
        /// model with flexes always has this flag with 3.3.6 to 3.5, whose islands do not contain
        /// all bodies in contact with a flex: an edit that clears it has no effect.
        const ISLAND = sys::mjDSBL_ISLAND;
        /// Several contact points between convex shapes, with engines from 3.8.0. Before,
        /// [`EnableFlags::MULTICCD`] enables them.
        const MULTICCD = sys::mjDSBL_MULTICCD;
    }
}

bitflags! {
    /// Optional features of the physics that are enabled.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    pub struct EnableFlags: u32 {
        /// Override of the contact parameters of the geoms by the parameters in the options.
        const OVERRIDE = sys::mjENBL_OVERRIDE;
        /// Computation of potential and kinetic energy.
        const ENERGY = sys::mjENBL_ENERGY;
        /// Comparison of forward and inverse dynamics, with newer engines also statistics of the
        /// solver.
        const FWDINV = sys::mjENBL_FWDINV;
        /// Noise in sensor readings, with engines up to 3.1.3.
        const SENSORNOISE = sys::mjENBL_SENSORNOISE;
        /// Several contact points between convex shapes, with engines up to 3.7.0. Newer engines
        /// have them unless [`DisableFlags::MULTICCD`] is set.
        const MULTICCD = sys::mjENBL_MULTICCD;
        /// Inverse dynamics of the step instead of continuous time, with engines from 3.0.0.
        const INVDISCRETE = sys::mjENBL_INVDISCRETE;
        /// The exact diagonal of the inverse inertia in constraint space, with engines from 3.9.0.
        const DIAGEXACT = sys::mjENBL_DIAGEXACT;
        /// Contacts that prevent fast convex geoms from passing through thin obstacles, with
        /// engines from 4.0.0.
        const SPECULATIVE = sys::mjENBL_SPECULATIVE;
    }
}

/// The flag, or in newer engines the two flags, that disable springs and dampers.
const PASSIVE: u32 =
    if sys::mjDSBL_PASSIVE < FIRST_ABSENT_FLAG { sys::mjDSBL_PASSIVE } else { sys::mjDSBL_SPRING | sys::mjDSBL_DAMPER };

/// Lowest bit of the flags that the engine does not have.
pub(crate) const FIRST_ABSENT_FLAG: u32 = 1 << 22;

impl DisableFlags {
    /// Returns `true` for flags that the engine has.
    pub(crate) fn is_present(self) -> bool {
        self.bits() < FIRST_ABSENT_FLAG
    }
}

impl EnableFlags {
    /// Returns `true` for flags that the engine has.
    pub(crate) fn is_present(self) -> bool {
        self.bits() < FIRST_ABSENT_FLAG
    }
}

impl Options {
    /// Rejects options that only other versions of the engine have.
    fn check_supported(&self) -> Result<()> {
        self.integrator.check_supported()?;
        // Engines without the option test all pairs.
        if self.collision != Collision::All {
            self.collision.check_supported()?;
        }
        for (name, _) in self.disable.iter_names().filter(|(_, flag)| !flag.is_present()) {
            Error::check_constant(&format!("mjDSBL_{name}"), format_args!("the flag DisableFlags::{name}"))?;
        }
        for (name, _) in self.enable.iter_names().filter(|(_, flag)| !flag.is_present()) {
            Error::check_constant(&format!("mjENBL_{name}"), format_args!("the flag EnableFlags::{name}"))?;
        }
        // A value that the engine does not store reads as the default again.
        let mut raw = MaybeUninit::<mjOption>::zeroed();
        // SAFETY: all-zero bytes are valid numbers.
        let stored = Self::read(unsafe {
            self.write(raw.assume_init_mut());
            raw.assume_init_ref()
        });
        let differing = [
            ("apirate", stored.apirate != self.apirate, "2.2.2 to 3.3.6"),
            ("ls_tolerance", stored.ls_tolerance != self.ls_tolerance, "3.0.0 and later"),
            ("ls_iterations", stored.ls_iterations != self.ls_iterations, "3.0.0 and later"),
            ("sdf_initpoints", stored.sdf_initpoints != self.sdf_initpoints, "3.0.0 and later"),
            ("sdf_iterations", stored.sdf_iterations != self.sdf_iterations, "3.0.0 and later"),
            ("o_friction", stored.o_friction != self.o_friction, "3.0.0 and later"),
            ("disableactuator", stored.disableactuator != self.disableactuator, "3.0.1 and later"),
        ];
        match differing.into_iter().find(|(_, differs, _)| *differs) {
            Some((name, _, versions)) => Err(Error::lacks(&format!("the option {name}"), versions)),
            None => Ok(()),
        }
    }

    /// Limit on the iterations of each solver.
    pub(super) const MOST_ITERATIONS: usize = 1_000_000;

    fn read(raw: &mjOption) -> Self {
        let mut adapted = AdaptedOptions::default();
        // SAFETY: valid structures, of which the function copies numbers.
        unsafe { adapted::get_options(raw, &raw mut adapted) };
        Self {
            timestep: raw.timestep,
            apirate: adapted.apirate,
            impratio: raw.impratio,
            tolerance: raw.tolerance,
            ls_tolerance: adapted.ls_tolerance,
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
            o_friction: adapted.o_friction,
            integrator: Integrator::of_field(raw.integrator),
            collision: Collision::of_field(adapted.collision),
            cone: Cone::of_field(raw.cone),
            jacobian: JacobianStorage::of_field(raw.jacobian),
            solver: Solver::of_field(raw.solver),
            iterations: Mirror::read(raw.iterations),
            ls_iterations: Mirror::read(adapted.ls_iterations),
            noslip_iterations: Mirror::read(raw.noslip_iterations),
            mpr_iterations: Mirror::read(adapted.ccd_iterations),
            sdf_initpoints: Mirror::read(adapted.sdf_initpoints),
            sdf_iterations: Mirror::read(adapted.sdf_iterations),
            disableactuator: adapted.disableactuator as u32,
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
        // Field by field: an assignment of the struct would write undefined bytes between its
        // fields, which are part of a binary file. Fields of other versions keep their values,
        // except those in `AdaptedOptions`.
        raw.timestep = self.timestep;
        raw.impratio = self.impratio;
        raw.tolerance = self.tolerance;
        raw.noslip_tolerance = self.noslip_tolerance;
        raw.gravity = self.gravity;
        raw.wind = self.wind;
        raw.magnetic = self.magnetic;
        raw.density = self.density;
        raw.viscosity = self.viscosity;
        raw.o_margin = self.o_margin;
        raw.o_solref = self.o_solref;
        raw.o_solimp = self.o_solimp;
        raw.integrator = self.integrator.raw();
        raw.cone = self.cone.raw();
        raw.jacobian = self.jacobian.raw();
        raw.solver = self.solver.raw();
        raw.iterations = self.iterations.write();
        raw.noslip_iterations = self.noslip_iterations.write();
        raw.disableflags = (self.disable.bits() | kept[0]) as i32;
        raw.enableflags = (self.enable.bits() | kept[1]) as i32;
        let adapted = AdaptedOptions {
            apirate: self.apirate,
            ccd_tolerance: self.mpr_tolerance,
            ls_tolerance: self.ls_tolerance,
            o_friction: self.o_friction,
            ccd_iterations: self.mpr_iterations.write(),
            collision: self.collision.raw(),
            ls_iterations: self.ls_iterations.write(),
            sdf_iterations: self.sdf_iterations.write(),
            sdf_initpoints: self.sdf_initpoints.write(),
            disableactuator: self.disableactuator as i32,
        };
        // SAFETY: valid structures, between which the function copies numbers.
        unsafe { adapted::set_options(raw, &raw const adapted) };
    }

    /// Rejects values for which the engine would raise a fatal error, compute meaningless results,
    /// or not return.
    pub(super) fn check(&self) -> Result<()> {
        let option = Checks("the option ");
        option.positive("timestep", self.timestep)?;
        option.positive("impratio", self.impratio)?;
        for (name, value) in [
            ("apirate", self.apirate),
            ("tolerance", self.tolerance),
            ("ls_tolerance", self.ls_tolerance),
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
            ("o_friction", &self.o_friction),
        ] {
            option.finite(name, values)?;
        }
        for (name, value) in [
            ("iterations", self.iterations),
            ("ls_iterations", self.ls_iterations),
            ("noslip_iterations", self.noslip_iterations),
            ("mpr_iterations", self.mpr_iterations),
            ("sdf_initpoints", self.sdf_initpoints),
            ("sdf_iterations", self.sdf_iterations),
        ] {
            option.require(value <= Self::MOST_ITERATIONS, name, value, "at most a million")?;
        }
        // The collision solver of newer engines has space for its first polytope only if it may
        // iterate.
        if cfg!(engine_since = "3.0.0") {
            option.require(self.mpr_iterations > 0, "mpr_iterations", self.mpr_iterations, "at least 1")?;
            // The collision functions for signed distance fields write a contact for each point, at
            // least one, into arrays of this length.
            let points = 1..=sys::mjMAXCONPAIR as usize;
            let expected = format_args!("from 1 to {}", points.end());
            option.require(points.contains(&self.sdf_initpoints), "sdf_initpoints", self.sdf_initpoints, expected)?;
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

    /// Disables islands if the engine writes out of bounds for the islands of this model: see
    /// [`DisableFlags::ISLAND`].
    pub(super) fn disable_unsafe_islands(&mut self) {
        // SAFETY: a valid model that is borrowed exclusively. The function changes its flags.
        unsafe { adapted::disable_unsafe_islands(self.raw_mut()) };
    }
}

impl ModelMut<'_> {
    /// Makes the constraint Jacobian dense if the engine would compute a wrong sparse one: see
    /// [`Options::jacobian`].
    #[cfg_attr(
        not(all(engine_since = "3.0.0", not(engine_since = "3.11.0"))),
        allow(clippy::unused_self, reason = "no flexes, or right ones")
    )]
    pub(crate) fn avoid_wrong_jacobian(&mut self) {
        #[cfg(all(engine_since = "3.0.0", not(engine_since = "3.11.0")))]
        {
            let rolls = |condim: &[i32]| condim.iter().any(|&dimension| dimension > 3);
            if self.nflex() > 0 && (rolls(self.flex_condim()) || rolls(self.geom_condim())) {
                self.raw_mut().opt.jacobian = sys::mjJAC_DENSE as i32;
            }
        }
    }
}

field_docs!(model::Options, "Option", "density", "density of medium");
field_docs!(model::Visual, "Visual", "global.offwidth", "width of offscreen buffer");
field_docs!(model::Statistics, "Statistic", "extent", "spatial extent");
