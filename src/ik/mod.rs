//! Inverse kinematics: joint velocities and positions for poses of hands, feet, heads and centres
//! of mass.
//!
//! ```
//! use mujoco_safe::control::residual::{Frame, FramePose, FramePosition, JointPosition};
//! use mujoco_safe::ik::{Ik, Task};
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.reset_to_key("stand")?;
//! data.kinematics()?;
//! let model = data.model().clone();
//! let mut ik = Ik::new(&model);
//!
//! // Keep the feet on the ground, lift a hand, and prefer the present posture.
//! for foot in ["foot_left", "foot_right"] {
//!     let pose = FramePose::new(Frame::body(&model, foot)?);
//!     let body = data.body(foot)?;
//!     ik.add_task(Task::new(pose.with_target(*body.xpos(), *body.xquat())));
//! }
//! let hand = ik.add_task(Task::new(FramePosition::body(&model, "hand_left")?));
//! ik.add_task(Task::new(JointPosition::all(&model).with_target(data.qpos())?).with_weight(1e-4));
//! ik.set_velocity_limits(2.0)?; // rad/s
//!
//! let target = [0.3, 0.4, 1.2];
//! ik.set_target(hand, &target)?;
//! for _ in 0..100 {
//!     let tick = ik.step(&mut data, 0.01)?;
//!     assert!(tick.is_solved());
//! }
//! data.kinematics()?;
//! assert!((data.body("hand_left")?.xpos()[2] - target[2]).abs() < 1e-2);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # The problem of a tick
//!
//! A [`Task`] is a [residual](crate::control::residual) r with a weight. In a tick of dt, the
//! displacement `x = v dt` in the tangent space of positions minimises
//!
//! ```text
//! Σ_t ½ w_t ‖S_t (J_t x + k_t r_t)‖² + ½ μ ‖x‖²
//! ```
//!
//! with scales S, the Jacobian J and a gain k of each task, within the limits of positions,
//! velocities and accelerations ([`Ik::set_velocity_limit`], …), and distances between geoms
//! ([`Ik::avoid`]). Tasks of a lower [priority](Task::with_priority) use only the freedom that
//! those of higher ones leave (O. Kanoun, F. Lamiraux, P.-B. Wieber, "Kinematic control of
//! redundant manipulators: generalizing the task-priority framework to inequality tasks", IEEE
//! Transactions on Robotics 27, 2011). Equality constraints of the model, which close chains, have
//! the first priority. The quadratic programs are solved by [`Qp`](crate::math::Qp).
//!
//! | purpose | residual |
//! |---|---|
//! | pose of a frame, also relative to another | [`FramePose`], [`FramePosition`], [`FrameOrientation`] |
//! | centre of mass | [`Subtree::com`] |
//! | posture | [`JointPosition`] |
//! | coupled joints | [`JointCoupling`] |
//! | direction of a camera or a tool | [`Gaze`] |
//! | linear and angular momentum | [`Task::rate`] of [`Subtree::velocity`], [`Subtree::angular_momentum`] |
//! | small velocities | [`Task::rate`] of [`JointVelocity`] |
//! | any other | an implementation of [`Residual`] |
//!
//! Free joints move a base, which is fixed by [`Ik::prescribe_velocity`], or moved with a given
//! velocity. Poses of mocap bodies are read in each tick.
//!
//! [`Ik::solve`] computes a tick, [`Ik::step`] also moves the positions. [`Ik::search`] finds
//! positions from random starts.
//!
//! The lengths of tendons with a range stay within it, up to the curvature of spatial tendons:
//! their lengths are linear in the displacement only for small ticks. A length outside of its range
//! returns if the other limits allow it; if they do not, it does not move farther out.
//!
//! # For users of mink
//!
//! | mink | here |
//! |---|---|
//! | `Configuration` | [`Data`](crate::Data) |
//! | `FrameTask(…, position_cost=a, orientation_cost=b)` | `Task::new(FramePose::new(frame)).with_weights([a², a², a², b², b², b²])` |
//! | `PostureTask`, `ComTask`, `LookAtTask` | [`JointPosition`], [`Subtree::com`], [`Gaze`] |
//! | `DampingTask` | [`Task::rate`] of [`JointVelocity`] |
//! | `lm_damping` | [`Task::with_damping`] |
//! | `ConfigurationLimit` | always active, also for tendons; [`Ik::set_position_margin`] |
//! | `VelocityLimit`, `CollisionAvoidanceLimit` | [`Ik::set_velocity_limit`], [`Ik::avoid`] |
//! | `DofFreezingTask` | [`Ik::prescribe_velocity`] |
//! | `EqualityConstraintTask` | always active |
//! | `solve_ik`, `integrate_inplace` | [`Ik::solve`], [`Ik::integrate`] |
//!
//! [`FramePose`]: crate::control::residual::FramePose
//! [`FramePosition`]: crate::control::residual::FramePosition
//! [`FrameOrientation`]: crate::control::residual::FrameOrientation
//! [`Gaze`]: crate::control::residual::Gaze
//! [`JointCoupling`]: crate::control::residual::JointCoupling
//! [`JointPosition`]: crate::control::residual::JointPosition
//! [`JointVelocity`]: crate::control::residual::JointVelocity
//! [`Residual`]: crate::control::residual::Residual
//! [`Subtree::angular_momentum`]: crate::control::residual::Subtree::angular_momentum
//! [`Subtree::com`]: crate::control::residual::Subtree::com
//! [`Subtree::velocity`]: crate::control::residual::Subtree::velocity

