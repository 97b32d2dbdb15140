//! One tick: the constraints, the quadratic programs of all priorities, and the result.

use super::Ik;
use super::limit::Limit;
use super::limits::Motion;
use super::objective::{Damping, Objective};
use crate::control::residual::Needs;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::math::{Qp, QpProblem, QpSolution, QpStatus};
use crate::numerics::linear_algebra::dot;

/// Half the width of the equations of higher priorities, relative to `1 + |x|`.
const SLACK: f64 = 1e-10;

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
        let damping = Damping { relative: self.regularisation, of_residual: 0.0 };
        let (mut status, iterations) = self.displace(data, Motion::Timed(dt), damping)?;
        self.velocity.iter_mut().zip(&self.displacement).for_each(|(velocity, change)| *velocity = change / dt);
        if !self.velocity.iter().all(|value| value.is_finite()) {
            status = IkStatus::Overflow;
            self.velocity.fill(0.0);
        }
        Ok(self.tick(status, iterations))
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
        let (status, iterations) = {
            let tick = self.solve(data, dt)?;
            (tick.status, tick.iterations)
        };
        self.integrate(data, dt)?;
        Ok(self.tick(status, iterations))
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
        let model = data.model().clone();
        self.limits.integrate(&model, data.qpos_mut(), &self.velocity, dt)
    }

    fn tick(&self, status: IkStatus, iterations: u32) -> Tick<'_> {
        let Self { velocity, active, conflicts, .. } = self;
        Tick { status, iterations, velocity, active, conflicts, violation: self.equations.violation }
    }

    pub(super) fn check_model(&self, data: &Data) -> Result<()> {
        self.model.relation(data.model()).check("the simulation of an Ik").map(drop)
    }

    /// Computes the displacement.
    pub(super) fn displace(&mut self, data: &mut Data, motion: Motion, damping: Damping) -> Result<(IkStatus, u32)> {
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
            if self.tendons.len() > 0 && needs < Needs::Forward {
                data.compute_tendon()?;
            }
        }
        self.objective.move_point();
        self.active.clear();
        self.conflicts.clear();
        self.limits.compute(data, motion, &self.velocity, &mut self.conflicts)?;
        self.write_constraints(data)?;
        let dt = if let Motion::Timed(dt) = motion { dt } else { 1.0 };
        let mut iterations = 0;
        let last = self.levels.len() - 1;
        for index in 0..=last {
            let priority = self.levels[index].priority;
            self.objective.assemble(&mut self.tasks, priority, data, dt, damping)?;
            self.write_equations(index > 0);
            let mut solved = self.solve_level(index)?;
            iterations += solved.1;
            if solved.0 == IkStatus::Infeasible && self.relax_rows() {
                solved = self.solve_level(index)?;
                iterations += solved.1;
            }
            if solved.0 != IkStatus::Solved {
                if index == 0 {
                    self.brake();
                }
                return Ok((solved.0, iterations));
            }
            if index < last {
                let Self { objective, equations, displacement, tasks, .. } = self;
                objective.for_each_row(tasks, priority, data, |row| equations.push(row))?;
                equations.hold(displacement);
            }
        }
        Ok((IkStatus::Solved, iterations))
    }

    /// Solves the quadratic program of a priority. Writes the displacement and the active limits,
    /// or a limit that contradicts others. Returns the status and the number of iterations.
    fn solve_level(&mut self, index: usize) -> Result<(IkStatus, u32)> {
        let numbers = self.objective.gradient.iter().chain(self.row_limits[0].iter().take(self.equations.count()));
        if !numbers.copied().all(f64::is_finite) {
            return Ok((IkStatus::Overflow, 0));
        }
        let Level { solver, displacement, .. } = &mut self.levels[index];
        let mut problem = QpProblem::new(&self.objective.matrix, &self.objective.gradient)
            .with_bounds(&self.limits.lower, &self.limits.upper);
        if self.constraints.nrows() > 0 {
            problem = problem.with_constraints(&self.constraints, &self.row_limits[0], &self.row_limits[1]);
        }
        let QpSolution { status, iterations, bound_multipliers, constraint_multipliers, conflict } =
            solver.solve(displacement, &problem)?;
        let status = match status {
            QpStatus::Solved => IkStatus::Solved,
            QpStatus::Infeasible => IkStatus::Infeasible,
            QpStatus::IterationLimit => IkStatus::IterationLimit,
            QpStatus::NotPositiveDefinite => IkStatus::NotPositiveDefinite,
            QpStatus::Overflow => IkStatus::Overflow,
        };
        let equations = self.equations.capacity();
        if status != IkStatus::Solved {
            let limit = conflict.and_then(|conflict| match conflict.checked_sub(bound_multipliers.len()) {
                None => self.limits.causes[conflict][usize::from(self.limits.lower[conflict] <= 0.0)],
                Some(row) => Some(self.row_causes[row]),
            });
            self.conflicts.extend(limit);
            return Ok((status, iterations));
        }
        self.active.clear();
        let of_joints = bound_multipliers.iter().enumerate().filter(|(_, multiplier)| **multiplier != 0.0);
        self.active
            .extend(of_joints.filter_map(|(dof, multiplier)| self.limits.causes[dof][usize::from(*multiplier > 0.0)]));
        let of_rows = constraint_multipliers.iter().enumerate().skip(equations).filter(|(_, value)| **value != 0.0);
        self.active.extend(of_rows.map(|(row, _)| self.row_causes[row]));
        self.displacement.copy_from_slice(displacement);
        Ok((status, iterations))
    }

    /// No longer asks pairs that are too near to move apart, and tendons outside of their ranges to
    /// return, and reports them. Returns `false` if there are none.
    fn relax_rows(&mut self) -> bool {
        let before = self.conflicts.len();
        let first = self.equations.capacity();
        let Self { row_limits: [lower, upper], row_causes, conflicts, .. } = self;
        for row in first..lower.len() {
            if lower[row] > 0.0 || upper[row] < 0.0 {
                (lower[row], upper[row]) = (lower[row].min(0.0), upper[row].max(0.0));
                conflicts.push(row_causes[row]);
            }
        }
        conflicts.len() > before
    }

    /// Sets the displacement that is nearest to zero within the bounds of the joints.
    fn brake(&mut self) {
        let bounds = self.limits.lower.iter().zip(&self.limits.upper);
        self.displacement
            .iter_mut()
            .zip(bounds)
            .for_each(|(change, (lower, upper))| *change = 0_f64.max(*lower).min(*upper));
    }

    /// Writes the rows of the pairs, of the balls and of the tendons, and finds the equations of
    /// the model.
    fn write_constraints(&mut self, data: &mut Data) -> Result<()> {
        self.equations.clear();
        if self.model.neq() > 0 {
            self.equations.push_constraints(data);
        }
        let (pairs, balls) = (self.pairs.len(), self.limits.limited_balls.len());
        let first = self.equations.capacity();
        let [lower, upper] = &mut self.row_limits;
        let buffers = &mut self.buffers;
        for (index, pair) in self.pairs.iter().enumerate() {
            lower[first + index] = pair.write(data, buffers, self.constraints.row_mut(first + index))?;
        }
        for (index, ball) in self.limits.limited_balls.iter().enumerate() {
            let place = first + pairs + index;
            let row = self.constraints.row_mut(place);
            row.fill(0.0);
            upper[place] = f64::INFINITY;
            if let Some((axis, angle)) = ball.rotation(data.qpos()) {
                row[ball.dof..ball.dof + 3].copy_from_slice(&axis);
                // A ball outside of its range does not move farther out.
                upper[place] = (data.model().jnt_range()[ball.joint][1] - angle).max(0.0);
            }
        }
        for index in 0..self.tendons.len() {
            let place = first + pairs + balls + index;
            [lower[place], upper[place]] = self.tendons.write(data, index, self.constraints.row_mut(place))?;
        }
        Ok(())
    }

    /// Writes the equations to the rows of the constraints. After the first priority, widens the
    /// limits of all rows so that they contain the present displacement despite rounding.
    fn write_equations(&mut self, contains_present: bool) {
        let Self { constraints, row_limits: [lower, upper], equations, displacement, .. } = self;
        let largest = displacement.iter().fold(0.0, |largest: f64, change| largest.max(change.abs()));
        let slack = if contains_present { SLACK * (1.0 + largest) } else { 0.0 };
        for (index, (row, right)) in equations.iter().enumerate() {
            constraints.row_mut(index).copy_from_slice(row);
            (lower[index], upper[index]) = (right - slack, right + slack);
        }
        for index in equations.count()..equations.capacity() {
            (lower[index], upper[index]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        if contains_present {
            for index in equations.capacity()..constraints.nrows() {
                let value = dot(constraints.row(index), displacement);
                lower[index] = lower[index].min(value);
                upper[index] = upper[index].max(value);
            }
        }
    }
}
