//! The settings that a model carries beside its elements: options of the physics, settings of the visualiser, statistics. Each
//! is a struct of plain values, read as a copy and written back after a check.
//!
//! | file | what is in it |
//! |---|---|
//! | `flags.rs` | features that are switched on and off |
//! | `statistics.rs` | the figures that set the model's scale |
//! | `visual.rs`, `visual_check.rs` | the settings of the visualiser, and what they may be |
//! | `mirror.rs` | a struct of the engine's as one of Rust, field by field |
//! | `check.rs` | ranges that several settings share |

mod check;
mod flags;
mod mirror;
mod statistics;
mod visual;
mod visual_check;

use mujoco_sys::mjOption;

use self::check::Checks;
pub use self::flags::{DisableFlags, EnableFlags};
use self::mirror::Mirror;
pub use self::statistics::Statistics;
pub use self::visual::{Visual, VisualGlobal, VisualHeadlight, VisualMap, VisualQuality, VisualRgba, VisualScale};
use super::Model;
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::error::Result;

/// The physics options of a model. A copy: read it with [`Model::options`], change it with
/// [`ModelMut::options`](super::ModelMut::options).
///
/// The default is the engine's own, which is what a model gets whose XML has no `<option>`.
///
/// ```
/// use mujoco_safe::{Integrator, Options};
///
/// let options = Options::default();
/// assert_eq!((options.timestep, options.gravity), (0.002, [0.0, 0.0, -9.81]));
/// assert_eq!(options.integrator, Integrator::Euler);
/// ```
///
/// With the feature `serde` it can be kept in a file. What the file leaves out has its default.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
#[non_exhaustive]
#[doc(alias = "mjOption")]
pub struct Options {
    /// Duration of a step, s. Positive.
    pub timestep: f64,
    /// How often a remote client may be served, Hz. The engine keeps the number and makes no use of it. Not negative.
    pub apirate: f64,
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
    #[doc(alias = "disableflags")]
    pub disable: DisableFlags,
    /// Optional features that are switched on.
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

impl Options {
    /// The most iterations that are accepted.
    const MOST_ITERATIONS: usize = 1_000_000;

    fn read(raw: &mjOption) -> Self {
        Self {
            timestep: raw.timestep,
            apirate: raw.apirate,
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
            iterations: Mirror::read(raw.iterations),
            noslip_iterations: Mirror::read(raw.noslip_iterations),
            mpr_iterations: Mirror::read(raw.mpr_iterations),
            disable: DisableFlags::from_bits_truncate(raw.disableflags as u32),
            enable: EnableFlags::from_bits_truncate(raw.enableflags as u32),
        }
    }

    /// What [`check`](Self::check) has found to be in range.
    pub(super) fn write(&self, raw: &mut mjOption) {
        *raw = mjOption {
            timestep: self.timestep,
            apirate: self.apirate,
            impratio: self.impratio,
            tolerance: self.tolerance,
            noslip_tolerance: self.noslip_tolerance,
            mpr_tolerance: self.mpr_tolerance,
            gravity: self.gravity,
            wind: self.wind,
            magnetic: self.magnetic,
            density: self.density,
            viscosity: self.viscosity,
            o_margin: self.o_margin,
            o_solref: self.o_solref,
            o_solimp: self.o_solimp,
            integrator: self.integrator.raw(),
            collision: self.collision.raw(),
            cone: self.cone.raw(),
            jacobian: self.jacobian.raw(),
            solver: self.solver.raw(),
            iterations: self.iterations.write(),
            noslip_iterations: self.noslip_iterations.write(),
            mpr_iterations: self.mpr_iterations.write(),
            disableflags: self.disable.bits() as i32,
            enableflags: self.enable.bits() as i32,
        };
    }

    /// Refuses what the engine would answer with a fatal error, with nonsense, or by never returning.
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
            option.require(value <= Self::MOST_ITERATIONS, name, value, "a million at most")?;
        }
        // `from_bits_retain` can make flags that the engine does not know.
        let unknown =
            (self.disable.bits() & !DisableFlags::all().bits(), self.enable.bits() & !EnableFlags::all().bits());
        let value = format_args!("made of unknown bits {unknown:?}");
        option.require(unknown == (0, 0), "disable or enable", value, "made of the flags that there are")
    }
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
}
