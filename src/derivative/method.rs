//! Methods of linearisation, their options, and the report of the method that was used.

use std::fmt;

use bitflags::bitflags;

use super::Differences;
use crate::macros::with_methods;

/// Method by which a [`Lineariser`](super::Lineariser) linearises a step of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TransitionMethod {
    /// Differences of a step by the engine, [`Data::transition_fd`](crate::Data::transition_fd), in
    /// one thread.
    Engine,
    /// The same differences, computed column by column and shared among the threads. Without a step
    /// in the options, those that disagree are repeated with others
    /// ([`Kinks::DIFFERENCES`](super::Kinks::DIFFERENCES)). In both methods the solvers CG and PGS
    /// have no [`tolerance`](crate::model::Options::tolerance), and since engine 3.12 Newton has
    /// one of at most 1e-15, because with the usual one they keep their initial guess for small
    /// changes, so that the differences lack the effect of the constraints. The model's limit on
    /// the [iterations](crate::model::Options::iterations) applies: CG and PGS make as many in each
    /// step. If the solver has not converged by then, `Columns` reports
    /// [`Kinks::DIFFERENCES`](super::Kinks::DIFFERENCES).
    Columns,
    /// Implicit differentiation, from differences of inverse dynamics, which needs no constraint
    /// solver: several times faster than differences of a step, and at least as accurate. The
    /// threads share the columns. If the method does not apply, the lineariser uses
    /// [`Columns`](Self::Columns) and gives the reason in the [`LinearisationReport`].
    Implicit,
    /// Derivatives of the equations of motion in closed form: the fastest and most accurate method.
    /// Differences remain for some terms, which the [`LinearisationReport`] names:
    /// [`differenced`](LinearisationReport::differenced). If the method does not apply to a model
    /// or a state, the lineariser uses [`Implicit`](Self::Implicit) or [`Columns`](Self::Columns),
    /// and gives the reason. One thread computes a system; several threads share those along a
    /// trajectory.
    Analytic,
}

/// Options of a [`Lineariser`](super::Lineariser).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TransitionOptions {
    /// Method of linearisation; [`Analytic`](TransitionMethod::Analytic) by default.
    pub method: TransitionMethod,
    /// Scheme of differences; [`Central`](Differences::Central) by default.
    pub differences: Differences,
    /// Step of the differences. By default `1e-7` for inverse dynamics, and `1e-6` for differences
    /// of a step, where it has to be large compared with the tolerance of the solver.
    pub eps: Option<f64>,
    /// Maximum number of rayon threads that work at the same time, from 1 to 1024. Each has its own
    /// simulation. The result does not depend on the number, to the last bit. A thread that the
    /// operating system schedules on the caller's processor gives no speed-up; in virtual machines
    /// this lasts for milliseconds. To avoid it, call from a pool whose threads are pinned to
    /// processors.
    pub threads: usize,
}

impl Default for TransitionOptions {
    /// Returns options for derivatives in closed form in one thread, where possible, and for
    /// central differences with the default step otherwise.
    fn default() -> Self {
        Self { method: TransitionMethod::Analytic, differences: Differences::Central, eps: None, threads: 1 }
    }
}

with_methods!(TransitionOptions {
    with_method(method: TransitionMethod),
    with_differences(differences: Differences),
    with_eps(eps: f64) = Some(eps),
    with_threads(threads: usize),
});

impl TransitionOptions {
    /// Returns the scheme and the step of the differences of a method.
    pub(super) fn step(&self, method: TransitionMethod) -> Step {
        let suitable = match method {
            TransitionMethod::Implicit | TransitionMethod::Analytic => 1e-7,
            TransitionMethod::Engine | TransitionMethod::Columns => 1e-6,
        };
        Step { differences: self.differences, eps: self.eps.unwrap_or(suitable), may_change: self.eps.is_none() }
    }
}

/// Scheme and step of differences.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) differences: Differences,
    pub(super) eps: f64,
    /// True if differences that do not converge may be repeated with another step.
    pub(super) may_change: bool,
}

