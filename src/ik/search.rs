//! Global inverse kinematics: iterations from random positions.
//!
//! The damping of an iteration is half the weighted square of the residuals (T. Sugihara,
//! "Solvability-unconcerned inverse kinematics by the Levenberg–Marquardt method", IEEE
//! Transactions on Robotics 27, 2011).

use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Ik;
use super::limits::{self, Motion};
use super::tick::IkStatus;
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::math::axis_angle2quat;
use crate::model::Model;
use crate::numerics::spatial::norm;

/// Iterations without progress after which a start is given up.
const PATIENCE: u32 = 10;
/// Factor of the error that counts as progress.
const PROGRESS: f64 = 0.8;

/// Options of [`Ik::search`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions {
    /// Largest component of the residuals of the first priority at a solution, m and rad; 1e-6 by
    /// default. Components with the weight zero do not count.
    pub tolerance: f64,
    /// Number of starts: the present position, and random ones; 100 by default.
    pub starts: u32,
    /// Largest number of iterations of a start; 100 by default.
    pub iterations: u32,
    /// Largest change of a degree of freedom in an iteration, m or rad; 0.7 by default.
    pub step: f64,
    /// Seed of the random positions; 0 by default.
    pub seed: u64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self { tolerance: 1e-6, starts: 100, iterations: 100, step: 0.7, seed: 0 }
    }
}

/// Outcome of [`Ik::search`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchOutcome {
    /// The positions are a solution.
    Found(SearchResult),
    /// No start led to a solution. The positions are those with the smallest error.
    NotFound(SearchResult),
}

/// Numbers of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchResult {
    /// Largest component of the residuals of the first priority, m and rad, or of a violation of a
    /// distance or an equality constraint.
    pub error: f64,
    /// Number of starts.
    pub starts: u32,
    /// Number of iterations of all starts.
    pub iterations: u32,
}

impl SearchOutcome {
    /// Returns the numbers, if a solution was found.
    pub fn found(self) -> Option<SearchResult> {
        if let Self::Found(result) = self { Some(result) } else { None }
    }
}

impl Ik {
    /// Searches for positions at which the residuals of the first priority are zero, and those of
    /// lower priorities small. It starts from the present position and then from random ones:
    /// joints with a range within it, other hinges within one turn, and other slides and free
    /// joints at their present positions. The result depends on the seed and the present position
    /// only.
    ///
    /// Limits of velocities and accelerations do not count, and prescribed joints do not move.
    /// Tasks that cannot be fulfilled, such as a posture, need a lower
    /// [priority](super::Task::with_priority).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a tolerance or a step that is not above zero, and zero starts; the
    /// errors of [`solve`](Self::solve).
    ///
    /// # Panics
    ///
    /// As for [`solve`](Self::solve).
    ///
    /// ```
    /// use mujoco_safe::control::residual::{Frame, FramePosition};
    /// use mujoco_safe::ik::{Ik, SearchOptions, Task};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// let model = data.model().clone();
    /// let mut ik = Ik::new(&model);
    /// ik.prescribe_velocity("root", Some(&[0.0; 6]))?;
    /// ik.add_task(Task::new(FramePosition::body(&model, "hand_left")?.with_target([0.3, 0.2, 1.3])));
    /// let found = ik.search(&mut data, &SearchOptions::default())?.found().expect("within reach");
    /// assert!(found.error < 1e-6);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "global inverse kinematics")]
    pub fn search(&mut self, data: &mut Data, options: &SearchOptions) -> Result<SearchOutcome> {
        self.check_model(data)?;
        let SearchOptions { tolerance, starts, iterations, step, seed } = *options;
        for (what, value) in
            [("the tolerance", tolerance), ("the step", step), ("the number of starts", f64::from(starts))]
        {
            let what = format_args!("{what} of a search");
            Error::check_range(value > 0.0 && value.is_finite(), what, value, "above zero and finite")?;
        }
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        self.start.copy_from_slice(data.qpos());
        self.best.copy_from_slice(data.qpos());
        let mut result = SearchResult { error: f64::INFINITY, starts: 0, iterations: 0 };
        for start in 0..starts {
            result.starts = start + 1;
            data.qpos_mut().copy_from_slice(&self.start);
            if start > 0 {
                let model = data.model().clone();
                self.randomise(&model, data.qpos_mut(), &mut random);
            }
            self.levels.iter_mut().for_each(|level| level.solver.forget());
            let mut least = f64::INFINITY;
            let mut waited = 0;
            for _ in 0..=iterations {
                let status = self.displace(data, Motion::Free(step))?;
                result.iterations += 1;
                let error = self.search_error(data, tolerance)?;
                if error < result.error {
                    result.error = error;
                    self.best.copy_from_slice(data.qpos());
                }
                if error <= tolerance {
                    return Ok(SearchOutcome::Found(result));
                }
                if error < PROGRESS * least {
                    (least, waited) = (error, 0);
                } else {
                    waited += 1;
                }
                if waited > PATIENCE || status != IkStatus::Solved {
                    break;
                }
                limits::integrate(&mut self.inequalities, data, &self.displacement, 1.0)?;
            }
        }
        data.qpos_mut().copy_from_slice(&self.best);
        data.kinematics()?;
        Ok(SearchOutcome::NotFound(result))
    }

    /// Returns the error at the positions before the last displacement.
    fn search_error(&self, data: &mut Data, tolerance: f64) -> Result<f64> {
        let first = self.levels[0].priority;
        let mut error = self.constraints.violation;
        for task in self.tasks.iter().filter(|task| task.priority == first && task.weight != 0.0 && !task.is_rate) {
            for (value, weight) in task.error.iter().zip(&task.weights) {
                if *weight != 0.0 {
                    error = error.max(value.abs());
                }
            }
        }
        // The distances and ranges are checked only at solutions.
        if error <= tolerance {
            error = error.max(limits::violation(data));
            for inequality in &self.inequalities {
                error = error.max(inequality.violation(data)?);
            }
        }
        Ok(error)
    }

    /// Writes random positions.
    fn randomise(&self, model: &Model, qpos: &mut [f64], random: &mut impl Rng) {
        for joint in 0..model.njnt() {
            let (place, dof) = (ffi::size(model.jnt_qposadr()[joint]), ffi::size(model.jnt_dofadr()[joint]));
            if self.limits.prescribed[dof].is_some() {
                continue;
            }
            let range = (model.jnt_limited()[joint] != 0).then(|| model.jnt_range()[joint]);
            let range = range.filter(|range| range.iter().all(|end| end.is_finite()));
            let part: f64 = random.random_range(0.0..1.0);
            let uniform = |[from, to]: [f64; 2]| from + part * (to - from);
            match (JointType::of_field(model.jnt_type()[joint]), range) {
                (JointType::Hinge | JointType::Slide, Some(range)) => qpos[place] = uniform(range),
                (JointType::Hinge, None) => {
                    qpos[place] = uniform([-std::f64::consts::PI, std::f64::consts::PI]);
                }
                (JointType::Ball, range) => {
                    let axis: [f64; 3] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
                    let largest = range.map_or(std::f64::consts::PI, |range| range[1].min(std::f64::consts::PI));
                    let length = norm(&axis).max(1e-9);
                    let quaternion = axis_angle2quat(&axis.map(|value| value / length), uniform([0.0, largest]));
                    qpos[place..place + 4].copy_from_slice(&quaternion);
                }
                (JointType::Slide, None) | (JointType::Free, _) => {}
            }
        }
    }
}