mod collision;
mod constraints;
mod inequality;
mod limit;
mod limits;
mod objective;
mod search;
mod settings;
mod task;
mod tick;

use std::sync::Arc;

pub use self::collision::Avoidance;
pub use self::limit::Limit;
pub use self::search::{SearchOptions, SearchOutcome, SearchResult};
pub use self::task::{Task, TaskId};
pub use self::tick::{IkStatus, Tick};

use self::constraints::Constraints;
use self::inequality::Inequality;
use self::limits::JointLimits;
use self::objective::Objective;
use self::tick::Level;
use crate::control::residual::ResidualJacobian;
use crate::error::Result;
use crate::model::{IntoModel, Model};

/// Inverse kinematics of a model: tasks, limits, and the workspace of their solution. See the
/// [module](crate::ik).
#[derive(Debug)]
pub struct Ik {
    model: Arc<Model>,
    tasks: Vec<Task>,
    limits: JointLimits,
    inequalities: Vec<Inequality>,
    objective: Objective,
    constraints: Constraints,
    /// Priorities in use, the first one first.
    levels: Vec<Level>,
    /// `(nv)`: displacement of the tick.
    displacement: Vec<f64>,
    /// `(nv)`: velocity of the last tick.
    velocity: Vec<f64>,
    active: Vec<Limit>,
    conflicts: Vec<Limit>,
    /// Number of iterations of the quadratic programs of the tick.
    iterations: u32,
    /// `(nq)`: first and best positions of a search.
    start: Vec<f64>,
    best: Vec<f64>,
    /// Priorities and sizes of the tasks for which the workspace was created.
    layout: Vec<(u32, usize)>,
    /// False if tasks may have changed since the workspace was created.
    is_prepared: bool,
}

impl Ik {
    /// Creates the inverse kinematics of a model, without tasks. The ranges of joints and tendons
    /// are limits. Takes a [`Model`], an `Arc<Model>` or an `&Arc<Model>`.
    pub fn new(model: impl IntoModel) -> Self {
        let model = model.into_model();
        let nv = model.nv();
        Self {
            tasks: Vec::new(),
            limits: JointLimits::new(&model),
            inequalities: inequality::of_ranges(&model).collect(),
            objective: Objective::new(&model),
            constraints: Constraints::new(0, &[], nv),
            levels: Vec::new(),
            displacement: vec![0.0; nv],
            velocity: vec![0.0; nv],
            active: Vec::new(),
            conflicts: Vec::new(),
            iterations: 0,
            start: vec![0.0; model.nq()],
            best: vec![0.0; model.nq()],
            layout: Vec::new(),
            is_prepared: false,
            model,
        }
    }