impl Step {
    /// Returns the step, and those with which differences are repeated if those to the right and to
    /// the left disagree.
    pub(super) fn trials(self) -> impl Iterator<Item = Self> {
        let count = if self.may_change && self.differences == Differences::Central { 4 } else { 1 };
        [1.0, 0.1, 10.0, 100.0].into_iter().take(count).map(move |factor| Self { eps: factor * self.eps, ..self })
    }
}

/// Reason why another method than the requested one was used.
///
/// Each variant names the method that is used. With the implicit integrator it is
/// [`Columns`](TransitionMethod::Columns) also for variants that name
/// [`Implicit`](TransitionMethod::Implicit). For [inverse
/// dynamics](super::Lineariser::inverse_jacobians) it always is
/// [`Engine`](TransitionMethod::Engine).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fallback {
    /// The simulation has [callbacks](crate::callback), which only calls on that simulation can
    /// invoke. The method is [`Engine`](TransitionMethod::Engine).
    Callbacks,
    /// The integrator is Runge–Kutta, for which the engine's differences would mix stages. The
    /// method is [`Columns`](TransitionMethod::Columns), with complete steps.
    RungeKutta,
    /// The integrator is [`Implicit`](crate::enums::Integrator::Implicit), or
    /// [`ImplicitFast`](crate::enums::Integrator::ImplicitFast) or
    /// [`Discrete`](crate::enums::Integrator::Discrete) of newer engines, whose step depends on
    /// derivatives of forces that the engine does not expose. The analytic method has formulas for
    /// the derivatives of `Implicit`, except for the forces of a medium, muscles, spatial tendons
    /// and actuators on sites. The method is [`Columns`](TransitionMethod::Columns).
    ImplicitIntegrator,
    /// The no-slip solver changes forces after the accelerations are computed, so inverse dynamics
    /// does not invert the step. The method is [`Columns`](TransitionMethod::Columns).
    NoSlip,
    /// The model has a value that the method does not understand: `field` is the field of
    /// `mjModel`, such as `jnt_springyield`, or of its options, such as `opt.enableflags`, and
    /// `element` is the index of the first such element, zero for options and sizes.
    ///
    /// Each method states which values of which fields it understands. Everything else must have
    /// its default, so features that newer engines add are not understood until they are examined.
    /// The method is [`Implicit`](TransitionMethod::Implicit) if that understands the model, else
    /// [`Columns`](TransitionMethod::Columns).
    ///
    /// The analytic method does not understand flexes, plugins, compensation of gravity, stiffness
    /// and damping of higher order, plastic deformation, damping and armature of actuators,
    /// armature of tendons, activations that act within the step, limits of actuator forces at
    /// joints or tendons, adhesion and surface velocity of geoms, `solreffriction` of pairs,
    /// equality constraints between sites, fixed tendons at ball and free joints (before 4.0),
    /// disabled groups of actuators, springs disabled without dampers or dampers without springs,
    /// the flag `EULERDAMP`, and options that newer engines can enable. Of these, the implicit
    /// method understands compensation of gravity, stiffness of higher order, damping of higher
    /// order of tendons, activations that act within the step, adhesion, surface velocity,
    /// `solreffriction`, constraints between sites, fixed tendons, and springs or dampers disabled
    /// alone. Neither understands sensors of contacts and of the actuator forces at joints or
    /// tendons.
    NotUnderstood {
        /// Field of `mjModel`, or `opt.` and the field of `mjOption`.
        field: &'static str,
        /// Index of the element.
        element: usize,
    },
    /// The formulas were not verified with this version of the engine. The method is
    /// [`Columns`](TransitionMethod::Columns).
    EngineVersion,
    /// The constraint solver stopped too far from the accelerations that satisfy the equations of
    /// motion, because of its iteration limit or its tolerance. The method is
    /// [`Columns`](TransitionMethod::Columns).
    NotConverged,
    /// A medium exerts forces on geoms of the [ellipsoid model](crate::Model::geom_fluid), for
    /// which the analytic method has no formula. The method is
    /// [`Implicit`](TransitionMethod::Implicit).
    Fluid,
    /// The analytic method has no formula for a spatial tendon: it winds around a geom, a segment
    /// has no length, or an equality constraint acts on it. The method is
    /// [`Implicit`](TransitionMethod::Implicit).
    SpatialTendon,
    /// The analytic method has no formula for an actuator: it covers motors, servos, other affine
    /// gains and biases, and muscles on hinges, slides, tendons and sites without a reference site,
    /// and motors on other joints. The method is [`Implicit`](TransitionMethod::Implicit).
    Actuator,
    /// The analytic method has no formula for a constraint that exerts a force, for example a
    /// contact of convex meshes, whose collision function iterates, or with engines from 3.7 a
    /// `connect` or `weld` constraint. The method is [`Implicit`](TransitionMethod::Implicit).
    Constraint,
    /// A derivative in closed form is not finite, for example the derivative of the limit of a ball
    /// joint at its zero rotation. The method is [`Implicit`](TransitionMethod::Implicit).
    Singular,
}

