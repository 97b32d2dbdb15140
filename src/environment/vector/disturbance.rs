//! Noise and delays between a policy and the simulations of a vector environment.

use std::ops::RangeInclusive;

use super::VectorEnvironment;
use crate::environment::Task;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::memory;
use crate::rollout::Random;

/// Stream of the random numbers for noise and delays in an episode.
pub(super) const STREAM: u64 = u64::MAX;

/// # Noise and delays
///
/// A policy that is learnt with noise and delays tolerates the noise and delays of a robot. An
/// episode draws them from [`Random::stream`]`(seed, index, episode, u64::MAX)`: the delay, the
/// noise of the first observation, and for each step the noise of the actions and the noise of the
/// observation.
///
/// ```
/// use mujoco_safe::environment::{Hopper, VectorEnvironment};
///
/// // Motors that act one to three steps late, with 2 % noise, and encoders with an error of 0.01 rad or rad/s.
/// let mut hoppers = VectorEnvironment::new(Hopper::model(), Hopper, 4, 42)?
///     .with_action_delay(1..=3)?
///     .with_action_noise(&[0.02; 3])?
///     .with_observation_noise(&[0.01; 11])?;
/// assert_ne!(hoppers.observations(), hoppers.batch().observations());
/// hoppers.step(&[1.0; 12])?;
/// assert!(hoppers.batch().controls()[(0, 0)].abs() < 0.2); // the first action has not arrived yet
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
impl<T: Task> VectorEnvironment<T> {
    /// Adds normally distributed noise of these standard deviations `(nu)` to the actions, and
    /// starts new episodes. The reward depends on the actions with noise.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if there are not `nu` deviations, [`Error::Invalid`] if one is negative or
    /// not finite, and the errors of [`reset`](Self::reset).
    pub fn with_action_noise(mut self, deviations: &[f64]) -> Result<Self> {
        let nu = self.batch.model().nu();
        Error::check_length("the standard deviations of the action noise (nu)", deviations.len(), nu)?;
        check_deviations("the standard deviation of the noise of action", deviations)?;
        self.disturbance.action_deviations = deviations.to_vec();
        self.disturb()
    }

    /// Adds normally distributed noise of these standard deviations `(nobs)` to the observations,
    /// and starts new episodes. The reward, the end of an episode and
    /// [`Batch::observations`](crate::Batch::observations) do not depend on this noise.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if there are not `nobs` deviations, [`Error::Invalid`] if one is negative
    /// or not finite, and the errors of [`reset`](Self::reset).
    pub fn with_observation_noise(mut self, deviations: &[f64]) -> Result<Self> {
        let nobs = self.final_observations.ncols();
        Error::check_length("the standard deviations of the observation noise (nobs)", deviations.len(), nobs)?;
        check_deviations("the standard deviation of the noise of observation", deviations)?;
        self.disturbance.observation_deviations = deviations.to_vec();
        self.disturb()
    }

    /// Delays the actions by a number of steps of the environment, and starts new episodes. The
    /// number is drawn from this range for each episode. Until the first action arrives, the
    /// controls are zero, plus noise.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the range is empty, or if memory does not suffice for the actions of
    /// the longest delay, and the errors of [`reset`](Self::reset).
    pub fn with_action_delay(mut self, steps: RangeInclusive<usize>) -> Result<Self> {
        if steps.is_empty() {
            return Err(Error::out_of_range("the range of the delay", format!("{steps:?}"), "not empty"));
        }
        let slots = steps.end().saturating_add(1);
        let nu = self.batch.model().nu();
        memory::check("steps of the delay", slots, self.len() * nu * size_of::<f64>())?;
        self.disturbance.recent = Matrix::zeros(self.len(), slots.saturating_mul(nu));
        self.disturbance.range = steps;
        self.disturb()
    }

    fn disturb(mut self) -> Result<Self> {
        let (count, nu) = (self.len(), self.batch.model().nu());
        self.disturbance.actions = Matrix::zeros(count, nu);
        self.disturbance.observations = Matrix::zeros(count, self.final_observations.ncols());
        self.disturbance.rows = vec![Row { random: Random::new(0, 0, 0), delay: 0 }; count];
        self.reset()?;
        Ok(self)
    }
}