    /// Returns the model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Adds a task.
    pub fn add_task(&mut self, task: Task) -> TaskId {
        self.tasks.push(task);
        self.is_prepared = false;
        TaskId(self.tasks.len() - 1)
    }

    /// Returns a task.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) for the id of a task of other inverse kinematics
    /// with more tasks.
    pub fn task(&self, id: TaskId) -> Result<&Task> {
        self.tasks.get(id.0).ok_or_else(|| id.unknown(self.tasks.len()))
    }

    /// Returns a task, to change its weights, its gain, its damping or its target.
    ///
    /// # Errors
    ///
    /// As for [`task`](Self::task).
    pub fn task_mut(&mut self, id: TaskId) -> Result<&mut Task> {
        let count = self.tasks.len();
        // The caller can replace the task.
        self.is_prepared = false;
        self.tasks.get_mut(id.0).ok_or_else(|| id.unknown(count))
    }

    /// Sets the target of the residual of a task: for a pose, a position and a quaternion.
    ///
    /// # Errors
    ///
    /// As for [`task`](Self::task), [`Error::Shape`](crate::Error::Shape) for a wrong length,
    /// [`Error::Invalid`](crate::Error::Invalid) for a number that is not finite,
    /// [`Error::Unsupported`](crate::Error::Unsupported) for a residual without a target.
    pub fn set_target(&mut self, id: TaskId, target: &[f64]) -> Result<()> {
        let count = self.tasks.len();
        let task = self.tasks.get_mut(id.0).ok_or_else(|| id.unknown(count))?;
        task.set_target(target)
    }

    /// Returns the residual of a task at the positions before the last tick, without weights.
    ///
    /// # Errors
    ///
    /// As for [`task`](Self::task).
    pub fn error(&self, id: TaskId) -> Result<&[f64]> {
        Ok(&self.task(id)?.error)
    }

    /// Creates the workspace for the present tasks and pairs, as the first tick after a change
    /// does.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`](crate::Error::Shape) unless a task has one weight for each component.
    pub fn prepare(&mut self) -> Result<()> {
        if self.is_prepared {
            return Ok(());
        }
        self.tasks.iter_mut().try_for_each(Task::prepare)?;
        self.is_prepared = true;
        if !self.levels.is_empty() && self.layout.iter().copied().eq(self.tasks.iter().map(Task::layout)) {
            return Ok(());
        }
        self.layout = self.tasks.iter().map(Task::layout).collect();
        let nv = self.model.nv();
        let mut priorities: Vec<u32> = self.tasks.iter().map(|task| task.priority).collect();
        priorities.sort_unstable();
        priorities.dedup();
        if priorities.is_empty() {
            priorities.push(0);
        }
        let equations = if self.model.neq() > 0 || priorities.len() > 1 { nv } else { 0 };
        self.constraints = Constraints::new(equations, &self.inequalities, nv);
        let rows = self.constraints.causes.len();
        self.levels = priorities.into_iter().map(|priority| Level::new(priority, nv, rows)).collect();
        let largest = self.tasks.iter().map(Task::size).max().unwrap_or(0);
        self.objective.jacobian = ResidualJacobian::zeros(&self.model, largest);
        self.active = Vec::with_capacity(2 * nv + rows);
        // Each priority adds at most one limit, and each row is relaxed once.
        self.conflicts = Vec::with_capacity(2 * nv + 2 * self.levels.len() + rows);
        Ok(())
    }

    /// Forgets the velocity and the active limits of the last tick, for example after a jump of the
    /// positions.
    pub fn reset(&mut self) {
        self.velocity.fill(0.0);
        self.levels.iter_mut().for_each(|level| level.solver.forget());
    }
}
