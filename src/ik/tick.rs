//! One tick: the constraints, the quadratic programs of all priorities, and the result.

use super::Ik;
use super::inequality::Inequality;
use super::limit::Limit;
use super::limits::{self, Motion};
use super::objective::Objective;
use crate::control::residual::Needs;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::math::{Qp, QpProblem, QpSolution, QpStatus};

/// Termination status of a tick. Unless it is [`Solved`](Self::Solved), the joints brake within
/// their own limits. If only a lower priority has failed, the velocity is that of the higher ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum IkStatus {
    /// The velocity is the best one within all limits.
    Solved,
    /// The limits contradict each other: see [`Tick::conflicts`].
    Infeasible,
    /// A quadratic program did not converge.
    IterationLimit,
    /// The tasks leave freedom, and the regularisation is too small.
    NotPositiveDefinite,
    /// A number exceeded the range of `f64`.
    Overflow,
}

/// Result of [`Ik::solve`].
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    status: IkStatus,
    iterations: u32,
    velocity: &'a [f64],
    active: &'a [Limit],
    conflicts: &'a [Limit],
    violation: f64,
}

impl<'a> Tick<'a> {
    /// Returns the status.
    pub fn status(&self) -> IkStatus {
        self.status
    }

    /// Returns `true` if the status is [`IkStatus::Solved`].
    pub fn is_solved(&self) -> bool {
        self.status == IkStatus::Solved
    }

    /// Returns the velocity `(nv)`, as `qvel`: m/s and rad/s.
    pub fn velocity(&self) -> &'a [f64] {
        self.velocity
    }

    /// Returns the limits that hold the tasks back, without those of
    /// [`Limit::Equation`](Limit::Equation).
    pub fn active(&self) -> &'a [Limit] {
        self.active
    }

    /// Returns the limits that could not be met, because others contradict them: a joint outside of
    /// its range returns as fast as its other limits allow.
    pub fn conflicts(&self) -> &'a [Limit] {
        self.conflicts
    }

    /// Returns the number of iterations of the quadratic programs.
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    /// Returns the largest violation of the equality constraints of the model before the tick.
    pub fn equality_violation(&self) -> f64 {
        self.violation
    }
}

/// Solver of a priority.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) priority: u32,
    pub(super) solver: Qp,
    /// `(nv)`
    displacement: Vec<f64>,
}

impl Level {
    pub(super) fn new(priority: u32, nv: usize, rows: usize) -> Self {
        Self { priority, solver: Qp::new(nv, rows), displacement: vec![0.0; nv] }
    }
}