impl fmt::Display for Fallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Callbacks => "the simulation has callbacks",
            Self::RungeKutta => "the integrator is Rk4",
            Self::ImplicitIntegrator => "the integrator is Implicit",
            Self::NoSlip => "the no-slip solver is on",
            Self::NotUnderstood { field, element } => {
                return write!(f, "the method does not understand the value of {field}, element {element}");
            }
            Self::EngineVersion => "the formulas were not verified with this version of the engine",
            Self::NotConverged => "the constraint solver has not converged",
            Self::Fluid => "a medium acts on ellipsoids",
            Self::SpatialTendon => "a spatial tendon has no closed form",
            Self::Actuator => "an actuator has no closed form",
            Self::Constraint => "a constraint has no closed form",
            Self::Singular => "a derivative is not finite",
        })
    }
}

bitflags! {
    /// Terms that the [analytic](TransitionMethod::Analytic) method computes by differences.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    pub struct DifferencedTerms: u32 {
        /// Rows of C and D: by differences of inverse dynamics, for sensors without a formula.
        /// These are the [`differenced_sensors`](super::Lineariser::differenced_sensors) of the
        /// lineariser.
        const SENSORS = 1;
        /// Geometry of contacts between shapes without a formula, such as boxes with boxes: by
        /// differences of their collision function.
        const CONTACTS = 1 << 1;
        /// Derivatives by parameters without a formula: by differences of the equations of motion
        /// at constant accelerations, or of steps. These are the
        /// [`differenced_parameters`](super::Lineariser::differenced_parameters) of the lineariser.
        const PARAMETERS = 1 << 2;
    }
}

