//! The fixed-lag smoother.

mod passes;
mod step;

use std::collections::VecDeque;

use self::passes::Passes;
use self::step::Step;
use super::filter::ExtendedKalmanFilter;
use super::update::{ReadingOutcome, Update};
use crate::data::Data;
use crate::derivative::LinearisationReport;
use crate::error::{Error, Result};
use crate::matrix::{Matrix, StridedView};
use crate::memory;

/// Smoother over a window of the last steps: estimates each state from all readings in the window,
/// also those after it.
///
/// The [filter](ExtendedKalmanFilter) runs as usual and gives the estimate of the present state
/// without delay. [`smooth`](Self::smooth) improves all estimates in the window. The filter does
/// not depend on that.
///
/// Each iteration linearises the steps and the readings about the trajectory of the iteration
/// before, and computes the Rauch–Tung–Striebel smoother of that linear system. This is the
/// Gauss–Newton method for the most probable trajectory (B. Bell, *The iterated Kalman smoother as
/// a Gauss–Newton method*, 1994), so one iteration suffices for a linear system. The prior of the
/// window is the prediction of the filter at its first step.
///
/// The backward pass is that of A. Bryson and M. Frazier, as modified by G. Bierman (*Fixed
/// interval smoothing with discrete measurements*, 1973). It has the result of the smoother by H.
/// Rauch, F. Tung and C. Striebel (1965) without the inverse of a predicted covariance, so a part
/// of the state may have no noise.
///
/// ```
/// use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise};
/// use mujoco_safe::{Data, Matrix, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let model = data.model().clone();
/// let noise = ProcessNoise::new(&model).with_forces(&[0.1, 0.01])?;
/// let tip = Measurement::new(&model).with_sensor("tip_position", 0.01)?;
/// let variances = Matrix::from_diagonal(&[0.01; 4]);
/// let filter = ExtendedKalmanFilter::new(Data::new(&model)?, &variances, noise, tip)?;
///
/// let mut smoother = FixedLagSmoother::new(filter, 50)?;
/// let mut readings = [0.0; 3];
/// data.qpos_mut()[1] = 0.1;
/// for _ in 0..100 {
///     data.step()?;
///     smoother.filter().measurement().select_into(data.sensordata(), &mut readings)?;
///     smoother.update(&[0.0], &readings)?;
///     smoother.predict(&[0.0])?;
/// }
/// let report = smoother.smooth()?;
/// assert!(report.converged, "{report:?}");
/// // The estimate of half a second ago.
/// let (state, covariance) = (smoother.state(0), smoother.covariance(0));
/// assert!(covariance[(1, 1)] < smoother.filter().covariance()[(1, 1)]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Debug)]
pub struct FixedLagSmoother {
    filter: ExtendedKalmanFilter,
    /// The first [`len`](Self::len) are in use, from the oldest on.
    steps: VecDeque<Step>,
    used: usize,
    iterations: usize,
    tolerance: f64,
    /// Simulation in which the trajectory is linearised.
    data: Data,
    passes: Passes,
}

/// Result of [`FixedLagSmoother::smooth`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Smoothing {
    /// Number of iterations.
    pub iterations: usize,
    /// Largest change of an estimate in the last iteration, in standard deviations of its error.
    pub change: f64,
    /// `true` if the change is below the tolerance. Otherwise the iterations ended at their limit,
    /// or because the next trajectory is not one that the simulation accepts. The trajectory is the
    /// last valid one.
    pub converged: bool,
}

impl FixedLagSmoother {
    /// Creates a smoother over a window of this number of states, the present one included. The
    /// memory for all of them is allocated here.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for an empty window or one for which there is no memory, and the errors
    /// of [`Data::try_clone`].
    pub fn new(filter: ExtendedKalmanFilter, window: usize) -> Result<Self> {
        Error::check_range(window > 0, "the window of a FixedLagSmoother", window, "at least 1")?;
        let (nx, inputs) = filter.plant.sizes();
        let model = filter.data().model();
        let sizes = [nx, inputs, model.nu(), filter.measurement().len()];
        let state = model.nq() + model.nv() + model.na();
        // About the size of the buffers of a step. The filter has matrices of these sizes.
        let (nz, ny) = (nx + inputs, filter.measurement().len());
        let values = 4 * nz * nz + 2 * ny * (nz + 3) + 3 * state + 2 * model.nu();
        let bytes = size_of::<Step>() + size_of::<f64>() * values;
        memory::check("states in the window of a FixedLagSmoother", window, bytes)?;
        let data = filter.data().try_clone()?;
        let steps = (0..window).map(|_| Step::new(state, sizes)).collect();
        let passes = Passes::new(&filter);
        let mut smoother = Self { filter, steps, used: 0, iterations: 5, tolerance: 1e-2, data, passes };
        smoother.push()?;
        Ok(smoother)
    }

    /// Sets the largest number of iterations of [`smooth`](Self::smooth), by default 5, and the
    /// largest change at which it stops, in standard deviations of the error, by default 0.01.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for no iterations, and for a tolerance that is negative or NaN.
    pub fn with_iterations(mut self, iterations: usize, tolerance: f64) -> Result<Self> {
        Error::check_range(iterations > 0, "the iterations of a FixedLagSmoother", iterations, "at least 1")?;
        Error::check_range(tolerance >= 0.0, "the tolerance of a FixedLagSmoother", tolerance, "not negative")?;
        (self.iterations, self.tolerance) = (iterations, tolerance);
        Ok(self)
    }