fn check_deviations(what: &str, deviations: &[f64]) -> Result<()> {
    match deviations.iter().position(|deviation| !(deviation.is_finite() && *deviation >= 0.0)) {
        None => Ok(()),
        Some(index) => {
            Err(Error::out_of_range(format!("{what} {index}"), deviations[index], "finite and not negative"))
        }
    }
}

/// Random numbers and delay of the present episode of a simulation.
#[derive(Clone)]
struct Row {
    random: Random,
    delay: usize,
}

/// Noise and delays of a vector environment, and the arrays with them, which are empty without
/// noise and delays.
pub(super) struct Disturbance {
    action_deviations: Vec<f64>,
    observation_deviations: Vec<f64>,
    /// Delays of the actions, steps.
    range: RangeInclusive<usize>,
    rows: Vec<Row>,
    /// Ring buffers of the last actions `(n, slots × nu)`. Step `k` of an episode has slot
    /// `k % slots`.
    recent: Matrix,
    /// Actions with noise and delay `(n, nu)`.
    actions: Matrix,
    /// Observations with noise `(n, nobs)`.
    pub(super) observations: Matrix,
}

impl Disturbance {
    pub(super) fn none() -> Self {
        Self {
            action_deviations: Vec::new(),
            observation_deviations: Vec::new(),
            range: 0..=0,
            rows: Vec::new(),
            recent: Matrix::default(),
            actions: Matrix::default(),
            observations: Matrix::default(),
        }
    }

    pub(super) fn has_observation_noise(&self) -> bool {
        !self.observation_deviations.is_empty()
    }

    fn changes_actions(&self) -> bool {
        !self.action_deviations.is_empty() || *self.range.end() > 0
    }

    /// Draws the delay of a new episode, and sets its first observation with noise.
    pub(super) fn start(&mut self, index: usize, mut random: Random, observation: &[f64]) {
        let Some(row) = self.rows.get_mut(index) else { return };
        let (least, most) = (*self.range.start(), *self.range.end());
        let more = random.uniform(0.0, (most - least) as f64 + 1.0) as usize;
        *row = Row { random, delay: least.saturating_add(more).min(most) };
        self.observations.row_mut(index).copy_from_slice(observation);
        row.add_noise(&self.observation_deviations, self.observations.row_mut(index));
    }

    /// Delays actions `(n, nu)` and adds noise to them. `steps` are the numbers of steps of the
    /// episodes so far.
    pub(super) fn disturb_actions(&mut self, actions: &[f64], steps: &[u64]) {
        if !self.changes_actions() {
            return;
        }
        let nu = self.actions.ncols();
        for (index, row) in self.rows.iter_mut().enumerate() {
            let (new, to) = (&actions[index * nu..][..nu], self.actions.row_mut(index));
            if *self.range.end() == 0 {
                to.copy_from_slice(new);
            } else {
                let (recent, slots) = (self.recent.row_mut(index), (*self.range.end() as u64).saturating_add(1));
                let place = |step: u64| (step % slots) as usize * nu;
                recent[place(steps[index])..][..nu].copy_from_slice(new);
                match steps[index].checked_sub(row.delay as u64) {
                    None => to.fill(0.0),
                    Some(step) => to.copy_from_slice(&recent[place(step)..][..nu]),
                }
            }
            row.add_noise(&self.action_deviations, to);
        }
    }

    /// Returns the actions that the simulations receive.
    pub(super) fn received<'a>(&'a self, actions: &'a [f64]) -> &'a [f64] {
        if self.changes_actions() { self.actions.as_slice() } else { actions }
    }

    /// Adds noise to the observations after a step.
    pub(super) fn disturb_observations(&mut self, observations: &mut Matrix) {
        for (index, row) in self.rows.iter_mut().enumerate() {
            row.add_noise(&self.observation_deviations, observations.row_mut(index));
        }
        self.observations.as_mut_slice().copy_from_slice(observations.as_slice());
    }
}

impl Row {
    fn add_noise(&mut self, deviations: &[f64], to: &mut [f64]) {
        for (value, deviation) in to.iter_mut().zip(deviations) {
            *value += deviation * self.random.normal();
        }
    }
}
