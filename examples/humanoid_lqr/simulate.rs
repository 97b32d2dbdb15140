//! Simulation with pushes and noise.

use mujoco_safe::element::Body;
use mujoco_safe::{Controller, Data, Result, Trajectory};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::set_point::SetPoint;

/// Default start of a push, s.
pub const PUSH_AT: f64 = 1.0;
/// Height of the centre of mass below which the robot counts as fallen, as a fraction of the height
/// at the set-point.
const FALLEN: f64 = 0.8;

/// Horizontal push of the torso.
#[derive(Clone, Copy, Debug)]
pub struct Push {
    /// Force, N, world frame.
    pub force: [f64; 2],
    /// Start, s.
    pub start: f64,
    /// Duration, s.
    pub duration: f64,
}

/// Disturbance of a simulation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disturbance {
    pub push: Option<Push>,
    /// Standard deviation of the noise on each control.
    pub noise: f64,
    pub seed: u64,
}

/// Recorded simulation.
#[derive(Clone, Debug)]
pub struct Run {
    pub trajectory: Trajectory,
    /// Centre of mass of the torso's subtree at each record, m.
    pub com: Vec<[f64; 3]>,
    /// Time of the fall, s.
    pub fell_at: Option<f64>,
}

impl Run {
    pub fn upright(&self) -> bool {
        self.fell_at.is_none()
    }

    /// Returns the final height of the centre of mass, m.
    pub fn final_height(&self) -> f64 {
        self.com.last().map_or(0.0, |com| com[2])
    }
}

/// Simulates from the set-point until the time is over or the robot has fallen.
pub fn simulate(
    data: &mut Data,
    controller: &mut dyn Controller,
    set_point: &SetPoint,
    torso: Body<'_>,
    seconds: f64,
    disturbance: Disturbance,
) -> Result<Run> {
    set_point.apply(data)?;
    let fallen = FALLEN * data.body(torso).subtree_com()[2];
    let steps = (seconds / data.model().timestep()).round() as usize;
    let mut random = Xoshiro256PlusPlus::seed_from_u64(disturbance.seed);
    let noise = Normal::new(0.0, disturbance.noise).expect("the deviation is finite and not negative");
    let mut run = Run {
        trajectory: Trajectory::with_capacity(data.model(), steps),
        com: Vec::with_capacity(steps),
        fell_at: None,
    };
    for _ in 0..steps {
        controller.control(data)?;
        if disturbance.noise > 0.0 {
            for ctrl in data.ctrl_mut() {
                *ctrl += noise.sample(&mut random);
            }
        }
        if let Some(push) = disturbance.push {
            let pushing = (push.start..push.start + push.duration).contains(&data.time());
            let [x, y] = if pushing { push.force } else { [0.0, 0.0] };
            *data.body_mut(torso).xfrc_applied_mut() = [x, y, 0.0, 0.0, 0.0, 0.0];
        }
        run.trajectory.push(data)?;
        data.step()?;
        let com = *data.body(torso).subtree_com();
        run.com.push(com);
        if com[2] < fallen {
            run.fell_at = Some(data.time());
            break;
        }
    }
    Ok(run)
}
