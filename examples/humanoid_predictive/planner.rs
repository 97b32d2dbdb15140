//! Predictive sampling about a regulator: many futures are simulated, each under the regulator and something random added to its
//! controls, and the best of them is what is done, until there is a better one (Howell, Gileadi, Tunyasuvunakool, Zakka, Erez,
//! Tassa, *Predictive Sampling: Real-time Behaviour Synthesis with MuJoCo*, 2022).

use mujoco_safe::rollout::{Rollout, Workers};
use mujoco_safe::{Controller, Data, Lqr, Result, StateSpec};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::cost::{Cost, JUDGED};
use crate::robot::Robot;

/// How many futures are tried for a decision.
pub const SAMPLES: usize = 32;
/// How long a future is, s.
pub const HORIZON: f64 = 0.5;
/// How many steps of the simulation a decision is for.
pub const STEPS: usize = 4;
/// The points of a future between which what is added to the controls goes along straight lines.
const KNOTS: usize = 4;
/// How far apart they are, s.
const SPACING: f64 = HORIZON / (KNOTS - 1) as f64;
/// The standard deviations of what is random, one after another.
const DEVIATIONS: [f64; 3] = [0.05, 0.15, 0.3];
/// What is added is not larger than what takes a control from one end of its range to the other.
const MOST: f64 = 2.0;

/// The state that a future begins in. The push is not part of it: nobody knows that it is coming, or how long it will last.
const STATE: StateSpec = StateSpec::FULL_PHYSICS.union(StateSpec::WARMSTART);

/// What is added to the controls of the regulator, over time.
#[derive(Clone)]
struct Addition {
    /// `(KNOTS, nu)`, row by row.
    knots: Vec<f64>,
    /// The time of the first knot, s.
    start: f64,
}

impl Addition {
    /// What is added to a control at a time. Before the first knot it is the first, behind the last the last.
    fn at(&self, time: f64, index: usize) -> f64 {
        let nu = self.knots.len() / KNOTS;
        let place = ((time - self.start) / SPACING).clamp(0.0, (KNOTS - 1) as f64);
        let (low, part) = (place as usize, place.fract());
        let knot = |knot: usize| self.knots[knot.min(KNOTS - 1) * nu + index];
        knot(low) * (1.0 - part) + knot(low + 1) * part
    }

    /// The same, with knots from another time on.
    fn from(&self, start: f64) -> Self {
        let nu = self.knots.len() / KNOTS;
        let knots = (0..KNOTS * nu).map(|entry| self.at(start + (entry / nu) as f64 * SPACING, entry % nu));
        Self { knots: knots.collect(), start }
    }
}

/// The regulator, and something added to it.
struct Policy<'p> {
    lqr: Lqr,
    addition: &'p Addition,
}

impl Controller for Policy<'_> {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        self.lqr.control(data)?;
        let time = data.time();
        for (index, ctrl) in data.ctrl_mut().iter_mut().enumerate() {
            let held = self.lqr.ctrl0()[index];
            // The regulator alone may not use up more than the range, or nothing could be added.
            let regulated = held + (*ctrl - held).clamp(-1.0, 1.0);
            *ctrl = (regulated + self.addition.at(time, index)).clamp(-1.0, 1.0);
        }
        Ok(())
    }
}

/// The controller that plans.
pub struct Planner {
    workers: Workers,
    lqr: Lqr,
    cost: Cost,
    random: Xoshiro256PlusPlus,
    best: Addition,
    state: Vec<f64>,
    /// How many steps of the simulation are left before the next decision.
    left: usize,
    /// When each decision was made, and what the future costs that it expects.
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
            best: Addition { knots: vec![0.0; KNOTS * model.nu()], start: 0.0 },
            state: vec![0.0; model.state_size(STATE)],
            left: 0,
            decisions: Vec::new(),
        })
    }

    /// Tries futures, and takes the best.
    fn decide(&mut self, data: &Data) -> Result<()> {
        data.state_into(STATE, &mut self.state)?;
        // What was the best so far, the regulator alone, and the best with something random added.
        let so_far = self.best.from(data.time());
        let mut futures = vec![so_far; SAMPLES];
        futures[1].knots.fill(0.0);
        for (index, future) in futures.iter_mut().enumerate().skip(2) {
            let deviation = DEVIATIONS[index % DEVIATIONS.len()];
            for knot in &mut future.knots {
                let noise: f64 = StandardNormal.sample(&mut self.random);
                *knot = (*knot + deviation * noise).clamp(-MOST, MOST);
            }
        }
        let steps = (HORIZON / self.workers.model().timestep()).round() as usize;
        let (lqr, cost) = (&self.lqr, &self.cost);
        let result = Rollout::on(&self.workers, SAMPLES, steps)
            .initial_state(STATE, &self.state)
            .controllers(|index| Policy { lqr: lqr.clone(), addition: &futures[index] })
            .record(StateSpec::empty())
            .outputs(JUDGED, |data, row| cost.judge(data, row))
            .chunk(1)
            .run()?;
        let costs: Vec<f64> = (0..SAMPLES).map(|index| cost.mean(result.outputs_of(index).rows())).collect();
        let best = (0..SAMPLES).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
        self.decisions.push((data.time(), costs[best]));
        self.best = futures.swap_remove(best);
        Ok(())
    }
}

impl Controller for Planner {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if self.left == 0 {
            self.decide(data)?;
            self.left = STEPS;
        }
        self.left -= 1;
        Policy { lqr: self.lqr.clone(), addition: &self.best }.control(data)
    }
}
