//! The swing-up: plan, track the plan, stabilise.

use std::sync::Arc;
use std::time::{Duration, Instant};

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{CostExpansion, Ilqr, IlqrOptions, IlqrSolution, TrajectoryCost};
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::{Controller, Data, Lineariser, Lqr, LqrWeights, Matrix, Model, Result, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Duration of the plan, s.
const PLAN_DURATION: f64 = 2.5;
/// Duration of the simulation, s.
pub const SIMULATION_DURATION: f64 = 6.0;
/// Angle within which the pole counts as upright, rad.
const UPRIGHT: f64 = 0.02;
/// Velocity below which the pole, rad/s, and the cart, m/s, count as at rest.
const AT_REST: f64 = 0.02;
/// Maximum deviation of the simulated initial angle from the planned one, rad.
const MAX_INITIAL_DEVIATION: f64 = 0.1;

/// Cost of a swing-up. The state is `[cart position, pole angle, cart velocity, pole velocity]`.
///
/// The angle enters through its cosine, so that both directions of rotation are equivalent.
struct SwingUp;

// Weights of each step: control, distance from the centre, and missing height of the pole.
const EFFORT: f64 = 0.02;
const DISTANCE: f64 = 0.05;
const HEIGHT: f64 = 0.02;
// Weights of the final state, which also includes the velocities.
const FINAL_DISTANCE: f64 = 100.0;
const FINAL_HEIGHT: f64 = 1000.0;
const FINAL_VELOCITY: f64 = 50.0;

impl TrajectoryCost for SwingUp {
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        let [position, angle, cart, pole] = *state else { unreachable!("a cart-pole has four states") };
        let below = 1.0 - angle.cos();
        Ok(match controls {
            Some(controls) => EFFORT * controls[0].powi(2) + DISTANCE * position.powi(2) + HEIGHT * below,
            None => {
                FINAL_DISTANCE * position.powi(2)
                    + FINAL_HEIGHT * below
                    + FINAL_VELOCITY * (cart.powi(2) + pole.powi(2))
            }
        })
    }

    fn expand(
        &self,
        _step: usize,
        state: &[f64],
        controls: Option<&[f64]>,
        expansion: &mut CostExpansion,
    ) -> Result<()> {
        let (distance, height) = if controls.is_some() { (DISTANCE, HEIGHT) } else { (FINAL_DISTANCE, FINAL_HEIGHT) };
        expansion.x[0] = 2.0 * distance * state[0];
        expansion.xx[(0, 0)] = 2.0 * distance;
        expansion.x[1] = height * state[1].sin();
        // Below the horizontal the cosine has negative curvature. A non-convex cost would have no
        // minimum along the step.
        expansion.xx[(1, 1)] = height * state[1].cos().max(0.0);
        match controls {
            Some(controls) => {
                expansion.u[0] = 2.0 * EFFORT * controls[0];
                expansion.uu[(0, 0)] = 2.0 * EFFORT;
            }
            None => {
                for (index, velocity) in state.iter().enumerate().skip(2) {
                    expansion.x[index] = 2.0 * FINAL_VELOCITY * velocity;
                    expansion.xx[(index, index)] = 2.0 * FINAL_VELOCITY;
                }
            }
        }
        Ok(())
    }
}

/// Swing-up from one initial state.
pub struct Attempt {
    /// Optimised plan.
    pub plan: IlqrSolution,
    /// Time to compute the plan.
    pub planning: Duration,
    /// Recorded simulation.
    pub trajectory: Trajectory,
    /// Time to run the simulation.
    pub simulating: Duration,
    /// Time from which the pole remains upright, s.
    pub up_at: Option<f64>,
}

impl Attempt {
    /// Returns the duration of the plan, s.
    pub fn planned(&self, model: &Model) -> f64 {
        self.plan.controls.nrows() as f64 * model.timestep()
    }
}

/// Plans a swing-up and simulates it. The seed determines the initial state, the initial guess and
/// the deviation of the simulation from the plan.
pub fn attempt(model: &Arc<Model>, seed: u64, threads: usize) -> Result<Attempt> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let mut data = Data::new(model.clone())?;
    let timestep = model.timestep();
    let steps = (PLAN_DURATION / timestep).round() as usize;

    // Start with a hanging pole somewhere on the rail, and with almost zero controls as the initial
    // guess.
    let hanging = std::f64::consts::PI + between(-0.2, 0.2);
    let start = [between(-0.3, 0.3), hanging];
    data.qpos_mut().copy_from_slice(&start);
    let guess = Matrix::from_row_major(steps, 1, (0..steps).map(|_| between(-0.05, 0.05)).collect());

    let start = Instant::now();
    let options = IlqrOptions::default().with_iterations(300).with_tolerance(1e-5).with_threads(threads);
    let plan = Ilqr::new(model.clone(), options)?.solve(&data, &guess, &SwingUp)?;
    let mut controller = TrackThenHold::new(&data, &plan, threads)?;
    let planning = start.elapsed();

    data.qpos_mut()[1] += between(-MAX_INITIAL_DEVIATION, MAX_INITIAL_DEVIATION);
    let simulated = (SIMULATION_DURATION / timestep).round() as usize;
    let mut trajectory = Trajectory::with_capacity(model, simulated);
    let start = Instant::now();
    trajectory.record(&mut data, &mut controller, simulated)?;
    let simulating = start.elapsed();

    let is_up = |record: usize| {
        let (qpos, qvel) = (trajectory.qpos(record), trajectory.qvel(record));
        lean(qpos[1]).abs() < UPRIGHT && qvel.iter().all(|velocity| velocity.abs() < AT_REST)
    };
    let settled = (0..simulated).rev().find(|&record| !is_up(record)).map_or(0, |record| record + 1);
    let up_at = (settled < simulated).then(|| trajectory.times()[settled]);
    Ok(Attempt { plan, planning, trajectory, simulating, up_at })
}

/// Returns the angle from upright, rad, wrapped to −π to π.
pub fn lean(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Controller that tracks the plan, and then stabilises the pole.
struct TrackThenHold {
    track: TimeVaryingLqr,
    hold: Lqr,
    /// End of the plan, s.
    plan_end: f64,
}

impl TrackThenHold {
    fn new(data: &Data, plan: &IlqrSolution, threads: usize) -> Result<Self> {
        let model = data.model();
        let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
        // Linearise at the upright angle, in the revolution in which the plan ends.
        let steps = plan.controls.nrows();
        let end = plan.states.row(steps);
        let mut upright = Data::new(model.clone())?;
        upright.qpos_mut()[1] = end[1] - lean(end[1]);
        let mut transition = Lineariser::new(model.clone(), TransitionOptions::default().with_threads(threads))?;
        let (system, _) = transition.linear_system(&mut upright)?;
        let solution = Lqr::solve(&system, &weights)?;
        let hold = Lqr::with_gain(&upright, solution.k)?;
        // Track the plan with the weights of the final regulator, and use its cost-to-go as the
        // terminal cost.
        let (states, controls) = (plan.states.clone(), plan.controls.clone());
        let track = TimeVaryingLqr::along(&mut transition, data, states, controls, &weights, &solution.p)?;
        Ok(Self { track, hold, plan_end: steps as f64 * model.timestep() })
    }
}

impl Controller for TrackThenHold {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if data.time() < self.plan_end { self.track.control(data) } else { self.hold.control(data) }
    }
}