/// # Ticks
impl Ik {
    /// Computes the velocity for a tick of `dt` seconds at the present positions. The positions do
    /// not change. Computes the results of the pipeline that the tasks need: for tasks of poses,
    /// those of [`Data::kinematics`] and [`Data::com_pos`].
    ///
    /// After the first call, solving does not allocate.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a simulation of a model that was loaded separately,
    /// [`Error::Invalid`] for a `dt` that is not above zero and finite, a weight, a gain or a
    /// damping that is negative or not finite, and a residual that is not finite; the errors of the
    /// residuals, of [`Data::kinematics`] and of [`Data::geom_distance`].
    ///
    /// # Panics
    ///
    /// If the residual of a task was created for another model.
    pub fn solve(&mut self, data: &mut Data, dt: f64) -> Result<Tick<'_>> {
        Error::check_range(dt > 0.0 && dt.is_finite(), "dt of Ik::solve", dt, "above zero and finite")?;
        let mut status = self.displace(data, Motion::Timed(dt))?;
        self.velocity.iter_mut().zip(&self.displacement).for_each(|(velocity, change)| *velocity = change / dt);
        if !self.velocity.iter().all(|value| value.is_finite()) {
            status = IkStatus::Overflow;
            self.velocity.fill(0.0);
        }
        Ok(self.tick(status))
    }

    /// Computes the velocity as [`solve`](Self::solve) does, and moves the positions.
    ///
    /// # Errors
    ///
    /// As for [`solve`](Self::solve).
    ///
    /// # Panics
    ///
    /// As for [`solve`](Self::solve).
    pub fn step(&mut self, data: &mut Data, dt: f64) -> Result<Tick<'_>> {
        let status = self.solve(data, dt)?.status;
        self.integrate(data, dt)?;
        Ok(self.tick(status))
    }

    /// Moves the positions by the velocity of the last tick for `dt` seconds. Rounding and the
    /// curvature of rotations do not move joints out of their ranges.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a simulation of a model that was loaded separately,
    /// [`Error::Invalid`] for a `dt` that is not finite.
    pub fn integrate(&mut self, data: &mut Data, dt: f64) -> Result<()> {
        self.check_model(data)?;
        limits::integrate(&mut self.inequalities, data, &self.velocity, dt)
    }

    fn tick(&self, status: IkStatus) -> Tick<'_> {
        let Self { iterations, velocity, active, conflicts, constraints, .. } = self;
        Tick { status, iterations: *iterations, velocity, active, conflicts, violation: constraints.violation }
    }

    pub(super) fn check_model(&self, data: &Data) -> Result<()> {
        self.model.relation(data.model()).check("the simulation of an Ik").map(drop)
    }

    /// Computes the displacement.
    pub(super) fn displace(&mut self, data: &mut Data, motion: Motion) -> Result<IkStatus> {
        self.check_model(data)?;
        self.prepare()?;
        let needs = Objective::needs(&self.tasks);
        if self.model.neq() > 0 && needs < Needs::Forward {
            data.fwd_position()?;
            if needs == Needs::Velocities {
                data.com_vel()?;
                data.subtree_vel()?;
            }
        } else {
            needs.max(Needs::Poses).compute(data)?;
            let has_tendons = self.inequalities.iter().any(|limited| matches!(limited, Inequality::Length(_)));
            if has_tendons && needs < Needs::Forward {
                data.compute_tendon()?;
            }
        }
        self.objective.jacobian.move_point();
        self.active.clear();
        self.conflicts.clear();
        self.limits.compute(data, motion, &self.velocity, &mut self.conflicts)?;
        self.constraints.start(&self.inequalities, data)?;
        let (dt, damping) = match motion {
            Motion::Timed(dt) => (dt, 0.0),
            Motion::Free(_) => (1.0, 0.5),
        };
        self.iterations = 0;
        let last = self.levels.len() - 1;
        for index in 0..=last {
            let priority = self.levels[index].priority;
            let equations = (index < last).then_some(&mut self.constraints);
            self.objective.assemble(&mut self.tasks, priority, data, dt, damping, equations)?;
            let mut status = self.solve_level(index)?;
            if status == IkStatus::Infeasible && self.constraints.relax(&mut self.conflicts) {
                status = self.solve_level(index)?;
            }
            if status != IkStatus::Solved {
                if index == 0 {
                    self.brake();
                }
                return Ok(status);
            }
            self.constraints.hold(&self.displacement);
        }
        Ok(IkStatus::Solved)
    }

    /// Solves the quadratic program of a priority. Writes the displacement and the active limits,
    /// or a limit that contradicts others.
    fn solve_level(&mut self, index: usize) -> Result<IkStatus> {
        let Self { constraints, limits, objective, .. } = self;
        if !objective.gradient.iter().all(|slope| slope.is_finite()) || !constraints.is_finite() {
            return Ok(IkStatus::Overflow);
        }
        let Level { solver, displacement, .. } = &mut self.levels[index];
        let problem = QpProblem::new(&objective.matrix, &objective.gradient)
            .with_bounds(&limits.lower, &limits.upper)
            .with_constraints(&constraints.rows, &constraints.lower, &constraints.upper);
        let QpSolution { status, iterations, bound_multipliers, constraint_multipliers, conflict } =
            solver.solve(displacement, &problem)?;
        self.iterations += iterations;
        let status = match status {
            QpStatus::Solved => IkStatus::Solved,
            QpStatus::Infeasible => IkStatus::Infeasible,
            QpStatus::IterationLimit => IkStatus::IterationLimit,
            QpStatus::NotPositiveDefinite => IkStatus::NotPositiveDefinite,
            QpStatus::Overflow => IkStatus::Overflow,
        };
        if status != IkStatus::Solved {
            let limit = conflict.and_then(|conflict| match conflict.checked_sub(bound_multipliers.len()) {
                None => limits.causes[conflict][usize::from(limits.lower[conflict] <= 0.0)],
                Some(row) => Some(constraints.causes[row]),
            });
            self.conflicts.extend(limit);
            return Ok(status);
        }
        self.active.clear();
        let of_joints = bound_multipliers.iter().enumerate().filter(|(_, multiplier)| **multiplier != 0.0);
        self.active.extend(of_joints.filter_map(|(dof, value)| limits.causes[dof][usize::from(*value > 0.0)]));
        let of_rows = constraint_multipliers.iter().zip(&constraints.causes).skip(constraints.capacity);
        self.active.extend(of_rows.filter(|(value, _)| **value != 0.0).map(|(_, cause)| cause));
        self.displacement.copy_from_slice(displacement);
        Ok(status)
    }

    /// Sets the displacement that is nearest to zero within the bounds of the joints.
    fn brake(&mut self) {
        let bounds = self.limits.lower.iter().zip(&self.limits.upper);
        self.displacement
            .iter_mut()
            .zip(bounds)
            .for_each(|(change, (lower, upper))| *change = 0_f64.max(*lower).min(*upper));
    }
}
