//! The swing-up itself: plan, follow, hold.

use std::sync::Arc;
use std::time::{Duration, Instant};

use mujoco_safe::control::ilqr::{CostExpansion, Ilqr, IlqrOptions, IlqrSolution, TrajectoryCost};
use mujoco_safe::nalgebra::DMatrix;
use mujoco_safe::{
    Controller, Data, Lineariser, Lqr, LqrWeights, Matrix, Model, Result, TimeVaryingLqr, Trajectory, TransitionOptions,
};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// How long the plan is, s.
const PLANNED: f64 = 2.5;
/// How long the simulation is, s.
pub const SIMULATED: f64 = 6.0;
/// The pole is upright where it leans less, rad, ...
const UPRIGHT: f64 = 0.02;
/// ... and at rest where it moves less, rad/s, and the cart too, m/s.
const AT_REST: f64 = 0.02;
/// How far a simulation is from the plan when it begins, at most, rad: the plan does not know.
const UNKNOWN: f64 = 0.1;

/// What it costs to swing a pole up. The state is `[cart position, pole angle, cart velocity, pole velocity]`.
///
/// The angle costs by its cosine, so that it does not matter which way round the pole comes up.
struct SwingUp;

/// What each step costs of the controls, of the distance from the middle and of the height that the pole has not got, ...
const EFFORT: f64 = 0.02;
const DISTANCE: f64 = 0.05;
const HEIGHT: f64 = 0.02;
/// ... and what the same, and the velocities, cost in the end.
const LAST_DISTANCE: f64 = 100.0;
const LAST_HEIGHT: f64 = 1000.0;
const LAST_VELOCITY: f64 = 50.0;

impl TrajectoryCost for SwingUp {
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> f64 {
        let [position, angle, cart, pole] = *state else { unreachable!("a cart-pole has four states") };
        let below = 1.0 - angle.cos();
        match controls {
            Some(controls) => EFFORT * controls[0].powi(2) + DISTANCE * position.powi(2) + HEIGHT * below,
            None => {
                LAST_DISTANCE * position.powi(2) + LAST_HEIGHT * below + LAST_VELOCITY * (cart.powi(2) + pole.powi(2))
            }
        }
    }

    fn expand(&self, _step: usize, state: &[f64], controls: Option<&[f64]>, expansion: &mut CostExpansion) {
        let (distance, height) = if controls.is_some() { (DISTANCE, HEIGHT) } else { (LAST_DISTANCE, LAST_HEIGHT) };
        expansion.x[0] = 2.0 * distance * state[0];
        expansion.xx[(0, 0)] = 2.0 * distance;
        expansion.x[1] = height * state[1].sin();
        // Below the middle the cosine is curved the other way; a cost that is not convex would have no best change.
        expansion.xx[(1, 1)] = height * state[1].cos().max(0.0);
        match controls {
            Some(controls) => {
                expansion.u[0] = 2.0 * EFFORT * controls[0];
                expansion.uu[(0, 0)] = 2.0 * EFFORT;
            }
            None => {
                for (index, velocity) in state.iter().enumerate().skip(2) {
                    expansion.x[index] = 2.0 * LAST_VELOCITY * velocity;
                    expansion.xx[(index, index)] = 2.0 * LAST_VELOCITY;
                }
            }
        }
    }
}

/// A swing-up from one beginning.
pub struct Attempt {
    /// The plan.
    pub plan: IlqrSolution,
    /// How long it took to find it.
    pub planning: Duration,
    /// What the simulation went through.
    pub trajectory: Trajectory,
    /// How long the simulation took.
    pub simulating: Duration,
    /// When the pole has come up and stayed there, s.
    pub up_at: Option<f64>,
}

impl Attempt {
    /// How long the plan is, s.
    pub fn planned(&self, model: &Model) -> f64 {
        self.plan.controls.nrows() as f64 * model.timestep()
    }
}

/// Plans, and has a simulation follow the plan, from beginnings and with first guesses that follow from the seed. The simulation
/// begins a little off where the plan does.
pub fn attempt(model: &Arc<Model>, seed: u64, threads: usize) -> Result<Attempt> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let mut data = Data::new(model.clone())?;
    let timestep = model.timestep();
    let steps = (PLANNED / timestep).round() as usize;

    // Hanging, more or less, somewhere on the rail. At first the controls are almost nothing.
    let hanging = std::f64::consts::PI + between(-0.2, 0.2);
    let begin = [between(-0.3, 0.3), hanging];
    data.qpos_mut().copy_from_slice(&begin);
    let guess = Matrix::from_row_major(steps, 1, (0..steps).map(|_| between(-0.05, 0.05)).collect());

    let start = Instant::now();
    let options = IlqrOptions { iterations: 300, tolerance: 1e-5, threads, ..Default::default() };
    let plan = Ilqr::new(model.clone(), options)?.solve(&data, &guess, &SwingUp)?;
    let mut controller = Follow::new(&data, &plan, threads)?;
    let planning = start.elapsed();

    data.qpos_mut()[1] += between(-UNKNOWN, UNKNOWN);
    let simulated = (SIMULATED / timestep).round() as usize;
    let mut trajectory = Trajectory::with_capacity(model, simulated);
    let start = Instant::now();
    trajectory.record(&mut data, &mut controller, simulated)?;
    let simulating = start.elapsed();

    let is_up = |record: usize| {
        let (qpos, qvel) = (trajectory.qpos(record), trajectory.qvel(record));
        lean(qpos[1]).abs() < UPRIGHT && qvel.iter().all(|velocity| velocity.abs() < AT_REST)
    };
    let down = (0..simulated).rev().find(|&record| !is_up(record)).map_or(0, |record| record + 1);
    let up_at = (down < simulated).then(|| trajectory.times()[down]);
    Ok(Attempt { plan, planning, trajectory, simulating, up_at })
}

/// How far the pole is from upright, rad: an angle between −π and π.
pub fn lean(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Follows the plan, and then holds the pole.
struct Follow {
    table: TimeVaryingLqr,
    hold: Lqr,
    /// When the plan ends, s.
    until: f64,
}

impl Follow {
    fn new(data: &Data, plan: &IlqrSolution, threads: usize) -> Result<Self> {
        let model = data.model();
        let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
        // Upright, on the side of the turns that the plan has come up on.
        let steps = plan.controls.nrows();
        let end = plan.states.row(steps);
        let mut upright = Data::new(model.clone())?;
        upright.qpos_mut()[1] = end[1] - lean(end[1]);
        let mut transition =
            Lineariser::new(model.clone(), TransitionOptions { threads, ..TransitionOptions::default() })?;
        let (system, _) = transition.linear_system(&mut upright)?;
        let solution = Lqr::solve(&system, &weights)?;
        let hold = Lqr::with_gain(&upright, Matrix::from(&solution.k))?;
        // Along the way, deviations cost what they cost the regulator that takes over.
        let terminal: DMatrix<f64> = solution.p;
        let (states, controls) = (plan.states.clone(), plan.controls.clone());
        let table = TimeVaryingLqr::along(&mut transition, data, states, controls, &weights, &terminal)?;
        Ok(Self { table, hold, until: steps as f64 * model.timestep() })
    }
}

impl Controller for Follow {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if data.time() < self.until { self.table.control(data) } else { self.hold.control(data) }
    }
}