bitflags! {
    /// Kinks of a step at the state of a linearisation, where derivatives have two sides, and
    /// differences that do not converge.
    ///
    /// The side is the one on which the input moves into its range. Where both directions are
    /// possible, a muscle contracts: its control grows, and its activation decreases. The methods
    /// [`Columns`](TransitionMethod::Columns), [`Implicit`](TransitionMethod::Implicit) and
    /// [`Analytic`](TransitionMethod::Analytic) differentiate controls and activations on that
    /// side. [`Engine`](TransitionMethod::Engine), which is the engine's own function, does so only
    /// for controls at the ends of their ranges; its central differences are means of both sides at
    /// the other kinks.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    pub struct Kinks: u32 {
        /// The control of a muscle equals its activation, as in every steady state, so that it is
        /// between contraction (the time constant of activation) and relaxation (the time constant
        /// of deactivation, with which it may be several times slower). The derivatives are for
        /// contraction, except the derivative by a control at the upper end of its range, or by an
        /// activation at the lower end of its range. Or the activation is 0 or 1, beyond which it
        /// does not affect the time constants: the derivative is the one inside.
        const MUSCLES = 1;
        /// A control is at an end of its range, beyond which it has no effect. The derivative is
        /// that inside the range.
        const CONTROLS = 1 << 1;
        /// An activation after the step is at an end of its range. The derivative is that inside
        /// the range. The method `Engine` does not report this kink.
        const ACTIVATIONS = 1 << 2;
        /// The force of an actuator is at an end of its range. The method `Analytic` gives the
        /// derivative inside the range. The others report [`DIFFERENCES`](Self::DIFFERENCES).
        const FORCES = 1 << 3;
        /// A contact, a limit of a joint or a limit of a tendon begins or ceases to act: the
        /// distance equals the margin, or the force is zero. Or the friction loss of a joint or a
        /// tendon is exactly at its limit. Or the violation of a constraint whose `solimp` has the
        /// power 1 is zero or equals the width. The method `Analytic` gives the derivative for the
        /// constraints that act at present. Or two geoms in contact have equal friction (or equal
        /// numbers in a `solref` of direct format), of which the contact has the larger (the
        /// smaller), and the derivative is by that number: it is the mean of both sides. The others
        /// report [`DIFFERENCES`](Self::DIFFERENCES), except for inverse dynamics.
        const CONSTRAINTS = 1 << 4;
        /// Differences to the right and to the left disagree by more than 2 %, with each step that
        /// was tried, so that some entries are not derivatives. Either there is a kink, of which
        /// central differences give the mean slope of the sides, or they do not converge because
        /// the result jumps: for example contacts of meshes, whose collision function stops at a
        /// tolerance, or bodies that penetrate each other deeply. Or the constraint solver stops at
        /// the limit of its [iterations](crate::model::Options::iterations) before it has
        /// converged, as PGS often does for stacks of bodies. Without a step in the
        /// [options](super::TransitionOptions::eps), differences that disagree by more than 0.2 %
        /// are repeated with steps that are 10 times smaller, and 10 and 100 times larger. At
        /// contacts whose collision function can jump (of all shapes, except with planes and
        /// between spheres and capsules), differences by positions must also agree with the
        /// differences of the double step. Only [central](super::Differences::Central) differences
        /// can be checked for kinks and jumps, and the differences of the method `Engine` cannot be
        /// checked at all.
        const DIFFERENCES = 1 << 5;
        /// The length of a tendon is at an end of the range in which its spring is slack
        /// (`springlength`). The method `Analytic` gives the derivative of the slack spring. The
        /// others report [`DIFFERENCES`](Self::DIFFERENCES), except for inverse dynamics.
        const SPRINGS = 1 << 6;
    }
}

/// Report of the method by which a step was linearised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct LinearisationReport {
    /// Method that was used.
    pub method: TransitionMethod,
    /// Reason why it is not the requested one; `None` if it is.
    pub fallback: Option<Fallback>,
    /// Terms that the analytic method computed by differences. Empty for the other methods, which
    /// are differences throughout.
    pub differenced: DifferencedTerms,
    /// Kinks at the state: the derivative exists on each side only, or does not exist.
    pub kinks: Kinks,
}

impl LinearisationReport {
    /// Creates the report of a method without differenced terms or kinks.
    pub(crate) fn new(method: TransitionMethod, fallback: Option<Fallback>) -> Self {
        Self { method, fallback, differenced: DifferencedTerms::empty(), kinks: Kinks::empty() }
    }

    /// Adds the report of another computation.
    pub(super) fn merge(&mut self, other: Self) {
        self.kinks |= other.kinks;
        self.differenced |= other.differenced;
        if other.fallback.is_some() || other.method != TransitionMethod::Analytic {
            (self.method, self.fallback) = (other.method, other.fallback);
        }
    }

    /// Returns `true` if the linearisation has left its simulation at the base point: in closed
    /// form, without differences of sensors.
    pub(super) fn is_at_point(self) -> bool {
        self.method == TransitionMethod::Analytic && !self.differenced.contains(DifferencedTerms::SENSORS)
    }
}
