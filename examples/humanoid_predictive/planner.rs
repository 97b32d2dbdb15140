//! Predictive sampling around a regulator: simulates many rollouts under the regulator plus random
//! perturbations of its controls, and applies the best one until a better one is found (Howell,
//! Gileadi, Tunyasuvunakool, Zakka, Erez, Tassa, *Predictive Sampling: Real-time Behaviour
//! Synthesis with MuJoCo*, 2022).

use mujoco_safe::rollout::{Rollout, Workers};
use mujoco_safe::{Controller, Data, Lqr, Result, StateSpec};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::cost::{Cost, OUTPUTS};
use crate::robot::Robot;

/// Number of rollouts per decision.
pub const SAMPLES: usize = 32;
/// Planning horizon, s.
pub const HORIZON: f64 = 0.5;
/// Number of simulation steps between two decisions.
pub const STEPS: usize = 4;
/// Number of knots of the piecewise linear perturbation.
const KNOTS: usize = 4;
/// Time between two knots, s.
const SPACING: f64 = HORIZON / (KNOTS - 1) as f64;
/// Standard deviations of the noise, assigned to the rollouts in turn.
const DEVIATIONS: [f64; 3] = [0.05, 0.15, 0.3];
/// Limit of a perturbation: the full width of a control range.
const MAX_PERTURBATION: f64 = 2.0;

/// Initial state of a rollout. It excludes the push, which the planner cannot foresee.
const STATE: StateSpec = StateSpec::FULL_PHYSICS.union(StateSpec::WARMSTART);

/// Piecewise linear perturbation of the controls over time.
#[derive(Clone)]
struct Perturbation {
    /// Values at the knots, `(KNOTS, nu)`, row-major.
    knots: Vec<f64>,
    /// Time of the first knot, s.
    start: f64,
}

impl Perturbation {
    /// Interpolates the perturbation of a control at a time. Outside of the knots it is constant.
    fn at(&self, time: f64, index: usize) -> f64 {
        let nu = self.knots.len() / KNOTS;
        let position = ((time - self.start) / SPACING).clamp(0.0, (KNOTS - 1) as f64);
        let (low, fraction) = (position as usize, position.fract());
        let knot = |knot: usize| self.knots[knot.min(KNOTS - 1) * nu + index];
        knot(low) * (1.0 - fraction) + knot(low + 1) * fraction
    }

    /// Resamples the perturbation at knots that start at another time.
    fn from(&self, start: f64) -> Self {
        let nu = self.knots.len() / KNOTS;
        let knots = (0..KNOTS * nu).map(|entry| self.at(start + (entry / nu) as f64 * SPACING, entry % nu));
        Self { knots: knots.collect(), start }
    }
}

/// Regulator with a perturbation.
struct Policy<'p> {
    lqr: Lqr,
    perturbation: &'p Perturbation,
}

impl Controller for Policy<'_> {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        self.lqr.control(data)?;
        let time = data.time();
        for (index, ctrl) in data.ctrl_mut().iter_mut().enumerate() {
            let nominal = self.lqr.ctrl0()[index];
            // Clamp the regulator's part, so that the perturbation can always take effect.
            let regulated = nominal + (*ctrl - nominal).clamp(-1.0, 1.0);
            *ctrl = (regulated + self.perturbation.at(time, index)).clamp(-1.0, 1.0);
        }
        Ok(())
    }
}

/// Controller that plans by predictive sampling.
pub struct Planner {
    workers: Workers,
    lqr: Lqr,
    cost: Cost,
    random: Xoshiro256PlusPlus,
    best: Perturbation,
    state: Vec<f64>,
    /// Number of simulation steps before the next decision.
    steps_left: usize,
    /// Time of each decision, s, and the predicted cost of the selected rollout.
    pub decisions: Vec<(f64, f64)>,
}

impl Planner {
    pub fn new(robot: &Robot, seed: u64) -> Result<Self> {
        let model = &robot.model;
        Ok(Self {
            workers: Workers::new(model.clone()),
            lqr: robot.lqr.clone(),
            cost: Cost::new(robot)?,
            random: Xoshiro256PlusPlus::seed_from_u64(seed),
            best: Perturbation { knots: vec![0.0; KNOTS * model.nu()], start: 0.0 },
            state: vec![0.0; model.state_size(STATE)],
            steps_left: 0,
            decisions: Vec::new(),
        })
    }

    /// Simulates candidates and selects the best one.
    fn plan(&mut self, data: &Data) -> Result<()> {
        data.state_into(STATE, &mut self.state)?;
        // Candidates: the previous best, the regulator alone, and noisy variations of the previous
        // best.
        let previous = self.best.from(data.time());
        let mut candidates = vec![previous; SAMPLES];
        candidates[1].knots.fill(0.0);
        for (index, candidate) in candidates.iter_mut().enumerate().skip(2) {
            let deviation = DEVIATIONS[index % DEVIATIONS.len()];
            for knot in &mut candidate.knots {
                let noise: f64 = StandardNormal.sample(&mut self.random);
                *knot = (*knot + deviation * noise).clamp(-MAX_PERTURBATION, MAX_PERTURBATION);
            }
        }
        let steps = (HORIZON / self.workers.model().timestep()).round() as usize;
        let (lqr, cost) = (&self.lqr, &self.cost);
        let result = Rollout::on(&self.workers, SAMPLES, steps)
            .with_initial_state(STATE, &self.state)
            .with_controllers(|index| Policy { lqr: lqr.clone(), perturbation: &candidates[index] })
            .with_recorded_states(StateSpec::empty())
            .with_outputs(OUTPUTS, |data, row| cost.write_outputs(data, row))
            .with_chunk(1)
            .run()?;
        let costs: Vec<f64> = (0..SAMPLES).map(|index| cost.mean(result.outputs_of(index).rows())).collect();
        let best = (0..SAMPLES).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
        self.decisions.push((data.time(), costs[best]));
        self.best = candidates.swap_remove(best);
        Ok(())
    }
}

impl Controller for Planner {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if self.steps_left == 0 {
            self.plan(data)?;
            self.steps_left = STEPS;
        }
        self.steps_left -= 1;
        Policy { lqr: self.lqr.clone(), perturbation: &self.best }.control(data)
    }
}
