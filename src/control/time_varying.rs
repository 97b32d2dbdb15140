//! The linear-quadratic regulator along a trajectory, with a gain for each step.

use std::sync::Arc;

use super::LqrWeights;
use super::feedback::{Feedback, clamp};
use super::riccati::{RiccatiError, RiccatiRecursion};
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::derivative::{self, LinearisationReport, Lineariser, StateSpace};
use crate::error::{Error, Result};
use crate::matrix::{Matrix, StridedView};
use crate::memory;

/// Regulator that follows a trajectory with a table of gains, one for each step.
///
/// In step `k` the controls are `ctrl = controls[k] − K[k] dx`, clamped to their ranges, where `dx`
/// is the deviation from `states[k]`, as in [`Lqr`](super::Lqr). The time of the simulation
/// determines the step: the table starts at [`start`](Self::start), and each row lasts for a time
/// step of the model. Before the start, the first row applies. After the end, the last state is the
/// set-point, with the gain and the controls of the last step. If the trajectory ends at rest, this
/// holds the simulation there for a while; use an [`Lqr`](super::Lqr) to hold it for longer.
///
/// [`control`](Controller::control) allocates nothing, and clones share the table.
///
/// ```
/// use mujoco_safe::control::TimeVaryingLqr;
/// use mujoco_safe::derivative::TransitionOptions;
/// use mujoco_safe::{Controller, Data, Lineariser, LqrWeights, Matrix, StateSpec, sample};
///
/// // Record a pole that falls for a second.
/// let mut data = Data::new(sample::cartpole())?;
/// data.qpos_mut()[1] = 0.2;
/// let start = data.state(StateSpec::INTEGRATION);
/// let (mut states, controls) = (Matrix::zeros(101, 4), Matrix::zeros(100, 1));
/// for step in 0..=100 {
///     data.physics_state_into(states.row_mut(step))?;
///     data.step()?;
/// }
///
/// // Follow that trajectory from another initial angle.
/// data.set_state(StateSpec::INTEGRATION, &start)?;
/// let weights = LqrWeights::diagonal(&[10.0, 100.0, 1.0, 1.0], &[0.01]);
/// let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default())?;
/// let mut follow = TimeVaryingLqr::along(&mut lineariser, &data, states, controls, &weights, &Matrix::identity(4))?;
/// data.qpos_mut()[1] = 0.25;
/// for _ in 0..100 {
///     follow.control(&mut data)?;
///     data.step()?;
/// }
/// assert!((data.qpos()[1] - follow.states()[(100, 1)]).abs() < 0.01);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct TimeVaryingLqr {
    table: Arc<Table>,
    start: f64,
    feedback: Feedback,
}

/// Trajectory with its gains.
#[derive(Debug)]
struct Table {
    states: Matrix,
    controls: Matrix,
    gains: Vec<Matrix>,
}

