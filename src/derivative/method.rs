//! By which method a step is linearised, and which one it was in the end.

use std::fmt;

use super::Differences;

/// How [`Lineariser`](super::Lineariser) linearises a step of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TransitionMethod {
    /// The engine's own differences, [`Data::transition_fd`](crate::Data::transition_fd), in one thread.
    Engine,
    /// The same differences, column by column, shared among the threads.
    Columns,
    /// By the implicit function theorem, from differences of inverse dynamics, which needs no solver: several times faster than
    /// differences of a step, and at least as accurate. The columns are shared among the threads. Where it does not hold,
    /// [`Columns`](Self::Columns) takes its place, and [`LinearisationReport`] says so.
    Inverse,
}

/// What [`Lineariser`](super::Lineariser) does, and with how many threads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionOptions {
    /// The method; [`Inverse`](TransitionMethod::Inverse) unless it is changed.
    pub method: TransitionMethod,
    /// Whether differences are taken to one side or to both.
    pub differences: Differences,
    /// The step of the differences, or one that suits the method that is used: `1e-7` through inverse dynamics, and `1e-6` for
    /// differences of a step, where it has to be large against the tolerance of the solver.
    pub eps: Option<f64>,
    /// How many threads of rayon's pool work at the same time, at most 1024; each has a simulation of its own. The result is the
    /// same for any number, to the last bit. A thread that the operating system puts on the caller's processor brings nothing,
    /// which happens in virtual machines, for milliseconds: there, make the call in a pool whose threads keep to a processor each.
    pub threads: usize,
}

impl Default for TransitionOptions {
    /// Through inverse dynamics, in one thread, by central differences with a step that suits the method.
    fn default() -> Self {
        Self { method: TransitionMethod::Inverse, differences: Differences::Central, eps: None, threads: 1 }
    }
}

impl TransitionOptions {
    /// How differences are taken by a method.
    pub(super) fn step(&self, method: TransitionMethod) -> Step {
        let suitable = if method == TransitionMethod::Inverse { 1e-7 } else { 1e-6 };
        Step { differences: self.differences, eps: self.eps.unwrap_or(suitable) }
    }
}

/// How differences are taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) differences: Differences,
    pub(super) eps: f64,
}

/// Why another method than the one asked for was used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fallback {
    /// The simulation has [callbacks](crate::callback), which only its own calls can make:
    /// [`Engine`](TransitionMethod::Engine) instead.
    Callbacks,
    /// The integrator is Runge–Kutta, of which the engine's differences would mix stages:
    /// [`Columns`](TransitionMethod::Columns) instead, with whole steps.
    RungeKutta,
    /// The integrator is [`Implicit`](crate::Integrator::Implicit), whose step depends on derivatives of forces that the engine
    /// does not give out: [`Columns`](TransitionMethod::Columns) instead.
    ImplicitIntegrator,
    /// The no-slip solver changes forces after the accelerations they belong to are known, so that inverse dynamics is not the
    /// inverse: [`Columns`](TransitionMethod::Columns) instead.
    NoSlip,
    /// The constraint solver has stopped before it found the accelerations that inverse dynamics belongs to, because of its
    /// limit of iterations or its tolerance: [`Columns`](TransitionMethod::Columns) instead.
    NotConverged,
}

impl fmt::Display for Fallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Callbacks => "the simulation has callbacks",
            Self::RungeKutta => "the integrator is Rk4",
            Self::ImplicitIntegrator => "the integrator is Implicit",
            Self::NoSlip => "the no-slip solver is on",
            Self::NotConverged => "the constraint solver has not converged",
        })
    }
}

/// By which method a step was linearised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinearisationReport {
    /// The method.
    pub method: TransitionMethod,
    /// Why it is not the one that was asked for, if it is not.
    pub fallback: Option<Fallback>,
}
