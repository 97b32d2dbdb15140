//! Tasks: residuals with weights, gains and priorities.

use std::fmt;

use crate::control::residual::Residual;
use crate::error::{Error, InvalidKind, Result};
use crate::macros::with_methods;

/// Task of an [`Ik`](super::Ik), in the order of their addition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TaskId(pub(super) usize);

impl TaskId {
    pub(super) fn unknown(self, count: usize) -> Error {
        Error::invalid(InvalidKind::Unknown, "the id of a task", self.0, format!("one of the {count} tasks"))
    }
}

/// Weighted residual that a tick decreases. See the [module](crate::ik) for the residuals.
#[non_exhaustive]
pub struct Task {
    /// Weight w of half the square; 1 by default. A task with the weight zero has no effect.
    pub weight: f64,
    /// Fraction k of the residual that a tick removes; 1 by default.
    pub gain: f64,
    /// Levenberg–Marquardt damping: this factor times the weighted square of the residual, added to
    /// the diagonal of the matrix; 0 by default. It shortens steps far from the target.
    pub damping: f64,
    pub(super) priority: u32,
    /// `(n)`: factors of w for each component; empty for 1.
    pub(super) weights: Vec<f64>,
    pub(super) residual: Box<dyn Residual>,
    /// True if the velocity makes the residual zero, and not the position.
    pub(super) is_rate: bool,
    /// `(n)`: residual before the last tick.
    pub(super) error: Vec<f64>,
}

impl Task {
    /// Creates a task that brings a function of the position to zero.
    pub fn new(residual: impl Residual + 'static) -> Self {
        Self {
            weight: 1.0,
            gain: 1.0,
            damping: 0.0,
            priority: 0,
            weights: Vec::new(),
            error: vec![0.0; residual.size()],
            residual: Box::new(residual),
            is_rate: false,
        }
    }

    /// Creates a task that brings a linear function of the velocity to zero, such as a momentum
    /// minus its target. Its gain has no effect.
    ///
    /// ```
    /// use mujoco_safe::control::residual::Subtree;
    /// use mujoco_safe::ik::{Ik, Task};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// let mut ik = Ik::new(data.model());
    /// // Rotate about the vertical axis.
    /// let momentum = Subtree::angular_momentum(data.model(), "torso")?;
    /// ik.add_task(Task::rate(momentum.with_target([0.0, 0.0, 0.1])));
    /// let velocity = ik.solve(&mut data, 0.01)?.velocity().to_vec();
    /// data.qvel_mut().copy_from_slice(&velocity);
    /// data.forward()?;
    /// data.subtree_vel()?;
    /// let momentum = data.body("torso")?.subtree_angmom()?;
    /// assert!(momentum[0].abs() < 1e-6 && (momentum[2] - 0.1).abs() < 1e-6);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn rate(residual: impl Residual + 'static) -> Self {
        Self { is_rate: true, ..Self::new(residual) }
    }

    /// Sets the weights of the components, which are multiplied by the weight of the task. A
    /// component with the weight zero is free. [`Ik::prepare`](super::Ik::prepare) checks that
    /// there is one for each component.
    #[must_use]
    pub fn with_weights(mut self, weights: impl Into<Vec<f64>>) -> Self {
        self.weights = weights.into();
        self
    }

    /// Sets the priority; 0, the first, by default. Tasks of a lower priority, with a larger
    /// number, do not change the velocities that those of higher priorities ask for.
    #[must_use]
    pub fn with_priority(mut self, priority: u32) -> Self {
        self.priority = priority;
        self
    }

    /// Returns the number of components.
    pub fn size(&self) -> usize {
        self.residual.size()
    }

    /// Sets the target of the residual.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] for a number that is not finite,
    /// [`Error::Unsupported`] for a residual without a target.
    pub fn set_target(&mut self, target: &[f64]) -> Result<()> {
        let Some(present) = self.residual.target_mut() else {
            return Err(Error::Unsupported("the residual of the task has no target".to_owned()));
        };
        Error::check_length("the target of a task", target.len(), present.len())?;
        Error::check_finite(target, |index| format!("component {index} of the target of a task"))?;
        present.copy_from_slice(target);
        Ok(())
    }

    /// Returns the priority and the size, on which the workspace depends.
    pub(super) fn layout(&self) -> (u32, usize) {
        (self.priority, self.size())
    }

    /// Checks the number of weights, and creates the buffer of the residual.
    pub(super) fn prepare(&mut self) -> Result<()> {
        if self.weights.is_empty() {
            self.weights = vec![1.0; self.size()];
        }
        Error::check_length("the weights of a task", self.weights.len(), self.size())?;
        self.error.resize(self.size(), 0.0);
        Ok(())
    }

    /// Checks the numbers, which can change between two ticks.
    pub(super) fn check(&self, index: usize) -> Result<()> {
        let numbers = [("weight", self.weight), ("gain", self.gain), ("damping", self.damping)];
        let weights = self.weights.iter().map(|weight| ("weight of a component", *weight));
        for (what, value) in numbers.into_iter().chain(weights) {
            Error::check_not_negative(format_args!("the {what} of task {index}"), value)?;
        }
        Ok(())
    }
}

with_methods!(Task { with_weight(weight: f64), with_gain(gain: f64), with_damping(damping: f64) });

impl fmt::Debug for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { weight, gain, damping, priority, .. } = self;
        write!(
            f,
            "Task: weight {weight}, gain {gain}, damping {damping}, priority {priority}, {} components",
            self.size()
        )
    }
}