impl TimeVaryingLqr {
    /// Creates the regulator along a trajectory of `N` steps: `states` `(N + 1, nq + nv + na)`,
    /// each `[qpos; qvel; act]`, and `controls` `(N, nu)`.
    ///
    /// The lineariser linearises each step. The gains minimise the cost of deviations: `weights` in
    /// each step, and `terminal`, `(nx, nx)` with `nx = 2 nv + na`, at the end. The table starts at
    /// the present time of `data`. The applied forces, mocap poses and user data of `data` apply
    /// along the trajectory; see [`Lineariser::along`].
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::Solver`] with a [`RiccatiError`] for weights of
    /// a wrong shape or a cost without a minimum, and the errors of [`Lineariser::along`].
    pub fn along<'t>(
        lineariser: &mut Lineariser,
        data: &Data,
        states: Matrix,
        controls: Matrix,
        weights: &LqrWeights,
        terminal: impl Into<StridedView<'t>>,
    ) -> Result<Self> {
        check_trajectory(data, &states, &controls)?;
        let (steps, width) = (controls.nrows(), states.ncols());
        let starts = Matrix::from_row_major(steps, width, states.as_slice()[..steps * width].to_vec());
        // The regulator does not use the sensors.
        let report = LinearisationReport::new(lineariser.options().method, None);
        let mut systems = vec![(StateSpace::zeros(data.model()), report); steps];
        lineariser.along_without_sensors_into(data, &starts, &controls, &mut systems)?;
        let gains = Self::solve(systems.iter().map(|(system, _)| system), weights, terminal)?;
        Self::with_gains(data, states, controls, gains)
    }

    /// Computes the gains for a sequence of linear systems, each `(nu, nx)`.
    ///
    /// # Errors
    ///
    /// As for [`RiccatiRecursion::step_back`].
    pub fn solve<'a, 't>(
        systems: impl DoubleEndedIterator<Item = &'a StateSpace>,
        weights: &LqrWeights,
        terminal: impl Into<StridedView<'t>>,
    ) -> Result<Vec<Matrix>, RiccatiError> {
        let mut recursion = RiccatiRecursion::new(terminal, weights.r.nrows())?;
        let mut gains = systems
            .rev()
            .map(|system| recursion.step_back(&system.a, &system.b, weights).cloned())
            .collect::<Result<Vec<_>, _>>()?;
        gains.reverse();
        Ok(gains)
    }

    /// Creates the regulator along a trajectory, as [`along`](Self::along) does, with `N` given
    /// gains, each `(nu, 2 nv + na)`. The table starts at the present time of `data`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, and [`Error::Invalid`] for a trajectory without steps.
    pub fn with_gains(data: &Data, states: Matrix, controls: Matrix, gains: Vec<Matrix>) -> Result<Self> {
        check_trajectory(data, &states, &controls)?;
        check_gains(data, &controls, &gains)?;
        let (nx, ..) = derivative::sizes(data.model());
        let table = Arc::new(Table { states, controls, gains });
        Ok(Self { table, start: data.time(), feedback: Feedback::new(nx) })
    }

    /// Creates a regulator that holds the present controls of a simulation for `steps` steps, with
    /// gains of zero. Its states are all the present state. It is the policy of a
    /// [`Planner`](super::predictive::Planner) before the first plan.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for zero steps, or more than there is memory for.
    pub fn hold_controls(data: &Data, steps: usize) -> Result<Self> {
        let (nx, nu, _) = derivative::sizes(data.model());
        let state = data.physics_state();
        let numbers = state.len() + nu + nu * nx;
        memory::check("steps", steps, numbers * size_of::<f64>() + size_of::<Matrix>())?;
        let states = Matrix::from_row_major(steps + 1, state.len(), state.repeat(steps + 1));
        let controls = Matrix::from_row_major(steps, nu, data.ctrl().repeat(steps));
        Self::with_gains(data, states, controls, vec![Matrix::zeros(nu, nx); steps])
    }

    /// Replaces the trajectory and the gains, whose shapes are the same as in
    /// [`with_gains`](Self::with_gains). The table starts at the present time of `data`. Allocates
    /// only if a clone shares the table, or if the shapes change.
    ///
    /// # Errors
    ///
    /// As for [`with_gains`](Self::with_gains).
    pub fn overwrite(&mut self, data: &Data, states: &Matrix, controls: &Matrix, gains: &[Matrix]) -> Result<()> {
        check_trajectory(data, states, controls)?;
        check_gains(data, controls, gains)?;
        if let Some(table) = Arc::get_mut(&mut self.table) {
            copy(states, &mut table.states);
            copy(controls, &mut table.controls);
            table.gains.resize_with(gains.len(), Matrix::default);
            gains.iter().zip(&mut table.gains).for_each(|(gain, output)| copy(gain, output));
        } else {
            let (states, controls, gains) = (states.clone(), controls.clone(), gains.to_vec());
            self.table = Arc::new(Table { states, controls, gains });
        }
        self.start = data.time();
        let (nx, ..) = derivative::sizes(data.model());
        self.feedback.resize(nx);
        Ok(())
    }

    /// Returns the number of steps of the trajectory, `N`.
    pub fn steps(&self) -> usize {
        self.table.gains.len()
    }

    /// Returns the states along the trajectory, `(N + 1, nq + nv + na)`.
    pub fn states(&self) -> &Matrix {
        &self.table.states
    }

    /// Returns the controls along the trajectory, `(N, nu)`.
    pub fn controls(&self) -> &Matrix {
        &self.table.controls
    }

    /// Returns the gains, one for each step, each `(nu, 2 nv + na)`.
    pub fn gains(&self) -> &[Matrix] {
        &self.table.gains
    }

    /// Returns the time at which the trajectory starts, in seconds of the simulation.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Sets the time at which the trajectory starts, in seconds of the simulation.
    pub fn set_start(&mut self, time: f64) {
        self.start = time;
    }

    /// Returns the row of [`states`](Self::states) for the present time of a simulation, from 0 to
    /// `N`.
    pub fn row(&self, data: &Data) -> usize {
        // The cast maps negative values and NaN to 0.
        let row = ((data.time() - self.start) / data.model().timestep()).round() as usize;
        row.min(self.steps())
    }
}

impl Controller for TimeVaryingLqr {
    #[inline]
    fn control(&mut self, data: &mut Data) -> Result<()> {
        let row = self.row(data);
        let step = row.min(self.steps() - 1);
        let Table { states, controls, gains } = &*self.table;
        let model = data.model();
        let (state, nq, nv) = (states.row(row), model.nq(), model.nv());
        Error::check_length("a state of a TimeVaryingLqr", state.len(), model.state_size(StateSpec::PHYSICS))?;
        Error::check_length("the controls of a TimeVaryingLqr", controls.ncols(), model.nu())?;
        self.feedback.measure(data, &state[..nq], Some(&state[nq..nq + nv]), &state[nq + nv..])?;
        data.ctrl_mut().copy_from_slice(controls.row(step));
        self.feedback.subtract(&gains[step], data.ctrl_mut());
        clamp(data);
        Ok(())
    }
}

/// Checks the shapes of the states and controls of a trajectory.
fn check_trajectory(data: &Data, states: &Matrix, controls: &Matrix) -> Result<()> {
    let (model, steps) = (data.model(), controls.nrows());
    if steps == 0 {
        return Err(Error::out_of_range("the number of steps of a trajectory", 0, "at least 1"));
    }
    Error::check_shape("the controls of a trajectory", controls.shape(), (steps, model.nu()))?;
    let expected = (steps + 1, model.state_size(StateSpec::PHYSICS));
    Error::check_shape("the states of a trajectory", states.shape(), expected)
}

/// Copies a matrix. Allocates only if the shape changes.
fn copy(from: &Matrix, to: &mut Matrix) {
    if from.shape() == to.shape() {
        to.as_mut_slice().copy_from_slice(from.as_slice());
    } else {
        *to = from.clone();
    }
}

/// Checks the number and the shapes of the gains along a trajectory.
fn check_gains(data: &Data, controls: &Matrix, gains: &[Matrix]) -> Result<()> {
    let (nx, nu, _) = derivative::sizes(data.model());
    Error::check_length("the gains along a trajectory", gains.len(), controls.nrows())?;
    gains.iter().try_for_each(|gain| Error::check_shape("a gain along a trajectory", gain.shape(), (nu, nx)))
}