    /// Returns the filter, which has the estimate of the present state.
    pub fn filter(&self) -> &ExtendedKalmanFilter {
        &self.filter
    }

    /// Returns the simulation of the filter for changes of its inputs and of its model, which then
    /// act in the whole window.
    pub fn data_mut(&mut self) -> &mut Data {
        self.filter.data_mut()
    }

    /// Returns the number of states in the window, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "the window is never empty")]
    pub fn len(&self) -> usize {
        self.used
    }

    /// Returns the estimate `[qpos; qvel; act]` of a state in the window, from the oldest, 0, to
    /// the present one.
    ///
    /// # Panics
    ///
    /// If there is no such state.
    pub fn state(&self, index: usize) -> &[f64] {
        &self.step(index).state
    }

    /// Returns the covariance of the error of a state in the window, `(nx, nx)`.
    ///
    /// # Panics
    ///
    /// If there is no such state.
    pub fn covariance(&self, index: usize) -> &Matrix {
        &self.step(index).covariance
    }

    fn step(&self, index: usize) -> &Step {
        let used = self.used;
        assert!(index < used, "there is no state {index}: the window has {used}, counted from 0");
        &self.steps[index]
    }

    /// Corrects the present estimate, as [`ExtendedKalmanFilter::update`] does, and keeps the
    /// readings that were used. The controls must be those of [`predict`](Self::predict).
    ///
    /// # Errors
    ///
    /// As for [`ExtendedKalmanFilter::update`], and [`Error::Unsupported`] for a second update in a
    /// step.
    pub fn update(&mut self, controls: &[f64], readings: &[f64]) -> Result<Update> {
        let Self { filter, steps, used, .. } = self;
        let step = &mut steps[*used - 1];
        if step.has_readings {
            let what = "a second update of a FixedLagSmoother in one step: give all readings to the first one";
            return Err(Error::Unsupported(what.to_owned()));
        }
        let update = filter.update(controls, readings)?;
        step.controls.copy_from_slice(controls);
        for ((kept, reading), outcome) in step.readings.iter_mut().zip(readings).zip(filter.outcomes()) {
            *kept = if *outcome == ReadingOutcome::Used { *reading } else { f64::NAN };
        }
        step.has_readings = true;
        filter.data().physics_state_into(&mut step.state)?;
        step.inputs.copy_from_slice(&filter.inputs);
        step.covariance.as_mut_slice().copy_from_slice(filter.covariance().as_slice());
        Ok(update)
    }

    /// Advances the filter by a step, as [`ExtendedKalmanFilter::predict`] does, and the window.
    ///
    /// # Errors
    ///
    /// As for [`ExtendedKalmanFilter::predict`].
    pub fn predict(&mut self, controls: &[f64]) -> Result<LinearisationReport> {
        let report = self.filter.predict(controls)?;
        self.steps[self.used - 1].controls.copy_from_slice(controls);
        self.push()?;
        Ok(report)
    }

    /// Starts again from the state of a simulation, with a window of one state.
    ///
    /// # Errors
    ///
    /// As for [`ExtendedKalmanFilter::reset`].
    pub fn reset<'a>(&mut self, data: &Data, covariance: impl Into<StridedView<'a>>) -> Result<()> {
        self.filter.reset(data, covariance)?;
        self.used = 0;
        self.push()
    }

    /// Improves all estimates in the window by all readings in it. Allocates nothing, under the
    /// conditions of [`ExtendedKalmanFilter::update`].
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if the model of [`data_mut`](Self::data_mut) was replaced, and other
    /// errors of the simulation or of a residual along the trajectory that was estimated before
    /// this call.
    pub fn smooth(&mut self) -> Result<Smoothing> {
        self.filter.plant.check()?;
        self.data.clone_from(self.filter.data());
        std::mem::swap(&mut self.data, &mut self.filter.plant.data);
        let result = self.iterate();
        std::mem::swap(&mut self.data, &mut self.filter.plant.data);
        result
    }

    fn iterate(&mut self) -> Result<Smoothing> {
        let Self { filter, steps, used, passes, .. } = self;
        let steps = &mut steps.make_contiguous()[..*used];
        let mut smoothing = Smoothing { iterations: 0, change: f64::INFINITY, converged: false };
        while smoothing.iterations < self.iterations && !smoothing.converged {
            match passes.run(filter, steps) {
                Ok(Some(change)) => smoothing.change = change,
                // The trajectory of the iteration before is not valid.
                Ok(None) => break,
                Err(error) if smoothing.iterations == 0 => return Err(error),
                Err(_) => {
                    Passes::undo(steps);
                    break;
                }
            }
            smoothing.iterations += 1;
            smoothing.converged = smoothing.change <= self.tolerance;
        }
        Ok(smoothing)
    }

    /// Appends the present prediction to the window.
    fn push(&mut self) -> Result<()> {
        if self.used == self.steps.len() {
            self.steps.rotate_left(1);
        } else {
            self.used += 1;
        }
        let step = &mut self.steps[self.used - 1];
        self.filter.data().physics_state_into(&mut step.state)?;
        step.prior_state.copy_from_slice(&step.state);
        for covariance in [&mut step.covariance, &mut step.prior_covariance] {
            covariance.as_mut_slice().copy_from_slice(self.filter.covariance().as_slice());
        }
        step.inputs.fill(0.0);
        step.controls.fill(0.0);
        step.readings.fill(f64::NAN);
        step.has_readings = false;
        Ok(())
    }
}
